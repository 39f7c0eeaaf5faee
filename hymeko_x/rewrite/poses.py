"""Named configurations that a format keeps as texts, as poses that every format can understand."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes, formats
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.parts import PoseSet, Stance

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc, RobotEdge
    from hymeko_x.rewrite.context import Context

    Poses = list[tuple[str, Mapping[Id, tuple[float, ...]]]]
    """Names, and the coordinates of each joint in rad or m."""


def name_poses(mechanism: Mechanism, context: Context) -> Mechanism:
    """The named configurations of the format that the robot came from (keyframes) as poses, unless it has poses already."""
    row = formats.of_source(mechanism)
    if row is None or row.poses is None or any(True for _ in mechanism.vertices(PoseSet)):
        return mechanism
    read: Callable[[Mechanism], Poses] = formats.loaded(row.poses)
    names = names_in_use(mechanism)
    vertices: dict[Id, PoseSet] = {}
    edges: dict[Id, RobotEdge] = {}
    for name, values in read(mechanism):
        key = names.take("pose", name or "pose")
        vertices[key] = PoseSet()
        arcs: list[RobotArc] = [Arc(joint, 0, numbers) for joint, numbers in values.items() if joint in mechanism.joints]
        edges[names.take("stance", key.name)] = Edge(Stance(), (Arc(key, 1), *arcs))
    if not vertices:
        return mechanism
    listed = ", ".join(f"'{key.name}'" for key in vertices)
    context.report.note(codes.FOR_TARGET, f"keyframes are named poses ({context.reason}): {listed}")
    return mechanism.replace(vertices=vertices, edges=edges)
