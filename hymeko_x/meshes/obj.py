"""What plain Wavefront OBJ files show, straight into arrays; what is not plain is left to the loader that knows all of OBJ.

Of the corners of a polygon only their points count, and where a material has an image also their places in it; all other numbers
are not even read.
"""

from __future__ import annotations

import re
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from hymeko_x.meshes.mtl import finishes_of
from hymeko_x.meshes.numerals import numbers_in, whole_numbers_at, words_in
from hymeko_x.meshes.part import Finish, Table
from hymeko_x.meshes.polygons import fans, used_rows

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from hymeko_x.meshes.part import Part

_GOES_ON = (b"\\\n", b"\\\r")
"""The end of a line that goes on in the next one."""
_WIDTHS = (3, 6)
"""A point, or a point with a colour."""
_UV_WIDTHS = (2, 3)
"""Two coordinates in an image, or three, of which the last one is for solid textures."""
_DIGITS = re.compile(rb"\d+")
_END, _TAB, _BLANK, _STROKE = b"\n\t /"
_POINT, _FACE, _PLACE, _USE, _LIBRARY = b"vftum"


class _Some(NamedTuple):
    """Some lines, each with blanks for its first two letters: where they begin, and at last where they end; their numbers in the file."""

    text: NDArray[np.uint8]
    starts: NDArray[np.intp]
    numbers: NDArray[np.intp]


class _Lines(NamedTuple):
    """A text of which every line has an end: where its lines begin, and at last where they end; their first and second letters."""

    text: NDArray[np.uint8]
    starts: NDArray[np.intp]
    first: NDArray[np.uint8]
    second: NDArray[np.uint8]


def obj_tables(data: bytes, fetch: Callable[[str], bytes | None] | None = None, *, mapped: bool = False) -> list[Table] | None:
    """The triangles of an OBJ file by material, each with what its libraries say of it. None where the file is not plain.

    ``fetch`` returns a library by the name that the file has for it; without one, or where none says anything, all is one table.
    Texture coordinates are there where the material has an image, or where ``mapped`` asks for all of them.
    Source: B1. Object Files (.obj), Advanced Visualizer Manual.
    """
    lines = _lines_of(data)
    if lines is None:
        return None
    used = _said(lines, _USE, b"usemtl")
    finishes = _finishes(lines, fetch) if used and fetch is not None else {}
    is_imaged = mapped or any(finish.image for finish in finishes.values())
    try:
        points = _rows(lines, _BLANK, _WIDTHS)
        uv = _rows(lines, _PLACE, _UV_WIDTHS) if is_imaged else None
        if points is None:
            return None
        pieces = _pieces(lines, used if finishes else [])
        tables = [_table(piece, name, finishes.get(name, Finish()), points, uv, mapped=mapped) for name, piece in pieces]
    except (ValueError, OverflowError):  # what is not a number, and numbers that are too large
        return None
    plain = [table for table in tables if table is not None]
    return plain if len(plain) == len(tables) else None


def _finishes(lines: _Lines, fetch: Callable[[str], bytes | None]) -> dict[str, Finish]:
    """What all libraries of the file say; of a material that several have, the last one."""
    found: dict[str, Finish] = {}
    for library in dict.fromkeys(name for _, name in _said(lines, _LIBRARY, b"mtllib")):
        found |= finishes_of(fetch(library) or b"")
    return found


def _table(
    lines: _Some, name: str, finish: Finish, points: NDArray[np.float64], uv: NDArray[np.float64] | None, *, mapped: bool
) -> Table | None:
    """What one material is used for; an image that nothing says the place of is not shown."""
    corners = _Corners.of(lines.text, lines.starts)
    if corners is None:
        return None
    faces = fans(corners.sizes, corners.field(0))
    if not _are_rows(faces, points):
        return None
    order = np.repeat(lines.numbers, np.maximum(corners.sizes - 2, 0))
    table = Table(*used_rows(points, faces), name, finish._replace(image=""), order=order)
    if not (finish.image or mapped) or uv is None or not corners.have_places:
        return table
    places = fans(corners.sizes, corners.field(1))
    if not _are_rows(places, uv):
        return table
    own, places = used_rows(uv, places)
    return table._replace(finish=finish, uv=own, corners=places)


def _are_rows(faces: NDArray[Any], table: NDArray[Any]) -> bool:
    return not faces.size or bool(faces.min() >= 0 and faces.max() < len(table))


# ---- lines -------------------------------------------------------------------------------------------------------------------


def _lines_of(data: bytes) -> _Lines | None:
    """The lines of a file; None where some go on in the next one, or do not begin as nearly all do."""
    if b"\\" in data and any(end in data for end in _GOES_ON):
        return None
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    text = np.frombuffer(data + b"\n", dtype=np.uint8)
    starts = np.concatenate(([0], np.flatnonzero(text == _END) + 1))
    first, second = text[starts[:-1]], text.take(starts[:-1] + 1, mode="clip")
    is_odd = (first == _BLANK) | (first == _TAB) | (((first == _POINT) | (first == _FACE)) & (second == _TAB))
    return None if is_odd.any() else _Lines(text, starts, first, second)


def _said(lines: _Lines, letter: int, word: bytes) -> list[tuple[int, str]]:
    """What stands behind a word with this first letter at the begin of a line, and the number of that line."""
    found = []
    for number in np.flatnonzero(lines.first == letter).tolist():
        line = lines.text[lines.starts[number] : lines.starts[number + 1]].tobytes()
        if line.startswith(word):
            found.append((number, line.removeprefix(word).strip().decode("utf-8", "replace")))
    return found


def _pieces(lines: _Lines, used: list[tuple[int, str]]) -> Iterator[tuple[str, _Some]]:
    """The polygons by material, those before the first one under no name, and by the form of the first corner of each use."""
    faces = np.flatnonzero((lines.first == _FACE) & (lines.second == _BLANK))
    if not len(faces):
        return
    names, owners = _owners(lines, faces, used)
    cuts = np.concatenate(([0], np.flatnonzero((np.diff(faces) > 1) | (np.diff(owners) != 0)) + 1, [len(faces)]))
    order = np.argsort(owners[cuts[:-1]], kind="stable")
    text, starts = _gathered(lines, faces[cuts[:-1]][order], faces[cuts[1:] - 1][order] + 1)
    numbers = faces[np.argsort(owners, kind="stable")]
    for name, (begin, end) in zip(names, pairwise([0, *np.cumsum(np.bincount(owners)).tolist()]), strict=True):
        own = starts[begin : end + 1]
        yield name, _Some(text[own[0] : own[-1]], own - own[0], numbers[begin:end])


def _owners(lines: _Lines, faces: NDArray[np.intp], used: list[tuple[int, str]]) -> tuple[list[str], NDArray[np.intp]]:
    """The material of each piece, in the order of their first polygons, and the piece of every polygon."""
    names, begins = ["", *(name for _, name in used)], np.searchsorted(faces, [0, *(number for number, _ in used)])
    counts, piece_of = np.diff(begins, append=len(faces)), np.zeros(len(names), dtype=np.intp)
    pieces: dict[tuple[str, bytes], int] = {}
    for use in np.flatnonzero(counts).tolist():
        piece_of[use] = pieces.setdefault((names[use], _form(lines, faces[begins[use]])), len(pieces))
    return [name for name, _ in pieces], np.repeat(piece_of, counts)


def _form(lines: _Lines, number: int) -> bytes:
    """How the first corner of a polygon is written: ``0//0`` for ``12//7``."""
    words = lines.text[lines.starts[number] : lines.starts[number + 1]].tobytes().split(None, 2)
    return b"".join(_DIGITS.sub(b"0", word) for word in words[1:2])


def _gathered(lines: _Lines, begins: NDArray[np.intp], ends: NDArray[np.intp]) -> tuple[NDArray[np.uint8], NDArray[np.intp]]:
    """Runs of lines, each line with blanks for its first two letters, and where each of them begins; at last, where they end."""
    runs = [*zip(begins.tolist(), ends.tolist(), strict=True)]
    texts = zip(lines.starts[begins].tolist(), lines.starts[ends].tolist(), strict=True)
    text = np.concatenate([lines.text[:0], *(lines.text[first:last] for first, last in texts)])
    lengths = np.diff(lines.starts)
    starts = np.cumsum(np.concatenate([[0], *(lengths[first:last] for first, last in runs)]))
    text[starts[:-1]] = text[starts[:-1] + 1] = _BLANK
    return text, starts


def _rows(lines: _Lines, second: int, widths: tuple[int, int]) -> NDArray[np.float64] | None:
    """As many numbers as the lesser width of each line of this kind of point; None where lines have other widths, or several."""
    is_wanted = (lines.first == _POINT) & (lines.second == second)
    text, starts = _gathered(lines, *np.flatnonzero(np.diff(is_wanted, prepend=False, append=False)).reshape(-1, 2).T)
    said = np.diff(np.searchsorted(words_in(text)[0], starts))
    if not len(said) or said[0] not in widths or (said != said[0]).any():
        return None
    return numbers_in(text.tobytes()).reshape(len(said), int(said[0]))[:, : widths[0]]


# ---- corners -----------------------------------------------------------------------------------------------------------------


class _Corners(NamedTuple):
    """The corners of polygons, words such as ``1/2/3``: how many each polygon has, where they begin and end, and their strokes."""

    text: NDArray[np.uint8]
    sizes: NDArray[np.intp]
    words: NDArray[np.intp]
    ends: NDArray[np.intp]
    strokes: NDArray[np.intp]

    @classmethod
    def of(cls, text: NDArray[np.uint8], starts: NDArray[np.intp]) -> _Corners | None:
        """None where not all have equally many strokes."""
        (words, ends), found = words_in(text), np.flatnonzero(text == _STROKE)
        if not len(words) or len(found) % len(words):
            return None
        strokes = found.reshape(len(words), -1)
        if strokes.size and ((strokes[:, 0] < words).any() or (strokes[:, -1] >= ends).any()):
            return None
        return cls(text, np.diff(np.searchsorted(words, starts)), words, ends, strokes)

    @property
    def have_places(self) -> bool:
        """Whether every corner says a place in an image."""
        return bool(self.strokes.size) and not (self._end(1) == self.strokes[:, 0] + 1).any()

    def _end(self, number: int) -> NDArray[np.intp]:
        return self.strokes[:, number] if number < self.strokes.shape[1] else self.ends

    def field(self, number: int) -> NDArray[np.int64]:
        """One number of each corner, from 0; what counts from the end of the file is not read.

        Raises: ValueError where there is anything else.
        """
        begins = self.words if number == 0 else self.strokes[:, number - 1] + 1
        return whole_numbers_at(self.text, begins, self._end(number)) - 1


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
