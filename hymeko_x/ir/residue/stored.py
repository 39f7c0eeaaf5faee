"""The points that an image holds of files which the mechanism only names, as a stage of USD does."""

from __future__ import annotations

from collections import Counter, defaultdict
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.ir.parts import Mesh
from hymeko_x.ir.values import X, Y, Z, rotate

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterable, Iterator

    from hymeko_x.ir.mechanism import Id, Mechanism, ShapeView

_DIGITS = 6
"""Places that agree to so many digits behind the point are the same."""


class _Shown(NamedTuple):
    """A mesh where a shape shows it; equal ``place`` means that the same points are seen at the same place, for the same purpose."""

    id: Id
    mesh: Mesh
    place: Hashable


def stored_points(mechanism: Mechanism, image: Mechanism) -> dict[str, Mesh]:
    """By uri, the points that the image has where the mechanism refers to a file.

    What the image shows in several parts, one for each colour, is one mesh again, if no other mesh has its place.
    """
    if not any(part.vertices for _, part in image.vertices(Mesh)):
        return {}
    found: dict[str, Mesh] = {}
    for body, views in mechanism.shapes.items():
        named = list(_shown(views, mechanism))
        for shown, parts in zip(named, _parts(named, list(_shown(image.shapes.get(body, ()), image))), strict=True):
            uri = shown.mesh.uri
            if uri is not None and uri not in found and parts and all(part.mesh.vertices for part in parts):
                found[uri] = _joined([part.mesh for part in parts])
    return found


def _shown(views: Iterable[ShapeView], mechanism: Mechanism) -> Iterator[_Shown]:
    for view in views:
        mesh = mechanism.graph.vertices.get(view.mesh) if view.mesh else None
        if isinstance(mesh, Mesh):
            axes = (rotate(view.pose.quat, axis) for axis in (X, Y, Z))
            matrix = [factor * number for axis, factor in zip(axes, mesh.scale, strict=True) for number in axis]
            place = tuple(round(number, _DIGITS) + 0.0 for number in (*view.pose.xyz, *matrix))
            yield _Shown(view.id, mesh, (view.shape.role, place))


def _parts(named: list[_Shown], image: list[_Shown]) -> Iterator[list[_Shown]]:
    """What the image has of each: the shape itself, and what only the image has at its place; nothing where two could own that."""
    own = {shown.id for shown in named}
    owners = Counter(shown.place for shown in named)
    seen: dict[Hashable, list[_Shown]] = defaultdict(list)
    for shown in image:
        seen[shown.id if shown.id in own else shown.place].append(shown)
    for shown in named:
        itself = [part for part in seen[shown.id] if part.place == shown.place]
        others = seen[shown.place]
        yield [] if others and owners[shown.place] > 1 else [*itself, *others]


def _joined(meshes: list[Mesh]) -> Mesh:
    vertices: list[float] = []
    faces: list[int] = []
    for mesh in meshes:
        start = len(vertices) // 3
        faces += [start + index for index in mesh.faces] if start else mesh.faces
        vertices += mesh.vertices
    return Mesh(vertices=tuple(vertices), faces=tuple(faces))
