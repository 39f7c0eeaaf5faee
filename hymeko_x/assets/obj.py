"""The triangles of plain Wavefront OBJ files, straight into arrays; what is not plain is left to the loader that knows all of OBJ."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hymeko_x.assets.numerals import numbers_in
from hymeko_x.assets.polygons import fans

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hymeko_x.assets.part import Part

_ODD = (b"\\\n", b"\\\r\n", b"\n ", b"\n\t", b"\nv\t", b"\nf\t")
"""Lines that go on in the next one, and lines that do not begin as nearly all do."""
_WIDTHS = (3, 6)
"""A point, or a point with a colour."""


def obj_table(data: bytes) -> tuple[NDArray[np.float64], NDArray[np.int64]] | None:
    """The points (n, 3) of an OBJ file and its triangles (m, 3) as rows of them; polygons as fans. None where it is not plain.

    Source: B1. Object Files (.obj), Advanced Visualizer Manual.
    """
    if any(odd in data for odd in _ODD):
        return None
    lines = data.splitlines()
    try:
        points = _points([line[2:] for line in lines if line[:2] == b"v "])
        faces = _faces([line[2:] for line in lines if line[:2] == b"f "])
    except (ValueError, OverflowError):  # what is not a number, and numbers that are too large
        return None
    if points is None or faces is None or (faces.size and (faces.min() < 0 or faces.max() >= len(points))):
        return None
    return points, faces


def _points(lines: list[bytes]) -> NDArray[np.float64] | None:
    widths = set(map(len, map(bytes.split, lines)))
    if len(widths) != 1 or not widths <= set(_WIDTHS):
        return None
    return numbers_in(b" ".join(lines)).reshape(len(lines), -1)[:, :3]


def _faces(lines: list[bytes]) -> NDArray[np.int64] | None:
    """Rows of points, from 0; what counts from the end of the file so far comes out below 0. None where corners differ in form."""
    sizes = np.fromiter(map(len, map(bytes.split, lines)), np.int64, len(lines))
    strokes = np.fromiter((line.count(b"/") for line in lines), np.int64, len(lines))
    width = int(strokes[0] // sizes[0]) + 1 if len(lines) and sizes[0] else 1
    if not np.array_equal(strokes, sizes * (width - 1)):
        return None
    text = b" ".join(lines).replace(b"//", b" 0 ").replace(b"/", b" ")
    return fans(sizes, numbers_in(text, np.int64).reshape(-1, width)[:, 0] - 1)


def obj_bytes(part: Part) -> bytes:
    """The part as a Wavefront OBJ file: points to float32 precision, texture coordinates, triangles."""
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in (part.points + 0.0).tolist()]
    if part.uv is not None:
        lines += [f"vt {u:.7g} {v:.7g}" for u, v in (part.uv + 0.0).tolist()]
        lines += [f"f {a}/{a} {b}/{b} {c}/{c}" for a, b, c in (part.faces + 1).tolist()]
    else:
        lines += [f"f {a} {b} {c}" for a, b, c in (part.faces + 1).tolist()]
    return ("\n".join(lines) + "\n").encode()
