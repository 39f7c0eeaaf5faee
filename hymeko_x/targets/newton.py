"""Newton and Isaac Sim: a stage that follows REP 158, and whose drives have force limits. docs/targets.md has the sources."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.backends.usd.assetinfo import describe_stage, follow_rep_158
from hymeko_x.diagnostics import counted
from hymeko_x.ir.parts import Role, Shape
from hymeko_x.rewrite.densities import weigh_colliders
from hymeko_x.rewrite.dummies import make_dummies_frames
from hymeko_x.rewrite.efforts import limit_efforts_by_actuators
from hymeko_x.rewrite.inertia import give_every_body_mass
from hymeko_x.rewrite.roots import leave_scenery_out, put_world_links_into_world

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge
    from hymeko_x.rewrite.context import Context, Rule

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


RULES: tuple[Rule, ...] = (
    leave_scenery_out,
    put_world_links_into_world,
    make_dummies_frames,
    weigh_colliders,
    give_every_body_mass,
    give_colliders_friction,
    limit_efforts_by_actuators,
    describe_stage,
    follow_rep_158,
)
