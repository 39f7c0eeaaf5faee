"""Mesh files: reading any type that robots use, by look or as a whole. Sizes are checked before anything is allocated."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hymeko_x.meshes.part import MOST_FACES, Look, Part, Unreadable
from hymeko_x.meshes.scene import read_scene
from hymeko_x.meshes.stl import read_stl
from hymeko_x.meshes.weld import joined

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

READABLE = (".stl", ".obj", ".dae", ".glb", ".gltf", ".ply", ".off")
"""The types of mesh files that can be read, by suffix."""
_IN_SEVERAL_FILES = (".gltf", ".glb")
"""Types whose triangles may stand in files of their own."""

MOST_BYTES = 2**28


def read_parts(data: bytes, suffix: str, fetch: Callable[[str], bytes]) -> tuple[Part, ...]:
    """The parts of a mesh file, one per look, in the order of the file.

    Node transformations and the file's unit are applied. The up axis of a COLLADA file is not, as in RViz and Gazebo:
    robot descriptions are written for readers that ignore it. ``fetch`` returns the content of a file that the mesh refers
    to, by the name it uses, or raises OSError.

    Raises: Unreadable.
    """
    check_file(data, suffix)
    if suffix == ".stl":
        return (_welded(read_stl(data), None),)
    groups = _by_look(read_scene(data, suffix, fetch))
    return sound(tuple(_welded(*_corners(group), group[0].look) for group in groups))


def check_file(data: bytes, suffix: str) -> None:
    """Raises: Unreadable for what is too large, of a type that is not read, or made to do harm."""
    if len(data) > MOST_BYTES:
        raise Unreadable(f"it has {len(data)} bytes, at most {MOST_BYTES} are read")
    if suffix not in READABLE:
        raise Unreadable(f"meshes of type '{suffix}' are not read; known: {', '.join(READABLE)}")
    if suffix == ".dae":
        _check_collada(data)


def sound(parts: tuple[Part, ...]) -> tuple[Part, ...]:
    """The parts, if there are any and every coordinate is a number."""
    if not parts:
        raise Unreadable("it has no triangles")
    if not all(np.isfinite(part.points).all() for part in parts):
        raise Unreadable("a coordinate is not a finite number")
    return parts


def _check_collada(data: bytes) -> None:
    """Entities would be expanded, and an archive unpacked to any size."""
    if b"!" in data and (b"<!DOCTYPE" in data or b"<!ENTITY" in data):  # one letter is found much faster than a word
        raise Unreadable("it declares XML entities, which are not expanded")
    if data.find(b"PK\x05\x06", -70_000) >= 0:
        raise Unreadable("it is a ZIP archive, which is not unpacked")


# ---- parts -------------------------------------------------------------------------------------------------------------------


def _by_look(parts: list[Part]) -> list[list[Part]]:
    """The parts that have the same look, in the order of their first appearance."""
    groups: dict[Look | None, list[Part]] = {}
    for part in parts:
        groups.setdefault(part.look, []).append(part)
    return list(groups.values())


def _corners(group: list[Part]) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """The corners (faces, 3, 3) of all triangles of the parts, and their texture coordinates where all have some."""
    corners = np.concatenate([part.points[part.faces] for part in group])
    maps = [part.uv[part.faces] for part in group if part.uv is not None]
    return corners, np.concatenate(maps) if len(maps) == len(group) else None


def _welded(corners: NDArray[Any], uv: NDArray[np.float64] | None, look: Look | None = None) -> Part:
    """Triangles with their common points shared; triangles with two equal corners are left out."""
    flat = corners.reshape(-1, 3)
    unique, index = joined(flat if uv is None else np.hstack([flat, uv.reshape(-1, 2)]))
    points, maps = unique[:, :3].astype(np.float64), None if uv is None else unique[:, 3:]
    return Part(points, _without_degenerate(index.reshape(-1, 3)), maps, look)


def _without_degenerate(faces: NDArray[Any]) -> NDArray[Any]:
    """The triangles with three different corners."""
    is_good = are_whole(faces)
    return faces if is_good.all() else np.asarray(faces[is_good])


def are_whole(faces: NDArray[Any]) -> NDArray[np.bool_]:
    """Which triangles have three different corners."""
    first, second, third = faces.T
    return np.asarray((first != second) & (second != third) & (third != first))


def inline_part(points: tuple[float, ...], faces: tuple[int, ...], places: tuple[float, ...] = (), corners: tuple[int, ...] = ()) -> Part:
    """The triangles of a mesh that is given by flat lists; without faces, those of its convex hull are not computed.

    ``places`` in an image and ``corners``, the rows of them, are left out where they do not fit.

    Raises: Unreadable.
    """
    table = np.array(points[: len(points) // 3 * 3], dtype=np.float64).reshape(-1, 3)
    index = np.array(faces[: len(faces) // 3 * 3], dtype=np.int64).reshape(-1, 3)
    if len(table) == 0:
        raise Unreadable("it has no points")
    if len(index) and (index.min() < 0 or index.max() >= len(table)):
        raise Unreadable("a triangle has a corner that does not exist")
    if not np.isfinite(table).all():
        raise Unreadable("a coordinate is not a finite number")
    uv = np.array(places, dtype=np.float64)
    rows = np.array(corners or faces, dtype=np.int64)
    is_there = rows.size == index.size > 0 and uv.size > 0 and uv.size % 2 == 0 and bool(np.isfinite(uv).all())
    if not is_there or rows.min() < 0 or rows.max() >= uv.size // 2:
        return Part(table, index)
    return Part(table, index, uv.reshape(-1, 2), None, rows.reshape(-1, 3))


def read_whole(data: bytes, suffix: str, fetch: Callable[[str], bytes]) -> Part:
    """All triangles of a mesh file as one part without a look, in the order of the file; no image is opened for that.

    Raises: Unreadable.
    """
    check_file(data, suffix)
    if suffix == ".stl":
        return _welded(read_stl(data), None)
    tables = _plain_tables(data, suffix)
    if tables is None:
        parts = read_scene(data, suffix, fetch if suffix in _IN_SEVERAL_FILES else _nothing_beside, looks=False)
        tables = [(part.points, part.faces) for part in parts]
    return sound((put_together(tables),))[0]


def put_together(tables: list[tuple[NDArray[np.float64], NDArray[Any]]]) -> Part:
    """Points and triangles of several meshes as one; common points are shared, and those of no triangle are left out.

    Raises: Unreadable when there is no triangle, or there are too many.
    """
    points, faces = put_in_one(tables)
    return Part(points, _without_degenerate(faces))


def put_in_one(tables: list[tuple[NDArray[np.float64], NDArray[Any]]]) -> tuple[NDArray[np.float64], NDArray[Any]]:
    """The same with every triangle, also those that have no area.

    Raises: Unreadable when there is no triangle, or there are too many.
    """
    if not any(len(faces) for _, faces in tables):
        raise Unreadable("it has no triangles")
    points, faces = tables[0] if len(tables) == 1 else _in_one_table(tables)
    if len(faces) > MOST_FACES:
        raise Unreadable(f"it has {len(faces)} triangles, at most {MOST_FACES} are read")
    used = np.zeros(len(points), dtype=bool)
    used[faces] = True
    unique, index = joined(points[used])
    if len(unique) < len(points):
        places = np.zeros(len(points), dtype=index.dtype)
        places[used] = index
        faces = places[faces]
    return unique, faces


def _in_one_table(tables: list[tuple[NDArray[np.float64], NDArray[Any]]]) -> tuple[NDArray[np.float64], NDArray[Any]]:
    starts = np.cumsum([0, *(len(points) for points, _ in tables)])
    points = np.concatenate([points for points, _ in tables])
    return points, np.concatenate([rows.astype(np.int64) + start for (_, rows), start in zip(tables, starts[:-1], strict=True)])


def _plain_tables(data: bytes, suffix: str) -> list[tuple[NDArray[np.float64], NDArray[Any]]] | None:
    """Points and triangles of the two text formats that most robots use, where nothing about them is unusual."""
    if suffix == ".dae":
        from hymeko_x.meshes.collada import collada_tables

        return [(table.points, table.faces) for table in collada_tables(data) or ()] or None
    if suffix == ".obj":
        from hymeko_x.meshes.obj import obj_tables

        return [(table.points, table.faces) for table in obj_tables(data) or ()] or None
    return None


def _nothing_beside(name: str) -> bytes:
    """What a mesh refers to, where only its triangles matter."""
    raise FileNotFoundError(name)


def merged(parts: tuple[Part, ...]) -> Part:
    """All triangles as one part without a look."""
    if len(parts) == 1:
        return parts[0]
    return _welded(np.concatenate([part.points[part.faces] for part in parts]), None)
