"""Friction of colliders that have none, for programs whose own defaults differ."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import counted
from hymeko_x.ir.parts import Role, Shape

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge
    from hymeko_x.rewrite.context import Context

SLIDING = 1.0
"""The sliding friction of a shape in MuJoCo, Newton and Gazebo where a file has none."""


def give_colliders_friction(mechanism: Mechanism, context: Context) -> Mechanism:
    """Every shape that collides has a friction, the usual one where the source has none. Idempotent."""
    edges: dict[Id, RobotEdge] = {}
    for view in mechanism.every_shape():
        edge = mechanism.graph.edges[view.id]
        if isinstance(edge.data, Shape) and edge.data.role is not Role.VISUAL and not edge.data.friction:
            edges[view.id] = replace(edge, data=replace(edge.data, friction=(SLIDING,)))
    if not edges:
        return mechanism
    message = f"{counted(len(edges), 'shape')} without friction get {SLIDING:g}, MuJoCo's and Newton's default ({context.reason})"
    context.report.note(codes.FOR_TARGET, message, element=str(next(iter(edges))))
    return mechanism.replace(edges=edges)
