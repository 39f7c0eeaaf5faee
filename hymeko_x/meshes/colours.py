"""The triangles of mesh files by what they are shown in, a colour or an image, for targets that hold triangles themselves."""

from __future__ import annotations

import posixpath
from typing import TYPE_CHECKING, Any

import numpy as np

from hymeko_x.meshes.mesh import are_whole, check_file, put_in_one, read_parts, read_whole, sound
from hymeko_x.meshes.part import Finish, Look, Painted, Part, Table

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

_IN_SCENES = (".glb", ".gltf")


def read_colours(data: bytes, suffix: str, fetch: Callable[[str], bytes], *, miss: Callable[[str], None] | None = None) -> Painted:
    """The triangles of a COLLADA, OBJ or glTF file, in its order, with its colours and images; those of other files have none.

    ``miss`` is told of every image of a COLLADA or OBJ file that is not there; what shows it has its colour instead.

    Raises: Unreadable.
    """
    check_file(data, suffix)
    if suffix in _IN_SCENES:
        return _painted([_piece_of(part) for part in read_parts(data, suffix, fetch)])
    tables = [table for table in _tables(data, suffix, fetch) if len(table.faces)]
    if not tables:
        return Painted(read_whole(data, suffix, fetch))
    images = _images(tables, fetch)
    for name in dict.fromkeys(table.finish.image for table in tables if table.finish.image and table.finish.image not in images):
        if miss is not None:
            miss(name)
    shown = [_with_image(table) if table.finish.image in images else _without_image(table) for table in tables]
    looks: dict[Finish, Look | None] = {}
    for table in shown:
        if table.finish not in looks:
            looks[table.finish] = _look(table, images)
    return _painted([(looks[table.finish], table) for table in shown])


def read_mapped(data: bytes, suffix: str, fetch: Callable[[str], bytes]) -> Part:
    """All triangles of a file, with their places in an image where it is an OBJ file that says all of them; its own looks do not count.

    Raises: Unreadable.
    """
    check_file(data, suffix)
    from hymeko_x.meshes.obj import obj_tables

    tables = [table for table in (obj_tables(data, mapped=True) or () if suffix == ".obj" else ()) if len(table.faces)]
    if not tables or any(table.uv is None for table in tables):
        return read_whole(data, suffix, fetch)
    return _painted([(None, table) for table in tables]).part


def _tables(data: bytes, suffix: str, fetch: Callable[[str], bytes]) -> list[Table]:
    """What the file shows in each material; nothing where it has none, or is not plain."""
    if suffix == ".dae":
        from hymeko_x.meshes.collada import collada_tables

        return collada_tables(data) or []
    if suffix != ".obj":
        return []
    from hymeko_x.meshes.obj import obj_tables

    return obj_tables(data, lambda name: _fetched(name, fetch)) or []


def _images(tables: list[Table], fetch: Callable[[str], bytes]) -> dict[str, bytes]:
    """The images that are there, by the names that the file has for them."""
    names = dict.fromkeys(table.finish.image for table in tables if table.finish.image)
    found = {name: _fetched(name, fetch) for name in names}
    return {name: data for name, data in found.items() if data is not None}


def _fetched(name: str, fetch: Callable[[str], bytes]) -> bytes | None:
    """A file beside the mesh; where there is none of that path, as on the disk of its author, the one of that name."""
    plain = name.replace("\\", "/")
    for wanted in dict.fromkeys((plain, posixpath.basename(plain))):
        try:
            return fetch(wanted)
        except OSError:
            continue
    return None


def _with_image(table: Table) -> Table:
    """A table in the colours of its image alone."""
    return table._replace(finish=table.finish._replace(rgba=None))


def _without_image(table: Table) -> Table:
    return table._replace(finish=table.finish._replace(image=""), uv=None, corners=None)


# ---- parts -------------------------------------------------------------------------------------------------------------------


def _look(table: Table, images: dict[str, bytes]) -> Look | None:
    """How a table looks; None where its file says nothing about it."""
    rgba, image = table.finish
    if image:
        return Look(table.material, None, images[image], posixpath.basename(image.replace("\\", "/")))
    return None if rgba is None else Look(table.material, rgba)


def _piece_of(part: Part) -> tuple[Look | None, Table]:
    """A part of a scene, whose points are apart where their places in its image are; a part without places shows no image."""
    has_look = part.look is not None and (part.look.rgba is not None or part.uv is not None)
    return part.look if has_look else None, Table(part.points, part.faces, uv=part.uv, corners=None if part.uv is None else part.faces)


def _painted(pieces: list[tuple[Look | None, Table]]) -> Painted:
    """Tables as one part. Points are apart only where they are at different places; what has no places in an image is at its corner."""
    tables = [table for _, table in pieces]
    points, faces = put_in_one([(table.points, table.faces) for table in tables])
    order = _order(tables)
    faces = faces[order]
    whole_ones = are_whole(faces)
    uv, corners = _places(tables)
    part = Part(points, faces[whole_ones], uv, None, None if corners is None else corners[order][whole_ones])
    numbers = {look: number for number, look in enumerate(dict.fromkeys(look for look, _ in pieces if look is not None))}
    own = np.array([-1 if look is None else numbers[look] for look, _ in pieces])
    owners = np.repeat(own, [len(table.faces) for table in tables])[order][whole_ones]
    by_look = np.argsort(owners, kind="stable")
    ends = np.searchsorted(owners[by_look], np.arange(len(numbers) + 1)).tolist()
    looks = tuple([(look, by_look[start:end]) for look, start, end in zip(numbers, ends, ends[1:], strict=False)])
    return Painted(sound((part,))[0], looks)


def _order(tables: list[Table]) -> NDArray[np.intp] | slice:
    """Which triangles of all tables, one table behind the other, make up the order of their file."""
    said = [table.order for table in tables if table.order is not None]
    return slice(None) if len(said) < 2 else np.argsort(np.concatenate(said), kind="stable")


def _places(tables: list[Table]) -> tuple[NDArray[np.float64], NDArray[Any]] | tuple[None, None]:
    """The places in an image of all corners; nothing where no table has any."""
    if all(table.uv is None for table in tables):
        return None, None
    nowhere = np.zeros((1, 2))
    return put_in_one(
        [
            (nowhere, np.zeros_like(table.faces)) if table.uv is None or table.corners is None else (table.uv, table.corners)
            for table in tables
        ]
    )
