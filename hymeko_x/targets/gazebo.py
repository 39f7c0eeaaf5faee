"""Gazebo Sim: a model whose joints can be commanded. docs/targets.md has the sources."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.backends.sdf.plugins import control_joints
from hymeko_x.diagnostics import listed
from hymeko_x.ir.graph import Edge
from hymeko_x.ir.parts import Dof, Joint
from hymeko_x.rewrite.efforts import limit_efforts_by_actuators
from hymeko_x.rewrite.roots import leave_scenery_out

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge
    from hymeko_x.rewrite.context import Context, Rule


def leave_limits_of_zero_out(mechanism: Mechanism, context: Context) -> Mechanism:
    """Limits of effort and velocity of 0, which authors of URDF write for unknown ones, are left out: Gazebo would hold the joint still."""
    edges: dict[Id, RobotEdge] = {}
    for view in mechanism.joints.values():
        dofs = tuple([_movable(dof) for dof in view.joint.dofs])
        if dofs != view.joint.dofs:
            edges[view.id] = Edge(Joint(dofs), mechanism.graph.edges[view.id].arcs)
    if edges:
        names = listed([f"'{key.name}'" for key in edges], 4)
        message = f"limits of effort or velocity of 0, by which Gazebo holds a joint still, are left out ({context.reason}): {names}"
        context.report.note(codes.FOR_TARGET, message)
    return mechanism.replace(edges=edges)


def _movable(dof: Dof) -> Dof:
    limits = dof.limits
    return replace(dof, limits=replace(limits, effort=limits.effort or None, velocity=limits.velocity or None))


RULES: tuple[Rule, ...] = (leave_scenery_out, leave_limits_of_zero_out, limit_efforts_by_actuators, control_joints)
