"""Numbers of the IR: vectors, rotations, poses and tensors as plain tuples of doubles.

SI units and radians throughout. Quaternions are (w, x, y, z) with unit norm and w >= 0, tensors are
(xx, yy, zz, xy, xz, yz). How an author wrote a rotation is kept beside it as :class:`Written`, so that the same
format writes it back digit by digit; comparisons ignore it.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.ir.decimals import clean_angles, clean_quat, shortest_of
from hymeko_x.ir.fields import Noted

if TYPE_CHECKING:
    from collections.abc import Sequence

Vec3 = tuple[float, float, float]
Quat = tuple[float, float, float, float]
Tensor = tuple[float, float, float, float, float, float]
Matrix3 = tuple[Vec3, Vec3, Vec3]

ZERO: Vec3 = (0.0, 0.0, 0.0)
X: Vec3 = (1.0, 0.0, 0.0)
Y: Vec3 = (0.0, 1.0, 0.0)
Z: Vec3 = (0.0, 0.0, 1.0)
NO_ROTATION: Quat = (1.0, 0.0, 0.0, 0.0)

_RIGID = 1e-5  # how far a matrix in single precision may be from a rotation
_UNIT_TOLERANCE = 4e-15  # a normalised vector is this close to unit norm; normalising it again must not change a bit


class Written(NamedTuple):
    """How a rotation was written: the kind of notation (``rpy``, ``quat``, ``euler``, ...) and its numbers, angles in rad."""

    kind: str
    numbers: tuple[float, ...]


class Pose(Noted, frozen=True, gc=False):
    """A rigid transformation: position ``xyz`` in m and unit quaternion ``quat`` (w, x, y, z) of the rotation.

    Make it with :func:`pose` and its siblings, which normalise; two equal rotations then have equal numbers.
    """

    xyz: Vec3 = ZERO
    quat: Quat = NO_ROTATION
    written: Written | None = None

    @staticmethod
    def from_rpy(rpy: Vec3, xyz: Vec3 = ZERO) -> Pose:
        """The pose of fixed-axis roll, pitch, yaw in rad and a position in m."""
        roll, pitch, yaw = map(float, rpy)
        return pose_from_rpy(_point(xyz), (roll, pitch, yaw))

    @staticmethod
    def from_quat(quat: Quat, xyz: Vec3 = ZERO) -> Pose:
        """The pose of any non-zero quaternion (w, x, y, z) and a position in m. Raises: ZeroDivisionError for a zero quaternion."""
        w, x, y, z = map(float, quat)
        return Pose(_point(xyz), unit_quat((w, x, y, z)))

    @staticmethod
    def from_matrix(matrix: Sequence[Sequence[float]]) -> Pose:
        """The pose of a rigid 4 x 4 matrix, with the position in m, or of a 3 x 3 rotation matrix, row by row.

        Raises: ValueError for another shape, and for a matrix that scales, shears or mirrors by more than 1e-5.
        """
        rows = [tuple(map(float, row)) for row in matrix]
        if [len(row) for row in rows] not in ([3] * 3, [4] * 4):
            raise ValueError("a pose is a matrix of 4 x 4 or 3 x 3 numbers")
        a, b, c = ((row[0], row[1], row[2]) for row in rows[:3])
        if not all(math.dist(cross(one, other), third) <= _RIGID for one, other, third in ((a, b, c), (b, c, a), (c, a, b))):
            raise ValueError("the matrix is no rotation: it scales, shears or mirrors")
        return Pose(ZERO if len(rows) == 3 else (rows[0][3], rows[1][3], rows[2][3]), quat_from_matrix((a, b, c)))

    def matrix(self) -> tuple[tuple[float, float, float, float], ...]:
        """The 4 x 4 matrix, row by row, with the position in m."""
        rows = zip(matrix_from_quat(self.quat), self.xyz, strict=True)
        return (*((*row, position) for row, position in rows), (0.0, 0.0, 0.0, 1.0))

    def inverse(self) -> Pose:
        """The pose with ``pose @ pose.inverse()`` = identity."""
        return inverse(self)

    def __matmul__(self, other: Pose) -> Pose:
        """The pose ``other``, given in this frame, seen from where this one is given."""
        return compose(self, other)


IDENTITY = Pose()


# ---- making values -----------------------------------------------------------------------------------------------------


def unit(vector: Vec3) -> Vec3:
    """The vector with length 1. A vector that has it already comes back bit by bit.

    Raises: ZeroDivisionError for a vector too short to have a direction.
    """
    x, y, z = vector
    square = x * x + y * y + z * z
    if abs(square - 1.0) < _UNIT_TOLERANCE:
        return vector
    length = math.hypot(x, y, z)
    if length < 1e-300 or not math.isfinite(length):
        raise ZeroDivisionError(f"{vector} has no direction")
    return (x / length, y / length, z / length)


def unit_quat(quat: Quat) -> Quat:
    """The unit quaternion of the same rotation with w >= 0 (for w = 0: first non-zero component positive).

    Raises: ZeroDivisionError for a zero quaternion.
    """
    w, x, y, z = quat
    square = w * w + x * x + y * y + z * z
    if not abs(square - 1.0) < _UNIT_TOLERANCE:  # also where a component is not a number
        length = math.hypot(w, x, y, z)
        if length < 1e-300 or not math.isfinite(length):
            raise ZeroDivisionError(f"{quat} is no rotation")
        w, x, y, z = w / length, x / length, y / length, z / length
    if w < 0.0 or (w == 0.0 and (x, y, z) < (0.0, 0.0, 0.0)):
        w, x, y, z = -w, -x, -y, -z
    return (w + 0.0, x + 0.0, y + 0.0, z + 0.0)  # + 0.0 turns -0.0 into 0.0


def pose(xyz: Vec3 = ZERO, quat: Quat = NO_ROTATION) -> Pose:
    """A pose from a position in m and any non-zero quaternion (w, x, y, z); unusual notation is remembered."""
    normal = unit_quat(quat)
    return Pose(xyz, normal, None if normal == quat else Written("quat", quat))


def pose_from_rpy(xyz: Vec3, rpy: Vec3) -> Pose:
    """A pose from a position in m and fixed-axis roll, pitch, yaw in rad; the angles are remembered as written."""
    if rpy == ZERO:
        return Pose(xyz)
    return Pose(xyz, quat_from_rpy(rpy), Written("rpy", rpy))


@lru_cache(4096)  # the same angles come again in other limbs, and when what was written is compared with what it means
def quat_from_rpy(rpy: Vec3) -> Quat:
    """The rotation Rz(yaw) Ry(pitch) Rx(roll) as a unit quaternion (w, x, y, z), w >= 0. Angles in rad.

    Source: URDF <origin rpy>: fixed axes, roll about x first.
    """
    roll, pitch, yaw = rpy[0] / 2.0, rpy[1] / 2.0, rpy[2] / 2.0
    cr, sr, cp, sp, cy, sy = math.cos(roll), math.sin(roll), math.cos(pitch), math.sin(pitch), math.cos(yaw), math.sin(yaw)
    return unit_quat(
        clean_quat(
            (
                cr * cp * cy + sr * sp * sy,
                sr * cp * cy - cr * sp * sy,
                cr * sp * cy + sr * cp * sy,
                cr * cp * sy - sr * sp * cy,
            )
        )
    )


def quat_about(axis: Vec3, angle: float) -> Quat:
    """The rotation by ``angle`` rad about the unit vector ``axis``."""
    s = math.sin(angle / 2.0)
    return unit_quat((math.cos(angle / 2.0), axis[0] * s, axis[1] * s, axis[2] * s))


def quat_from_z(direction: Vec3) -> Quat:
    """The smallest rotation that turns the z axis into the unit vector ``direction`` (about x for the opposite of z)."""
    x, y, z = direction
    if z > -1.0 + 1e-14:
        return unit_quat((1.0 + z, -y, x, 0.0))
    return (0.0, 1.0, 0.0, 0.0)


def plane_axes(normal: Vec3) -> tuple[Vec3, Vec3]:
    """The x and y directions of a plane: x and y turned by the smallest rotation from z to the normal."""
    turn = quat_from_z(normal)
    return rotate(turn, X), rotate(turn, Y)


def _point(xyz: Vec3) -> Vec3:
    x, y, z = map(float, xyz)
    return (x, y, z)


def quat_from_matrix(rows: Matrix3) -> Quat:
    """The unit quaternion (w, x, y, z) of a rotation matrix, row by row; exact to rounding for every rotation.

    Source: S. W. Shepperd, Quaternion from rotation matrix, 1978: the largest component is computed from the diagonal.
    """
    (a, b, c), (d, e, f), (g, h, i) = rows
    found = max(
        (1 + a + e + i, (1 + a + e + i, h - f, c - g, d - b)),
        (1 + a - e - i, (h - f, 1 + a - e - i, b + d, c + g)),
        (1 - a + e - i, (c - g, b + d, 1 - a + e - i, f + h)),
        (1 - a - e + i, (d - b, c + g, f + h, 1 - a - e + i)),
    )
    return unit_quat(found[1])


# ---- reading values ----------------------------------------------------------------------------------------------------


def rpy_of(value: Pose) -> Vec3:
    """Fixed-axis roll, pitch, yaw in rad of the pose's rotation: as written if it was written so (also in MJCF), else computed.

    At pitch = +-pi/2, where roll and yaw are not unique, yaw is 0. Exact to rounding everywhere.
    """
    if value.written is not None and value.written.kind in ("rpy", "euler:XYZ"):
        roll, pitch, yaw = value.written.numbers
        return (roll, pitch, yaw)
    return rpy_from_quat(value.quat)


def rpy_from_quat(quat: Quat) -> Vec3:
    """Fixed-axis roll, pitch, yaw in rad of a unit quaternion (w, x, y, z). The pitch is within pi/2, but for a rotation about y alone."""
    if quat == NO_ROTATION:
        return ZERO
    w, x, y, z = quat
    return _rpy_from_quat((w + 0.0, x + 0.0, y + 0.0, z + 0.0))  # + 0.0: zeros of both signs are equal, and so are their angles


@lru_cache(4096)
def _rpy_from_quat(quat: Quat) -> Vec3:
    r = matrix_from_quat(quat)
    flat = math.hypot(r[0][0], r[1][0])
    pitch = math.atan2(-r[2][0], flat)
    yaw = math.atan2(r[1][0], r[0][0]) if flat > 1e-15 else 0.0
    turn = quat_product(quat_about(Y, pitch), quat_about(Z, 0.0))
    turn = quat_product(quat_about(Z, yaw), turn)
    rest = quat_product(quat_inverse(turn), quat)  # what is left is a rotation about x, even where pitch is near +-pi/2
    roll = 2.0 * math.atan2(rest[1], rest[0])
    if roll > math.pi:
        roll -= 2.0 * math.pi
    elif roll <= -math.pi:
        roll += 2.0 * math.pi
    roll, pitch, yaw = clean_angles((roll, pitch, yaw))
    is_pitch = abs(roll) == abs(yaw) == math.pi  # half a turn about x and about z with a pitch between is a pitch alone
    return (0.0, clean_angles((math.copysign(math.pi, pitch) - pitch,))[0], 0.0) if is_pitch else (roll, pitch, yaw)


def matrix_from_quat(quat: Quat) -> Matrix3:
    """The rotation matrix of a unit quaternion (w, x, y, z), row by row."""
    w, x, y, z = quat
    return (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    )


# ---- calculating -------------------------------------------------------------------------------------------------------


def quat_product(a: Quat, b: Quat) -> Quat:
    """The rotation ``b`` followed by ``a``: R(a) R(b). Not normalised."""
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return (
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


def quat_inverse(quat: Quat) -> Quat:
    """The inverse of a unit quaternion."""
    w, x, y, z = quat
    return (w, -x, -y, -z)


def rotate(quat: Quat, vector: Vec3) -> Vec3:
    """The vector turned by a unit quaternion."""
    if quat == NO_ROTATION:
        return vector
    r = matrix_from_quat(quat)
    x, y, z = vector
    return (
        r[0][0] * x + r[0][1] * y + r[0][2] * z,
        r[1][0] * x + r[1][1] * y + r[1][2] * z,
        r[2][0] * x + r[2][1] * y + r[2][2] * z,
    )


def add(a: Vec3, b: Vec3) -> Vec3:
    """a + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def scaled(vector: Vec3, factor: float) -> Vec3:
    """factor * vector."""
    return (vector[0] * factor, vector[1] * factor, vector[2] * factor)


def cross(a: Vec3, b: Vec3) -> Vec3:
    """a x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def compose(a: Pose, b: Pose) -> Pose:
    """a * b: the pose b, given in the frame a, seen from where a is given."""
    if b == IDENTITY:
        return a
    if a == IDENTITY:
        return b
    quat = a.quat if b.quat == NO_ROTATION else quat_product(a.quat, b.quat)
    return Pose(add(a.xyz, rotate(a.quat, b.xyz)), unit_quat(quat))


def inverse(a: Pose) -> Pose:
    """The pose with compose(a, inverse(a)) = identity."""
    if a == IDENTITY:
        return a
    back = quat_inverse(a.quat)
    x, y, z = rotate(back, a.xyz)
    return Pose((-x + 0.0, -y + 0.0, -z + 0.0), unit_quat(back))


def apply(a: Pose, point: Vec3) -> Vec3:
    """The point, given in the frame a, seen from where a is given."""
    return add(a.xyz, rotate(a.quat, point))


@lru_cache(4096)  # writers ask again for what readers have computed
def rotate_tensor(quat: Quat, tensor: Tensor) -> Tensor:
    """R I R^T: a symmetric tensor given in turned axes, seen in the axes in which ``quat`` is given."""
    if quat == NO_ROTATION:
        return tensor
    r = matrix_from_quat(quat)
    xx, yy, zz, xy, xz, yz = tensor
    columns = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
    (a, b, c), (d, e, f), (g, h, i) = [[dot(row, column) for column in columns] for row in r]
    first, second, third = r
    x, y = (a, b, c), (d, e, f)
    turned = (dot(x, first), dot(y, second), dot((g, h, i), third), dot(x, second), dot(x, third), dot(y, third))
    return shortest_of(turned)  # type: ignore[return-value]


def dot(a: Vec3, b: Vec3) -> float:
    """The inner product, never a negative zero."""
    return 0.0 + a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def rotation_angle(a: Quat, b: Quat) -> float:
    """The angle in rad, 0..pi, of the rotation between two unit quaternions."""
    w, x, y, z = quat_product(quat_inverse(a), b)
    return 2.0 * math.atan2(math.hypot(x, y, z), abs(w))
