"""What is computed from triangles: normals, extents, volume, a second side."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hymeko_x.memory import remembered
from hymeko_x.meshes.submesh import Submesh

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hymeko_x.ir.values import Vec3


_BLOCK = 8192
"""Triangles whose normals are computed together: all of a large mesh at once would take twice the time, most of it for new memory."""


def face_normals(points: NDArray[np.float32], corners: NDArray[Any]) -> NDArray[np.float32]:
    """The unit normal of each triangle (n x 3, single precision), by the right hand; z where a triangle has none.

    ``points`` is (m, 3), ``corners`` the rows of ``points`` of all triangles, flat.
    """
    columns = points.T.astype(np.float64, order="C")
    normals = np.empty((len(corners) // 3, 3), dtype=np.float32)
    for start in range(0, len(normals), _BLOCK):
        normals[start : start + _BLOCK] = _normals_of(columns, corners[3 * start : 3 * (start + _BLOCK)]).T
    return normals


def _normals_of(columns: NDArray[np.float64], corners: NDArray[Any]) -> NDArray[np.float64]:
    """The normals (3 x n) of triangles of points (3 x m)."""
    first, second, third = (columns.take(corners[start::3], axis=1) for start in range(3))
    second -= first
    third -= first
    (ax, ay, az), (bx, by, bz) = second, third
    normals = np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
    lengths = np.sqrt((normals * normals).sum(axis=0))
    flat = ~(lengths > 0.0)
    normals[:, flat], lengths[flat] = [[0.0], [0.0], [1.0]], 1.0
    return np.asarray(normals / lengths)


@remembered
def volume_of_sheets(part: Submesh) -> float:
    """The sum of the volumes of the pyramids from the mean point to all triangles, in m^3; zero for a flat mesh.

    Source: MuJoCo's volume of a mesh with ``inertia="legacy"``.
    """
    a, b, c = (part.points[part.faces[:, corner]] - part.points.mean(axis=0) for corner in range(3))
    return float(np.abs(np.einsum("ij,ij->i", a, np.cross(b, c))).sum() / 6.0)


@remembered
def extents(part: Submesh) -> Vec3:
    """The lengths in m of the box along the principal axes of the points, ascending."""
    low, middle, high = sorted(_principal(part)[1].tolist())
    return (low, middle, high)


def _principal(part: Submesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The principal axes of the points (columns), by ascending moments, and the lengths in m of the box along them."""
    centred = part.points - part.points.mean(axis=0)
    _, axes = np.linalg.eigh(centred.T @ centred)
    return axes, np.ptp(centred @ axes, axis=0)


@remembered
def thickened(part: Submesh, share: float) -> Submesh:
    """A flat part as a thin solid: a second layer lies below the first one, ``share`` of the largest extent away."""
    axes, lengths = _principal(part)
    below = part.points - axes[:, 0] * share * lengths.max()
    faces = np.concatenate([part.faces, part.faces[:, ::-1] + len(part.points)])
    uv = None if part.uv is None else np.concatenate([part.uv, part.uv])
    corners = None
    if part.uv is not None and part.corners is not None:
        corners = np.concatenate([part.corners, part.corners[:, ::-1] + len(part.uv)])
    return Submesh(np.concatenate([part.points, below]), faces, uv, part.appearance, corners)


def turned_triangles(part: Submesh) -> int:
    """How many triangles have normals of their corners that point to the other side than the order of the corners does."""
    if part.normals is None:
        return 0
    rows = part.faces if part.normal_corners is None else part.normal_corners
    if rows.shape != part.faces.shape or (rows.size and not (rows.min() >= 0 and rows.max() < len(part.normals))):
        return 0
    given = sum(part.normals.take(rows[:, corner], axis=0) for corner in range(3))
    with np.errstate(invalid="ignore", over="ignore"):
        return int((np.einsum("ij,ij->i", face_normals(part.points.astype(np.float64), part.faces.ravel()), given) < 0.0).sum())
