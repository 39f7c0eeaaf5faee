"""OBJ and binary STL files as triangles: positions and faces alone, which is all that the verifier compares.

A third of the time of trimesh, which also reads materials, normals and places in images, and takes half a second to be imported: together
more than half of a verification with sixty such files. Files with rarer features are left to trimesh.
"""

from __future__ import annotations

import re
from collections import defaultdict
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec import DecodeError, json

from hymeko_x.verify.model import Surface

if TYPE_CHECKING:
    from hymeko_x.verify.model import Array, Index

_OTHER_INDICES = re.compile(rb"/[-\d/]*")
_IN_NUMBERS = b"0123456789+-.eE \t\r\n"
_POINT, _FACE = b"v ", b"f "
_WANTED = (_POINT, _FACE)
_NEWLINE = ord("\n")
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
    lines = None if b"\\" in data else _lines_of(data)
    if lines is None:
        return None
    points = _points(lines.get(_POINT, b""))
    triangles, polygons = _triangles(lines.get(_FACE, b""))
    if points is None or triangles is None or not len(triangles) or triangles.min() < 1 or triangles.max() > len(points):
        return None
    return Surface(points, triangles - 1, polygons)


def _lines_of(data: bytes) -> dict[bytes, bytes] | None:
    """The lines of points, and those of faces, as one text each; None where there are lines of rare kinds.

    Nearly all lines stand in few runs of one kind: runs are found and copied, not lines, which is three times as fast.
    """
    text = np.frombuffer(data + b"\n\n", np.uint8)
    starts = np.concatenate(([0], np.flatnonzero(text[: len(data)] == _NEWLINE) + 1))
    kinds = text[starts] * np.uint16(256) + text[starts + 1]
    firsts = np.concatenate(([0], np.flatnonzero(np.diff(kinds)) + 1))
    found: dict[bytes, list[bytes]] = defaultdict(list)
    begins = starts[firsts].tolist()
    for begin, end in pairwise([*begins, len(data)]):
        kind = data[begin : begin + 2].partition(b"\n")[0]
        if kind in _WANTED:
            found[kind].append(data[begin:end])
        elif kind not in _BEGINNINGS:
            return None
    return {kind: b"".join(runs) for kind, runs in found.items()}


def _points(text: bytes) -> Array | None:
    """The first three numbers of each line; None where lines have different lengths or too few numbers."""
    count = text.rstrip(b"\n").count(b"\n") + 1
    numbers = _separated(text)
    width = 0 if numbers is None else len(numbers) // count
    if numbers is None or width < 3 or len(numbers) != width * count or not np.isfinite(numbers).all():
        return None
    return np.ascontiguousarray(numbers.reshape(-1, width)[:, :3])


def _separated(text: bytes) -> Any:
    """The numbers of points; None as :func:`_numbers`. Where one blank separates them they are read as JSON, in half the time of numpy."""
    try:
        listed = text.rstrip(b"\n").removeprefix(_POINT).replace(b"\n" + _POINT, b",").replace(b" ", b",")
        return np.array(json.decode(b"[%b]" % listed, type=list[float]))
    except DecodeError:
        return _numbers(text.replace(_POINT, b""), np.float64)


def _triangles(text: bytes) -> tuple[Index | None, bool]:
    """The corners (n, 3) of faces, counted from 1, and whether there are faces with more than three; None for broken ones."""
    lines = text.rstrip(b"\n").split(b"\n")
    text = text.replace(_FACE, b"")
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
