"""Mesh files of any type that robots use: by appearance, as a whole, or with colours and images as subsets.

Sizes are checked before anything is allocated.
"""

from __future__ import annotations

import posixpath
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec.structs import replace

from hymeko_x.memory import remembered, remembered_reader
from hymeko_x.meshes.scene import GLTF, read_scene
from hymeko_x.meshes.stl import read_stl
from hymeko_x.meshes.submesh import MOST_FACES, Appearance, ColouredMesh, MaterialEntry, MaterialGroup, Submesh, Unreadable
from hymeko_x.meshes.weld import joined
from hymeko_x.source import suffix_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from hymeko_x.ir.parts import Mesh
    from hymeko_x.source import Files

    Triangles = tuple[NDArray[np.float64], NDArray[Any]]
    """Points (n, 3) and triangles (m, 3) as rows of them."""

READABLE = (".stl", ".obj", ".dae", ".glb", ".gltf", ".ply", ".off")
"""The types of mesh files that can be read, by suffix."""

MOST_BYTES = 2**28


@remembered_reader
def read_parts(data: bytes, suffix: str, fetch: Callable[[str], bytes]) -> tuple[Submesh, ...]:
    """The submeshes of a mesh file, one per appearance, in the order of the file.

    Node transformations and the file's unit are applied. The up axis of a COLLADA file is not, as in RViz and Gazebo:
    robot descriptions are written for readers that ignore it. ``fetch`` returns the content of a file that the mesh refers
    to, by the name it uses, or raises OSError.

    Raises: Unreadable.
    """
    check_file(data, suffix)
    if suffix == ".stl":
        return (_welded(read_stl(data), None),)
    groups = _by_appearance(read_scene(data, suffix, fetch))
    return sound(tuple(map(_in_one, groups)))


def check_file(data: bytes, suffix: str) -> None:
    """Raises: Unreadable for what is too large, of a type that is not read, or made to do harm."""
    if len(data) > MOST_BYTES:
        raise Unreadable(f"it has {len(data)} bytes, at most {MOST_BYTES} are read")
    if suffix not in READABLE:
        raise Unreadable(f"meshes of type '{suffix}' are not read; known: {', '.join(READABLE)}")
    if suffix == ".dae":
        _check_collada(data)


def sound(parts: tuple[Submesh, ...]) -> tuple[Submesh, ...]:
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


# ---- submeshes -------------------------------------------------------------------------------------------------------------------


def _by_appearance(parts: list[Submesh]) -> list[list[Submesh]]:
    """The submeshes that have the same appearance, in the order of their first appearance."""
    groups: dict[Appearance | None, list[Submesh]] = {}
    for part in parts:
        groups.setdefault(part.appearance, []).append(part)
    return list(groups.values())


def _in_one(group: Sequence[Submesh]) -> Submesh:
    """All triangles of parts of one appearance, with their texture coordinates and normals where all have some."""
    tables = [[_at_corners(part.uv, part.corners, part), _at_corners(part.normals, part.normal_corners, part)] for part in group]
    uv, normals = (None if any(table is None for table in of_all) else np.concatenate(of_all) for of_all in zip(*tables, strict=True))
    return _welded(np.concatenate([part.points[part.faces] for part in group]), uv, group[0].appearance, normals)


def _at_corners(table: NDArray[Any] | None, rows: NDArray[Any] | None, part: Submesh) -> Any:
    return None if table is None else table[part.faces if rows is None else rows]


def _welded(
    corners: NDArray[Any], uv: NDArray[np.float64] | None, appearance: Appearance | None = None, normals: NDArray[np.float64] | None = None
) -> Submesh:
    """Triangles with their common points shared; triangles with two equal corners are left out."""
    flat = corners.reshape(-1, 3)
    unique, index = joined(flat if uv is None else np.hstack([flat, uv.reshape(-1, 2)]))
    points, maps = unique[:, :3].astype(np.float64), None if uv is None else unique[:, 3:]
    faces = index.reshape(-1, 3)
    if normals is None:
        return Submesh(points, _without_degenerate(faces), maps, appearance)
    table, rows = joined(normals.reshape(-1, 3))
    return Submesh(points, _without_degenerate(faces), maps, appearance, None, table, rows.reshape(-1, 3)[are_proper(faces)])


def _without_degenerate(faces: NDArray[Any]) -> NDArray[Any]:
    """The triangles with three different corners."""
    is_good = are_proper(faces)
    return faces if is_good.all() else np.asarray(faces[is_good])


def are_proper(faces: NDArray[Any]) -> NDArray[np.bool_]:
    """Which triangles have three different corners."""
    first, second, third = faces.T
    return np.asarray((first != second) & (second != third) & (third != first))


def inline_part(mesh: Mesh) -> Submesh:
    """The triangles of a mesh that has its points; without faces, those of its convex hull are not computed.

    Texture coordinates and normals are left out where they do not fit.

    Raises: Unreadable.
    """
    table = np.array(mesh.vertices[: len(mesh.vertices) // 3 * 3], dtype=np.float64).reshape(-1, 3)
    index = np.array(mesh.faces[: len(mesh.faces) // 3 * 3], dtype=np.int64).reshape(-1, 3)
    if len(table) == 0:
        raise Unreadable("it has no points")
    if len(index) and (index.min() < 0 or index.max() >= len(table)):
        raise Unreadable("a triangle has a corner that does not exist")
    if not np.isfinite(table).all():
        raise Unreadable("a coordinate is not a finite number")
    uv, corners = _of_corners(mesh.texcoords, mesh.texfaces or mesh.faces, 2, index.size)
    normals, normal_corners = _of_corners(mesh.normals, mesh.normalfaces or mesh.faces, 3, index.size)
    return Submesh(table, index, uv, None, corners, normals, normal_corners)


def _of_corners(numbers: tuple[float, ...], rows: tuple[int, ...], width: int, size: int) -> Triangles | tuple[None, None]:
    """A table and its rows for each of so many corners; nothing where they do not fit."""
    table, index = np.array(numbers, dtype=np.float64), np.array(rows, dtype=np.int64)
    is_there = index.size == size > 0 and table.size > 0 and table.size % width == 0 and bool(np.isfinite(table).all())
    if not is_there or index.min() < 0 or index.max() >= table.size // width:
        return None, None
    return table.reshape(-1, width), index.reshape(-1, 3)


@remembered_reader
def read_whole(data: bytes, suffix: str, fetch: Callable[[str], bytes]) -> Submesh:
    """All triangles of a mesh file as one submesh without an appearance, in the order of the file; no image is opened for that.

    Raises: Unreadable.
    """
    check_file(data, suffix)
    if suffix == ".stl":
        return _welded(read_stl(data), None)
    found: Sequence[MaterialGroup | Submesh] = _plain_groups(data, suffix)
    if not found:
        found = read_scene(data, suffix, fetch if suffix in GLTF else _nothing_beside, with_appearance=False)
    points, faces = put_in_one([(some.points, some.faces) for some in found])
    return sound((Submesh(points, _without_degenerate(faces)),))[0]


def put_in_one(tables: list[Triangles]) -> Triangles:
    """Points and triangles of several meshes as one; common points are shared, and those of no triangle are left out.

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


def _in_one_table(tables: list[Triangles]) -> Triangles:
    starts = np.cumsum([0, *(len(points) for points, _ in tables)])
    points = np.concatenate([points for points, _ in tables])
    return points, np.concatenate([rows.astype(np.int64) + start for (_, rows), start in zip(tables, starts[:-1], strict=True)])


def _plain_groups(
    data: bytes, suffix: str, fetch: Callable[[str], bytes | None] | None = None, *, mapped: bool = False, normals: bool = False
) -> list[MaterialGroup]:
    """The triangles of each material of a plain COLLADA or OBJ file; nothing for other types, and where the file is not plain."""
    if suffix == ".dae":
        from hymeko_x.meshes.collada import collada_groups

        return collada_groups(data, normals=normals) or []
    if suffix == ".obj":
        from hymeko_x.meshes.obj import obj_groups

        return obj_groups(data, fetch, mapped=mapped, normals=normals) or []
    return []


def _nothing_beside(name: str) -> bytes:
    """Files that a mesh refers to, where only its triangles matter: none."""
    raise FileNotFoundError(name)


@remembered
def merged(parts: tuple[Submesh, ...]) -> Submesh:
    """All triangles as one submesh without an appearance, with texture coordinates and normals where all have some."""
    return parts[0] if len(parts) == 1 else replace(_in_one(parts), appearance=None)


# ---- colours and images --------------------------------------------------------------------------------------------------------------


def read_colours(data: bytes, suffix: str, fetch: Callable[[str], bytes], *, miss: Callable[[str], None] | None = None) -> ColouredMesh:
    """The triangles of a file, in its order, with its colours, images and normals; STL has none of them.

    ``miss`` is called with every missing image of a COLLADA or OBJ file; its triangles have their colour instead.

    Raises: Unreadable.
    """
    found, missing = _read_colours(data, suffix, fetch)
    if miss is not None:
        for name in missing:
            miss(name)
    return found


@remembered_reader
def _read_colours(data: bytes, suffix: str, fetch: Callable[[str], bytes]) -> tuple[ColouredMesh, tuple[str, ...]]:
    """The triangles, and the names of the missing images. Raises: Unreadable."""
    check_file(data, suffix)
    if suffix == ".stl":
        return ColouredMesh(read_whole(data, suffix, fetch)), ()
    groups = [group for group in _plain_groups(data, suffix, lambda name: _fetched(name, fetch), normals=True) if len(group.faces)]
    if not groups:
        return _coloured([_piece_of(part) for part in read_parts(data, suffix, fetch)]), ()
    images = _images(groups, fetch)
    missing = dict.fromkeys(group.entry.image for group in groups if group.entry.image and group.entry.image not in images)
    shown = [_with_image(group) if group.entry.image in images else _without_image(group) for group in groups]
    appearances: dict[MaterialEntry, Appearance | None] = {}
    for group in shown:
        if group.entry not in appearances:
            appearances[group.entry] = _appearance_of(group, images)
    return _coloured([(appearances[group.entry], group) for group in shown]), tuple(missing)


@remembered_reader
def read_mapped(data: bytes, suffix: str, fetch: Callable[[str], bytes]) -> Submesh:
    """All triangles of a file without its appearances, with its normals; with texture coordinates where it is an OBJ file that has them.

    Both are there where every corner has some.

    Raises: Unreadable.
    """
    check_file(data, suffix)
    if suffix == ".stl":
        return read_whole(data, suffix, fetch)
    groups = [group for group in _plain_groups(data, suffix, mapped=True, normals=True) if len(group.faces)]
    if not groups:
        found = read_scene(data, suffix, fetch if suffix in GLTF else _nothing_beside, with_appearance=False)
        groups = [_group_of(part) for part in found]
    if suffix != ".obj" or any(group.uv is None for group in groups):
        groups = [group._replace(uv=None, corners=None) for group in groups]
    return _coloured([(None, group) for group in groups]).mesh


def _images(groups: list[MaterialGroup], fetch: Callable[[str], bytes]) -> dict[str, bytes]:
    """The images that are there, by the names that the file has for them."""
    names = dict.fromkeys(group.entry.image for group in groups if group.entry.image)
    found = {name: _fetched(name, fetch) for name in names}
    return {name: data for name, data in found.items() if data is not None}


def _fetched(name: str, fetch: Callable[[str], bytes]) -> bytes | None:
    """A file beside the mesh; where there is none of that path, which may be one of the author's disk, the one of that name."""
    plain = name.replace("\\", "/")
    for wanted in dict.fromkeys((plain, posixpath.basename(plain))):
        try:
            return fetch(wanted)
        except OSError:
            continue
    return None


def _with_image(group: MaterialGroup) -> MaterialGroup:
    """A group with the colours of its image alone."""
    return group._replace(entry=group.entry._replace(rgba=None))


def _without_image(group: MaterialGroup) -> MaterialGroup:
    return group._replace(entry=group.entry._replace(image=""), uv=None, corners=None)


def _appearance_of(group: MaterialGroup, images: dict[str, bytes]) -> Appearance | None:
    """The appearance of a group; None where its file has none for it."""
    rgba, image = group.entry
    if image:
        return Appearance(group.material, None, images[image], posixpath.basename(image.replace("\\", "/")))
    return None if rgba is None else Appearance(group.material, rgba)


def _piece_of(part: Submesh) -> tuple[Appearance | None, MaterialGroup]:
    """A submesh of a scene as a group; one without texture coordinates has no image."""
    has_appearance = part.appearance is not None and (part.appearance.rgba is not None or part.uv is not None)
    return part.appearance if has_appearance else None, _group_of(part)


def _group_of(part: Submesh) -> MaterialGroup:
    """A submesh as a group of the triangles of a file."""
    corners, normal_corners = (
        None if table is None else part.faces if rows is None else rows
        for table, rows in ((part.uv, part.corners), (part.normals, part.normal_corners))
    )
    return MaterialGroup(part.points, part.faces, uv=part.uv, corners=corners, normals=part.normals, normal_corners=normal_corners)


def _coloured(pieces: list[tuple[Appearance | None, MaterialGroup]]) -> ColouredMesh:
    """Groups as one mesh, in which equal points are one; triangles without texture coordinates have those of the image's corner."""
    groups = [group for _, group in pieces]
    points, faces = put_in_one([(group.points, group.faces) for group in groups])
    order = _order(groups)
    faces = faces[order]
    proper = are_proper(faces)
    uv, corners = _places(groups)
    normals, normal_corners = _normals(groups)
    part = Submesh(
        points,
        faces[proper],
        uv,
        None,
        None if corners is None else corners[order][proper],
        normals,
        None if normal_corners is None else normal_corners[order][proper],
    )
    kinds = dict.fromkeys(appearance for appearance, _ in pieces if appearance is not None)
    numbers = {appearance: number for number, appearance in enumerate(kinds)}
    own = np.array([-1 if appearance is None else numbers[appearance] for appearance, _ in pieces])
    owners = np.repeat(own, [len(group.faces) for group in groups])[order][proper]
    by_appearance = np.argsort(owners, kind="stable")
    ends = np.searchsorted(owners[by_appearance], np.arange(len(kinds) + 1)).tolist()
    appearances = tuple([(appearance, by_appearance[start:end]) for appearance, start, end in zip(kinds, ends, ends[1:], strict=False)])
    return ColouredMesh(sound((part,))[0], appearances)


def _order(groups: list[MaterialGroup]) -> NDArray[np.intp] | slice:
    """The order of the file, as rows of the triangles of all groups one after the other."""
    orders = [group.order for group in groups if group.order is not None]
    return slice(None) if len(orders) < 2 else np.argsort(np.concatenate(orders), kind="stable")


def _places(groups: list[MaterialGroup]) -> Triangles | tuple[None, None]:
    """The texture coordinates of all corners; nothing where no group has any."""
    if all(group.uv is None for group in groups):
        return None, None
    nowhere = np.zeros((1, 2))
    return put_in_one(
        [
            (nowhere, np.zeros_like(group.faces)) if group.uv is None or group.corners is None else (group.uv, group.corners)
            for group in groups
        ]
    )


def _normals(groups: list[MaterialGroup]) -> Triangles | tuple[None, None]:
    """The normals of all corners; nothing where a group has none."""
    tables = [(group.normals, group.normal_corners) for group in groups if group.normals is not None and group.normal_corners is not None]
    return put_in_one(tables) if len(tables) == len(groups) else (None, None)


def triangles_of(mesh: Mesh, files: Files) -> Submesh | None:
    """All triangles of a mesh, unscaled; None where its file is missing or unreadable, which the conversion reports as it places it."""
    try:
        if mesh.vertices:
            return inline_part(mesh)
        path = files.find(mesh.uri or "")
        if path is None:
            return None
        return read_whole(files.read(path), suffix_of(mesh.uri or ""), lambda name: files.read(files.find(name) or name))
    except (Unreadable, OSError):
        return None
