"""Rotations as authors write them: which rotation a notation means. Angles in rad; quaternions (w, x, y, z).

The kinds of :class:`hymeko_x.ir.values.Written` that a pose may have: ``quat`` (4 numbers, any length), ``rpy`` (3),
``euler:xyz`` (3, with any sequence; lower case turns about moving axes, upper case about fixed ones, so that ``XYZ`` means
``rpy``), ``axisangle`` (4), ``xyaxes`` (6), ``zaxis`` (3), ``fromto`` (two points: the z axis leads from the second to the
first, the origin is midway) and ``dir`` (3: where a light shines, its -z).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hymeko_x.ir.decimals import clean_quat, clean_vector, shortest, shortest_of
from hymeko_x.ir.values import (
    NO_ROTATION,
    ZERO,
    Pose,
    Written,
    X,
    Y,
    Z,
    add,
    cross,
    dot,
    quat_about,
    quat_from_rpy,
    quat_product,
    rotate,
    scaled,
    unit,
    unit_quat,
)

if TYPE_CHECKING:
    from hymeko_x.ir.values import Quat, Vec3

_AXES = {"x": X, "y": Y, "z": Z}
NOTATIONS = ("quat", "rpy", "euler:xyz", "axisangle", "xyaxes", "zaxis", "fromto", "dir")
"""Every kind; ``euler`` goes with any sequence."""

_COUNTS = {"quat": 4, "rpy": 3, "axisangle": 4, "xyaxes": 6, "zaxis": 3, "fromto": 6, "dir": 3}


def number_count(kind: str) -> int | None:
    """How many numbers a notation has; None for one that is not known."""
    return 3 if _is_euler(kind) else _COUNTS.get(kind)


def pose_as_written(xyz: Vec3, written: Written) -> Pose:
    """The pose at ``xyz`` in m with the rotation that was written; for ``fromto`` the position follows from the points.

    Angles about fixed axes are ``rpy``, as URDF has them; zeros, which URDF has not, keep their notation.

    Raises: ZeroDivisionError for numbers that are no rotation.
    """
    if written.kind == "fromto":
        first, second = ends_of(written)
        x, y, z = shortest_of(scaled(add(first, second), 0.5), max(map(abs, written.numbers)))
        return Pose((x, y, z), quat_from_direction(add(first, scaled(second, -1.0))), written)
    if written.kind == "euler:XYZ" and written.numbers != ZERO:
        written = Written("rpy", written.numbers)
    return Pose(xyz, quat_as_written(written), written)


def clean_pose(pose: Pose) -> Pose:
    """A computed pose without noise; lengths relative to 1 m at least. It has no notation."""
    return Pose(clean_vector(pose.xyz), unit_quat(clean_quat(pose.quat)))


def ends_of(written: Written) -> tuple[Vec3, Vec3]:
    """The two points of ``fromto``."""
    a, b, c, d, e, f = written.numbers
    return (a, b, c), (d, e, f)


def length_of(written: Written) -> float:
    """The distance in m of the two points of ``fromto``."""
    first, second = ends_of(written)
    return shortest(math.dist(first, second))


def between_ends(pose: Pose, length: float) -> Pose:
    """The pose with the notation ``fromto``, of something along its z axis of this length in m; the numbers without noise."""
    half = scaled(rotate(pose.quat, Z), length / 2.0)
    ends = (clean_vector(add(pose.xyz, half)), clean_vector(add(pose.xyz, scaled(half, -1.0))))
    return Pose(pose.xyz, pose.quat, Written("fromto", (*ends[0], *ends[1])))


def is_as_written(pose: Pose) -> bool:
    """Whether the notation of a pose still means it: one that was made from another pose may have another place or rotation."""
    return pose.written is None or pose_as_written(pose.xyz, pose.written) == pose


def quat_as_written(written: Written) -> Quat:
    """The rotation that was written. Raises: ZeroDivisionError for numbers that are no rotation."""
    kind, numbers = written
    if _is_euler(kind):
        return _from_euler(kind[6:], numbers)
    if kind == "axisangle":
        return unit_quat(clean_quat(quat_about(unit(numbers[:3]), numbers[3])))  # type: ignore[arg-type]
    if kind == "xyaxes":
        return _from_xyaxes(numbers[:3], numbers[3:])  # type: ignore[arg-type]
    if kind == "zaxis":
        return quat_from_direction(numbers)  # type: ignore[arg-type]
    if kind == "dir":
        return quat_from_direction(scaled(numbers, -1.0))  # type: ignore[arg-type]
    if kind == "rpy":
        return quat_from_rpy(numbers)
    return unit_quat(numbers)  # type: ignore[arg-type]


def quat_from_direction(direction: Vec3) -> Quat:
    """The smallest rotation that turns z into a direction of any length (about x for the opposite of z)."""
    x, y, z = unit(direction)
    axis = cross(Z, (x, y, z))
    sine = math.hypot(*axis)
    if sine < 1e-14:
        return NO_ROTATION if z > 0.0 else (0.0, 1.0, 0.0, 0.0)
    return unit_quat(clean_quat(quat_about(scaled(axis, 1.0 / sine), math.atan2(sine, z))))


def _is_euler(kind: str) -> bool:
    sequence = kind.removeprefix("euler:")
    return len(sequence) == 3 and len(kind) == 9 and set(sequence.lower()) <= set(_AXES)


def _from_euler(sequence: str, angles: tuple[float, ...]) -> Quat:
    """Source: MuJoCo, compiler/eulerseq."""
    quat = NO_ROTATION
    for letter, angle in zip(sequence, angles, strict=True):
        turn = quat_about(_AXES[letter.lower()], angle)
        quat = quat_product(quat, turn) if letter.islower() else quat_product(turn, quat)
    return unit_quat(clean_quat(quat))


def _from_xyaxes(x: Vec3, y: Vec3) -> Quat:
    """The frame with this x axis whose y axis is as close as can be to the one given."""
    x = unit(x)
    y = unit(add(y, scaled(x, -dot(x, y))))
    z = cross(x, y)
    return _from_columns(x, y, z)


def _from_columns(x: Vec3, y: Vec3, z: Vec3) -> Quat:
    """The rotation whose matrix has these columns, by the largest of the four components."""
    squares = (
        1.0 + x[0] + y[1] + z[2],
        1.0 + x[0] - y[1] - z[2],
        1.0 - x[0] + y[1] - z[2],
        1.0 - x[0] - y[1] + z[2],
    )
    best = max(range(4), key=squares.__getitem__)
    rows = (
        (squares[0], y[2] - z[1], z[0] - x[2], x[1] - y[0]),
        (y[2] - z[1], squares[1], x[1] + y[0], z[0] + x[2]),
        (z[0] - x[2], x[1] + y[0], squares[2], y[2] + z[1]),
        (x[1] - y[0], z[0] + x[2], y[2] + z[1], squares[3]),
    )
    return unit_quat(clean_quat(rows[best]))
