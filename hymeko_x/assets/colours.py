"""The triangles of mesh files by what they are shown in, a colour or an image, for targets that hold triangles themselves."""

from __future__ import annotations

import posixpath
from dataclasses import replace
from typing import TYPE_CHECKING

from hymeko_x.assets.mesh import are_whole, check_file, put_in_one, put_together, read_parts, read_whole, sound
from hymeko_x.assets.part import Finish, Look, Part

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.assets.part import Table

_IN_SCENES = (".glb", ".gltf")


def read_colours(data: bytes, suffix: str, fetch: Callable[[str], bytes], *, miss: Callable[[str], None] | None = None) -> tuple[Part, ...]:
    """One part for each colour or image of a COLLADA, OBJ or glTF file, in the order of the file; others are one part without a look.

    ``miss`` is told of every image of a COLLADA or OBJ file that is not there; what shows it has its colour instead.

    Raises: Unreadable.
    """
    check_file(data, suffix)
    if suffix in _IN_SCENES:
        return tuple(_split_maps(part) for part in read_parts(data, suffix, fetch))
    tables = _tables(data, suffix, fetch)
    if not tables:
        return (read_whole(data, suffix, fetch),)
    images = _images(tables, fetch)
    for name in dict.fromkeys(table.finish.image for table in tables if table.finish.image and table.finish.image not in images):
        if miss is not None:
            miss(name)
    groups: dict[Finish, list[Table]] = {}
    for table in tables:
        if len(table.faces):
            shown = table if table.finish.image in images else _without_image(table)
            groups.setdefault(shown.finish, []).append(shown)
    return sound(tuple(_part(group, images) for group in groups.values()))


def read_mapped(data: bytes, suffix: str, fetch: Callable[[str], bytes]) -> Part:
    """All triangles of a file, with their places in an image where it is an OBJ file that says all of them; its own looks do not count.

    Raises: Unreadable.
    """
    check_file(data, suffix)
    from hymeko_x.assets.obj import obj_tables

    tables = [table for table in (obj_tables(data, mapped=True) or () if suffix == ".obj" else ()) if len(table.faces)]
    if not tables or any(table.uv is None for table in tables):
        return read_whole(data, suffix, fetch)
    return sound((_mapped(tables),))[0]


def _tables(data: bytes, suffix: str, fetch: Callable[[str], bytes]) -> list[Table]:
    """What the file shows in each material; nothing where it has none, or is not plain."""
    if suffix == ".dae":
        from hymeko_x.assets.collada import collada_tables

        return collada_tables(data) or []
    if suffix != ".obj":
        return []
    from hymeko_x.assets.obj import obj_tables

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


def _without_image(table: Table) -> Table:
    return table._replace(finish=table.finish._replace(image=""), uv=None, corners=None)


# ---- parts -------------------------------------------------------------------------------------------------------------------


def _part(group: list[Table], images: dict[str, bytes]) -> Part:
    first = group[0]
    rgba, image = first.finish
    if not image:
        whole = put_together([(table.points, table.faces) for table in group])
        return replace(whole, look=None if rgba is None else Look(first.material, rgba))
    look = Look(first.material, None, images[image], posixpath.basename(image.replace("\\", "/")))
    return replace(_mapped(group), look=look)


def _mapped(group: list[Table]) -> Part:
    """Tables that all have places in an image as one part."""
    points, faces = put_in_one([(table.points, table.faces) for table in group])
    uv, corners = put_in_one([(table.uv, table.corners) for table in group if table.uv is not None and table.corners is not None])
    whole_ones = are_whole(faces)
    return Part(points, faces[whole_ones], uv, None, corners[whole_ones])


def _split_maps(part: Part) -> Part:
    """A part whose points are apart only where their places in the image are, with the two in tables of their own."""
    if part.uv is None:
        return replace(part, look=part.look if part.look and part.look.rgba else None)
    points, faces = put_in_one([(part.points, part.faces)])
    uv, corners = put_in_one([(part.uv, part.faces)])
    whole_ones = are_whole(faces)
    return Part(points, faces[whole_ones], uv, part.look, corners[whole_ones])
