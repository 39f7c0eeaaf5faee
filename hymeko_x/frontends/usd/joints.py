"""Joints of UsdPhysics: their two frames, dofs and limits, with the attributes of MuJoCo's and Newton's schemas."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.formats import usd as words
from hymeko_x.formats.usd import joints as table
from hymeko_x.frontends.usd.bodies import body_at
from hymeko_x.frontends.usd.transforms import decomposed, rotation_of
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Dof, DofKind, Limits
from hymeko_x.ir.values import NO_ROTATION, ZERO, Pose, Vec3, compose, inverse, rotate, rotation_angle, unit

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.builder import UsdBuilder
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.frontends.usd.transforms import Transform
    from hymeko_x.ir.mechanism import Id

_MJC = ("armature", "damping", "frictionloss", "stiffness", "ref", "springref")
_OF_COUPLINGS = ("newton:mimic", "mjc:coef", "mjc:target", "mjc:solimp", "mjc:solref")
_UNLIMITED = 1e6
"""PhysX' limit in degrees or units per second of a joint without a limit."""
_NEWTON = ("armature", "damping", "friction", "velocityLimit")


class JointEnd(Struct, frozen=True):
    """One side of a joint: the body (or the world) and the joint's frame in it."""

    body: Id
    pose: Pose


class ReadJoint(Struct, frozen=True):
    """A joint as its prim has it, not yet part of a tree: ``ends`` are those of body0 and body1.

    ``merged`` are the prims of its dofs where it was made of several joints.
    """

    prim: Prim
    id: Id
    dofs: tuple[Dof, ...]
    ends: tuple[JointEnd, JointEnd]
    is_enabled: bool
    is_excluded: bool
    merged: tuple[Prim, ...] = ()


def read_joint(prim: Prim, builder: UsdBuilder) -> ReadJoint | None:
    """The joint of a prim; None, reported and kept as an extra, where it does not connect two bodies."""
    first, second = _end(prim, 0, builder), _end(prim, 1, builder)
    if first is None or second is None:
        return None
    if first.body == second.body:
        message = f"joint '{prim.path}' connects {first.body} with itself; it is kept as written and moves nothing"
        builder.warn(prim, codes.MISSING_PART, message)
        return None
    key = builder.new_id(prim, "joint")
    dofs = _dofs(prim, builder)
    builder.mark_read(prim, "@type", *(f"physics:local{what}{side}" for what in ("Pos", "Rot") for side in "01"))
    builder.mark_read(prim, *(name for name in ("physics:body0", "physics:body1") if prim.targets(name)))
    _mark_schemas(prim, builder)
    enabled = prim.value("physics:jointEnabled") is not False
    excluded = bool(prim.value("physics:excludeFromArticulation"))
    _note_physx(prim, key, builder)
    if prim.kind == table.GENERIC:
        builder.note(key, words.TYPE, prim.kind)
    for side, end in enumerate((first, second)):
        _note_ground(prim, side, end, key, builder)
    return ReadJoint(prim, key, dofs, (first, second), enabled, excluded)


def _mark_schemas(prim: Prim, builder: UsdBuilder) -> None:
    """A schema of which every value is typed, or one that is not zero, needs no extra: the writer applies it. One without values does."""
    read = builder.read_names.get(prim.path, set())
    own = [name for name in prim.properties if not name.startswith(_OF_COUPLINGS)]
    for prefix, schema in (("mjc:", "MjcJointAPI"), ("newton:", "NewtonJointAPI"), ("physxJoint:", "PhysxJointAPI")):
        authored = [name for name in own if name.startswith(prefix)]
        is_written = any(name in read and prim.value(name) for name in authored)
        if authored and (is_written or read.issuperset(authored)):
            builder.mark_read(prim, f"@{schema}")


# ---- ends --------------------------------------------------------------------------------------------------------------------


def _end(prim: Prim, side: int, builder: UsdBuilder) -> JointEnd | None:
    """The joint's frame in the body of one side; without a body in the world, in the frame of whatever prim is named."""
    position = builder.get(prim, f"physics:localPos{side}") or ZERO
    quat = builder.get(prim, f"physics:localRot{side}") or NO_ROTATION
    local = Pose(position, rotation_of(quat))
    targets = prim.targets(f"physics:body{side}")
    if not targets:
        return JointEnd(WORLD, _in_frame(decomposed(builder.scene.world), local))
    target = builder.scene.prims.get(targets[0])
    if target is None:
        message = f"joint '{prim.path}': body{side} is '{targets[0]}', which does not exist; the joint is kept as written"
        builder.error(prim, codes.UNDEFINED_REFERENCE, message)
        return None
    found = body_at(target, builder)
    frame = _in_frame(builder.transforms.of(target), local)
    if found is None:
        return JointEnd(WORLD, frame)
    body, key = found
    if body is target:
        return JointEnd(key, Pose(_stretched(position, builder.transforms.of(body).scale), local.quat))
    return JointEnd(key, compose(inverse(builder.transforms.of(body).pose), frame))


def _note_ground(prim: Prim, side: int, end: JointEnd, key: Id, builder: UsdBuilder) -> None:
    """Keep which prim stood for the world, where it is a group above bodies, which will be written without a place of its own."""
    targets = prim.targets(f"physics:body{side}") if end.body == WORLD else []
    if targets and any(path.startswith(f"{targets[0]}/") for path in builder.bodies):
        builder.note(key, words.GROUND[side], targets[0])


def _in_frame(frame: Transform, local: Pose) -> Pose:
    """A pose given in the scaled space of a frame, in the frame's own parent."""
    return compose(frame.pose, Pose(_stretched(local.xyz, frame.scale), local.quat))


def _stretched(vector: Vec3, scale: Vec3) -> Vec3:
    return (vector[0] * scale[0] + 0.0, vector[1] * scale[1] + 0.0, vector[2] * scale[2] + 0.0)


# ---- dofs --------------------------------------------------------------------------------------------------------------------


def _dofs(prim: Prim, builder: UsdBuilder) -> tuple[Dof, ...]:
    kind = table.DOFS.get(prim.kind)
    if kind is None:
        return _generic_dofs(prim, builder) if prim.kind == table.GENERIC else ()
    if kind is DofKind.BALL:
        return (_behaving(prim, Dof(kind), builder),)
    axis = table.AXES[builder.axis(prim, "physics:axis", "X")]
    return (_behaving(prim, Dof(kind, axis, _limits(prim, kind, builder)), builder),)


def _limits(prim: Prim, kind: DofKind, builder: UsdBuilder) -> Limits:
    """Degrees or lengths of the stage as rad or m. Infinite bounds are none; lower above upper switches both off."""
    lower = builder.number(prim, "physics:lowerLimit", -math.inf)
    upper = builder.number(prim, "physics:upperLimit", math.inf)
    if lower > upper:
        return Limits()
    return Limits(_bound(lower, kind, builder), _bound(upper, kind, builder))


def _bound(value: float, kind: DofKind, builder: UsdBuilder) -> float | None:
    if not math.isfinite(value) or abs(value) > 3e38:
        return None
    return math.radians(value) if kind is DofKind.HINGE else value * builder.scene.metres


def _generic_dofs(prim: Prim, builder: UsdBuilder) -> tuple[Dof, ...]:
    """The axes that are left free: low above high locks one, an axis without a LimitAPI is free.

    A point that turns freely in all directions is a ball, and one without any limit at all floats.
    """
    free = [name for name in table.D6_AXES if not _is_locked(prim, name)]
    bare = [name for name in free if not prim.has_api(f"PhysicsLimitAPI:{name}")]
    if len(bare) == len(table.D6_AXES):
        return (Dof(DofKind.FREE),)
    is_ball = bare[-3:] == list(table.D6_AXES[3:]) and not any(prim.has_api(f"PhysicsDriveAPI:{name}") for name in bare[-3:])
    dofs = []
    for name in free[:-3] if is_ball else free:
        kind, axis = table.d6_axis(name)
        is_limited = prim.has_api(f"PhysicsLimitAPI:{name}")
        low = builder.number(prim, f"limit:{name}:physics:low", -math.inf) if is_limited else -math.inf
        high = builder.number(prim, f"limit:{name}:physics:high", math.inf) if is_limited else math.inf
        if math.isfinite(low) or math.isfinite(high):
            builder.mark_read(prim, f"@PhysicsLimitAPI:{name}")
        limits = Limits(_bound(low, kind, builder), _bound(high, kind, builder))
        dofs.append(_behaving(prim, Dof(kind, axis, limits), builder))
    if is_ball:
        dofs.append(_behaving(prim, Dof(DofKind.BALL), builder))
    for name in table.D6_AXES:
        if name not in free:
            _mark_lock(prim, name, builder)
    return tuple(dofs)


def _mark_lock(prim: Prim, name: str, builder: UsdBuilder) -> None:
    """A locked axis; by how much its bounds are crossed only counts where it is not by as much as the writer's."""
    low, high = f"limit:{name}:physics:low", f"limit:{name}:physics:high"
    authored = prim.value(low), prim.value(high)
    builder.mark_read(prim, f"@PhysicsLimitAPI:{name}", *((low, high) if authored == table.LOCKED else ()))


def _is_locked(prim: Prim, name: str) -> bool:
    if not prim.has_api(f"PhysicsLimitAPI:{name}"):
        return False
    low, high = (prim.value(f"limit:{name}:physics:{end}") for end in ("low", "high"))
    return bool((-math.inf if low is None else low) > (math.inf if high is None else high))


def _behaving(prim: Prim, dof: Dof, builder: UsdBuilder) -> Dof:
    """The dof with MuJoCo's and Newton's attributes of the whole joint. Newton counts angles in degrees, MuJoCo in radians."""
    scene = builder.scene
    turns = dof.kind is not DofKind.SLIDE
    inertia = scene.kilograms * (scene.metres**2 if turns else 1.0)
    effort = scene.kilograms * scene.metres * (scene.metres if turns else 1.0)
    degree = 180.0 / math.pi if turns else 1.0
    angle = math.pi / 180.0 if turns else scene.metres
    mjc = {name: builder.number(prim, f"mjc:{name}", math.nan) for name in _MJC}
    newton = {name: builder.number(prim, f"newton:{name}", math.nan) for name in _NEWTON}
    twins = {"armature": (mjc["armature"], newton["armature"]), "maxJointVelocity": (newton["velocityLimit"],)}
    physx = {name: _of_physx(prim, name, twins[name], builder) for name in table.PHYSX}
    speed = _first(newton["velocityLimit"], physx["maxJointVelocity"], math.inf) * angle
    if math.isfinite(newton["velocityLimit"]):
        builder.mark_read(prim, "newton:velocityLimit")
    return replace(
        dof,
        armature=_first(mjc["armature"] * inertia, newton["armature"] * inertia, physx["armature"] * inertia),
        damping=_first(mjc["damping"] * inertia, newton["damping"] * inertia * degree),
        friction=_first(mjc["frictionloss"] * effort, newton["friction"] * effort),
        stiffness=_first(mjc["stiffness"] * inertia),
        ref=_first(mjc["ref"] * angle),
        spring_ref=_first(mjc["springref"] * angle),
        limits=replace(dof.limits, velocity=speed if math.isfinite(speed) else None, effort=_effort(prim, effort, builder)),
    )


def _of_physx(prim: Prim, name: str, twins: tuple[float, ...], builder: UsdBuilder) -> float:
    """A value of PhysxJointAPI, NaN where it has none; it stays an extra where MuJoCo's or Newton's attribute, a twin, contradicts."""
    value = prim.value(f"physxJoint:{name}")
    if not isinstance(value, float) or not 0.0 < value < _UNLIMITED:
        return math.nan
    if all(math.isnan(twin) or words.single(twin) == words.single(value) for twin in twins):
        builder.mark_read(prim, f"physxJoint:{name}")
    return words.single(value)


def _note_physx(prim: Prim, key: Id, builder: UsdBuilder) -> None:
    """Keep which values PhysxJointAPI has, as far as the joint has the same."""
    read = builder.read_names.get(prim.path, set())
    names = [name for name in table.PHYSX if f"physxJoint:{name}" in read]
    if names:
        builder.note(key, words.PHYSX, tuple(names))


def _effort(prim: Prim, unit: float, builder: UsdBuilder) -> float | None:
    """MuJoCo's symmetric limit of the force at the joint; a one-sided one stays an extra."""
    low, high = (prim.value(f"mjc:actuatorfrcrange:{end}") for end in ("min", "max"))
    if low is None or high is None or low != -high:
        return None
    builder.mark_read(prim, "mjc:actuatorfrcrange:min", "mjc:actuatorfrcrange:max")
    return float(abs(high * unit))


def _first(*values: float) -> float:
    """The first authored value, else 0."""
    return next((value for value in values if not math.isnan(value)), 0.0)


# ---- drives --------------------------------------------------------------------------------------------------------------------


class DofRef(NamedTuple):
    """A joint, or by its name one dof of a joint that was made of several."""

    joint: Id
    dof: str


def dof_refs(joint: ReadJoint) -> list[tuple[Prim, DofRef]]:
    """Each prim of a joint with the dof that it moves."""
    if not joint.merged:
        return [(joint.prim, DofRef(joint.id, ""))]
    return [(prim, DofRef(joint.id, dof.name or "")) for prim, dof in zip(joint.merged, joint.dofs, strict=True)]


# ---- several joints between the same two bodies ------------------------------------------------------------------------------------

_SAME = 1e-5
"""In rad, and in m or of the distance where that is longer: frames of joints have single precision."""


def merge_parallel(joints: list[ReadJoint], builder: UsdBuilder) -> list[ReadJoint]:
    """The joints with every run of hinges, slides and balls between the same two bodies made one, at the place of its first."""
    groups: dict[object, list[ReadJoint]] = {}
    for joint in joints:
        first, second = joint.ends
        is_simple = joint.prim.kind in table.DOFS and joint.is_enabled and not joint.is_excluded
        groups.setdefault((first.body, second.body) if is_simple else joint.id, []).append(joint)
    return [merged for group in groups.values() for merged in _merged(group, builder)]


def _merged(group: list[ReadJoint], builder: UsdBuilder) -> list[ReadJoint]:
    """One joint for those that agree on where the child is; the others, if any, stay by themselves and close a loop."""
    first = group[0]
    at = _child_at(first)
    agreeing = [joint for joint in group if _is_close(_child_at(joint), at)]
    if len(agreeing) < 2:
        return group
    dofs = tuple(_dof_seen_from(first, joint) for joint in agreeing)
    builder.note(first.id, words.PATH, tuple(joint.prim.path for joint in agreeing))
    for joint in agreeing:
        if joint.prim.display_name == joint.id.name:  # which the dof is called
            builder.mark_read(joint.prim, "displayName")
    for joint in agreeing[1:]:
        builder.elements[joint.prim.path] = [first.id]
        builder.notations.pop(joint.id, None)
    rest = [joint for joint in group if joint not in agreeing]
    return [replace(first, dofs=dofs, merged=tuple(joint.prim for joint in agreeing)), *rest]


def _child_at(joint: ReadJoint) -> Pose:
    """The child in its parent where all coordinates are at their reference."""
    return compose(joint.ends[0].pose, inverse(joint.ends[1].pose))


def _is_close(a: Pose, b: Pose) -> bool:
    size = max(1.0, *map(abs, (*a.xyz, *b.xyz)))
    return max(abs(p - q) for p, q in zip(a.xyz, b.xyz, strict=True)) < _SAME * size and rotation_angle(a.quat, b.quat) < _SAME


def _dof_seen_from(first: ReadJoint, joint: ReadJoint) -> Dof:
    """A joint's dof in the frame of the first one, under the joint's name."""
    dof = replace(joint.dofs[0], name=joint.id.name)
    if joint.ends[0].pose == first.ends[0].pose:
        return dof
    frame = compose(inverse(first.ends[0].pose), joint.ends[0].pose)
    anchor = (0.0, 0.0, 0.0) if dof.kind is DofKind.SLIDE else frame.xyz
    axis = dof.axis if dof.kind is DofKind.BALL else unit(rotate(frame.quat, dof.axis))
    return replace(dof, axis=axis, anchor=_tidy(anchor))


def _tidy(vector: tuple[float, float, float]) -> tuple[float, float, float]:
    """Rounding errors of single precision are no anchors."""
    x, y, z = (0.0 if abs(value) < 1e-9 else value for value in vector)
    return (x, y, z)
