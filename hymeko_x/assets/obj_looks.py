"""What Wavefront OBJ files show in several materials, with the colours and images of their libraries.

Texture coordinates are turned into numbers only where a material of the file has an image.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from hymeko_x.assets.numerals import numbers_in
from hymeko_x.assets.part import Finish, Table
from hymeko_x.assets.polygons import fans

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

_ODD = (b"\\\n", b"\\\r\n", b"\n ", b"\n\t", b"\nv\t", b"\nf\t")
"""Lines that go on in the next one, and lines that do not begin as nearly all do."""
_WIDTHS = (3, 6)
"""A point, or a point with a colour."""
_UV_WIDTHS = (2, 3)
"""Two coordinates in an image, or three, of which the last one is for solid textures."""
_USE = re.compile(rb"^usemtl[ \t]*(.*?)[ \t\r]*$", re.MULTILINE)
_LIBRARY = re.compile(rb"^mtllib[ \t]+(.*?)[ \t\r]*$", re.MULTILINE)
_SOLID = 3


def obj_tables(data: bytes, finishes: Mapping[str, Finish], *, mapped: bool = False) -> list[Table] | None:
    """The triangles of an OBJ file by material, each with what its library says of it. None where the file is not plain.

    Texture coordinates are there where the material has an image, or where ``mapped`` asks for all of them.
    """
    if any(odd in data for odd in _ODD):
        return None
    first, *used = _USE.split(data)
    has_images = mapped or any(finish.image for finish in finishes.values())
    lines = data.splitlines()
    try:
        points, uv = _rows(lines, b"v ", _WIDTHS), _rows(lines, b"vt ", _UV_WIDTHS) if has_images else None
        pieces = [("", first), *((name.decode("utf-8", "replace"), text) for name, text in zip(used[::2], used[1::2], strict=True))]
        tables = (
            [] if points is None else [_table(text, name, finishes.get(name, Finish()), points, uv, mapped=mapped) for name, text in pieces]
        )
    except (ValueError, OverflowError):
        return None
    shown = [table for table in tables if table is not None]
    return shown if len(shown) == len(tables) else None


def _table(
    text: bytes, name: str, finish: Finish, points: NDArray[np.float64], uv: NDArray[np.float64] | None, *, mapped: bool
) -> Table | None:
    """What one material is used for; an image that nothing says the place of is not shown."""
    found = _corners([line[2:] for line in text.splitlines() if line[:2] == b"f "])
    if found is None or not _are_rows(found[0], points):
        return None
    faces, corners = found
    if not (finish.image or mapped) or uv is None or corners is None or not _are_rows(corners, uv):
        return Table(points, faces, name, finish._replace(image=""))
    return Table(points, faces, name, finish, uv, corners)


def _are_rows(faces: NDArray[Any], table: NDArray[Any]) -> bool:
    return not faces.size or bool(faces.min() >= 0 and faces.max() < len(table))


def _rows(lines: list[bytes], word: bytes, widths: tuple[int, int]) -> NDArray[np.float64] | None:
    """As many numbers as the lesser width of each line that begins with the word; None where lines have other widths, or several."""
    rows = [line[len(word) :] for line in lines if line.startswith(word)]
    said = set(map(len, map(bytes.split, rows)))
    if len(said) != 1 or not said <= set(widths):
        return None
    return numbers_in(b" ".join(rows)).reshape(len(rows), -1)[:, : widths[0]]


def _corners(lines: list[bytes]) -> tuple[NDArray[np.int64], NDArray[np.int64] | None] | None:
    """Triangles as rows of points and of texture coordinates, from 0. None where corners differ in form.

    What counts from the end of the file so far comes out below 0.
    """
    sizes = np.fromiter(map(len, map(bytes.split, lines)), np.int64, len(lines))
    strokes = np.fromiter((line.count(b"/") for line in lines), np.int64, len(lines))
    width = int(strokes[0] // sizes[0]) + 1 if len(lines) and sizes[0] else 1
    if not np.array_equal(strokes, sizes * (width - 1)):
        return None
    text = b" ".join(lines).replace(b"//", b" 0 ").replace(b"/", b" ")
    rows = numbers_in(text, np.int64).reshape(-1, width) - 1
    if width == 1:
        return fans(sizes, rows[:, 0]), None
    order = fans(sizes, np.arange(len(rows)))
    return rows[:, 0][order], rows[:, 1][order]


# ---- materials ---------------------------------------------------------------------------------------------------------------


def libraries_of(data: bytes) -> list[str]:
    """The files that an OBJ file takes its materials from, as it calls them."""
    return list(dict.fromkeys(found.decode("utf-8", "replace") for found in _LIBRARY.findall(data))) if _USE.search(data) else []


def finishes_of(library: bytes) -> dict[str, Finish]:
    """The colour and the image of each material of an MTL file that has some.

    Source: MTL material format (Lightwave, OBJ), Wavefront.
    """
    found: dict[str, Finish] = {}
    name = ""
    for line in library.decode("utf-8", "replace").splitlines():
        word, _, rest = line.strip().partition(" ")
        said = rest.strip()
        if word == "newmtl":
            name = said
        elif word == "Kd" and (rgb := _rgb(said)) is not None:
            found[name] = found.get(name, Finish())._replace(rgba=(*rgb, 1.0))
        elif word == "map_Kd" and said:
            found[name] = found.get(name, Finish())._replace(image=said.split()[-1] if said.startswith("-") else said)
    return found


def _rgb(said: str) -> tuple[float, float, float] | None:
    try:
        values = [float(word) for word in said.split()]
    except ValueError:
        return None
    if len(values) != _SOLID or not all(0.0 <= value <= 1.0 for value in values):
        return None
    return values[0], values[1], values[2]
