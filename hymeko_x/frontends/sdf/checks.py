"""What libsdformat refuses and this reader accepts: files that other programs of SDF will not load are reported."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf.numbers import LEAST_NUMBERS, LEAST_NUMBERS_IN

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.diagnostics import Report
    from hymeko_x.frontends.sdf.builder import SdfBuilder
    from hymeko_x.xml.tree import XmlNode

_CONTENT = ("link", "model", "include")
_OWN_NAMES = ("plugin",)
"""Elements whose names need not differ."""
_NO_REFERENCES = ("visual", "collision", "sensor", "light")
"""Named elements that no other one refers to; the readers of the others report reserved names."""
_RENAMED = ("link", "joint", "frame", "model")
"""Elements that get another name where one of their own kind has it, which their readers report."""
_BEGINS_AS_NUMBER = re.compile(r"[+-]?(?:\.?\d|inf|nan)", re.IGNORECASE)
"""What libsdformat reads as a number, which may have anything behind it."""


def check_models(place: XmlNode, report: Report) -> list[XmlNode]:
    """Report several models without a world around them, models without links, and names that the elements in one element share.

    Returns the elements that share theirs, and keep it.
    """
    shared: list[XmlNode] = []
    tops = [child for child in place.children if child.tag == "model"]
    if place.tag == "sdf" and len(tops) > 1:
        message = f"the file has {len(tops)} models and no <world> around them; libsdformat reads the first one alone"
        report.warn(codes.REPEATED, message, tops[1].origin)
    _check_root(place, report)
    stack = [place]
    while stack:
        node = stack.pop()
        shared += _check_names(node, report)
        if node.tag == "model":
            _check_links(node, report)
        stack += [child for child in reversed(node.children) if child.tag in ("model", "link", "joint")]
    return shared


def _check_root(place: XmlNode, report: Report) -> None:
    """A file without a world has a model, a light or an actor."""
    kinds = list(dict.fromkeys(child.tag for child in place.children if child.tag in ("model", "light", "actor")))
    if place.tag == "sdf" and len(kinds) > 1:
        message = f"the file has a <{'> and a <'.join(kinds)}> and no <world> around them; libsdformat refuses it"
        report.warn(codes.REPEATED, message, place.origin)


def _check_links(node: XmlNode, report: Report) -> None:
    is_static = any(child.tag == "static" and (child.text or "").strip() in ("1", "true") for child in node.children)
    if not is_static and not any(child.tag in _CONTENT for child in node.children):
        message = f"the model '{node.attributes.get('name', '')}' has no link, which libsdformat refuses"
        report.warn(codes.MISSING_PART, message, node.origin)


def _check_names(node: XmlNode, report: Report) -> list[XmlNode]:
    taken: dict[str, XmlNode] = {}
    shared: list[XmlNode] = []
    for child in node.children:
        name = "" if child.tag in _OWN_NAMES else child.attributes.get("name", "")
        if child.tag in _NO_REFERENCES and (name == words.WORLD_FRAME or (name.startswith("__") and name.endswith("__"))):
            message = f"the name '{name}' of a <{child.tag}> is reserved in SDF, and libsdformat refuses it; it is kept"
            report.warn(codes.BAD_NAME, message, child.origin)
        other = taken.get(name)
        taken.setdefault(name, child)
        if not name or other is None or (other.tag == child.tag and child.tag in _RENAMED):
            continue
        shared += [other, child]
        both = f"a <{other.tag}> and a <{child.tag}> are" if other.tag != child.tag else f"two <{child.tag}> are"
        report.warn(codes.DUPLICATE_NAME, f"{both} called '{name}', which libsdformat refuses; both keep the name", child.origin)
    return shared


# ---- numbers -----------------------------------------------------------------------------------------------------------------


def check_numbers(nodes: Iterable[XmlNode], builder: SdfBuilder) -> None:
    """Report elements that stay as written where SDF has numbers, and that contain none; plugins and elements with a prefix are free."""
    stack = [child for node in nodes for child in node.unread_children()]
    while stack:
        node = stack.pop()
        if node.tag in _OWN_NAMES or ":" in node.tag:
            continue
        stack += [child for child in node.children if child.is_element]
        found = [] if node.children or node.start in builder.bad_numbers else (node.text or "").split()
        around = "" if node.parent is None else node.parent.tag
        least = LEAST_NUMBERS.get(node.tag, 0) or LEAST_NUMBERS_IN.get((around, node.tag), 0)
        if least and found and (len(found) < least or not all(map(_BEGINS_AS_NUMBER.match, found[:least]))):
            expected = "a number" if least == 1 else f"{least} numbers"
            text = " ".join(found)[:60]
            message = f"{node.subject}: <{node.tag}> is '{text}', expected {expected}; libsdformat refuses it, and it is kept as written"
            builder.warn(codes.BAD_NUMBER, node, message)
