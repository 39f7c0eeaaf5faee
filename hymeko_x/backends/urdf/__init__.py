"""URDF out. Prints a legal mechanism as URDF 1.0: one root, joints with at most one dof (or planar, or free).

Deterministic; numbers as the shortest decimals that read back to the same doubles; what a URDF file said and the
mechanism carries as extras stands again where it stood. docs/mapping/urdf.md says what is written how.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.backends.urdf.joints import joint_tag
from hymeko_x.backends.urdf.links import link_tag
from hymeko_x.backends.urdf.materials import robot_material_tag
from hymeko_x.backends.urdf.meshes import contents_of
from hymeko_x.backends.urdf.order import order
from hymeko_x.backends.urdf.sheet import Sheet
from hymeko_x.backends.urdf.transmissions import transmission_tag
from hymeko_x.formats import urdf as words
from hymeko_x.formats.urdf.notations import STYLE, Explicit, Style
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.source import Package
from hymeko_x.xml.printing import Tag, foreign_text, put_back, ready, render
from hymeko_x.xml.text import escaped, escaped_lines, parts_of_text
from hymeko_x.xml.unread import COMMENT, FOLLOWING, PRECEDING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Extra, Id, Mechanism
    from hymeko_x.rewrite.context import Options


class Draft(NamedTuple):
    """A URDF file before it is text: the root, what is to stand in it, ready lines before and after it, and mesh files beside it.

    Each of the ``elements`` is made when it is asked for, so that those of a large robot are never there all at once.
    """

    root: Tag
    elements: Iterator[Tag | str]
    before: list[str]
    after: list[str]
    meshes: dict[str, bytes]


def write(mechanism: Mechanism, options: Options, report: Report) -> Package:
    """The URDF file of a mechanism. Meshes are referred to by their uris as they are.

    Raises: Refusal with HX104 for a joint or a shape that URDF cannot say; legalising beforehand rewrites those.
    """
    del report  # printing takes no decisions, so there is nothing to say
    made = draft(mechanism, options.within)
    made.root.children += [element if isinstance(element, str) else ready(element, 1) for element in made.elements]

    def printed(residue: str) -> bytes:
        root = Tag(made.root.name, made.root.attributes, [*made.root.children, *residue_elements(residue)])
        return "\n".join(['<?xml version="1.0"?>', *made.before, *render(root), *made.after, ""]).encode()

    return Package(printed(""), made.meshes, carry=printed)


def draft(mechanism: Mechanism, within: str = "") -> Draft:
    """The elements of the URDF file of a mechanism. Each at top level knows whose it is. Files beside it are in the folder ``within``.

    Raises: Refusal with HX104 as :func:`write`.
    """
    root = _root_tag(mechanism)
    sheet = Sheet(mechanism, _declared(root), within)
    extras = [extra for extra in mechanism.extras.get(ROOT, ()) if extra.format in (words.FORMAT, COMMENT)]
    meshes = contents_of(mechanism, sheet.mesh_files, sheet.textures)
    return Draft(root, _merged(extras, sheet), _around(extras, PRECEDING, sheet), _around(extras, FOLLOWING, sheet), meshes)


def residue_elements(text: str, *, readable: bool = True) -> list[str]:
    """The elements that carry a residue; ``readable`` allows CDATA, which xacro would not unescape."""
    texts = [f"<![CDATA[\n{part}]]>" if readable and "]]>" not in part else escaped_lines(part) for part in parts_of_text(text)]
    return [f'<{words.RESIDUE} xmlns:hymeko="{words.RESIDUE_NAMESPACE}">{part}</{words.RESIDUE}>' for part in texts]


def _root_tag(mechanism: Mechanism) -> Tag:
    root = Tag("robot", {"name": mechanism.name})
    if Explicit.VERSION in (mechanism.notation(ROOT, STYLE) or Style()).explicit:
        root.attributes["version"] = "1.0"
    own = [extra for extra in mechanism.extras.get(ROOT, ()) if extra.format == words.FORMAT and extra.path.startswith("@")]
    put_back(root, own, {})
    return root


def _declared(root: Tag) -> dict[str, str]:
    return {name: uri for name, uri in root.attributes.items() if name.startswith("xmlns")}


def _tag(key: Id, sheet: Sheet) -> Tag:
    tag = _WRITERS[key.kind](key, sheet)
    tag.owner = key
    sheet.put_back(tag, key)
    return tag


_WRITERS = {"body": link_tag, "joint": joint_tag, "material": robot_material_tag, "drive": transmission_tag}


def _merged(extras: list[Extra], sheet: Sheet) -> Iterator[Tag | str]:
    """Typed elements and extras in one row: an extra stands where it stood, as far as there is something before it."""
    foreign = sorted((extra for extra in extras if extra.path in ("", "text()")), key=lambda extra: (extra.index, extra.path == ""))
    waiting = iter(foreign)
    extra = next(waiting, None)
    place = 0
    for key in order(sheet):
        while extra is not None and extra.index <= place:
            yield _text(extra, sheet)
            extra = next(waiting, None)
            place += 1
        yield _tag(key, sheet)
        place += 1
    while extra is not None:
        yield _text(extra, sheet)
        extra = next(waiting, None)


def _text(extra: Extra, sheet: Sheet) -> str:
    return escaped(extra.text) if extra.path == "text()" else foreign_text(extra, sheet.declared)


def _around(extras: list[Extra], path: str, sheet: Sheet) -> list[str]:
    """What stands before or after the root element."""
    return [_text(extra, sheet) for extra in sorted(extras, key=lambda extra: extra.index) if extra.path == path]
