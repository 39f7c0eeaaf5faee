"""MJCF without default classes: every element has all attributes that it would inherit, so that it means the same in any other file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.diagnostics import Report
from hymeko_x.formats.mjcf import NAME
from hymeko_x.formats.mjcf.classes import Classes, merge
from hymeko_x.formats.mjcf.notations import CHILDCLASS
from hymeko_x.formats.mjcf.schema import attributes_of
from hymeko_x.formats.mjcf.tree import COMMENT, parse_text, verbatim
from hymeko_x.formats.mjcf.words import KEPT_SECTIONS
from hymeko_x.frontends.mjcf import read
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.source import Source

if TYPE_CHECKING:
    from hymeko_x.formats.mjcf.tree import Element
    from hymeko_x.ir.mechanism import Extra, Mechanism


def flatten(mechanism: Mechanism, text: bytes) -> Mechanism:
    """The mechanism, printed as this text, without its default classes.

    Values that are typed have what the classes give already; everything else that they give becomes extras of the elements.
    """
    flat = read(Source(mechanism.source.file, _without_classes(parse_text(text.decode())).encode()), Report()).mechanism
    extras = {key: _own(found) + flat.extras.get(key, ()) if key != ROOT else _sections(found) for key, found in mechanism.extras.items()}
    extras |= {key: found for key, found in flat.extras.items() if key not in extras and key != ROOT}
    notations = {
        key: {name: value for name, value in found.items() if name != CHILDCLASS.name} for key, found in mechanism.notations.items()
    }
    return replace(mechanism, extras={key: found for key, found in extras.items() if found}, notations=notations, stereotypes={})


def _own(found: tuple[Extra, ...]) -> tuple[Extra, ...]:
    """The extras of an element that do not come from MJCF; those that do are read again."""
    return tuple(extra for extra in found if extra.format not in (NAME, "comment"))


def _sections(found: tuple[Extra, ...]) -> tuple[Extra, ...]:
    """The extras of the whole without the default classes."""
    return tuple(extra for extra in found if extra.format != NAME or not extra.text.startswith("<default"))


def _without_classes(root: Element) -> str:
    """The document with every inherited attribute at its element. Not recursive."""
    classes = Classes([child for child in root.children if child.tag == "default"])
    root.children = [child for child in root.children if child.tag != "default"]
    sections = [child for child in root.children if child.tag not in (*KEPT_SECTIONS, COMMENT)]
    stack: list[tuple[Element, str, str | None]] = [(child, section.tag, None) for section in sections for child in section.children]
    while stack:
        element, section, childclass = stack.pop()
        inside = element.attributes.pop("childclass", childclass)
        own = element.attributes.pop("class", None)
        tag = f"{element.tag}@equality" if section == "equality" and element.tag in ("joint", "tendon") else element.tag
        base = classes.of(tag, own or childclass)
        if section == "actuator":  # what all actuators have in common may be more than this one has
            known = attributes_of(f"actuator/{element.tag}")
            base = {name: text for name, text in base.items() if name in known}
        element.attributes.update(merge(base, element.attributes))
        stack += [(child, section, inside) for child in element.children]
    return verbatim(root)
