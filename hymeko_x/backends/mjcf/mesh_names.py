"""Names of meshes that no author named: their file's, and where two files are called alike, what they are for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.ir.names import free_name
from hymeko_x.ir.parts import Mesh, Role

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.ir.mechanism import Mechanism, ShapeView

_NUMBERED = "#"
"""Between the name and the number of an id that another element of its kind would have as well."""


def name_meshes(mechanism: Mechanism, source: Mechanism) -> Mechanism:
    """The mechanism with names for meshes whose ids are numbered: ``hand_collision``, or ``hand_2`` for want of a better one.

    A mesh of the ``source`` keeps its name for itself, even where it is not written: what is read back would be taken for it.
    """
    meshes = dict(mechanism.vertices(Mesh))
    taken = {mesh.name or key.name for key, mesh in (*meshes.items(), *source.vertices(Mesh))}
    users = mechanism.shapes_by_mesh()
    changed = {}
    for key, mesh in meshes.items():
        stem, mark, number = key.name.rpartition(_NUMBERED)
        if mesh.name or not mark or not number.isdigit():
            continue
        name = next((name for name in _wanted(stem, users.get(key, [])) if name not in taken), None)
        name = name or free_name(stem, taken.__contains__, "_")
        taken.add(name)
        changed[key] = replace(mesh, name=name)
    return mechanism.replace(vertices=changed)


def _wanted(stem: str, users: list[ShapeView]) -> Iterator[str]:
    """The names to try: the stem, and with the role of all shapes that show the mesh."""
    yield stem
    roles = {view.shape.role for view in users}
    if len(roles) == 1 and roles != {Role.BOTH}:
        yield f"{stem}_{roles.pop().value}"
