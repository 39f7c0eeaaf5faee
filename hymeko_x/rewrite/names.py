"""Names that an XML attribute cannot hold, or that a target would read as no name at all."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.ir.names import free_name, names_in_use, rename

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.ir.parts import Mesh, Texture
    from hymeko_x.rewrite.context import Context

_NOT_XML = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


def usable_name(name: str) -> str:
    """The name with ``_`` for characters that XML forbids."""
    return _NOT_XML.sub("_", name)


def make_names_usable(mechanism: Mechanism, context: Context) -> Mechanism:
    """Empty names become the kind of the element (of the mechanism: robot), characters that XML forbids become ``_``."""
    if not mechanism.name:
        mechanism = replace(mechanism, name="robot")
        context.report.note(codes.RENAMED, "the robot has no name; it is written as 'robot'")
    keys = (*mechanism.graph.vertices, *mechanism.graph.edges)
    texts = [key.name for key in keys]
    if all(texts) and not _NOT_XML.search("".join(texts)):
        return mechanism
    unusable = [key for key in keys if not key.name or _NOT_XML.search(key.name)]
    names = names_in_use(mechanism)
    renamed: dict[Id, Id] = {}
    for key in unusable:
        new = names.take(key.kind, usable_name(key.name) or key.kind)
        renamed[key] = new
        found = "is empty" if not key.name else f"{key.name!r} has characters that XML cannot hold"
        context.report.warn(
            codes.RENAMED, f"the name of a {key.kind} {found}; it is written as '{new.name}'", mechanism.origin(key), element=str(new)
        )
    return rename(mechanism, renamed)


def name_assets_once(mechanism: Mechanism, context: Context) -> Mechanism:
    """Meshes and textures are written under the name that their author gave them, or else their id's, each name once per kind."""
    taken: dict[str, set[str]] = {}
    changed: dict[Id, Mesh | Texture] = {}
    for key, part in mechanism.assets():
        wanted = part.name or key.name
        names = taken.setdefault(key.kind, set())
        name = free_name(wanted, names.__contains__)
        names.add(name)
        if name != wanted:
            changed[key] = replace(part, name=name)
            context.report.note(
                codes.RENAMED, f"another {key.kind} is called '{wanted}' already; this one is written as '{name}'", mechanism.origin(key)
            )
    return mechanism.replace(vertices=changed)
