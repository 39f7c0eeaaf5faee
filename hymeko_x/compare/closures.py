"""Closures of two mechanisms that hold the same points together, in their bodies' frames or at frames of their own."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from hymeko_x.ir.mechanism import pose_weight
from hymeko_x.ir.parts import Loop
from hymeko_x.ir.values import apply

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.compare.diff import Difference, Tolerance
    from hymeko_x.ir.mechanism import Id, Mechanism, MountView, RobotEdge
    from hymeko_x.ir.values import Vec3

_ENDS = re.compile(r"\[[01]\]\.(target|weight.*)")


class Closures:
    """The closures that both mechanisms have, and the frames that only the second one has for them."""

    def __init__(self, before: Mechanism, after: Mechanism, tolerance: Tolerance) -> None:
        points = [(key, edge) for key, edge in before.graph.edges.items() if _joins_two_points(edge)]
        mounted, other_mounted = (_mounted(mechanism) if points else {} for mechanism in (before, after))
        self.alike: set[Id] = set()
        self.anchors: set[Id] = set()
        for key, edge in points:
            other = after.graph.edges.get(key)
            if other is None or not _joins_two_points(other):
                continue
            if _hold_alike(_ends(edge, mounted), _ends(other, other_mounted), tolerance):
                self.alike.add(key)
                frames = [arc.target for arc in other.arcs if arc.target in other_mounted and arc.target not in before.graph.vertices]
                self.anchors |= {*frames, *(other_mounted[frame].id for frame in frames)}

    def describes_the_same(self, difference: Difference) -> bool:
        """Whether it is in how a closure that holds the same points describes them, or one of its frames is new."""
        if difference.element in self.alike:
            return _ENDS.fullmatch(difference.field) is not None
        return difference.element in self.anchors and not difference.field and difference.before is None


def _joins_two_points(edge: RobotEdge) -> bool:
    return isinstance(edge.data, Loop) and edge.data.kind == "connect" and len(edge.arcs) == 2


def _mounted(mechanism: Mechanism) -> Mapping[Id, MountView]:
    return {view.mounted: view for views in mechanism.mounts.values() for view in views if view.mounted.kind == "frame"}


def _ends(edge: RobotEdge, mounted: Mapping[Id, MountView]) -> dict[Id, Vec3]:
    """The point in m on each of the two bodies."""
    found = {}
    for arc in edge.arcs:
        point, view = pose_weight(arc).xyz, mounted.get(arc.target)
        body = arc.target if view is None else view.body
        found[body] = point if view is None else apply(view.pose, point)
    return found


def _hold_alike(ends: dict[Id, Vec3], others: dict[Id, Vec3], tolerance: Tolerance) -> bool:
    return ends.keys() == others.keys() and all(
        tolerance.accepts(a, b) for body, point in ends.items() for a, b in zip(point, others[body], strict=True)
    )
