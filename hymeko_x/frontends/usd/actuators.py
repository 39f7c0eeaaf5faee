"""Actuators: the drives of UsdPhysics on joints, and MjcActuator prims."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats import usd as words
from hymeko_x.formats.usd import actuators as table
from hymeko_x.formats.usd import joints
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.parts import Actuator, DofKind, Drive, Joint

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.builder import UsdBuilder
    from hymeko_x.frontends.usd.joints import DofRef
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.ir.mechanism import Id, RobotArc


# ---- drives of UsdPhysics ----------------------------------------------------------------------------------------------------------

DRIVE = "PhysicsDriveAPI"


def read_drives(prim: Prim, end: DofRef, builder: UsdBuilder) -> None:
    """Each DriveAPI of a joint as an actuator: position with a stiffness, velocity with damping alone, else motor."""
    edge = builder.edges.get(end.joint)
    if edge is None or not isinstance(edge.data, Joint):
        return
    for schema in prim.schemas:
        instance = schema.removeprefix(f"{DRIVE}:")
        number = _driven(instance, end.dof, edge.data) if instance != schema else None
        if number is not None:
            builder.mark_read(prim, f"@{schema}")
            _add_drive(prim, end.joint, instance, number, edge.data, builder)


def _driven(instance: str, name: str, joint: Joint) -> int | None:
    """Which dof a drive moves; None where the joint has no such axis or the drive is for another kind of motion."""
    kinds = {"angular": DofKind.HINGE, "linear": DofKind.SLIDE}
    for number, dof in enumerate(joint.dofs):
        if instance in kinds:
            if (dof.name == name if name else len(joint.dofs) == 1) and dof.kind is kinds[instance]:
                return number
        elif instance in joints.D6_AXES:
            kind, axis = joints.d6_axis(instance)
            if dof.kind is kind and tuple(map(abs, dof.axis)) == axis:
                return number
    return None


def _add_drive(prim: Prim, key: Id, instance: str, number: int, joint: Joint, builder: UsdBuilder) -> None:
    """Gains per degree become gains per radian; the target of a drive stays an extra."""
    scene, turns = builder.scene, joint.dofs[number].kind is DofKind.HINGE
    gain = scene.kilograms * (scene.metres**2 * 180.0 / math.pi if turns else 1.0)
    effort = scene.kilograms * scene.metres * (scene.metres if turns else 1.0)
    prefix = f"drive:{instance}:physics"
    kp, kv = (words.single_in(builder.number(prim, f"{prefix}:{name}", 0.0), gain) for name in ("stiffness", "damping"))
    most = builder.number(prim, f"{prefix}:maxForce", math.inf) * effort
    if _is_limit(most, joint.dofs[number].limits.effort):
        if not (kp or kv):
            return  # a drive without gains only repeats the limit
        most = math.inf
    kind = "position" if kp else "velocity" if kv else "motor"
    inherited = builder.number(prim, table.INHERITED.format(instance), 0.0) if kp else 0.0
    gains = [(name, value) for name, value in (("kp", kp), ("kv", kv), ("inheritrange", inherited)) if value]
    limits: list[tuple[str, float | str | tuple[float, ...]]] = [("forcerange", (-most, most))] if math.isfinite(most) else []
    own = joint.dofs[number].name
    name = own or (key.name if len(joint.dofs) == 1 else f"{key.name}_{instance}")
    actuator = builder.new_id(prim, "actuator", name)
    builder.vertices[actuator] = Actuator(kind, (*gains, *limits))
    builder.note(actuator, words.TYPE, instance)
    role = "" if len(joint.dofs) == 1 else own or str(number)
    builder.edges[builder.new_id(prim, "drive", name)] = Edge(Drive(), (Arc(actuator, 1), Arc(key, -1, None, role)))


def _is_limit(most: float, effort: float | None) -> bool:
    """Whether the greatest force of a drive is the effort limit of its dof, in single precision."""
    return effort is not None and math.isclose(most, effort, rel_tol=1e-6)


# ---- MjcActuator -------------------------------------------------------------------------------------------------------------------

_GENERAL = ("gaintype", "gainprm", "biastype", "biasprm", "dyntype", "dynprm")
_KINDS = ("frame", "body", "tendon")


def read_actuator(prim: Prim, ends: dict[str, DofRef], builder: UsdBuilder) -> None:
    """The actuator of a prim with the edge to its targets; one without a known target stays an extra."""
    arcs = [arc for role, name in _relationships(prim) for arc in _arcs(prim, role, name, ends, builder)]
    if not arcs:
        builder.warn(prim, codes.UNDEFINED_REFERENCE, f"actuator '{prim.path}' has no target that exists; it is kept as written")
        return
    parameters = _parameters(prim, builder)
    is_plain = arcs[0].target.kind != "body" and not any(name in _GENERAL for name, _ in parameters)
    kind = "motor" if is_plain else "general"  # MJCF has no motor on a body
    key = builder.new_id(prim, "actuator")
    builder.vertices[key] = table.with_inherited_range(Actuator(kind, tuple(parameters)))
    builder.note(key, words.TYPE, table.PRIM)
    gear = builder.get(prim, "mjc:gear")
    weight = _trimmed(tuple(map(float, gear))) if gear is not None else None
    first: RobotArc = Arc(arcs[0].target, -1, weight, arcs[0].role)
    is_in_parent = prim.value("mjc:jointInParent") is True
    builder.mark_read(prim, "@type", *(name for _, name in _relationships(prim)), *(["mjc:jointInParent"] if is_in_parent else []))
    drive = Drive("jointinparent" if is_in_parent else "")
    builder.edges[builder.new_id(prim, "drive", key.name)] = Edge(drive, (Arc(key, 1), first, *arcs[1:]))


def _relationships(prim: Prim) -> list[tuple[str, str]]:
    """The relationships that name something, with the role of it. A target beside a slider is the crank."""
    named = [name for name in (table.TARGET, table.SLIDER, table.REFERENCE) if prim.targets(name)]
    roles = {table.TARGET: "crank" if table.SLIDER in named else "", table.SLIDER: "slider", table.REFERENCE: "reference"}
    return [(roles[name], name) for name in named]


def _arcs(prim: Prim, role: str, name: str, ends: dict[str, DofRef], builder: UsdBuilder) -> list[RobotArc]:
    path = prim.targets(name)[0]
    end = ends.get(path)
    if end is not None:
        return [Arc(end.joint, -1, None, end.dof)]
    found = next((key for key in builder.elements.get(path, ()) if key.kind in _KINDS), None)
    return [Arc(found, -1, None, role)] if found is not None else []


# ---- parameters ------------------------------------------------------------------------------------------------------------------


def _parameters(prim: Prim, builder: UsdBuilder) -> list[tuple[str, float | str | tuple[float, ...]]]:
    """The other attributes of the prim, under the names of MJCF; defaults of the schema are left out."""
    found: list[tuple[str, float | str | tuple[float, ...]]] = []
    for name, attribute in table.TOKENS.items():
        value = builder.get(prim, f"mjc:{attribute}")
        if isinstance(value, str) and value not in ("auto", table.DEFAULTS.get(name)):
            found.append((name, value))
        elif value is not None:
            _leave(prim, f"mjc:{attribute}", builder)
    for name, attribute in table.VECTORS.items():
        value = builder.get(prim, f"mjc:{attribute}")
        if value is not None:
            found.append((name, _trimmed(tuple(map(float, value)))))
    for name, attribute in table.RANGES.items():
        if any(prim.has_value(f"mjc:{attribute}:{end}") for end in ("min", "max")):
            low, high = (float(builder.get(prim, f"mjc:{attribute}:{end}") or 0.0) for end in ("min", "max"))
            found.append((name, (low, high)))
    for name, attribute in (*table.NUMBERS.items(), *table.INTEGERS.items()):
        value = builder.get(prim, f"mjc:{attribute}")
        if isinstance(value, int | float):
            found.append((name, float(value)))
    return found


def _leave(prim: Prim, name: str, builder: UsdBuilder) -> None:
    """A property that was looked at stays an extra."""
    builder.read_names.get(prim.path, set()).discard(name)


def _trimmed(values: tuple[float, ...]) -> tuple[float, ...]:
    """Numbers without the zeros at the end, at least one."""
    count = max((place for place, value in enumerate(values, start=1) if value), default=1)
    return values[:count]
