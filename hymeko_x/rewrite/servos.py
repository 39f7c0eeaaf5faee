"""What a position servo has to move and to carry at the home configuration, and the gains that follow from it."""

from __future__ import annotations

import math
import operator
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.ir.kinematics import displacement, dof_number
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Body, DofKind
from hymeko_x.ir.values import IDENTITY, ZERO, Pose, add, apply, compose, cross, dot, inverse, rotate, rotate_tensor, scaled

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.ir.mechanism import Id, JointView, Mechanism, RobotArc
    from hymeko_x.ir.parts import Dof, Parameters
    from hymeko_x.ir.values import Tensor, Vec3

GRAVITY = 9.81
"""In m/s^2."""
SAG = 0.01
"""How far, in rad or m, gravity may pull a servo from its target in the worst direction."""
LEAST_FREQUENCY = 20.0
"""The least natural frequency of a servo in rad/s, so that one without a load is at its target within half a second."""

_STIFFNESS = 100.0
"""Position gain in Nm/rad or N/m of a joint without effort limit."""
_FULL_EFFORT_AT = 0.1
"""The error (rad or m; for velocities a part of the limit) at which a servo asks for all of the effort limit."""
_NO_TENSOR = (0.0,) * 6


class Load(NamedTuple):
    """What a dof moves while all other dofs are held, in kg m^2 or kg, and the greatest torque of gravity on it, in Nm or N.

    ``inertia`` is its diagonal entry of the mass matrix. ``weight`` is the torque of gravity at home, along -z of the world.
    """

    inertia: float
    gravity: float
    weight: float


class CompositeInertia(NamedTuple):
    """Mass in kg, mass times centre in kg m, and tensor in kg m^2 of some bodies, in the world about its origin."""

    mass: float
    moment: Vec3
    tensor: Tensor


def home(dof: Dof) -> float:
    """The coordinate of a dof at home, in rad or m: its reference, or the limit next to it where it is outside of them."""
    lower, upper = dof.limits.lower, dof.limits.upper
    if lower is not None and upper is not None and lower > upper:
        return dof.ref
    return max(lower if lower is not None else -math.inf, min(upper if upper is not None else math.inf, dof.ref))


def gains(load: Load, effort: float | None) -> tuple[float, float]:
    """Stiffness and damping of a servo, in Nm/rad and Nms/rad or N/m and Ns/m.

    The stiffness carries the load with an error of SAG, and is at least that of the natural frequency LEAST_FREQUENCY; the effort limit,
    where there is one, is reached at SAG at the soonest. The damping is critical for the moved inertia.
    """
    stiffness = max(load.gravity / SAG, load.inertia * LEAST_FREQUENCY**2)
    if effort:
        stiffness = min(stiffness, effort / SAG)
    return stiffness, 2.0 * math.sqrt(stiffness * load.inertia)


def parameters_of(kind: str, dof: Dof, load: Load | None) -> Parameters:
    """Control ranges from the limits; gains that carry the load where it is known, else so that a small error asks for all effort."""
    limits = dof.limits
    match kind:
        case "position":
            damping = ("dampratio", 1.0)
            gain = limits.effort / _FULL_EFFORT_AT if limits.effort else _STIFFNESS
            if load is not None and load.inertia > 0.0:
                gain, kv = (_rounded(value) for value in gains(load, limits.effort))
                damping = ("kv", kv)
            reach = ((limits.lower, limits.upper),) if limits.lower is not None and limits.upper is not None else ()
            return (("kp", gain), damping, *(("ctrlrange", span) for span in reach))
        case "velocity":
            speed = limits.velocity or 0.0
            gain = limits.effort / (_FULL_EFFORT_AT * (speed or 1.0)) if limits.effort else _STIFFNESS * _FULL_EFFORT_AT
            return (("kv", gain), *((("ctrlrange", (-speed, speed)),) if speed else ()))
        case _:
            return (("ctrlrange", (-limits.effort, limits.effort)),) if limits.effort else ()


def _rounded(value: float) -> float:
    """A gain with the three digits that a person would write."""
    return float(f"{value:.3g}")


def loads(mechanism: Mechanism) -> dict[tuple[Id, int], Load]:
    """The load of each hinge, slide and screw at home, by joint and number.

    Where gravity points is not known, and the bodies before the dof may have any pose: gravity acts where it turns most.

    Source: R. Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 6 (composite rigid bodies).
    """
    poses = home_poses(mechanism)
    moved = {body: inertia_of(mechanism.vertex(body, Body), pose) for body, pose in poses.items() if body != WORLD}
    found: dict[tuple[Id, int], Load] = {}
    for view, frames in joints_inward(mechanism, poses):
        for number, dof in enumerate(view.joint.dofs):
            if dof.kind not in (DofKind.BALL, DofKind.FREE):
                found[view.id, number] = _load(moved[view.child], dof, frames[number])
        if view.parent != WORLD:
            moved[view.parent] = _together(moved[view.parent], moved[view.child])
    return found


def dof_of(mechanism: Mechanism, arc: RobotArc) -> tuple[Id, int]:
    """The joint and the number of the dof to which an arc leads."""
    view = mechanism.joints.get(arc.target)
    return arc.target, (dof_number(view.joint, arc.role) or 0) if view else 0


def joints_inward(mechanism: Mechanism, poses: Mapping[Id, Pose]) -> Iterator[tuple[JointView, list[Pose]]]:
    """Every joint of the tree, those further out first, with the frames of its dofs where the bodies have these poses."""
    for body in reversed([*mechanism.depth_first()]):
        view = mechanism.parent_joint.get(body)
        if view is not None:
            yield view, [*_frames(view, poses.get(view.parent, IDENTITY))]


def _frames(view: JointView, parent: Pose) -> Iterator[Pose]:
    """The frame in the world in which each dof of a joint moves, at home, and behind the last one that of the joint in its child."""
    frame = compose(parent, view.parent_pose)
    yield frame
    for dof in view.joint.dofs:
        frame = compose(frame, displacement(dof, home(dof) - dof.ref))
        yield frame


def home_poses(mechanism: Mechanism) -> dict[Id, Pose]:
    """The pose of each body, in the world or its own root, where every dof is at home. Not recursive."""
    poses: dict[Id, Pose] = {WORLD: IDENTITY}
    for body in mechanism.depth_first():
        above = mechanism.parent_joint.get(body)
        if above is None:
            poses[body] = IDENTITY
            continue
        *_, last = _frames(above, poses.get(above.parent, IDENTITY))
        poses[body] = compose(last, inverse(above.child_pose))
    return poses


# ---- inertias, in the world about its origin -------------------------------------------------------------------------------------


def motion_of(dof: Dof, frame: Pose) -> tuple[Vec3, Vec3]:
    """The rotation and the velocity at the origin of the world, per unit of the coordinate of a dof that stands in this frame."""
    axis = rotate(frame.quat, dof.axis)
    if dof.kind is DofKind.SLIDE:
        return ZERO, axis
    return axis, add(cross(apply(frame, dof.anchor), axis), scaled(axis, dof.pitch))


def inertia_of(body: Body, pose: Pose) -> CompositeInertia:
    """The inertia of a body; zero without a mass."""
    inertial = body.inertial
    if inertial is None or not inertial.mass or inertial.mass < 0.0:
        return CompositeInertia(0.0, ZERO, _NO_TENSOR)
    mass, (x, y, z) = inertial.mass, apply(pose, inertial.com)
    xx, yy, zz, xy, xz, yz = rotate_tensor(pose.quat, inertial.tensor) if inertial.tensor else _NO_TENSOR
    a, b, c = mass * x, mass * y, mass * z
    return CompositeInertia(
        mass, (a, b, c), (xx + b * y + c * z, yy + a * x + c * z, zz + a * x + b * y, xy - a * y, xz - a * z, yz - b * z)
    )


def _together(one: CompositeInertia, other: CompositeInertia) -> CompositeInertia:
    """The inertia of the bodies of both."""
    tensor: Tensor = tuple(map(operator.add, one.tensor, other.tensor))
    return CompositeInertia(one.mass + other.mass, add(one.moment, other.moment), tensor)


def _load(moved: CompositeInertia, dof: Dof, frame: Pose) -> Load:
    """The load of a dof that stands in this frame and moves these bodies."""
    turn, velocity = motion_of(dof, frame)
    xx, yy, zz, xy, xz, yz = moved.tensor
    pushed = (dot((xx, xy, xz), turn), dot((xy, yy, yz), turn), dot((xz, yz, zz), turn))
    inertia = dot(turn, pushed) + 2.0 * dot(velocity, cross(turn, moved.moment)) + moved.mass * dot(velocity, velocity)
    return Load(max(inertia, 0.0) + dof.armature, *_gravity(moved, dof, frame))


def _gravity(moved: CompositeInertia, dof: Dof, frame: Pose) -> tuple[float, float]:
    """The greatest force of gravity along a dof, wherever it points, and the size of that along -z."""
    axis = rotate(frame.quat, dof.axis)
    if dof.kind is DofKind.SLIDE:
        return moved.mass * GRAVITY, moved.mass * GRAVITY * abs(axis[2])
    lever = cross(axis, add(moved.moment, scaled(apply(frame, dof.anchor), -moved.mass)))
    return GRAVITY * math.hypot(*lever), GRAVITY * abs(lever[2])
