"""The points that an image holds of files which the mechanism only names, as a stage of USD does."""

from __future__ import annotations

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
    """By uri, the points that the image has where the mechanism refers to a file: those that the shape of the same name shows."""
    if not any(part.vertices for _, part in image.vertices(Mesh)):
        return {}
    found: dict[str, Mesh] = {}
    for body, views in mechanism.shapes.items():
        seen = {shown.id: shown for shown in _shown(image.shapes.get(body, ()), image)}
        for shown in _shown(views, mechanism):
            there, uri = seen.get(shown.id), shown.mesh.uri
            if uri is not None and there is not None and there.place == shown.place and there.mesh.vertices:
                found.setdefault(uri, Mesh(vertices=there.mesh.vertices, faces=there.mesh.faces))
    return found


def _shown(views: Iterable[ShapeView], mechanism: Mechanism) -> Iterator[_Shown]:
    for view in views:
        mesh = mechanism.graph.vertices.get(view.mesh) if view.mesh else None
        if isinstance(mesh, Mesh):
            axes = (rotate(view.pose.quat, axis) for axis in (X, Y, Z))
            matrix = [factor * number for axis, factor in zip(axes, mesh.scale, strict=True) for number in axis]
            place = tuple(round(number, _DIGITS) + 0.0 for number in (*view.pose.xyz, *matrix))
            yield _Shown(view.id, mesh, (view.shape.role, place))
