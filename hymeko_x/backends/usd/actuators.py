"""Actuators: servos and motors as drives of UsdPhysics, all others as MjcActuator prims."""

from __future__ import annotations

import math
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from pxr import Vt

from hymeko_x.backends.usd.sheet import T, apply, dof_of, point, prim_of, put
from hymeko_x.formats import usd as words
from hymeko_x.formats.usd import actuators as table
from hymeko_x.formats.usd import joints
from hymeko_x.ir.mechanism import end_of, numbers_weight
from hymeko_x.ir.parts import Actuator, DofKind, Drive

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.backends.usd.sheet import UsdSheet, WrittenPrim
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.ir.parts import Dof, Parameters


# ---- drives of UsdPhysics ----------------------------------------------------------------------------------------------------------

SERVOS = ("position", "velocity")
"""The kinds of actuators that are drives on a joint."""
_USUAL_GAINS: Mapping[str, Mapping[str, float]] = MappingProxyType({"position": {"kp": 1.0}, "velocity": {"kv": 1.0}})
"""MuJoCo's gains where a file gives none; UsdPhysics has none then."""


def write_drives(sheet: UsdSheet) -> None:
    """Each servo or motor on one dof as a DriveAPI of its joint; gains per degree, force limits from its force range or the dof's limit.

    A dof with an effort limit and no such drive has one without gains, for programs that know effort limits only of drives.
    """
    driven_prims: set[Any] = set()
    limited = _limited_dofs(sheet)
    for key, _, arcs in sheet.mechanism.edges(Drive):
        source = end_of(arcs, 1)
        driven = next((arc for arc in arcs if arc.sign < 0), None)
        actuator = sheet.mechanism.part(source, Actuator)
        found = dof_of(sheet, driven) if driven is not None else None
        if found is None or driven is None or source is None or actuator is None or not _is_drive(sheet, source, actuator):
            continue
        spec, axis, dof = found
        instance = axis or _instance(dof)
        _write_drive(spec, instance, actuator, dof, (*numbers_weight(driven), 1.0)[0])
        limited.pop((spec.path, instance), None)
        if spec.path not in driven_prims:
            driven_prims.add(spec.path)
            sheet.paths |= {source: spec.path, key: spec.path}
    for (path, instance), effort in limited.items():
        apply(sheet.prims[path], f"PhysicsDriveAPI:{instance}")
        put(sheet.prims[path], f"drive:{instance}:physics:maxForce", T.Float, effort)


def _limited_dofs(sheet: UsdSheet) -> dict[tuple[Any, str], float]:
    """The positive effort limit of each hinge and slide that has one, by its prim and the instance of its drive."""
    found: dict[tuple[Any, str], float] = {}
    for (key, number), (path, axis) in sheet.dofs.items():
        dof = sheet.mechanism.joints[key].joint.dofs[number] if key in sheet.mechanism.joints else None
        if dof is not None and dof.kind in (DofKind.HINGE, DofKind.SLIDE) and (effort := dof.limits.effort or 0.0) > 0.0:
            found[path, axis or _instance(dof)] = effort
    return found


def _instance(dof: Dof) -> str:
    return "angular" if dof.kind is DofKind.HINGE else "linear"


def _is_drive(sheet: UsdSheet, key: Id, actuator: Actuator) -> bool:
    """Whether a drive represents it: servos, and motors that were drives before."""
    noted = sheet.mechanism.notation(key, words.TYPE)
    return actuator.kind in SERVOS or (actuator.kind == "motor" and noted in joints.DRIVES)


def _write_drive(spec: Any, instance: str, actuator: Actuator, dof: Dof, gear: float) -> None:
    """The gains of a servo at its joint: one behind a gear acts there with the square of it, and its force with the gear."""
    unit = math.pi / 180.0 if dof.kind is DofKind.HINGE else 1.0
    authored = {**_USUAL_GAINS.get(actuator.kind, {}), **dict(actuator.parameters)}
    apply(spec, f"PhysicsDriveAPI:{instance}")
    for name, parameter in (("stiffness", "kp"), ("damping", "kv")):
        value = authored.get(parameter)
        if isinstance(value, int | float):
            put(spec, f"drive:{instance}:physics:{name}", T.Float, value * gear * gear * unit)
    inherited = authored.get("inheritrange")
    if isinstance(inherited, float) and inherited:
        put(spec, table.INHERITED.format(instance), T.Double, inherited)
    most = authored.get("forcerange")
    if isinstance(most, tuple) and len(most) == 2:
        put(spec, f"drive:{instance}:physics:maxForce", T.Float, max(map(abs, most)) * abs(gear))
    elif (effort := dof.limits.effort or 0.0) > 0.0:
        put(spec, f"drive:{instance}:physics:maxForce", T.Float, effort)


# ---- MjcActuator -------------------------------------------------------------------------------------------------------------------


def write_actuators(sheet: UsdSheet) -> None:
    """Each actuator that no drive represents, with its targets: as a general one, where that is known. Servos of joints are drives."""
    for key, drive, arcs in sheet.mechanism.edges(Drive):
        source = end_of(arcs, 1)
        actuator = sheet.mechanism.part(source, Actuator)
        targets = [(arc, _target(sheet, arc)) for arc in arcs if arc.sign < 0]
        if source is None or actuator is None or source in sheet.paths:
            continue
        if not targets or any(target is None for _, target in targets):
            continue
        is_servo = actuator.kind in SERVOS and targets[0][0].target.kind == "joint"
        parameters = None if is_servo else table.in_general(actuator.kind, actuator.parameters)
        if parameters is None:
            continue
        spec = sheet.add_prim(source, "actuators", table.PRIM)
        sheet.paths[key] = spec.path
        _write_targets(spec, targets, drive)
        _write_parameters(spec, parameters)


def _target(sheet: UsdSheet, arc: RobotArc) -> Any | None:
    """The prim of the target of an arc, or else of its whole joint. A floating base is a joint without a prim."""
    found, home = prim_of(sheet, arc), sheet.paths.get(arc.target)
    if found is not None or home is None:
        return found
    return home if sheet.prims[home].kind.startswith("Physics") else None


def _write_targets(spec: WrittenPrim, targets: list[tuple[RobotArc, Any]], drive: Drive) -> None:
    roles = {"slider", "reference"}
    for place, (arc, target) in enumerate(targets):
        name = table.RELATIONSHIPS[arc.role] if arc.role in roles else table.TARGET
        if place == 0 or arc.role in roles:
            point(spec, name, target)
    gear = numbers_weight(targets[0][0])
    if gear:
        put(spec, "mjc:gear", T.DoubleArray, Vt.DoubleArray([*gear, *[0.0] * (6 - len(gear))]))
    if drive.kind == "jointinparent":
        put(spec, "mjc:jointInParent", T.Bool, True)


def _write_parameters(spec: WrittenPrim, parameters: Parameters) -> None:
    """The parameters that the schema has an attribute for."""
    for name, value in parameters:
        if name in table.TOKENS and isinstance(value, str):
            put(spec, f"mjc:{table.TOKENS[name]}", T.Token, value)
        elif name in table.VECTORS and not isinstance(value, str):
            numbers = value if isinstance(value, tuple) else (value,)
            put(spec, f"mjc:{table.VECTORS[name]}", T.DoubleArray, Vt.DoubleArray([*numbers, *[0.0] * (table.LENGTH - len(numbers))]))
        elif name in table.RANGES and isinstance(value, tuple) and len(value) == 2:
            for end, bound in zip(("min", "max"), value, strict=True):
                put(spec, f"mjc:{table.RANGES[name]}:{end}", T.Double, bound)
        elif name in table.NUMBERS and isinstance(value, int | float):
            put(spec, f"mjc:{table.NUMBERS[name]}", T.Double, value)
        elif name in table.INTEGERS and isinstance(value, int | float):
            put(spec, f"mjc:{table.INTEGERS[name]}", T.Int, int(value))
