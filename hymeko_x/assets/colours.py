"""The triangles of mesh files by colour, for targets that hold triangles themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.assets.mesh import check_file, put_together, read_whole, sound
from hymeko_x.assets.part import Look, Part

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.assets.collada import Table


def read_colours(data: bytes, suffix: str, fetch: Callable[[str], bytes]) -> tuple[Part, ...]:
    """One part for each colour of a COLLADA file, in the order of the file; other files are one part without a look.

    Raises: Unreadable.
    """
    check_file(data, suffix)
    tables = _tables(data) if suffix == ".dae" else []
    if not tables:
        return (read_whole(data, suffix, fetch),)
    groups: dict[object, list[Table]] = {}
    for table in tables:
        if len(table.faces):
            groups.setdefault(table.rgba, []).append(table)
    return sound(tuple(_part(group) for group in groups.values()))


def _tables(data: bytes) -> list[Table]:
    from hymeko_x.assets.collada import collada_tables

    return collada_tables(data) or []


def _part(group: list[Table]) -> Part:
    whole = put_together([(table.points, table.faces) for table in group])
    look = None if group[0].rgba is None else Look(group[0].material, group[0].rgba)
    return Part(whole.points, whole.faces, None, look)
