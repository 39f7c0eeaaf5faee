"""Polygons as triangles, as the OBJ reader in MuJoCo cuts them: quadrilaterals along the shorter diagonal, larger ones ear by ear.

All is computed in single precision and in the same order as there, since the choice between equal diagonals is one of rounding.
Source: tinyobjloader 2, exportGroupsToShape (the built-in ear clipping); MuJoCo's mesh_face proves it in the tests.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

MOST_CORNERS = 100
"""MuJoCo leaves polygons with more corners out."""
_LARGE = re.compile(rb"^[ \t]*f(?:[ \t]+[^\s]+){%d}" % (MOST_CORNERS + 1), re.MULTILINE)
_TRIANGLE, _QUADRILATERAL = 3, 4
_LEAST_CORNER = np.finfo(np.float32).eps


def leaves_polygons_out(data: bytes) -> bool:
    """Whether an OBJ file has polygons that MuJoCo leaves out."""
    return _LARGE.search(data) is not None


def cut(points: NDArray[np.float32], sizes: NDArray[Any], corners: NDArray[Any]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The triangles of polygons: places in ``corners`` (n, 3), and for each triangle the number of its polygon.

    ``points`` is (m, 3), ``sizes`` the number of corners of each polygon, ``corners`` the rows of ``points`` of all. Polygons of fewer
    than three corners have none, nor have those of more than 100, as in MuJoCo.
    """
    starts = np.cumsum(sizes) - sizes
    tables, owners = [], []
    for found, cutter in ((sizes == _TRIANGLE, _triangles), (sizes == _QUADRILATERAL, _quadrilaterals)):
        numbers = np.flatnonzero(found)
        places = cutter(points, starts[numbers], corners)
        tables.append(places)
        owners.append(np.repeat(numbers, len(places) // max(len(numbers), 1)))
    large = np.flatnonzero((sizes > _QUADRILATERAL) & (sizes <= MOST_CORNERS))
    widths = 2 ** np.ceil(np.log2(sizes[large])).astype(np.intp)  # polygons of about one size are cut together
    for width in np.unique(widths).tolist():
        numbers = large[widths == width]
        around = np.arange(width) % sizes[numbers, None]
        ears, whose = _ears(points[corners[starts[numbers, None] + around]], sizes[numbers])
        tables.append(ears + starts[numbers[whose], None])
        owners.append(numbers[whose])
    places, owner = np.concatenate(tables), np.concatenate(owners)
    order = np.argsort(owner, kind="stable")
    return places[order], owner[order]


def _triangles(points: NDArray[np.float32], starts: NDArray[np.intp], corners: NDArray[Any]) -> NDArray[np.intp]:
    return np.asarray(starts[:, None] + np.arange(3))


def _quadrilaterals(points: NDArray[np.float32], starts: NDArray[np.intp], corners: NDArray[Any]) -> NDArray[np.intp]:
    """Two triangles for each; where both diagonals are as long, along that from the second corner."""
    a, b, c, d = (points[corners[starts + place]] for place in range(4))
    first, second = c - a, d - b
    lengths = [line[:, 0] * line[:, 0] + line[:, 1] * line[:, 1] + line[:, 2] * line[:, 2] for line in (first, second)]
    along_first = (lengths[0] < lengths[1])[:, None, None]
    places = np.where(along_first, np.array([[0, 1, 2], [0, 2, 3]]), np.array([[0, 1, 3], [1, 2, 3]]))
    return np.asarray((starts[:, None, None] + places).reshape(-1, 3))


# ---- ears ------------------------------------------------------------------------------------------------------------------------


def _ears(points: NDArray[np.float32], sizes: NDArray[Any]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The triangles of polygons with more than four corners, by the numbers of these, and whose they are; of tangled ones not all.

    ``points`` (m, n, 3) are the corners of each polygon, of which there are ``sizes`` (m,); behind them they come again. All polygons are
    cut in step: each step looks at one corner of each, and cuts it off where it is an ear.
    """
    flat = np.take_along_axis(points, _axes(points, sizes)[:, None, :], axis=2)
    rows = np.arange(len(flat))
    left = np.tile(np.arange(flat.shape[1]), (len(flat), 1))
    count = np.array(sizes, dtype=np.intp)
    at, tries, before = np.zeros_like(count), count.copy(), count.copy()
    found: list[NDArray[np.intp]] = []
    owners: list[NDArray[np.intp]] = []
    while len(rows := rows[(count[rows] > _TRIANGLE) & (tries[rows] > 0)]):
        counts = count[rows]
        at[rows] -= np.where(at[rows] >= counts, counts, 0)
        tries[rows] = np.where(before[rows] != counts, counts, tries[rows] - 1)
        before[rows] = counts
        places = (at[rows, None] + np.arange(counts.max())) % counts[:, None]
        around = left[rows[:, None], places]  # the three corners in question, and behind them the others
        corners = flat[rows[:, None], around]
        is_other = np.arange(_TRIANGLE, counts.max()) < counts[:, None]
        is_ear = ~(_are_reflex(corners[:, :3]) | (_are_within(corners[:, :3], corners[:, 3:]) & is_other).any(axis=1))
        cut_off = rows[is_ear]
        found.append(around[is_ear, :3])
        owners.append(cut_off)
        kept = np.arange(left.shape[1] - 1)
        left[cut_off, :-1] = left[cut_off[:, None], kept + (kept >= places[is_ear, 1:2])]
        count[cut_off] -= 1
        at[rows[~is_ear]] += 1
    done = np.flatnonzero(count == _TRIANGLE)
    return np.concatenate([*found, left[done, :3]]), np.concatenate([*owners, done])


def _axes(points: NDArray[np.float32], sizes: NDArray[Any]) -> NDArray[np.intp]:
    """The two axes (m, 2) onto which polygons are laid: across the largest component of the normal at the first corner that is one."""
    places = np.arange(points.shape[1])
    after, last = (np.take_along_axis(points, ((places + step) % sizes[:, None])[..., None], axis=1) for step in (1, 2))
    a, b = after - points, last - after
    normals = np.abs(
        np.stack(
            [
                a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1],
                a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2],
                a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0],
            ],
            axis=2,
        )
    )
    is_bent = (normals > _LEAST_CORNER).any(axis=2)
    x, y, z = normals[np.arange(len(normals)), is_bent.argmax(axis=1)].T
    across_x = ((x > y) & (x > z)) | ~is_bent.any(axis=1)
    across_z = ~across_x & (z > x) & (z > y)
    return np.where(across_x[:, None], [1, 2], np.where(across_z[:, None], [0, 1], [0, 2]))


def _are_reflex(ears: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Whether the turn at the second of three points (m, 3, 2) is against that of the first two about the origin."""
    (ax, ay), (bx, by), (cx, cy) = (ears[:, corner].T for corner in range(3))
    turn = (bx - ax) * (cy - by) - (by - ay) * (cx - bx)
    area = (ax * by - ay * bx) * np.float32(0.5)
    return np.asarray(turn * area < 0.0)


def _are_within(ears: NDArray[np.float32], points: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Whether a ray from each point (m, k, 2) crosses the sides of its triangle (m, 3, 2) an odd number of times."""
    x, y = points[..., 0], points[..., 1]
    inside = np.zeros(x.shape, dtype=bool)
    with np.errstate(all="ignore"):  # of sides along the ray, which it does not cross
        for first, second in ((0, 2), (1, 0), (2, 1)):
            (ax, ay), (bx, by) = ears[:, first, :, None].swapaxes(0, 1), ears[:, second, :, None].swapaxes(0, 1)
            inside ^= ((ay > y) != (by > y)) & (x < (bx - ax) * (y - ay) / (by - ay) + ax)
    return inside
