"""Joints that follow others, for formats in which one scalar dof follows one other by a polynomial."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.ir.kinematics import dof_number
from hymeko_x.ir.mechanism import numbers_weight
from hymeko_x.ir.parts import Coupling, DofKind, Joint

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc
    from hymeko_x.rewrite.context import Context

_HIGHEST_POWER = 4
_SCALAR = (DofKind.HINGE, DofKind.SLIDE)


def make_couplings_scalar(mechanism: Mechanism, context: Context) -> Mechanism:
    """Couplings that cannot be a polynomial of one scalar dof are left out; so are those that lead nowhere.

    A leader that is fixed stays: its coordinate is 0, and the follower is held at the polynomial's constant.
    """
    gone: list[Id] = []
    for key, _, arcs in mechanism.edges(Coupling):
        if any(arc.target.kind == "tendon" for arc in arcs):
            continue
        reason = _unsayable(mechanism, arcs)
        if reason is not None:
            gone.append(key)
            context.report.warn(codes.NOT_SAID, f"{key} is left out: {reason}", mechanism.origin(key), element=str(key))
            continue
        held = next((arc.target for arc in arcs if arc.sign < 0 and _is_fixed(mechanism, arc.target)), None)
        if held is not None:
            context.report.note(
                codes.REWRITTEN,
                f"{key} follows {held}, which is fixed; the follower is held at the constant of the relation",
                mechanism.origin(key),
                element=str(key),
            )
    return mechanism.with_graph(mechanism.graph.replace(without=gone)) if gone else mechanism


def _unsayable(mechanism: Mechanism, arcs: tuple[RobotArc, ...]) -> str | None:
    """Why the target cannot say this coupling, or None when it can."""
    followers = [arc for arc in arcs if arc.sign > 0]
    leaders = [arc for arc in arcs if arc.sign < 0]
    if len(followers) != 1 or len(leaders) != 1:
        return f"it has {len(followers)} followers and {len(leaders)} leaders, and only one of each can be written"
    follower, leader = followers[0], leaders[0]
    if (follower.target, follower.role) == (leader.target, leader.role):
        return f"{follower.target} follows itself"
    if numbers_weight(follower)[:1] == (0.0,):
        return "its follower has the coefficient 0"
    if any(numbers_weight(leader)[_HIGHEST_POWER + 1 :]):
        return f"its polynomial has a power above {_HIGHEST_POWER}"
    if _is_fixed(mechanism, follower.target):
        return f"{follower.target} is fixed and cannot follow"
    return _missing(mechanism, follower) or _missing(mechanism, leader)


def _missing(mechanism: Mechanism, arc: RobotArc) -> str | None:
    view = mechanism.joints.get(arc.target)
    if view is None:
        return f"{arc.target} does not exist"
    if not view.joint.dofs:
        return None
    number = dof_number(view.joint, arc.role)
    if number is None:
        return f"{arc.target} has {len(view.joint.dofs)} dofs, and none is meant in particular"
    if view.joint.dofs[number].kind not in _SCALAR:
        return f"{arc.target} is a {view.joint.dofs[number].kind.value} joint, whose coordinate is not one number"
    return None


def _is_fixed(mechanism: Mechanism, joint: Id) -> bool:
    view = mechanism.joints.get(joint)
    return view is not None and view.joint == Joint()
