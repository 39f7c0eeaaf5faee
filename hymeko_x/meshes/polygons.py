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

Point = tuple[np.float32, np.float32]


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
    for number in np.flatnonzero((sizes > _QUADRILATERAL) & (sizes <= MOST_CORNERS)).tolist():
        start, size = int(starts[number]), int(sizes[number])
        ears = _ears(points[corners[start : start + size]])
        tables.append(np.array(ears, dtype=np.intp).reshape(-1, 3) + start)
        owners.append(np.full(len(ears), number))
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


def _ears(points: NDArray[np.float32]) -> list[tuple[int, int, int]]:
    """The triangles of a polygon with more than four corners, by the numbers of its corners; of a tangled one not all."""
    flat = points[:, _axes(points)]
    left = list(range(len(flat)))
    found: list[tuple[int, int, int]] = []
    at, tries, before = 0, len(left), len(left)
    while len(left) > _TRIANGLE and tries > 0:
        count = len(left)
        at = at - count if at >= count else at
        tries, before = (count, count) if before != count else (tries - 1, before)
        ear = [left[(at + step) % count] for step in range(3)]
        others = (left[(at + step) % count] for step in range(3, count))
        if _is_reflex(flat[ear]) or any(_is_within(flat[ear], flat[other]) for other in others):
            at += 1
            continue
        found.append((ear[0], ear[1], ear[2]))
        del left[(at + 1) % count]
    if len(left) == _TRIANGLE:
        found.append((left[0], left[1], left[2]))
    return found


def _axes(points: NDArray[np.float32]) -> tuple[int, int]:
    """The two axes onto which a polygon is laid: across the largest component of its normal at the first corner that is one."""
    after, last = np.roll(points, -1, axis=0), np.roll(points, -2, axis=0)
    a, b = after - points, last - after
    normals = np.abs(
        np.stack(
            [
                a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1],
                a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2],
                a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0],
            ],
            axis=1,
        )
    )
    bent = np.flatnonzero((normals > _LEAST_CORNER).any(axis=1))
    if not len(bent):
        return 1, 2
    x, y, z = normals[bent[0]]
    if x > y and x > z:
        return 1, 2
    return (0, 1) if z > x and z > y else (0, 2)


def _is_reflex(ear: NDArray[np.float32]) -> bool:
    """Whether the turn at the second of three points is against that of the first two about the origin."""
    (ax, ay), (bx, by), (cx, cy) = ear
    turn = (bx - ax) * (cy - by) - (by - ay) * (cx - bx)
    area = (ax * by - ay * bx) * np.float32(0.5)
    return bool(turn * area < 0.0)


def _is_within(ear: NDArray[np.float32], point: NDArray[np.float32]) -> bool:
    """Whether a ray from the point crosses the sides of a triangle an odd number of times."""
    x, y = point
    inside = False
    for (ax, ay), (bx, by) in zip(ear, (ear[2], ear[0], ear[1]), strict=True):
        if (ay > y) != (by > y) and x < (bx - ax) * (y - ay) / (by - ay) + ax:
            inside = not inside
    return inside
