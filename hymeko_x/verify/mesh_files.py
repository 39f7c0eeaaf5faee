"""OBJ and binary STL files as triangles: positions and faces alone, which is all that the verifier compares.

A third of the time of trimesh, which also reads materials, normals and places in images, and takes half a second to be imported: together
more than half of a verification with sixty such files. Files with rarer features are left to trimesh.
"""

from __future__ import annotations

import re
from collections import defaultdict
from typing import TYPE_CHECKING, Any

import numpy as np

from hymeko_x.verify.model import Surface

if TYPE_CHECKING:
    from hymeko_x.verify.model import Array, Index

_OTHER_INDICES = re.compile(rb"/[-\d/]*")
_IN_NUMBERS = b"0123456789+-.eE \t\r\n"
_POINT, _FACE = b"v ", b"f "
_BEGINNINGS = frozenset((_POINT, _FACE, b"vn", b"vt", b"o ", b"g ", b"s ", b"us", b"mt", b"l ", b"# ", b"##", b"#\r", b"#", b"\r", b""))
"""The first two letters of the lines that nearly all files have."""

_STL_HEAD = 84
_STL_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_stl(data: bytes) -> Surface | None:
    """The triangles of a binary file; None where its length is not that of the number of triangles in its head."""
    count = int.from_bytes(data[_STL_HEAD - 4 : _STL_HEAD], "little")
    if not count or len(data) != _STL_HEAD + count * _STL_FACET.itemsize:
        return None
    corners = np.frombuffer(data, _STL_FACET, count, _STL_HEAD)["corners"].reshape(-1, 3).astype(np.float64)
    return Surface(corners, np.arange(3 * count).reshape(-1, 3)) if np.isfinite(corners).all() else None


def read_obj(data: bytes) -> Surface | None:
    """The triangles of a file; larger faces as fans. None where it has rare or continued lines, relative indices or broken ones."""
    lines: dict[bytes, list[bytes]] = defaultdict(list)
    for line in data.split(b"\n"):
        lines[line[:2]].append(line)
    if b"\\" in data or not lines.keys() <= _BEGINNINGS:
        return None
    points = _points(lines[_POINT])
    triangles, polygons = _triangles(lines[_FACE])
    if points is None or triangles is None or not len(triangles) or triangles.min() < 1 or triangles.max() > len(points):
        return None
    return Surface(points, triangles - 1, polygons)


def _points(lines: list[bytes]) -> Array | None:
    """The first three numbers of each line; None where lines have different lengths or too few numbers."""
    numbers = _numbers(b"\n".join(lines).replace(_POINT, b""), np.float64)
    width = 0 if numbers is None else len(numbers) // len(lines)
    if numbers is None or width < 3 or len(numbers) != width * len(lines) or not np.isfinite(numbers).all():
        return None
    return np.ascontiguousarray(numbers.reshape(-1, width)[:, :3])


def _triangles(lines: list[bytes]) -> tuple[Index | None, bool]:
    """The corners (n, 3) of faces, counted from 1, and whether there are faces with more than three; None for broken ones."""
    text = b"\n".join(lines).replace(_FACE, b"")
    numbers = _numbers(_OTHER_INDICES.sub(b"", text) if b"/" in text else text, np.intp)
    if numbers is None or len(numbers) == 3 * len(lines):
        return (None if numbers is None else numbers.reshape(-1, 3)), False
    ends = np.cumsum([len(line.split()) - 1 for line in lines])
    if ends[-1] != len(numbers):
        return None, True
    faces = np.split(numbers, ends[:-1])
    return np.array([(face[0], face[i], face[i + 1]) for face in faces for i in range(1, len(face) - 1)], dtype=np.intp), True


def _numbers(text: bytes, kind: type[np.float64] | type[np.intp]) -> Any:
    """All numbers of a text; None where there are none, or something else as well."""
    if not text.strip() or text.translate(None, _IN_NUMBERS):
        return None
    return np.fromstring(text, dtype=kind, sep=" ")
