"""What is computed from triangles: normals, extents, volume, a second side."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hymeko_x.assets.part import Part

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hymeko_x.ir.values import Vec3


def face_normals(points: NDArray[np.float32], corners: NDArray[Any]) -> NDArray[np.float32]:
    """The unit normal of each triangle (n x 3, single precision), by the right hand; z where a triangle has none.

    ``points`` is (m, 3), ``corners`` the rows of ``points`` of all triangles, flat.
    """
    first, second, third = (points[corners[corner::3]].astype(np.float64) for corner in range(3))
    (ax, ay, az), (bx, by, bz) = (second - first).T, (third - first).T
    normals = np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=1)
    lengths = np.sqrt(np.einsum("ij,ij->i", normals, normals))
    flat = ~(lengths > 0.0)
    normals[flat], lengths[flat] = (0.0, 0.0, 1.0), 1.0
    return np.asarray(normals / lengths[:, None], dtype=np.float32)


def volume_of_sheets(part: Part) -> float:
    """The sum of the volumes of the pyramids from the mean point to all triangles, in m^3; zero for a flat mesh.

    Source: MuJoCo's volume of a mesh with ``inertia="legacy"``.
    """
    a, b, c = (part.points[part.faces[:, corner]] - part.points.mean(axis=0) for corner in range(3))
    return float(np.abs(np.einsum("ij,ij->i", a, np.cross(b, c))).sum() / 6.0)


def extents(part: Part) -> Vec3:
    """The lengths in m of the box along the principal axes of the points, ascending."""
    centred = part.points - part.points.mean(axis=0)
    _, axes = np.linalg.eigh(centred.T @ centred)
    low, middle, high = sorted(np.ptp(centred @ axes, axis=0).tolist())
    return (low, middle, high)


def thickened(part: Part, share: float) -> Part:
    """A flat part as a thin solid: a second layer lies below the first one, ``share`` of the largest extent away."""
    centred = part.points - part.points.mean(axis=0)
    _, axes = np.linalg.eigh(centred.T @ centred)
    below = part.points - axes[:, 0] * share * np.ptp(centred @ axes, axis=0).max()
    faces = np.concatenate([part.faces, part.faces[:, ::-1] + len(part.points)])
    uv = None if part.uv is None else np.concatenate([part.uv, part.uv])
    return Part(np.concatenate([part.points, below]), faces, uv, part.look)
