"""What acts on joints, where UsdPhysics or Newton has a schema for it: drives and mimics."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

from hymeko_x.backends.usd.prims import T
from hymeko_x.backends.usd.sheet import apply, point, put
from hymeko_x.formats import usd as words
from hymeko_x.ir.parts import Actuator, Coupling, DofKind, Drive, Joint

if TYPE_CHECKING:
    from hymeko_x.backends.usd.prims import Prim
    from hymeko_x.backends.usd.sheet import Sheet
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.ir.parts import Dof

SERVOS = ("position", "velocity")
"""The kinds of actuators that are drives on a joint."""


def write_drives(sheet: Sheet) -> None:
    """Each servo or motor on one dof as a DriveAPI of its joint; gains per degree, force limits from its force range."""
    driven_prims: set[Any] = set()
    for key, _, arcs in sheet.mechanism.edges(Drive):
        source = next((arc.target for arc in arcs if arc.sign > 0), None)
        driven = next((arc for arc in arcs if arc.sign < 0), None)
        actuator = sheet.mechanism.graph.vertices.get(source) if source is not None else None
        found = dof_of(sheet, driven) if driven is not None else None
        if found is None or source is None or not isinstance(actuator, Actuator) or not _is_drive(sheet, source, actuator):
            continue
        spec, axis, dof = found
        _write_drive(spec, axis or ("angular" if dof.kind is DofKind.HINGE else "linear"), actuator, dof)
        if spec.path not in driven_prims:
            driven_prims.add(spec.path)
            sheet.homes |= {source: spec.path, key: spec.path}


def _is_drive(sheet: Sheet, key: Id, actuator: Actuator) -> bool:
    """Whether a drive says it: servos, and motors that were drives before."""
    noted = sheet.mechanism.notation(key, words.TYPE)
    return actuator.kind in SERVOS or (actuator.kind == "motor" and noted in words.DRIVES)


def _write_drive(spec: Any, instance: str, actuator: Actuator, dof: Dof) -> None:
    unit = math.pi / 180.0 if dof.kind is DofKind.HINGE else 1.0
    said = dict(actuator.parameters)
    apply(spec, f"PhysicsDriveAPI:{instance}")
    for name, parameter in (("stiffness", "kp"), ("damping", "kv")):
        value = said.get(parameter)
        if isinstance(value, int | float):
            put(spec, f"drive:{instance}:physics:{name}", T.Float, value * unit)
    most = said.get("forcerange")
    if isinstance(most, tuple) and len(most) == 2:
        put(spec, f"drive:{instance}:physics:maxForce", T.Float, max(map(abs, most)))


def dof_of(sheet: Sheet, arc: RobotArc) -> tuple[Any, str, Dof] | None:
    """The prim of the dof that an arc means, its axis where that is a generic joint, and the dof itself (hinge or slide)."""
    from hymeko_x.ir.kinematics import dof_number

    edge = sheet.mechanism.graph.edges.get(arc.target)
    if edge is None or not isinstance(edge.data, Joint):
        return None
    number = dof_number(edge.data, arc.role)
    place = sheet.dofs.get((arc.target, number)) if number is not None else None
    if place is None or number is None or edge.data.dofs[number].kind not in (DofKind.HINGE, DofKind.SLIDE):
        return None
    return sheet.prims[place[0]], place[1], edge.data.dofs[number]


def prim_of(sheet: Sheet, arc: RobotArc) -> Any | None:
    """The path of the prim of what an arc means: of one dof where a joint has several; None where an axis of a joint is no prim."""
    if arc.target.kind != "joint":
        return sheet.homes.get(arc.target)
    found = dof_of(sheet, arc)
    return found[0].path if found is not None and not found[1] else None


class _Follower(NamedTuple):
    """A coupling with one leader: the prims and dofs of both ends, and the coefficients."""

    key: Id
    coupling: Coupling
    spec: Prim
    dof: Dof
    leader: Prim
    weight: tuple[float, ...]


def write_mimics(sheet: Sheet) -> None:
    """Each coupling with one leader as Newton's mimic; the constant of a hinge in degrees. MuJoCo's schema has powers up to four.

    Newton refuses a leader that follows another joint itself, so that it is led by the first of its leaders.
    """
    followers: dict[Any, _Follower] = {}
    for key, coupling, arcs in sheet.mechanism.edges(Coupling):
        found = _follower(sheet, key, coupling, arcs)
        if found is not None:
            followers.setdefault(found.spec.path, found)
    for found in followers.values():
        spec, weight = found.spec, found.weight
        if sheet.mechanism.notation(found.key, words.EQUALITY) is None:
            leader, native = _first_leader(found, followers)
            _write_mimic(spec, leader.path, found.dof, native, found.coupling.active)
            _write_powers(spec, weight, 2)
        else:
            apply(spec, "MjcEqualityJointAPI")
            point(spec, "mjc:target", found.leader.path)
            _write_powers(spec, weight, 0)
        sheet.homes[found.key] = spec.path


def _follower(sheet: Sheet, key: Id, coupling: Coupling, arcs: tuple[RobotArc, ...]) -> _Follower | None:
    follower = next((arc for arc in arcs if arc.sign > 0), None)
    leaders = [arc for arc in arcs if arc.sign < 0]
    if follower is None or len(leaders) != 1:
        return None
    here, there = dof_of(sheet, follower), dof_of(sheet, leaders[0])
    weight = leaders[0].weight if isinstance(leaders[0].weight, tuple) else (0.0, 1.0)
    if here is None or there is None or len(weight) > 5:
        return None
    return _Follower(key, coupling, here[0], here[2], there[0], weight)


def _first_leader(found: _Follower, followers: dict[Any, _Follower]) -> tuple[Prim, tuple[float, ...]]:
    """The leader that follows nobody, and the coefficients with respect to it: a + b (c + d x) = (a + b c) + b d x."""
    leader, weight = found.leader, found.weight
    passed = {found.spec.path}
    while leader.path in followers and leader.path not in passed and len(weight) == 2:
        above = followers[leader.path]
        if len(above.weight) != 2:
            break
        passed.add(leader.path)
        leader, weight = above.leader, (weight[0] + weight[1] * above.weight[0], weight[1] * above.weight[1])
    return (leader, weight) if leader.path not in passed else (found.leader, found.weight)


def _write_mimic(spec: Any, leader: Any, dof: Dof, weight: tuple[float, ...], is_active: bool) -> None:
    apply(spec, "NewtonMimicAPI")
    point(spec, "newton:mimicJoint", leader)
    constant = weight[0] if weight else 0.0
    put(spec, "newton:mimicCoef0", T.Float, math.degrees(constant) if dof.kind is DofKind.HINGE else constant)
    put(spec, "newton:mimicCoef1", T.Float, weight[1] if len(weight) > 1 else 0.0)
    if not is_active:
        put(spec, "newton:mimicEnabled", T.Bool, False)


def _write_powers(spec: Any, weight: tuple[float, ...], first: int) -> None:
    """The coefficients of MuJoCo's schema from this power on; the default is 1 for the first power, else 0."""
    said = [(power, value) for power, value in enumerate(weight) if power >= first and value != (1.0 if power == 1 else 0.0)]
    for power, value in said:
        apply(spec, "MjcEqualityJointAPI")
        put(spec, f"mjc:coef{power}", T.Double, value)
