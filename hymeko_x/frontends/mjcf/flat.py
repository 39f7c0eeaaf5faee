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
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import Shape
from hymeko_x.source import Source

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.ir.mechanism import Extra, Mechanism
    from hymeko_x.xml.tree import XmlNode


def flatten(mechanism: Mechanism, write: Callable[[Mechanism], bytes]) -> Mechanism:
    """The mechanism, printed by ``write``, without its default classes.

    Values that are typed have what the classes give already; everything else that they give becomes extras of the elements.
    """
    named = _named(mechanism)
    flat = read(Source(mechanism.source.file, _without_classes(parse_text(write(named).decode())).encode()), Report()).mechanism
    called = {shape.name: key for key, shape, _ in named.edges(Shape)}
    ids = {key: called.get(shape.name, key) for key, shape, _ in flat.edges(Shape)}
    read_again = {ids.get(key, key): found for key, found in flat.extras.items()}
    extras = {key: _own(found) + read_again.get(key, ()) for key, found in mechanism.extras.items() if key != ROOT}
    extras |= {key: found for key, found in read_again.items() if key not in extras and key != ROOT}
    extras[ROOT] = _sections(mechanism.extras.get(ROOT, ()), flat.extras.get(ROOT, ()))
    notations = {
        key: {name: value for name, value in found.items() if name != CHILDCLASS.name} for key, found in mechanism.notations.items()
    }
    return replace(mechanism, extras={key: found for key, found in extras.items() if found}, notations=notations, stereotypes={})


def _own(found: tuple[Extra, ...]) -> tuple[Extra, ...]:
    """The extras of an element that do not come from MJCF; those that do are read again."""
    return tuple(extra for extra in found if extra.format not in (NAME, "comment"))


def _named(mechanism: Mechanism) -> Mechanism:
    """The mechanism with a name for every element, so that each is found again in what is read."""
    notations = {
        key: found if key.kind == "shape" else {name: value for name, value in found.items() if name != UNNAMED.name}
        for key, found in mechanism.notations.items()
    }
    taken = {shape.name for _, shape, _ in mechanism.edges(Shape)}
    edges = {}
    for key, shape, _ in mechanism.edges(Shape):
        name = key.name
        while not shape.name and name in taken:
            name += "'"
        edges[key] = replace(mechanism.graph.edges[key], data=replace(shape, name=shape.name or name))
    return replace(mechanism.replace(edges=edges), notations=notations)


def _sections(own: tuple[Extra, ...], flat: tuple[Extra, ...]) -> tuple[Extra, ...]:
    """The extras of the whole without the default classes, and with what elements in them inherit."""
    kept = tuple(extra for extra in own if extra.format != NAME or not extra.text.startswith("<default"))
    read_again = iter([extra.text for extra in flat if extra.format == NAME])
    if len([extra for extra in kept if extra.format == NAME]) != len([extra for extra in flat if extra.format == NAME]):
        return kept
    texts = [next(read_again) if extra.format == NAME else extra.text for extra in kept]
    return tuple([replace(extra, text=text) if " class=" in extra.text else extra for extra, text in zip(kept, texts, strict=True)])


def _without_classes(root: XmlNode) -> str:
    """The document with every inherited attribute at its element. Not recursive."""
    classes = Classes([child for child in root.children if child.tag == "default"])
    root.children = [child for child in root.children if child.tag != "default"]
    sections = [child for child in root.children if child.tag not in (*KEPT_SECTIONS, COMMENT)]
    stack: list[tuple[XmlNode, str, str | None]] = [(child, section.tag, None) for section in sections for child in section.children]
    while stack:
        element, place, childclass = stack.pop()
        section, path = place.partition("/")[0], f"{place}/{element.tag}"
        inside = element.attributes.pop("childclass", childclass)
        own = element.attributes.pop("class", None)
        tag = f"{element.tag}@equality" if section == "equality" and element.tag in ("joint", "tendon") else element.tag
        base = classes.of(tag, own or childclass)
        if section in ("actuator", "tendon"):  # a class has what all kinds of them have together, and nothing for the joints of a tendon
            base = {name: text for name, text in base.items() if name in attributes_of(path)}
        element.attributes.update(merge(base, element.attributes))
        stack += [(child, path, inside) for child in element.children]
    return verbatim(root)
