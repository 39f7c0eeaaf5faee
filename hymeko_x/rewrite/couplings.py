"""Couplings and tendons that a format cannot represent as they are."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.ir.graph import Edge
from hymeko_x.ir.kinematics import dof_number
from hymeko_x.ir.mechanism import numbers_weight
from hymeko_x.ir.names import free_name
from hymeko_x.ir.parts import Coupling, DofKind, Drive, Frame, Joint, Sense, Shape, Tendon
from hymeko_x.ir.tendons import wrong_path
from hymeko_x.rewrite.joints import interval

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc, RobotEdge
    from hymeko_x.rewrite.context import Context


# ---- couplings ---------------------------------------------------------------------------------------------------------


_HIGHEST_POWER = 4
_SCALAR = (DofKind.HINGE, DofKind.SLIDE)


def drop_inactive_couplings(mechanism: Mechanism, context: Context) -> Mechanism:
    """Couplings that a program can switch on later are left out of formats in which a follower always follows."""
    gone = [key for key, coupling, _ in mechanism.edges(Coupling) if not coupling.active]
    for key in gone:
        context.report.warn(codes.NOT_REPRESENTED, f"{key} is not active; it is left out", mechanism.origin(key), element=str(key))
    return mechanism.replace(without=gone)


def make_couplings_scalar(mechanism: Mechanism, context: Context) -> Mechanism:
    """Couplings that cannot be a polynomial of one scalar dof are left out; so are those that lead nowhere.

    A leader that is fixed stays: its coordinate is 0, and the follower is held at the polynomial's constant.
    """
    gone: list[Id] = []
    for key, _, arcs in mechanism.edges(Coupling):
        if any(arc.target.kind == "tendon" for arc in arcs):
            continue
        reason = _problem(mechanism, arcs)
        if reason is not None:
            gone.append(key)
            context.report.warn(codes.NOT_REPRESENTED, f"{key} is left out: {reason}", mechanism.origin(key), element=str(key))
            continue
        held = next((arc.target for arc in arcs if arc.sign < 0 and _is_fixed(mechanism, arc.target)), None)
        if held is not None:
            context.report.note(
                codes.REWRITTEN,
                f"{key} follows {held}, which is fixed; the follower is held at the constant of the relation",
                mechanism.origin(key),
                element=str(key),
            )
    return mechanism.replace(without=gone)


def _problem(mechanism: Mechanism, arcs: tuple[RobotArc, ...]) -> str | None:
    """Why the format cannot represent this coupling, or None when it can."""
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


# ---- tendons -----------------------------------------------------------------------------------------------------------


def drop_odd_tendons(mechanism: Mechanism, context: Context) -> Mechanism:
    """A tendon whose path is not valid is left out, with what acts on it."""
    placed = {view.mounted for views in mechanism.mounts.values() for view in views}
    gone: set[Id] = set()
    for key, tendon, arcs in mechanism.edges(Tendon):
        wrong = wrong_path(replace(tendon, armature=0.0), arcs, mechanism.graph.edges) or _unplaced_site(mechanism, arcs, placed)
        if wrong is not None:
            gone.add(key)
            context.report.warn(codes.NOT_REPRESENTED, f"{key} is left out: its path {wrong}", mechanism.origin(key), element=str(key))
    if not gone:
        return mechanism
    dependent = [key for key, edge in mechanism.graph.edges.items() if _leads_to(edge, gone)]
    ends = {arc.target for key in dependent for arc in mechanism.graph.edges[key].arcs}
    elements = [end for end in ends if end.kind in ("actuator", "sensor")]
    return mechanism.replace(without=[*gone, *dependent, *elements])


def _unplaced_site(mechanism: Mechanism, arcs: tuple[RobotArc, ...], placed: set[Id]) -> str | None:
    """The complaint about a path that leads through a site which is on no body, or None."""
    for arc in arcs:
        if arc.target.kind == "frame" and not (arc.target in placed and isinstance(mechanism.graph.vertices.get(arc.target), Frame)):
            return f"leads through {arc.target}, which is on no body"
    return None


def _leads_to(edge: RobotEdge, gone: set[Id]) -> bool:
    return isinstance(edge.data, Coupling | Drive | Sense) and any(arc.target in gone for arc in edge.arcs)


def make_tendons_sound(mechanism: Mechanism, context: Context) -> Mechanism:
    """Limits become closed intervals; a cable around a shape has no armature."""
    changed: dict[Id, RobotEdge] = {}
    for key, tendon, arcs in mechanism.edges(Tendon):
        findings: list[tuple[bool, str]] = []
        lower, upper = interval(tendon.limits, findings)
        sound = replace(tendon, limits=replace(tendon.limits, lower=lower, upper=upper))
        if wrong_path(sound, arcs, mechanism.graph.edges) is not None or tendon.armature < 0.0:
            findings.append((True, f"armature {tendon.armature!r} is left out: it is negative, or the cable leads around a shape"))
            sound = replace(sound, armature=0.0)
        for serious, text in findings:
            tell = context.report.warn if serious else context.report.note
            tell(codes.REWRITTEN, f"{key}: {text}", mechanism.origin(key), element=str(key))
        if sound != tendon:
            changed[key] = Edge(sound, arcs)
    return mechanism.replace(edges=changed)


def name_wrapped_shapes(mechanism: Mechanism, _context: Context) -> Mechanism:
    """A shape around which a tendon leads has a name that no other shape has."""
    wrapped = [arc.target for _, _, arcs in mechanism.edges(Tendon) for arc in arcs if arc.target.kind == "shape"]
    taken = {shape.name for _, shape, _ in mechanism.edges(Shape) if shape.name} if wrapped else set()
    changed: dict[Id, RobotEdge] = {}
    for key in wrapped:
        edge = mechanism.graph.edges[key]
        if key in changed or not isinstance(edge.data, Shape) or edge.data.name:
            continue
        name = free_name(key.name, taken.__contains__, "_")
        taken.add(name)
        changed[key] = replace(edge, data=replace(edge.data, name=name))
    return mechanism.replace(edges=changed)
