"""What a position servo has to move and to carry at the home configuration, and the gains that follow from it."""

from __future__ import annotations

import math
import operator
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.ir.kinematics import displacement, dof_number
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Body, DofKind
from hymeko_x.ir.values import IDENTITY, Pose, add, apply, compose, cross, inverse, rotate, rotate_tensor, scaled

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from hymeko_x.ir.mechanism import Id, JointView, Mechanism, RobotArc
    from hymeko_x.ir.parts import Dof, Parameters

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


class Load(NamedTuple):
    """What a dof moves, in kg m^2 or kg, and the greatest torque of gravity on it, in Nm or N.

    ``inertia`` is moved when all other dofs are held (a diagonal entry of the mass matrix), ``free`` when those behind it are free (its
    articulated inertia). ``weight`` is the torque of gravity at home, along -z of the world.
    """

    inertia: float
    free: float
    gravity: float
    weight: float


_Matrix = list[list[float]]
"""A spatial inertia in the world, about its origin: six rows, rotation before translation."""


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

    Source: R. Featherstone, Rigid Body Dynamics Algorithms, 2008, chapters 6 (composite) and 7 (articulated inertias).
    """
    poses = home_poses(mechanism)
    held, free = ({body: _own(mechanism.vertex(body, Body), pose) for body, pose in poses.items() if body != WORLD} for _ in range(2))
    found: dict[tuple[Id, int], Load] = {}
    for body in reversed([*mechanism.depth_first()]):
        view = mechanism.parent_joint.get(body)
        if view is None:
            continue
        frames = [*_frames(view, poses.get(view.parent, IDENTITY))]
        for number in reversed(range(len(view.joint.dofs))):
            dof, frame = view.joint.dofs[number], frames[number]
            if dof.kind in (DofKind.BALL, DofKind.FREE):
                free[body] = _zero()
                continue
            axis = _axis(dof, frame)
            pushed = _times(free[body], axis)
            alone = max(_dot(axis, pushed), 0.0) + dof.armature
            together = max(_dot(axis, _times(held[body], axis)), 0.0) + dof.armature
            found[view.id, number] = Load(together, alone, *_gravity(held[body], dof, frame))
            if alone > 0.0:
                _add(free[body], [[-a * b / alone for b in pushed] for a in pushed])
        if view.parent != WORLD:
            _add(held[view.parent], held[body])
            _add(free[view.parent], free[body])
    return found


def dof_of(mechanism: Mechanism, arc: RobotArc) -> tuple[Id, int]:
    """The joint and the number of the dof to which an arc leads."""
    view = mechanism.joints.get(arc.target)
    return arc.target, (dof_number(view.joint, arc.role) or 0) if view else 0


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


# ---- spatial vectors and inertias, in the world about its origin: rotation before translation ------------------------------------


def _axis(dof: Dof, frame: Pose) -> list[float]:
    """The motion of a dof that stands in this frame, per unit of its coordinate."""
    axis = rotate(frame.quat, dof.axis)
    if dof.kind is DofKind.SLIDE:
        return [0.0, 0.0, 0.0, *axis]
    return [*axis, *add(cross(apply(frame, dof.anchor), axis), scaled(axis, dof.pitch))]


def _own(body: Body, pose: Pose) -> _Matrix:
    """The inertia of a body; none without a mass."""
    inertial = body.inertial
    if inertial is None or not inertial.mass or inertial.mass < 0.0:
        return _zero()
    mass, (x, y, z) = inertial.mass, apply(pose, inertial.com)
    xx, yy, zz, xy, xz, yz = rotate_tensor(pose.quat, inertial.tensor) if inertial.tensor else (0.0,) * 6
    a, b, c = mass * x, mass * y, mass * z
    return [
        [xx + b * y + c * z, xy - a * y, xz - a * z, 0.0, -c, b],
        [xy - a * y, yy + a * x + c * z, yz - b * z, c, 0.0, -a],
        [xz - a * z, yz - b * z, zz + a * x + b * y, -b, a, 0.0],
        [0.0, c, -b, mass, 0.0, 0.0],
        [-c, 0.0, a, 0.0, mass, 0.0],
        [b, -a, 0.0, 0.0, 0.0, mass],
    ]


def _gravity(moved: _Matrix, dof: Dof, frame: Pose) -> tuple[float, float]:
    """The greatest force of gravity along a dof, wherever it points, and the size of that along -z."""
    mass, moment = moved[3][3], (moved[2][4], moved[0][5], moved[1][3])
    if dof.kind is DofKind.SLIDE:
        return mass * GRAVITY, mass * GRAVITY * abs(rotate(frame.quat, dof.axis)[2])
    axis, anchor = rotate(frame.quat, dof.axis), apply(frame, dof.anchor)
    lever = cross(axis, add(moment, scaled(anchor, -mass)))
    return GRAVITY * math.hypot(*lever), GRAVITY * abs(lever[2])


def _zero() -> _Matrix:
    return [[0.0] * 6 for _ in range(6)]


def _add(to: _Matrix, other: _Matrix) -> None:
    for row, more in zip(to, other, strict=True):
        row[:] = map(operator.add, row, more)


def _times(matrix: _Matrix, vector: list[float]) -> list[float]:
    return [_dot(row, vector) for row in matrix]


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return float(sum(map(operator.mul, a, b)))
