"""The arcs of an edge when its residue is put in: with the weights that were edited since, and notations that mean these."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.ir.graph import Edge
from hymeko_x.ir.parts import Role, Shape
from hymeko_x.ir.values import Pose
from hymeko_x.ir.written import between_ends, length_of
from hymeko_x.residue.alike import is_alike

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, RobotArc, RobotEdge
    from hymeko_x.residue import Change

_ROUNDING = 1e-9
"""How far a point may be from where its place has it, in m, or as a part of its largest coordinate."""
ARCS = ("arcs",)
"""The path of all arcs of an edge."""
_COLOUR = ("data", "rgba")
"""The path of a shape's own colour."""


def with_edited_weights(part: object, change: Change) -> Change:
    """A change of all arcs with the edited weights of those that source and image share; any other change as it is.

    The colour of a shape that was moved is then still that of its material, which the image does not have.
    """
    if change.path != ARCS or not isinstance(part, Edge) or not isinstance(change.there, tuple) or len(part.arcs) != len(change.there):
        return change
    edited: dict[tuple[int, Id], tuple[RobotArc, RobotArc]] = {}
    for now, then in zip(part.arcs, change.there, strict=True):
        if not is_alike(replace(now, weight=None), replace(then, weight=None)):
            return change
        if not is_alike(now.weight, then.weight):
            edited[now.sign, now.target] = now, then
    arcs = []
    for arc in change.value:  # type: ignore[attr-defined]
        now, then = edited.pop((arc.sign, arc.target), (arc, arc))
        if not is_alike(arc.weight, then.weight):
            return change
        arcs.append(replace(arc, weight=now.weight))
    return change if edited else change._replace(there=part.arcs, value=tuple(arcs))


def without_lost_material(part: object, changes: list[Change], edited: list[Change]) -> list[Change]:
    """The changes of a part. A visible shape that lost the colour which the image had of its material does not get that material."""
    is_bare = isinstance(part, Edge) and isinstance(part.data, Shape) and part.data.rgba is None and part.data.role is not Role.COLLISION
    if not is_bare or all(change.path != _COLOUR for change in edited):
        return changes
    return [change._replace(value=_without_material(change.value)) if change.path == ARCS else change for change in changes]


def _without_material(arcs: object) -> object:
    return tuple([arc for arc in arcs if arc.role != "material"]) if isinstance(arcs, tuple) else arcs


def with_own_ends(edge: RobotEdge) -> RobotEdge:
    """The edge, of whose arcs those that are written as two points (``fromto``) have the points of their place as it is now.

    The points are part of what is kept, and the place may have been edited since.
    """
    return Edge(edge.data, tuple([_with_ends(arc) for arc in edge.arcs]))


def _with_ends(arc: RobotArc) -> RobotArc:
    pose = arc.weight
    if not isinstance(pose, Pose) or pose.written is None or pose.written.kind != "fromto":
        return arc
    kept, own = pose.written.numbers, between_ends(pose, length_of(pose.written)).written
    assert own is not None
    room = _ROUNDING * max(1.0, *map(abs, kept))
    if all(abs(a - b) <= room for a, b in zip(own.numbers, kept, strict=True)):
        return arc
    return replace(arc, weight=replace(pose, written=own))
