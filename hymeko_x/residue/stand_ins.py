"""Files of the source that are not where its image is: what the image has in their places.

A file that was copied goes by another name; what was converted, moved or drawn into the image is used as it is there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from msgspec.structs import replace

from hymeko_x import formats
from hymeko_x.ir.parts import Layer, Material, Mesh, Role, Texture
from hymeko_x.ir.provenance import StoredLook, StoredMesh
from hymeko_x.ir.values import X, Y, Z, rotate
from hymeko_x.source import suffix_of

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterable, Iterator

    from hymeko_x.ir.mechanism import Id, Mechanism, ShapeView

_PLACE_DIGITS = 6
"""Places that agree to so many digits behind the point are the same."""


def with_stand_ins(mechanism: Mechanism, image: Mechanism) -> Mechanism:
    """The restored mechanism, which knows what its image has in the places of its files."""
    places: dict[str, str] = dict(image.places)
    stored: dict[Id, StoredMesh | Texture] = {**image.stored, **_stored_meshes(mechanism, image)}
    for key, part in mechanism.assets():
        before = image.graph.vertices.get(key)
        if part.uri is None and isinstance(part, Mesh) and not part.vertices and isinstance(before, Mesh) and before.uri is not None:
            stored[key] = StoredMesh(before)  # it had points of its own, which are in that file
        if part.uri is None or not isinstance(before, Mesh | Texture) or before.uri in (None, part.uri):
            continue
        if is_copy(mechanism, key, part, before):
            places[part.uri] = image.places.get(before.uri or "", before.uri or "")
        else:
            stored[key] = StoredMesh(before) if isinstance(before, Mesh) else before
    return replace(mechanism, places=places, stored=stored) if places or stored else mechanism


def is_copy(mechanism: Mechanism, key: Id, part: object, before: object) -> bool:
    """Whether the image's file is the source's: of the same type, and nothing else about the points has changed."""
    if not isinstance(part, Mesh | Texture) or not isinstance(before, Mesh | Texture):
        return False
    if suffix_of(part.uri or "") != suffix_of(before.uri or ""):
        return False
    if isinstance(part, Mesh) and isinstance(before, Mesh):
        return part.scale == before.scale and not _is_moved(mechanism, key)
    return True


def _is_moved(mechanism: Mechanism, mesh: Id) -> bool:
    """Whether the source's format says that the points of a mesh are elsewhere than in its file."""
    return any(map(formats.is_placing, mechanism.extras.get(mesh, ())))


# ---- meshes that the image holds itself ------------------------------------------------------------------------------------------


class _Shown(NamedTuple):
    """A mesh where a shape shows it; equal ``place`` means that the same points are seen at the same place, for the same purpose."""

    view: ShapeView
    mesh: Mesh
    place: Hashable


def _stored_meshes(mechanism: Mechanism, image: Mechanism) -> dict[Id, StoredMesh]:
    """What the image has where the mechanism refers to a file: what the shape of the same name shows."""
    if not any(part.vertices for _, part in image.vertices(Mesh)):
        return {}
    found: dict[Id, StoredMesh] = {}
    for body, views in mechanism.shapes.items():
        seen = {shown.view.id: shown for shown in _shown(image.shapes.get(body, ()), image)}
        for shown in _shown(views, mechanism):
            there, key = seen.get(shown.view.id), shown.view.mesh
            if key is None or shown.mesh.uri is None or there is None or not there.mesh.vertices:
                continue
            scale = shown.mesh.scale
            if there.place != shown.place:
                if not _is_moved(mechanism, key) or there.view.pose != shown.view.pose:
                    continue
                scale = there.mesh.scale
            if key not in found or not found[key].looks:
                bare = replace(there.mesh, name=None, scale=scale)
                found[key] = StoredMesh(bare, tuple(_appearances(there, mechanism, image)))
    return found


def _shown(views: Iterable[ShapeView], mechanism: Mechanism) -> Iterator[_Shown]:
    for view in views:
        mesh = mechanism.graph.vertices.get(view.mesh) if view.mesh else None
        if isinstance(mesh, Mesh):
            axes = (rotate(view.pose.quat, axis) for axis in (X, Y, Z))
            matrix = [factor * number for axis, factor in zip(axes, mesh.scale, strict=True) for number in axis]
            place = tuple(round(number, _PLACE_DIGITS) + 0.0 for number in (*view.pose.xyz, *matrix))
            yield _Shown(view, mesh, (view.shape.role, place))


def _appearances(shown: _Shown, mechanism: Mechanism, image: Mechanism) -> Iterator[StoredLook]:
    """The materials that only the image has, which are those of the file; first that of the shape, on the rest of the mesh."""
    if shown.view.shape.role is not Role.VISUAL or shown.view.id in mechanism.subsets:
        return
    appearances = [(subset.material, subset.faces) for subset in image.subsets.get(shown.view.id, ())]
    if shown.view.material is not None:
        taken = {face for _, faces in appearances for face in faces}
        appearances.insert(0, (shown.view.material, tuple([face for face in range(len(shown.mesh.faces) // 3) if face not in taken])))
    for key, faces in appearances:
        material = image.graph.vertices.get(key)
        if faces and isinstance(material, Material) and key not in mechanism.graph.vertices:
            textures = (image.graph.vertices.get(edge.arcs[0].target) for _, edge, _ in image.graph.edges_at(key) if _is_colour(edge.data))
            yield StoredLook(material, next((part for part in textures if isinstance(part, Texture)), None), faces)


def _is_colour(part: object) -> bool:
    return isinstance(part, Layer) and part.use == "rgb"
