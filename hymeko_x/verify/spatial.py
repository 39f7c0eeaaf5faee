"""Batched rotations and rigid transformations: arrays of shape (..., 3, 3) and (..., 4, 4)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hymeko_x.verify.model import Array


def rotation_about(axes: Array, angles: Array) -> Array:
    """Rodrigues' formula: rotations by ``angles`` (...) in rad about unit ``axes`` (..., 3), as (..., 3, 3)."""
    axes, angles = np.broadcast_arrays(axes, angles[..., None])
    angle = angles[..., 0]
    x, y, z = axes[..., 0], axes[..., 1], axes[..., 2]
    s, c = np.sin(angle), np.cos(angle)
    v = 1.0 - c
    out = np.empty((*angle.shape, 3, 3))
    out[..., 0, 0], out[..., 0, 1], out[..., 0, 2] = c + x * x * v, x * y * v - z * s, x * z * v + y * s
    out[..., 1, 0], out[..., 1, 1], out[..., 1, 2] = x * y * v + z * s, c + y * y * v, y * z * v - x * s
    out[..., 2, 0], out[..., 2, 1], out[..., 2, 2] = x * z * v - y * s, y * z * v + x * s, c + z * z * v
    return out


def rotation_from_quat(quats: Array) -> Array:
    """Rotations of quaternions (..., 4) as (w, x, y, z), normalised first."""
    unit = quats / np.linalg.norm(quats, axis=-1, keepdims=True)
    w, x, y, z = unit[..., 0], unit[..., 1], unit[..., 2], unit[..., 3]
    out = np.empty((*unit.shape[:-1], 3, 3))
    out[..., 0, 0], out[..., 0, 1], out[..., 0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    out[..., 1, 0], out[..., 1, 1], out[..., 1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    out[..., 2, 0], out[..., 2, 1], out[..., 2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
    return out


def quat_from_rotation(rotation: Array) -> Array:
    """The unit quaternion (w, x, y, z), w >= 0, of each rotation (3, 3) or (n, 3, 3).

    The largest column of 4 q q^T, which a rotation gives without a root (Shepperd 1978). scipy's would take a third of a second to load.
    """
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = (np.moveaxis(row, -1, 0) for row in np.moveaxis(rotation, -2, 0))
    products = np.array(
        [
            [1 + xx + yy + zz, zy - yz, xz - zx, yx - xy],
            [zy - yz, 1 + xx - yy - zz, xy + yx, xz + zx],
            [xz - zx, xy + yx, 1 - xx + yy - zz, yz + zy],
            [yx - xy, xz + zx, yz + zy, 1 - xx - yy + zz],
        ]
    )
    largest = np.einsum("ii...->i...", products).argmax(axis=0)
    quats: Array = np.moveaxis(np.take_along_axis(products, largest[None, None], axis=0)[0], 0, -1)
    quats = quats / np.linalg.norm(quats, axis=-1, keepdims=True)
    return np.where(quats[..., :1] < 0.0, -quats, quats)


def rigid(rotation: Array, position: Array) -> Array:
    """Homogeneous transformations (..., 4, 4) of rotations (..., 3, 3) and positions (..., 3)."""
    shape = np.broadcast_shapes(rotation.shape[:-2], position.shape[:-1])
    out = np.zeros((*shape, 4, 4))
    out[..., :3, :3], out[..., :3, 3], out[..., 3, 3] = rotation, position, 1.0
    return out


def pose(position: Array, quat: Array) -> Array:
    """Homogeneous transformation of a position and a quaternion (w, x, y, z)."""
    return rigid(rotation_from_quat(np.asarray(quat, float)), np.asarray(position, float))


def inverse(transform: Array) -> Array:
    """Inverse of rigid transformations (..., 4, 4)."""
    turned = np.swapaxes(transform[..., :3, :3], -1, -2)
    return rigid(turned, -(turned @ transform[..., :3, 3:])[..., 0])


def angle_between(a: Array, b: Array) -> Array:
    """The angle in rad of the rotation from a to b, exact near 0 and near pi. Shapes (..., 3, 3)."""
    return angle_of(np.swapaxes(a, -1, -2) @ b)


def angle_of(rotation: Array) -> Array:
    """The angle in [0, pi] of rotations (..., 3, 3): atan2 of the skew part's length and the trace."""
    skew = np.stack(
        [rotation[..., 2, 1] - rotation[..., 1, 2], rotation[..., 0, 2] - rotation[..., 2, 0], rotation[..., 1, 0] - rotation[..., 0, 1]],
        -1,
    )
    trace = rotation[..., 0, 0] + rotation[..., 1, 1] + rotation[..., 2, 2]
    angles: Array = np.arctan2(np.linalg.norm(skew, axis=-1), trace - 1.0)
    return angles


def random_quats(rng: np.random.Generator, count: int) -> Array:
    """Uniformly distributed unit quaternions (count, 4)."""
    quats = rng.normal(size=(count, 4))
    turned: Array = quats / np.linalg.norm(quats, axis=1, keepdims=True)
    return turned


def frame_with_z(axis: Array, origin: Array | None = None) -> Array:
    """A frame whose z axis points along ``axis``."""
    z = axis / np.linalg.norm(axis)
    helper = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = np.cross(helper, z)
    x /= np.linalg.norm(x)
    return rigid(np.stack([x, np.cross(z, x), z], axis=1), np.zeros(3) if origin is None else origin)


def shifted_tensor(mass: float, com: Array, tensor: Array) -> Array:
    """The inertia tensor (3, 3) about the frame's origin of a body with this tensor about its centre of mass (parallel axes)."""
    shifted: Array = tensor + mass * (com @ com * np.eye(3) - np.outer(com, com))
    return shifted
