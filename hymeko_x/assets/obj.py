"""The triangles of plain Wavefront OBJ files, straight into arrays; what is not plain is left to the loader that knows all of OBJ."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hymeko_x.assets.numerals import numbers_in
from hymeko_x.assets.polygons import fans

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hymeko_x.assets.part import Part

_GOES_ON = (b"\\\n", b"\\\r")
"""The end of a line that goes on in the next one."""
_WIDTHS = (3, 6)
"""A point, or a point with a colour."""
_END, _TAB, _BLANK, _STROKE, _POINT, _FACE = b"\n\t /vf"


def obj_table(data: bytes) -> tuple[NDArray[np.float64], NDArray[np.int64]] | None:
    """The points (n, 3) of an OBJ file and its triangles (m, 3) as rows of them; polygons as fans. None where it is not plain.

    Of the corners of a polygon only their points count; normals and texture coordinates are not even turned into numbers.
    Source: B1. Object Files (.obj), Advanced Visualizer Manual.
    """
    text = np.frombuffer(b"\n".join([*(data.splitlines() if b"\r" in data else [data]), b""]), dtype=np.uint8)
    starts = np.concatenate(([0], np.flatnonzero(text == _END) + 1))
    first, second = text[starts[:-1]], text.take(starts[:-1] + 1, mode="clip")
    is_point, is_face = first == _POINT, first == _FACE
    is_odd = (first == _BLANK) | (first == _TAB) | ((is_point | is_face) & (second == _TAB))
    if is_odd.any() or (b"\\" in data and any(end in data for end in _GOES_ON)):
        return None
    try:
        points = _points(*_lines(text, starts, is_point & (second == _BLANK)))
        faces = _faces(*_lines(text, starts, is_face & (second == _BLANK)))
    except (ValueError, OverflowError):  # what is not a number, and numbers that are too large
        return None
    if points is None or faces is None or (faces.size and (faces.min() < 0 or faces.max() >= len(points))):
        return None
    return points, faces


def _lines(text: NDArray[np.uint8], starts: NDArray[np.intp], is_wanted: NDArray[np.bool_]) -> tuple[NDArray[np.uint8], NDArray[np.intp]]:
    """Some lines of a text, each with a blank for its first letter, and where each of them begins; at last, where they end."""
    lengths = np.diff(starts)
    turns = np.flatnonzero(np.diff(is_wanted, prepend=False, append=False))
    runs = [text[:0], *(text[first:last] for first, last in starts[turns].reshape(-1, 2).tolist())]
    wanted = np.concatenate(runs)
    begins = np.concatenate(([0], np.cumsum(lengths[is_wanted])))
    wanted[begins[:-1]] = _BLANK
    return wanted, begins


def _points(text: NDArray[np.uint8], starts: NDArray[np.intp]) -> NDArray[np.float64] | None:
    widths = np.diff(np.searchsorted(_words(text), starts))
    if not len(widths) or widths[0] not in _WIDTHS or (widths != widths[0]).any():
        return None
    return numbers_in(text.tobytes()).reshape(len(widths), int(widths[0]))[:, :3]


def _faces(text: NDArray[np.uint8], starts: NDArray[np.intp]) -> NDArray[np.int64] | None:
    """Rows of points, from 0; what counts from the end of the file so far comes out below 0. None where corners differ in form."""
    words, strokes = _words(text), np.flatnonzero(text == _STROKE)
    points = text if not len(strokes) else _before_strokes(text, words, strokes)
    return None if points is None else fans(np.diff(np.searchsorted(words, starts)), numbers_in(points.tobytes(), np.int64) - 1)


def _before_strokes(text: NDArray[np.uint8], words: NDArray[np.intp], strokes: NDArray[np.intp]) -> NDArray[np.uint8] | None:
    """A text with blanks for what stands behind the first stroke of each word; None where not all have equally many strokes."""
    if not len(words) or len(strokes) % len(words):
        return None
    strokes = strokes.reshape(len(words), -1)
    blanks = np.flatnonzero(text <= _BLANK)
    ends = blanks[np.searchsorted(blanks, words)]
    if (strokes[:, 0] < words).any() or (strokes[:, -1] >= ends).any():
        return None
    is_behind = np.zeros(len(text), dtype=np.int8)
    is_behind[strokes[:, 0]], is_behind[ends] = 1, -1
    np.cumsum(is_behind, dtype=np.int8, out=is_behind)
    return np.where(is_behind, np.uint8(_BLANK), text)


def _words(text: NDArray[np.uint8]) -> NDArray[np.intp]:
    """Where the words of a text begin that itself begins with a blank."""
    is_blank = text <= _BLANK
    return np.flatnonzero(is_blank[:-1] > is_blank[1:]) + 1


def obj_bytes(part: Part) -> bytes:
    """The part as a Wavefront OBJ file: points to float32 precision, texture coordinates, triangles."""
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in (part.points + 0.0).tolist()]
    if part.uv is not None:
        lines += [f"vt {u:.9g} {v:.9g}" for u, v in (part.uv + 0.0).tolist()]
        corners = part.faces if part.corners is None else part.corners
        lines += [f"f {a}/{u} {b}/{v} {c}/{w}" for a, b, c, u, v, w in (np.hstack([part.faces, corners]) + 1).tolist()]
    else:
        lines += [f"f {a} {b} {c}" for a, b, c in (part.faces + 1).tolist()]
    return ("\n".join(lines) + "\n").encode()
