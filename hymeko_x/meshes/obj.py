"""Triangles, colours and images of plain Wavefront OBJ files; the loader for all of OBJ reads the others.

Of the corners of a polygon only their points count, and where a material has an image also their texture coordinates.
"""

from __future__ import annotations

import re
from itertools import accumulate, pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from hymeko_x.memory import remembered
from hymeko_x.meshes.numerals import numbers_in
from hymeko_x.meshes.submesh import MaterialEntry, MaterialGroup, fans, used_rows

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from hymeko_x.meshes.submesh import Submesh

_NORMAL = 2
"""The place of the normal among the numbers of a corner."""
_CONTINUED = (b"\\\n", b"\\\r")
"""The end of a line that continues in the next one."""
_RUNS = re.compile(rb"(?:v .*\n)++|(?:vt.*\n)++|(?:vn.*\n)++|(?:f .*\n)++|.*\n")
"""Lines in a row that begin with the same word, or any other line."""
_WIDTHS = (3, 6)
"""A point, or a point with a colour."""
_UV_WIDTHS = (2, 3)
_NORMAL_WIDTHS = (3, 3)
"""Two texture coordinates, or three, of which the last one is for solid textures."""


class _Lines(NamedTuple):
    """The lines of a file by their first word, in runs; ``uses`` has for each material the number of its first run of polygons."""

    points: list[bytes]
    places: list[bytes]
    normals: list[bytes]
    faces: list[bytes]
    uses: list[tuple[int, str]]
    libraries: list[str]


def obj_groups(
    data: bytes, fetch: Callable[[str], bytes | None] | None = None, *, mapped: bool = False, normals: bool = False
) -> list[MaterialGroup] | None:
    """The triangles of an OBJ file by material, each with its entry in the file's libraries. None where the file is not plain.

    ``fetch`` returns a library by the name that the file has for it; without one, or without entries, all is one group.
    Groups have texture coordinates where the material has an image, or where ``mapped`` asks for all of them, and ``normals`` if asked for.
    Source: B1. Object Files (.obj), Advanced Visualizer Manual.
    """
    lines = _lines_of(data)
    if lines is None:
        return None
    entries: dict[str, MaterialEntry] = {}
    for library in dict.fromkeys(lines.libraries if lines.uses and fetch is not None else ()):
        entries |= material_entries((fetch(library) if fetch is not None else None) or b"")
    is_imaged = mapped or any(entry.image for entry in entries.values())
    try:
        points = _rows(lines.points, _WIDTHS)
        uv = _rows(lines.places, _UV_WIDTHS) if is_imaged else None
        shading = _rows(lines.normals, _NORMAL_WIDTHS) if normals else None
        if points is None:
            return None
        polygons = _by_material(lines, lines.uses if entries else [])
        tables = _Tables(points, uv, shading)
        groups = [_group(some, entries.get(some.material, MaterialEntry()), tables, mapped=mapped) for some in polygons]
    except ValueError:  # a word that is no number
        return None
    plain = [group for group in groups if group is not None]
    return plain if len(plain) == len(groups) else None


def _lines_of(data: bytes) -> _Lines | None:
    """The lines of a file; None where some continue in the next one, or begin with a blank."""
    if b"\\" in data and any(end in data for end in _CONTINUED):
        return None
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    found = _Lines([], [], [], [], [], [])
    runs = {b"v ": found.points, b"vt": found.places, b"vn": found.normals, b"f ": found.faces}
    for run in _RUNS.findall(data + b"\n"):
        word = run[:2]
        if word in runs:
            runs[word].append(run)
        elif word[:1] in (b" ", b"\t") or word in (b"v\t", b"f\t"):
            return None
        elif run.startswith(b"usemtl"):
            found.uses.append((len(found.faces), _name(run, b"usemtl")))
        elif run.startswith(b"mtllib"):
            found.libraries.append(_name(run, b"mtllib"))
    return found


def _name(line: bytes, word: bytes) -> str:
    return line.removeprefix(word).strip().decode("utf-8", "replace")


def words_of(lines: bytes) -> tuple[NDArray[np.uint8], NDArray[np.intp], NDArray[np.intp]]:
    """The text of lines, with a line break before the first one too, the places where words begin, and the number of words of each line."""
    text = np.frombuffer(lines, dtype=np.uint8)
    is_blank = text <= ord(" ")
    starts = np.flatnonzero(is_blank[:-1] > is_blank[1:]) + 1
    return text, starts, np.diff(np.searchsorted(starts, np.flatnonzero(text == ord("\n"))))


def _rows(runs: list[bytes], widths: tuple[int, int]) -> NDArray[np.float64] | None:
    """As many numbers of each line as the lesser width; None where lines have other widths, or several."""
    if not runs:
        return None
    lines = _without_word(runs)
    _, _, counts = words_of(lines)
    if counts[0] not in widths or (counts != counts[0]).any():
        return None
    return numbers_in(lines).reshape(len(counts), int(counts[0]))[:, : widths[0]]


def _without_word(runs: list[bytes]) -> bytes:
    """The lines of runs of one word without it, and with a line break before the first one."""
    lines = b"\n" + b"".join(runs)
    return lines.replace(lines[:3], b"\n")


# ---- polygons ----------------------------------------------------------------------------------------------------------------


class _Tables(NamedTuple):
    """The points of a file, its texture coordinates, and its normals; the others None where they are missing or not wanted."""

    points: NDArray[np.float64]
    uv: NDArray[np.float64] | None
    normals: NDArray[np.float64] | None


class _Polygons(NamedTuple):
    """Polygons of one material, and their numbers in the file."""

    material: str
    runs: list[bytes]
    order: list[int]


def _by_material(lines: _Lines, uses: list[tuple[int, str]]) -> list[_Polygons]:
    """The polygons by material, and by the form of the first corner of each use; those before the first use have no name."""
    found: dict[tuple[str, str], _Polygons] = {}
    numbers = [*accumulate((run.count(b"\n") for run in lines.faces), initial=0)]
    for (start, name), (end, _) in pairwise([(0, ""), *uses, (len(lines.faces), "")]):
        if start < end:
            some = found.setdefault((name, _form(lines.faces[start])), _Polygons(name, [], []))
            some.runs.extend(lines.faces[start:end])
            some.order.extend(range(numbers[start], numbers[end]))
    return list(found.values())


def _form(run: bytes) -> str:
    """The fields that the first corner of a run of polygons has: ``x-x`` for ``12//7``."""
    return "".join("x" if field else "-" for corner in run.split(b"\n", 1)[0].split(None, 2)[1:2] for field in corner.split(b"/"))


def _group(some: _Polygons, entry: MaterialEntry, tables: _Tables, *, mapped: bool) -> MaterialGroup | None:
    """The triangles of one material; an image without texture coordinates is left out. None where they are not plain."""
    corners = _corners(_without_word(some.runs))
    if corners is None:
        return None
    sizes, numbers, has_places = corners
    faces = fans(sizes, numbers[:, 0])
    if not _are_rows(faces, tables.points):
        return None
    order = np.repeat(np.array(some.order, dtype=np.intp), np.maximum(sizes - 2, 0))
    group = MaterialGroup(*used_rows(tables.points, faces), some.material, entry._replace(image=""), order=order)
    shaded = _of_corners(tables.normals, sizes, numbers[:, _NORMAL:])
    if shaded is not None:
        group = group._replace(normals=shaded[0], normal_corners=shaded[1])
    places = _of_corners(tables.uv, sizes, numbers[:, 1:]) if (entry.image or mapped) and has_places else None
    return group if places is None else group._replace(entry=entry, uv=places[0], corners=places[1])


def _of_corners(
    table: NDArray[np.float64] | None, sizes: NDArray[np.intp], numbers: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[Any]] | None:
    """A table and its rows at the corners of triangles, of which the first column has those of the polygons; None where they do not fit."""
    if table is None or not numbers.shape[1]:
        return None
    rows = fans(sizes, numbers[:, 0])
    return used_rows(table, rows) if _are_rows(rows, table) else None


def _corners(lines: bytes) -> tuple[NDArray[np.intp], NDArray[np.int64], bool] | None:
    """The number of corners of each polygon, the numbers of all corners (from 0), and whether the second of them are places in an image.

    None where the corners have different numbers of strokes, which are ``1``, ``1/2``, ``1//3`` or ``1/2/3``.

    Raises: ValueError where there is anything but numbers.
    """
    text, starts, sizes = words_of(lines)
    strokes = np.diff(np.searchsorted(np.flatnonzero(text == ord("/")), np.append(starts, len(text))))
    if (strokes != strokes[:1]).any():
        return None
    numbers = numbers_in(lines.replace(b"//", b"/0/").replace(b"/", b" "), np.int64)
    return sizes, numbers.reshape(len(starts), -1) - 1, bool(strokes[:1].any()) and b"//" not in lines


def _are_rows(faces: NDArray[Any], table: NDArray[Any]) -> bool:
    return not faces.size or bool(faces.min() >= 0 and faces.max() < len(table))


@remembered
def obj_bytes(part: Submesh) -> bytes:
    """The part as a Wavefront OBJ file: points to float32 precision, texture coordinates, normals, triangles."""
    text = _printed(b"v %.9g %.9g %.9g\n", part.points + 0.0)
    columns, corner = [part.faces], b"%d"
    if part.uv is not None:
        text += _printed(b"vt %.9g %.9g\n", part.uv + 0.0)
        columns.append(part.faces if part.corners is None else part.corners)
        corner = b"%d/%d"
    if part.normals is not None:
        text += _printed(b"vn %.9g %.9g %.9g\n", part.normals + 0.0)
        columns.append(part.faces if part.normal_corners is None else part.normal_corners)
        corner += b"/%d" if part.uv is not None else b"//%d"
    return text + _printed(b"f " + b" ".join([corner] * 3) + b"\n", np.stack(columns, axis=2) + 1)


def _printed(line: bytes, rows: NDArray[Any]) -> bytes:
    """A line for each of the rows, with its numbers."""
    return line * len(rows) % tuple(rows.ravel().tolist())


# ---- material libraries --------------------------------------------------------------------------------------------------------------

_SOLID = 3
_DECIMALS = 12
"""After which what is left of 1 is a matter of its double."""


def material_entries(library: bytes) -> dict[str, MaterialEntry]:
    """The colour and the image of each material of an MTL file that has some.

    Source: MTL material format (Lightwave, OBJ), Wavefront.
    """
    found: dict[str, MaterialEntry] = {}
    shares: dict[str, dict[str, list[str]]] = {}
    name = ""
    for line in library.decode("utf-8", "replace").splitlines():
        word, _, rest = line.strip().partition(" ")
        text = rest.strip()
        if word == "newmtl":
            name = text
        elif word == "Kd" and (rgb := _rgb(text)) is not None:
            found[name] = found.get(name, MaterialEntry())._replace(rgba=(*rgb, 1.0))
        elif word == "map_Kd" and text:
            found[name] = found.get(name, MaterialEntry())._replace(image=text.split()[-1] if text.startswith("-") else text)
        elif word in ("d", "Tr"):
            shares.setdefault(name, {})[word] = text.split()
    return {name: _seen_through(entry, shares.get(name, {})) for name, entry in found.items()}


def _seen_through(entry: MaterialEntry, text: dict[str, list[str]]) -> MaterialEntry:
    if entry.rgba is None:
        return entry
    return entry._replace(rgba=(*entry.rgba[:3], opacity(text.get("d", ()), text.get("Tr", ()))))


def opacity(dissolve: Sequence[str], transparency: Sequence[str]) -> float:
    """The opacity of a material, 0..1, from the words behind its statements: ``d``, else 1 minus ``Tr``.

    An invisible material is read as opaque: files have `Tr 1` (MeshLab) or `d 0` (Blender) for robots that are meant to be visible.
    """
    through = _share(transparency)
    found = _share(dissolve) or (None if through is None else round(1.0 - through, _DECIMALS))
    return found or 1.0


def _share(words: Sequence[str]) -> float | None:
    """The number from 0 to 1 that comes first; None for anything else, such as a halo, of which each side hides another part."""
    try:
        value = float(words[0])
    except (ValueError, IndexError):
        return None
    return value if 0.0 <= value <= 1.0 else None


def _rgb(text: str) -> tuple[float, float, float] | None:
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        return None
    if len(values) != _SOLID or not all(0.0 <= value <= 1.0 for value in values):
        return None
    return values[0], values[1], values[2]
