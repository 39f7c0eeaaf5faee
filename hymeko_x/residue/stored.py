"""What an image holds of the mesh files which the mechanism only names, as a stage of USD does: their points and looks."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.ir.mechanism import StoredLook, StoredMesh
from hymeko_x.ir.parts import Layer, Material, Mesh, Role, Texture
from hymeko_x.ir.values import X, Y, Z, rotate

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterable, Iterator

    from hymeko_x.ir.mechanism import Mechanism, ShapeView

_DIGITS = 6
"""Places that agree to so many digits behind the point are the same."""


class _Shown(NamedTuple):
    """A mesh where a shape shows it; equal ``place`` means that the same points are seen at the same place, for the same purpose."""

    view: ShapeView
    mesh: Mesh
    place: Hashable


def stored_meshes(mechanism: Mechanism, image: Mechanism) -> dict[str, StoredMesh]:
    """By uri, what the image has where the mechanism refers to a file: what the shape of the same name shows."""
    if not any(part.vertices for _, part in image.vertices(Mesh)):
        return {}
    found: dict[str, StoredMesh] = {}
    for body, views in mechanism.shapes.items():
        seen = {shown.view.id: shown for shown in _shown(image.shapes.get(body, ()), image)}
        for shown in _shown(views, mechanism):
            there, uri = seen.get(shown.view.id), shown.mesh.uri
            if uri is None or there is None or there.place != shown.place or not there.mesh.vertices:
                continue
            if uri not in found or not found[uri].looks:
                mesh = there.mesh
                bare = Mesh(None, (1.0, 1.0, 1.0), None, mesh.vertices, mesh.faces, mesh.texcoords, mesh.texfaces)
                found[uri] = StoredMesh(bare, tuple(_looks(there, mechanism, image)))
    return found


def _shown(views: Iterable[ShapeView], mechanism: Mechanism) -> Iterator[_Shown]:
    for view in views:
        mesh = mechanism.graph.vertices.get(view.mesh) if view.mesh else None
        if isinstance(mesh, Mesh):
            axes = (rotate(view.pose.quat, axis) for axis in (X, Y, Z))
            matrix = [factor * number for axis, factor in zip(axes, mesh.scale, strict=True) for number in axis]
            place = tuple(round(number, _DIGITS) + 0.0 for number in (*view.pose.xyz, *matrix))
            yield _Shown(view, mesh, (view.shape.role, place))


def _looks(shown: _Shown, mechanism: Mechanism, image: Mechanism) -> Iterator[StoredLook]:
    """The materials that only the image has, which are those of the file; first that of the shape, on the rest of the mesh."""
    if shown.view.shape.role is not Role.VISUAL or shown.view.id in mechanism.subsets:
        return
    looks = [(subset.material, subset.faces) for subset in image.subsets.get(shown.view.id, ())]
    if shown.view.material is not None:
        taken = {face for _, faces in looks for face in faces}
        looks.insert(0, (shown.view.material, tuple([face for face in range(len(shown.mesh.faces) // 3) if face not in taken])))
    for key, faces in looks:
        material = image.graph.vertices.get(key)
        if faces and isinstance(material, Material) and key not in mechanism.graph.vertices:
            textures = (image.graph.vertices.get(edge.arcs[0].target) for _, edge, _ in image.graph.edges_at(key) if _is_colour(edge.data))
            yield StoredLook(material, next((part for part in textures if isinstance(part, Texture)), None), faces)


def _is_colour(part: object) -> bool:
    return isinstance(part, Layer) and part.use == "rgb"
