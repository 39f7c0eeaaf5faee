"""Forward kinematics of the object model: poses in the world, or in the root of their tree, at coordinates by joint.

T_world_child(q) = T_world_parent * P * prod_i( Tr(a_i) M_i(q_i - ref_i) Tr(-a_i) ) * C^-1, as :class:`hymeko_x.ir.parts.Joint` has it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from hymeko_x.ir.kinematics import below, displacement, dof_number, turn_about
from hymeko_x.ir.mechanism import WORLD, numbers_weight
from hymeko_x.ir.parts import Coupling, Dof, DofKind
from hymeko_x.ir.values import IDENTITY, Pose, compose, pose
from hymeko_x.robot.errors import EditError, unknown_name

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, JointView, Mechanism, RobotArc

Coordinates = Mapping[str, "float | Sequence[float]"] | Sequence[float]
"""Coordinates by joint, or all of them in the order of the joints: rad or m, a quaternion (w, x, y, z) for a ball, position in m and
quaternion (w, x, y, z) for a free joint. A mapping may leave joints out."""

WIDTHS = {DofKind.BALL: 4, DofKind.FREE: 7}
"""How many coordinates a dof has that has not one."""


def all_poses(mechanism: Mechanism, q: Coordinates) -> dict[Id, Pose]:
    """The pose of each body. Linear in the bodies. Raises: KeyError for unknown joints, EditError for coordinates that are none."""
    values = coordinates(mechanism, q)
    poses: dict[Id, Pose] = {WORLD: IDENTITY}
    for body in mechanism.depth_first():
        above = mechanism.parent_joint.get(body)
        poses[body] = IDENTITY if above is None else _moved(poses.get(above.parent, IDENTITY), above, values)
    return poses


def pose_of(mechanism: Mechanism, body: Id, q: Coordinates) -> Pose:
    """The pose of one body; of all joints only those above it move."""
    values = coordinates(mechanism, q)
    chain: list[JointView] = []
    seen: set[Id] = set()
    key = body
    while key in mechanism.parent_joint and key not in seen:
        seen.add(key)
        chain.append(mechanism.parent_joint[key])
        key = chain[-1].parent
    found = IDENTITY
    for joint in reversed(chain):
        found = _moved(found, joint, values)
    return found


def coordinates(mechanism: Mechanism, q: Coordinates) -> dict[Id, tuple[float, ...]]:
    """The coordinates of each joint that has some given, those of followers computed from their leaders unless they are given."""
    given = _by_name(mechanism, q)
    values: dict[Id, tuple[float, ...]] = {}
    by_name = {key.name: key for key in mechanism.joints}
    for name, value in given.items():
        if name not in by_name:
            raise unknown_name("joint", name, by_name)
        key = by_name[name]
        values[key] = _checked(str(key), _numbers(value, str(key)), mechanism.joints[key].joint.dofs)
    return _with_followers(mechanism, values)


def _numbers(value: float | Sequence[float], name: str) -> tuple[float, ...]:
    """One coordinate, or several in a sequence or an array. Raises: EditError for what are no finite numbers."""
    try:
        found = (float(value),) if isinstance(value, float | int) else tuple([float(number) for number in value])
    except (TypeError, ValueError):
        found = (math.nan,)
    if not all(map(math.isfinite, found)):
        raise EditError(f"{name}: coordinates are finite numbers, found {value!r}")
    return found


def _checked(name: str, numbers: tuple[float, ...], dofs: tuple[Dof, ...]) -> tuple[float, ...]:
    """As many coordinates as the joint has. Raises: EditError for another number, and for a quaternion of zeros."""
    width = width_of(dofs)
    if len(numbers) != width:
        raise EditError(f"{name} has {width} coordinates, found {len(numbers)}")
    start = 0
    for dof in dofs:
        start += WIDTHS.get(dof.kind, 1)
        if dof.kind in WIDTHS and not any(numbers[start - 4 : start]):
            raise EditError(f"{name}: a quaternion of zeros is no rotation")
    return numbers


def width_of(dofs: tuple[Dof, ...]) -> int:
    """The number of coordinates of a joint."""
    return sum(WIDTHS.get(dof.kind, 1) for dof in dofs)


def references(dofs: tuple[Dof, ...]) -> tuple[float, ...]:
    """The coordinates of a joint at which its child is where its poses put it."""
    found: list[float] = []
    for dof in dofs:
        turn = [1.0, 0.0, 0.0, 0.0]
        found += [0.0, 0.0, 0.0, *turn] if dof.kind is DofKind.FREE else turn if dof.kind is DofKind.BALL else [dof.ref]
    return tuple(found)


def _by_name(mechanism: Mechanism, q: Coordinates) -> Mapping[str, float | Sequence[float]]:
    if isinstance(q, Mapping):
        return q
    numbers = _numbers(q, f"robot '{mechanism.name}'")
    found: dict[str, Sequence[float]] = {}
    start = 0
    for key, view in mechanism.joints.items():
        width = width_of(view.joint.dofs)
        if width:
            found[key.name] = numbers[start : start + width]
        start += width
    if start != len(numbers):
        raise EditError(f"robot '{mechanism.name}' has {start} coordinates, found {len(numbers)}")
    return found


def _with_followers(mechanism: Mechanism, values: dict[Id, tuple[float, ...]]) -> dict[Id, tuple[float, ...]]:
    """Followers after their leaders, as far as those do not go round in a circle."""
    waiting = [(arcs[0], arcs[1:]) for _, data, arcs in mechanism.edges(Coupling) if data.active and arcs and arcs[0].target not in values]
    followers = {follower.target for follower, _ in waiting}
    while waiting:
        ready = [item for item in waiting if all(arc.target not in followers for arc in item[1])]
        if not ready:
            return values
        for follower, leaders in ready:
            if follower.target in mechanism.joints:
                _follow(mechanism, follower, leaders, values)
        followers -= {follower.target for follower, _ in ready}
        waiting = [item for item in waiting if item[0].target in followers]
    return values


def _follow(mechanism: Mechanism, follower: RobotArc, leaders: Sequence[RobotArc], values: dict[Id, tuple[float, ...]]) -> None:
    total = 0.0
    for arc in leaders:
        leader = mechanism.joints.get(arc.target)
        if leader is None:
            return
        number = dof_number(leader.joint, arc.role) or 0
        here = values.get(arc.target, references(leader.joint.dofs))[number]
        total += sum(factor * here**power for power, factor in enumerate(numbers_weight(arc)))
    joint = mechanism.joints[follower.target].joint
    found = list(values.get(follower.target, references(joint.dofs)))
    found[dof_number(joint, follower.role) or 0] = total
    values[follower.target] = tuple(found)


# ---- motion ------------------------------------------------------------------------------------------------------------------


def _moved(parent: Pose, joint: JointView, values: Mapping[Id, tuple[float, ...]]) -> Pose:
    numbers = values.get(joint.id)
    if not numbers:
        return below(parent, joint.parent_pose, joint.child_pose)
    frame, start = joint.parent_pose, 0
    for dof in joint.joint.dofs:
        width = WIDTHS.get(dof.kind, 1)
        frame = compose(frame, _motion(dof, numbers[start : start + width]))
        start += width
    return below(parent, frame, joint.child_pose)


def _motion(dof: Dof, numbers: tuple[float, ...]) -> Pose:
    if dof.kind is DofKind.FREE:
        return pose((numbers[0], numbers[1], numbers[2]), (numbers[3], numbers[4], numbers[5], numbers[6]))
    if dof.kind is DofKind.BALL:
        return turn_about(dof.anchor, pose(quat=(numbers[0], numbers[1], numbers[2], numbers[3])).quat)
    return displacement(dof, numbers[0] - dof.ref)
