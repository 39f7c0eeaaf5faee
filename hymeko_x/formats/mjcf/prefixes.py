"""Names in verbatim MJCF: what an extra is called, and refers to, where elements have new names."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING
from xml.parsers.expat import ExpatError

from msgspec.structs import replace

from hymeko_x.formats.mjcf.tree import parse_text, verbatim

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.ir.mechanism import Extra
    from hymeko_x.xml.tree import XmlNode

_SITES = ("site", "site1", "site2", "cranksite", "refsite", "sidesite", "slidersite")
_KINDS: Mapping[str, str] = MappingProxyType(
    {
        **dict.fromkeys(("body", "body1", "body2", "flexbody", "node", "target"), "body"),
        **dict.fromkeys(("joint", "joint1", "joint2", "jointinparent"), "joint"),
        **dict.fromkeys(("geom", "geom1", "geom2"), "shape"),
        **dict.fromkeys(_SITES, "frame"),
        **dict.fromkeys(("tendon", "tendon1", "tendon2"), "tendon"),
        **{kind: kind for kind in ("actuator", "camera", "light", "material", "mesh", "sensor", "texture")},
        **dict.fromkeys(("name", "flex", "hfield", "layer", "numeric", "objname", "refname", "skin", "tuple"), ""),
    }
)
"""The attributes that hold the name of an element, its own or that of another one, with the kind of that; "" where the IR has none."""
_OBJECTS: Mapping[str, str] = MappingProxyType(
    {
        "body": "body",
        "xbody": "body",
        "geom": "shape",
        "site": "frame",
        **{kind: kind for kind in ("joint", "camera", "actuator", "tendon")},
    }
)
"""The kinds of elements by the words of ``objtype`` and ``reftype``, which say what ``objname`` and ``refname`` name."""
_OF_SEVERAL = ("flex", "flexcomp")
"""The elements that name several bodies in one attribute, with blanks between them."""
_OF_THE_WHOLE = ("compiler", "option", "size", "visual", "statistic", "keyframe", "default")
"""The sections that a robot has once: those of the host count. Keyframes are written anew."""


def renamed(extra: Extra, change: Callable[[str, str], str], *, is_of_whole: bool) -> Extra | None:
    """An extra with all names changed by their kind; None for a section of a part where that of the host counts."""
    attribute = extra.path.rpartition("/")[2]
    if attribute.startswith("@"):
        kind = _KINDS.get(attribute[1:])
        return replace(extra, text=change(kind, extra.text)) if kind is not None and extra.text else extra
    node = _element(extra.text)
    if node is None:
        return extra
    if is_of_whole and (node.tag in _OF_THE_WHOLE or extra.path.startswith("@")):
        return None
    stack, is_changed = [node], False
    while stack:
        element = stack.pop()
        for name in _KINDS.keys() & element.attributes.keys():
            old = element.attributes[name]
            element.attributes[name] = _changed(element, name, change)
            is_changed |= element.attributes[name] != old
        stack += element.children
    return replace(extra, text=verbatim(node)) if is_changed else extra


def _changed(element: XmlNode, attribute: str, change: Callable[[str, str], str]) -> str:
    """The attribute with changed names; a flex names several bodies."""
    old, kind = element.attributes[attribute], _kind_of(element, attribute)
    if element.tag in _OF_SEVERAL and kind == "body":
        return " ".join(change(kind, name) for name in old.split())
    return change(kind, old)


def _element(text: str) -> XmlNode | None:
    """The element that a text is; None for a comment, and for what is no XML."""
    try:
        return parse_text(text) if text.startswith("<") else None
    except ExpatError:
        return None


def _kind_of(element: XmlNode, attribute: str) -> str:
    """The kind of the element that an attribute names."""
    if attribute in ("objname", "refname"):
        return _OBJECTS.get(element.attributes.get(f"{attribute[:3]}type", ""), "")
    return _KINDS[attribute]
