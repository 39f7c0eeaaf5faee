"""Joints of UsdPhysics from joints and closures: one prim per dof, local frames on both sides, degrees."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Any

from pxr import Gf, Sdf

from hymeko_x.backends.usd.sheet import T, apply, point, put, quatf
from hymeko_x.formats import usd as words
from hymeko_x.formats.usd import joints as table
from hymeko_x.ir.decimals import shortest
from hymeko_x.ir.mechanism import WORLD, Id, pose_weight
from hymeko_x.ir.parts import Dof, DofKind, Loop
from hymeko_x.ir.values import IDENTITY, ZERO, Pose, X, add, compose, quat_from_z, quat_inverse, quat_product, scaled, unit_quat
from hymeko_x.ir.written import clean_pose

if TYPE_CHECKING:
    from hymeko_x.backends.usd.sheet import UsdSheet
    from hymeko_x.ir.mechanism import JointView, RobotArc
    from hymeko_x.ir.values import Quat, Vec3

_TYPES = {kind: name for name, kind in table.DOFS.items()}
_TOKENS = {axis: token for token, axis in table.AXES.items()}
_HALF_TURNS = {"X": (0.0, 0.0, 0.0, 1.0), "Y": (0.0, 1.0, 0.0, 0.0), "Z": (0.0, 1.0, 0.0, 0.0)}
"""For each token a rotation that turns its axis round."""
_OPPOSITE = {add(ZERO, scaled(axis, -1.0)): token for token, axis in table.AXES.items()}
_LOOPS = {"weld": table.FIXED, "connect": _TYPES[DofKind.BALL], "distance": table.DISTANCE}


def write_joints(sheet: UsdSheet) -> None:
    """Every joint of the tree. A base that floats needs no prim: its body is just where it is."""
    for view in sheet.mechanism.joints.values():
        is_held = not view.joint.dofs and sheet.mechanism.notation(view.id, words.HELD) is not None
        if view.parent != WORLD or not (is_held or _floats(view)):
            write_joint(sheet, view)
        elif view.child in sheet.paths:
            sheet.paths[view.id] = sheet.paths[view.child]


def _floats(view: JointView) -> bool:
    return len(view.joint.dofs) == 1 and view.joint.dofs[0].kind is DofKind.FREE


def write_joint(sheet: UsdSheet, view: JointView) -> None:
    """One prim for a joint with at most one dof or with the axes of a generic one, else one for each dof."""
    dofs = view.joint.dofs
    is_turned = sheet.mechanism.notation(view.id, words.REVERSED) is not None
    ends = (view.parent, view.parent_pose), (view.child, view.child_pose)
    numbers = list(range(len(dofs)))
    if is_turned:
        ends, dofs, numbers = (ends[1], ends[0]), tuple(table.opposite(dof) for dof in reversed(dofs)), numbers[::-1]
    if len(dofs) < 2 or sheet.mechanism.notation(view.id, words.TYPE) == table.GENERIC:
        spec = sheet.add_prim(view.id, "joints", _type_of(sheet, view.id, dofs))
        write_frames(sheet, spec, view.id, ends, dofs)
        for number, dof in zip(numbers, dofs, strict=True):
            sheet.dofs[view.id, number] = (spec.path, axis_name(dof) if spec.kind == table.GENERIC else "")
        return
    _write_parallel(sheet, view, ends, dofs, numbers)


def _type_of(sheet: UsdSheet, key: Id, dofs: tuple[Dof, ...]) -> str:
    if sheet.mechanism.notation(key, words.TYPE) == table.GENERIC:
        return table.GENERIC
    return table.FIXED if not dofs else _TYPES.get(dofs[0].kind, table.GENERIC)


def axis_name(dof: Dof) -> str:
    """The axis of a generic joint that a dof in its frame is; empty where it is along none."""
    token = _TOKENS.get(dof.axis)
    return "" if token is None else f"{'trans' if dof.kind is DofKind.SLIDE else 'rot'}{token}"


End = tuple[Id, Pose]


def _write_parallel(sheet: UsdSheet, view: JointView, ends: tuple[End, End], dofs: tuple[Dof, ...], numbers: list[int]) -> None:
    """Several dofs: a joint for each between the same two bodies, which together are one (Newton, MuJoCo's converters)."""
    numbered = [f"{view.id.name}_{place + 1}" for place in range(len(dofs))]
    names = [dof.name or name for dof, name in zip(dofs, numbered, strict=True)]
    paths = _parallel_paths(sheet, view.id, names, numbered)
    for place, (number, dof) in enumerate(zip(numbers, dofs, strict=True)):
        path, name = paths[place], names[place]
        spec = sheet.define(path, _TYPES.get(dof.kind, table.GENERIC), name)
        sheet.element_paths.add(path)
        write_frames(sheet, spec, view.id, ends, (dof,))
        sheet.dofs[view.id, number] = (path, "")
        if place == 0:
            sheet.paths[view.id] = path


def _parallel_paths(sheet: UsdSheet, key: Id, names: list[str], numbered: list[str]) -> list[Any]:
    """Where the joints of one joint's dofs go: where they were, else by their names, which have to be in alphabetical order.

    UsdPhysics' parser lists the joints of an articulation in that order, and Newton takes it for the order of the dofs.
    """
    noted = sheet.mechanism.notation(key, words.PATH) or ()
    there = [Sdf.Path(text) for text in noted if Sdf.Path.IsValidPathString(text) and Sdf.Path(text) not in sheet.prims]
    if len(there) == len(names):
        return there
    group = sheet.scope("joints")
    paths = [sheet.free_path(group, name) for name in names]
    is_ordered = all(first < second for first, second in itertools.pairwise(paths))
    return paths if is_ordered else [sheet.free_path(group, name) for name in numbered]


# ---- one prim ------------------------------------------------------------------------------------------------------------------


def write_frames(sheet: UsdSheet, spec: Any, key: Id, ends: tuple[End, End], dofs: tuple[Dof, ...]) -> None:
    """Bodies, local frames, axis and limits. An axis that is none of x, y, z turns both frames so that it is their x."""
    turn, token = _turn(dofs[0]) if len(dofs) == 1 and spec.kind not in (table.GENERIC, _TYPES[DofKind.BALL]) else (IDENTITY.quat, "X")
    anchor = dofs[0].anchor if len(dofs) == 1 else (0.0, 0.0, 0.0)
    for side, (body, pose) in enumerate(ends):
        _write_end(sheet, spec, side, body, key)
        frame = clean_pose(compose(pose, Pose(anchor, turn))) if any(anchor) or turn != IDENTITY.quat else pose
        put(spec, f"physics:localPos{side}", T.Point3f, Gf.Vec3f(*sheet.in_prim_space(body, frame.xyz)))
        put(spec, f"physics:localRot{side}", T.Quatf, quatf(frame.quat))
    if spec.kind == table.GENERIC:
        _write_generic(spec, dofs)
    elif len(dofs) == 1 and dofs[0].kind in (DofKind.HINGE, DofKind.SLIDE):
        put(spec, "physics:axis", T.Token, token)
        _write_limits(spec, dofs[0], is_neutral=sheet.is_neutral)
    for dof in dofs[:1]:
        write_behaviour(spec, dof, table.PHYSX if sheet.is_neutral else sheet.mechanism.notation(key, words.PHYSX) or ())


def _write_end(sheet: UsdSheet, spec: Any, side: int, body: Id, key: Id) -> None:
    """The body of one side; for the world none, or the group without a place of its own that stood for it."""
    if body != WORLD and body in sheet.paths:
        point(spec, f"physics:body{side}", sheet.paths[body])
    noted = sheet.mechanism.notation(key, words.GROUND[side]) if body == WORLD else None
    if noted is not None and Sdf.Path.IsValidPathString(noted) and Sdf.Path(noted) in sheet.prims:
        point(spec, f"physics:body{side}", Sdf.Path(noted))


def _turn(dof: Dof) -> tuple[Quat, str]:
    """The rotation from the token's axis to the dof's, and the token; half a turn where the axis points the other way."""
    if dof.axis in _TOKENS:
        return IDENTITY.quat, _TOKENS[dof.axis]
    if dof.axis in _OPPOSITE:
        token = _OPPOSITE[dof.axis]
        return _HALF_TURNS[token], token
    return quat_between_x_and(dof.axis), "X"


def quat_between_x_and(axis: Vec3) -> Quat:
    """A rotation that turns x into the axis, by way of z."""
    return unit_quat(quat_product(quat_from_z(axis), quat_inverse(quat_from_z(X))))


def _write_limits(spec: Any, dof: Dof, *, is_neutral: bool) -> None:
    """Both limits; one that is not there is infinite, which is the default and written only where a profile wants it."""
    for name, value, none in (("lower", dof.limits.lower, -math.inf), ("upper", dof.limits.upper, math.inf)):
        if value is not None or is_neutral:
            put(spec, f"physics:{name}Limit", T.Float, none if value is None else _coordinate(dof, value))


def _coordinate(dof: Dof, value: float) -> float:
    """Degrees of a hinge, metres of a slide."""
    return shortest(math.degrees(value)) if dof.kind is DofKind.HINGE else value


def _write_generic(spec: Any, dofs: tuple[Dof, ...]) -> None:
    """A LimitAPI on each axis that is limited or locked (low above high); the others are free."""
    if dofs and dofs[0].kind is DofKind.FREE:
        return
    authored = {axis_name(dof): dof for dof in dofs if dof.kind is not DofKind.BALL}
    bare = {"rotX", "rotY", "rotZ"} if any(dof.kind is DofKind.BALL for dof in dofs) else set()
    for name in table.D6_AXES:
        if name in bare:
            continue
        dof = authored.get(name)
        if dof is None or dof.limits.lower is not None or dof.limits.upper is not None:
            apply(spec, f"PhysicsLimitAPI:{name}")
        low, high = table.LOCKED if dof is None else (dof.limits.lower, dof.limits.upper)
        for end, value in (("low", low), ("high", high)):
            if value is not None:
                put(spec, f"limit:{name}:physics:{end}", T.Float, value if dof is None else _coordinate(dof, value))


def write_behaviour(spec: Any, dof: Dof, physx: tuple[str, ...]) -> None:
    """What a dof does beyond moving, in MuJoCo's schema (doubles, radians) and in Newton's (degrees), where it is not the default.

    ``physx`` are the values, of limits of velocities (in degrees) and armature, that PhysX' own schema gets as well.
    """
    turns = dof.kind is not DofKind.SLIDE
    degree = math.pi / 180.0 if turns else 1.0
    mjc = {
        "armature": dof.armature,
        "damping": dof.damping,
        "frictionloss": dof.friction,
        "stiffness": dof.stiffness,
        "ref": shortest(dof.ref / degree),
        "springref": shortest(dof.spring_ref / degree),
    }
    newton = {"armature": dof.armature, "damping": shortest(dof.damping * degree), "friction": dof.friction}
    _write_schema(spec, "MjcJointAPI", "mjc", T.Double, mjc)
    _write_schema(spec, "NewtonJointAPI", "newton", T.Float, newton)
    if dof.limits.velocity is not None:
        apply(spec, "NewtonJointAPI")
        put(spec, "newton:velocityLimit", T.Float, dof.limits.velocity / degree)
    values = {"armature": dof.armature, "maxJointVelocity": shortest((dof.limits.velocity or 0.0) / degree)}
    _write_schema(spec, "PhysxJointAPI", "physxJoint", T.Float, {name: value for name, value in values.items() if name in physx})
    if dof.limits.effort is not None:
        apply(spec, "MjcJointAPI")
        put(spec, "mjc:actuatorfrcrange:min", T.Double, 0.0 - dof.limits.effort)
        put(spec, "mjc:actuatorfrcrange:max", T.Double, dof.limits.effort)


def _write_schema(spec: Any, schema: str, prefix: str, kind: Any, values: dict[str, float]) -> None:
    authored = {name: value for name, value in values.items() if value}
    if authored:
        apply(spec, schema)
    for name, value in authored.items():
        put(spec, f"{prefix}:{name}", kind, value)


# ---- closures --------------------------------------------------------------------------------------------------------------------


def write_loops(sheet: UsdSheet) -> None:
    """Each closure between two bodies as a joint that is not part of the articulation."""
    frames = _frames(sheet)
    for key, loop, arcs in sheet.mechanism.edges(Loop):
        ends = [_closure_end(arc, frames) for arc in arcs]
        if len(ends) != 2 or any(body != WORLD and body not in sheet.paths for body, _ in ends):
            continue
        spec = sheet.add_prim(key, "joints", _loop_type(sheet, key, loop))
        write_frames(sheet, spec, key, (ends[0], ends[1]), loop.dofs)
        if sheet.mechanism.notation(key, words.ARTICULATED) is None:
            put(spec, "physics:excludeFromArticulation", T.Bool, True)
        if not loop.active:
            put(spec, "physics:jointEnabled", T.Bool, False)
        if loop.kind == "distance":
            for name, value in loop.parameters:
                if isinstance(value, float):
                    put(spec, f"physics:{name}", T.Float, value)


def _loop_type(sheet: UsdSheet, key: Id, loop: Loop) -> str:
    noted = sheet.mechanism.notation(key, words.TYPE)
    if noted is not None or loop.kind in _LOOPS:
        return noted or _LOOPS[loop.kind]
    return _type_of(sheet, key, loop.dofs) if len(loop.dofs) < 2 else table.GENERIC


def _frames(sheet: UsdSheet) -> dict[Id, End]:
    """The body and pose of each mounted element."""
    return {view.mounted: (view.body, view.pose) for views in sheet.mechanism.mounts.values() for view in views}


def _closure_end(arc: RobotArc, frames: dict[Id, End]) -> End:
    if arc.target in frames:
        body, pose = frames[arc.target]
        return body, compose(pose, pose_weight(arc))
    return arc.target, pose_weight(arc)
