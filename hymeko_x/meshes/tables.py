"""Mesh files as tables, as MuJoCo reads them: every point of the file in its order, and the triangles that it makes of the faces.

Source: MuJoCo 4.0, proven with its mjModel. Of an OBJ file only the first object or group with faces counts, and of a text that is not
understood MuJoCo refuses the file. Equal points of STL, which has no others, become one; those of OBJ and MSH stay as many as they are.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from hymeko_x.memory import remembered
from hymeko_x.meshes.numerals import numbers_in
from hymeko_x.meshes.obj import words_of
from hymeko_x.meshes.polygons import MOST_CORNERS, cut, leaves_polygons_out
from hymeko_x.meshes.stl import read_stl
from hymeko_x.meshes.submesh import MOST_FACES, Submesh, Unreadable, fans
from hymeko_x.meshes.weld import joined

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SOLID = 3
_MSH_HEADER = 16
_POLYGON = re.compile(rb"^[ \t]*f(?:[ \t]+[\d/-]+){4}", re.MULTILINE)
_OBJECT = re.compile(rb"^[ \t]*[og][ \t]", re.MULTILINE)
_FLAT = 1e-6
"""The part of an area that rounding to single precision may change."""


def read_mesh(data: bytes, suffix: str) -> Submesh | None:
    """The points and triangles that MuJoCo reads from a file, with texture coordinates from the lower left and with the normals that the
    file has; None for other types.

    Raises: Unreadable.
    """
    readers = {".obj": _read_obj, ".stl": _read_stl, ".msh": _read_msh}
    if suffix not in readers:
        return None
    return _checked(readers[suffix](data))


def _checked(part: Submesh) -> Submesh:
    """The same solid. Raises: Unreadable where it is none."""
    if not len(part.faces):
        raise Unreadable("it has no triangles")
    if len(part.faces) > MOST_FACES:
        raise Unreadable(f"it has {len(part.faces)} triangles, at most {MOST_FACES} are read")
    if part.faces.min() < 0 or part.faces.max() >= len(part.points):
        raise Unreadable("a triangle has a corner that does not exist")
    if not np.isfinite(part.points).all():
        raise Unreadable("a coordinate is not a finite number")
    return part


@remembered
def read_otherwise(data: bytes, suffix: str) -> tuple[Submesh, str] | None:
    """A file that other programs read as another solid, as MuJoCo reads it, and why; None where they see the same.

    Others take all objects of an OBJ file, and cut polygons that are bent or concave in ways of their own. Raises: Unreadable.
    """
    if suffix != ".obj" or not (_POLYGON.search(data) or len(_OBJECT.findall(data)) > 1):
        return None
    lines = _lines_of(data)
    solid, polygons = _solid_of(lines)
    part = _checked(solid)
    if lines.has_more:
        return part, "has several objects, of which MuJoCo reads the first"
    if leaves_polygons_out(data):
        return part, f"has polygons of more than {MOST_CORNERS} corners, which MuJoCo leaves out"
    if not _are_flat_and_convex(part.points, polygons):
        return part, "has polygons that are bent or concave; they are cut as MuJoCo cuts them"
    return None


def _are_flat_and_convex(points: NDArray[np.float64], polygons: _Polygons) -> bool:
    """Whether the areas of the triangles of each polygon add up to its own, cut as a fan from its first corner and as MuJoCo does."""
    sizes, corners, rows, owners = polygons
    fan = fans(sizes, np.arange(len(corners)))
    fan_owners = np.repeat(np.arange(len(sizes)), np.maximum(sizes - 2, 0))
    areas = [_areas(points, corners[table], whose, len(sizes)) for table, whose in ((rows, owners), (fan, fan_owners))]
    allowed = _FLAT * areas[1][1]
    return bool(all((np.abs(sums - whole) <= allowed).all() for whole, sums in areas))


def _areas(
    points: NDArray[np.float64], triangles: NDArray[Any], owners: NDArray[np.intp], count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Of each polygon twice the area that its outline spans, and the sum of twice the areas of its triangles."""
    a, b, c = (points[triangles[:, corner]] for corner in range(3))
    crossed = np.cross(b - a, c - a)
    whole = np.stack([np.bincount(owners, crossed[:, axis], count) for axis in range(3)], axis=1)
    return np.asarray(np.linalg.norm(whole, axis=1)), np.asarray(np.bincount(owners, np.linalg.norm(crossed, axis=1), count))


# ---- STL and MSH -------------------------------------------------------------------------------------------------------------------


def _read_stl(data: bytes) -> Submesh:
    """Points that are equal to the last bit, the sign of zero included, are one."""
    corners = np.ascontiguousarray(read_stl(data), dtype=np.float32).reshape(-1, 3)
    first, index = joined(corners.view(np.uint32).astype(np.float64))
    points = np.ascontiguousarray(first.astype(np.uint32)).view(np.float32)
    return Submesh(points.astype(np.float64), index.reshape(-1, 3))


def _read_msh(data: bytes) -> Submesh:
    """MuJoCo's own binary format; texture coordinates there count from the upper left."""
    if len(data) < _MSH_HEADER:
        raise Unreadable(f"it has {len(data)} bytes, and an MSH file has at least {_MSH_HEADER}")
    points, normals, uv, faces = np.frombuffer(data, "<i4", 4).tolist()
    lengths = (3 * points, 3 * normals, 2 * uv, 3 * faces)
    if min(lengths) < 0 or len(data) != _MSH_HEADER + 4 * sum(lengths):
        raise Unreadable("its length is another one than its header tells")
    ends = np.cumsum(lengths)
    table = np.frombuffer(data, "<f4", int(ends[2]), _MSH_HEADER).astype(np.float64)
    rows = np.frombuffer(data, "<i4", lengths[3], _MSH_HEADER + 4 * int(ends[2])).astype(np.int64).reshape(-1, 3)
    places = table[ends[1] : ends[2]].reshape(-1, 2) * (1.0, -1.0) + (0.0, 1.0) if uv == points else None
    turns = table[ends[0] : ends[1]].reshape(-1, 3) if normals == points else None
    return Submesh(table[: ends[0]].reshape(-1, 3), rows, places, normals=turns)


# ---- OBJ ---------------------------------------------------------------------------------------------------------------------------


class _Obj(NamedTuple):
    """The lines of a file by their first word, and the faces of its first object, each with the number of such lines before it."""

    points: list[bytes]
    places: list[bytes]
    normals: list[bytes]
    faces: list[tuple[bytes, int, int, int]]
    has_more: bool = False
    """Whether there are faces of other objects."""


class _Polygons(NamedTuple):
    """The faces of a file: the number of corners of each, the points of all corners, and the triangles that MuJoCo cuts them into.

    ``rows`` (n, 3) are places in ``corners``, ``owners`` (n,) the numbers of the polygons.
    """

    sizes: NDArray[np.intp]
    corners: NDArray[np.int64]
    rows: NDArray[np.intp]
    owners: NDArray[np.intp]


def _read_obj(data: bytes) -> Submesh:
    return _solid_of(_lines_of(data))[0]


def _solid_of(lines: _Obj) -> tuple[Submesh, _Polygons]:
    try:
        points = _table(lines.points, _SOLID)
        uv = _table(lines.places, 2)
        shading = _table(lines.normals, _SOLID)
        sizes, fields = _corners(lines)
    except (ValueError, IndexError) as error:
        raise Unreadable(f"a line is not understood ({error})") from error
    corners = fields[:, 0]
    if corners.size and (corners.min() < 0 or corners.max() >= len(points)):
        raise Unreadable("a face has a point that does not exist")
    if not len(sizes):
        raise Unreadable("it has no triangles")
    rows, owners = cut(points.astype(np.float32), sizes, corners)
    places, turns = _rows_of(uv, fields[:, 1], rows), _rows_of(shading, fields[:, 2], rows)
    shown, shaded = None if places is None else uv, None if turns is None else shading
    return Submesh(points, corners[rows], shown, None, places, shaded, turns), _Polygons(sizes, corners, rows, owners)


def _rows_of(table: NDArray[np.float64], column: NDArray[np.int64], rows: NDArray[np.intp]) -> NDArray[np.int64] | None:
    """The rows of a table for each triangle; None where a corner has none: then MuJoCo has none for the whole mesh."""
    is_whole = column.size and column.min() >= 0 and column.max() < len(table)
    return column[rows] if is_whole else None


def _lines_of(data: bytes) -> _Obj:
    found = _Obj([], [], [], [])
    is_first, has_more = True, False
    for line in data.replace(b"\r\n", b"\n").replace(b"\r", b"\n").split(b"\n"):
        word, _, rest = line.lstrip().replace(b"\t", b" ", 1).partition(b" ")
        if word == b"v":
            found.points.append(rest)
        elif word == b"vt":
            found.places.append(rest)
        elif word == b"vn":
            found.normals.append(rest)
        elif word == b"f" and len(rest.split(None, _SOLID)) >= _SOLID:
            has_more = has_more or not is_first
            if is_first:
                found.faces.append((rest, len(found.points), len(found.places), len(found.normals)))
        elif word in (b"o", b"g") and found.faces:
            is_first = False
    return found._replace(has_more=has_more)


def faces_of_first_object(data: bytes) -> list[bytes]:
    """The corners of each face that MuJoCo reads from an OBJ file, as written."""
    return [row for row, *_ in _lines_of(data).faces]


def _table(rows: list[bytes], width: int) -> NDArray[np.float64]:
    """The first numbers of each row in single precision; missing ones are zero."""
    counts = {len(row.split()) for row in rows[:1]}
    numbers = np.zeros((0, width))
    if counts:
        count = counts.pop()
        try:
            numbers = numbers_in(b" ".join(rows)).reshape(len(rows), count)[:, :width]
        except ValueError:
            numbers = np.array([[*map(float, row.split()[:width]), *(0.0,) * width][:width] for row in rows])
    if numbers.shape[1] < width:
        numbers = np.hstack([numbers, np.zeros((len(numbers), width - numbers.shape[1]))])
    with np.errstate(over="ignore"):
        return np.asarray(numbers.astype(np.float32).astype(np.float64))


def _corners(lines: _Obj) -> tuple[NDArray[np.intp], NDArray[np.int64]]:
    """The number of corners of each face, and for each corner the rows of its point, its place and its normal, -1 for none."""
    if not lines.faces:
        return np.zeros(0, dtype=np.intp), np.zeros((0, 3), dtype=np.int64)
    data = b"\n%b\n" % b"\n".join([row for row, *_ in lines.faces])
    text, starts, sizes = words_of(data)
    strokes = np.flatnonzero(text == ord("/"))
    counts = np.diff(np.searchsorted(strokes, np.append(starts, len(text))))
    if b"-" not in data and (counts == counts[:1]).all() and not (text[strokes + 1] <= ord(" ")).any():
        numbers = numbers_in(data.replace(b"//", b"/0/").replace(b"/", b" "), np.int64).reshape(len(starts), -1)[:, :3] - 1
        return sizes, np.hstack([numbers, np.full((len(numbers), 3 - numbers.shape[1]), -1)])
    found = []
    for row, *before in lines.faces:
        for corner in row.split():
            point, place, normal = [*corner.split(b"/"), b"", b""][:3]
            others = ((place, before[1]), (normal, before[2]))
            found.append((_index(point, before[0]), *(_index(word, at) if word else -1 for word, at in others)))
    return sizes, np.array(found, dtype=np.int64)


def _index(text: bytes, before: int) -> int:
    """A number from 1 on, or from -1 backwards, as one from 0 on."""
    number = int(text)
    if number == 0:
        raise ValueError("an index is zero")
    return number - 1 if number > 0 else before + number
