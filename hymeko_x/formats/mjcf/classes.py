"""Default classes of MJCF: what an element inherits. Shared by reader and writer.

Precedence: the element's own attributes, then its class, then the nearest childclass above it, then the class ``main``;
a nested class begins with what its parent has. Source: MuJoCo XML reference, default.
"""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.mjcf import MAIN

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from hymeko_x.xml.tree import XmlNode

Attributes = dict[str, str]

FAMILIES: Mapping[str, str] = MappingProxyType(
    {
        **dict.fromkeys(("connect", "weld", "joint@equality", "tendon@equality", "flex", "flexvert", "flexstrain"), "equality"),
        **dict.fromkeys(("spatial", "fixed"), "tendon"),
    }
)
"""Under which element of <default> the defaults of an element stand, where that is not its own tag."""

TURNS = ("quat", "euler", "axisangle", "xyaxes", "zaxis")
"""The attributes for an orientation; an element's own one replaces that of its class."""
ANY_TURN = frozenset(TURNS)

ACTUATORS = frozenset(
    ("general", "motor", "position", "velocity", "intvelocity", "orientation", "pid", "damper", "cylinder", "muscle", "adhesion", "dcmotor")
)
"""In <default> all of these set one and the same actuator: what they have in common is inherited across tags, and the last one
decides which kind it is, so that gains of another tag before it are gone."""

_SHARED = frozenset(
    (
        "ctrllimited",
        "ctrlrange",
        "forcelimited",
        "forcerange",
        "actlimited",
        "actrange",
        "gear",
        "group",
        "user",
        "lengthrange",
        "armature",
        "damping",
        "cranklength",
        "inheritrange",
        "delay",
        "nsample",
        "interp",
    )
)
_ANY_ACTUATOR = "actuator"

_SOLVER = ("solref", "solimp", "solreflimit", "solimplimit", "solreffriction", "solimpfriction")
PARTIAL = frozenset({"size", "friction", "gear", "damping", "stiffness", *_SOLVER, "user"})
"""Attributes that may have fewer numbers than there are; the rest is inherited."""

_NOTHING: Mapping[str, str] = MappingProxyType({})


class Classes:
    """The default classes of a file, by name, each with all that it inherits."""

    def __init__(self, sections: Iterable[XmlNode] = ()) -> None:
        self._classes: dict[str, dict[str, Attributes]] = {MAIN: {}}
        self._given: dict[tuple[str, str], Mapping[str, str]] = {}
        for section in sections:
            self._add(section)

    def _add(self, section: XmlNode) -> None:
        """One <default> at top level with all inside it."""
        stack: list[tuple[XmlNode, str | None]] = [(section, None)]
        while stack:
            element, parent = stack.pop()
            name = element.attributes.get("class")
            if parent is None:
                name = MAIN if name is None else name
                if name != MAIN:
                    raise refuse(
                        codes.BAD_NAME, f"the default class at top level is called 'main' and nothing else, not '{name}'", element.origin
                    )
            elif not name:
                raise refuse(codes.MISSING_ATTRIBUTE, "a <default> inside another one needs a class", element.origin)
            elif name in self._classes:
                raise refuse(codes.DUPLICATE_NAME, f"the default class '{name}' is defined twice", element.origin)
            inherited = self._classes[name if parent is None else parent]
            self._classes[name] = _with_own(inherited, element)
            stack.extend((child, name) for child in reversed(element.children) if child.tag == "default")

    def has(self, name: str) -> bool:
        """Whether there is a class of this name."""
        return name in self._classes

    @property
    def names(self) -> list[str]:
        """All classes in order."""
        return list(self._classes)

    def of(self, tag: str, name: str | None) -> Mapping[str, str]:
        """What the class gives to elements of this tag; nothing where there is no such class."""
        place = tag, name or MAIN
        given = self._given.get(place)
        if given is None:
            given = self._given[place] = self._look_up(*place)
        return given

    def _look_up(self, tag: str, name: str) -> Mapping[str, str]:
        found = self._classes.get(name, {})
        if tag in ACTUATORS and _ANY_ACTUATOR in found:
            return {**found[_ANY_ACTUATOR], **found.get(tag, _NOTHING)}
        return found.get(FAMILIES.get(tag, tag.partition("@")[0]), _NOTHING)


def _with_own(inherited: dict[str, Attributes], element: XmlNode) -> dict[str, Attributes]:
    merged = dict(inherited)
    for child in element.children:
        if child.tag in ACTUATORS:
            _add_actuator(merged, child)
        elif child.tag != "default" and not child.tag.startswith("#"):
            merged[child.tag] = dict(merge(merged.get(child.tag, _NOTHING), child.attributes))
    return merged


def _add_actuator(merged: dict[str, Attributes], child: XmlNode) -> None:
    shared = {name: text for name, text in child.attributes.items() if name in _SHARED}
    own = {name: text for name, text in child.attributes.items() if name not in _SHARED}
    merged[_ANY_ACTUATOR] = dict(merge(merged.get(_ANY_ACTUATOR, _NOTHING), shared))
    if child.tag != "general":
        for other in ACTUATORS - {child.tag}:
            merged.pop(other, None)
    merged[child.tag] = dict(merge(merged.get(child.tag, _NOTHING), own))


def merge(base: Mapping[str, str], own: Mapping[str, str]) -> Mapping[str, str]:
    """The attributes of an element: its own over what it inherits."""
    if not base:
        return own
    if not own:
        return base
    merged = {**base, **own}
    both = base.keys() & own.keys()
    for name in PARTIAL & both:
        merged[name] = _completed(own[name], base[name])
    if not ANY_TURN.isdisjoint(own):
        for turn in ANY_TURN & base.keys() - own.keys():
            del merged[turn]
    return merged


def _completed(own: str, base: str) -> str:
    first, rest = own.split(), base.split()
    return own if len(first) >= len(rest) else " ".join([*first, *rest[len(first) :]])


_IN_ELEMENTS = re.compile(
    r"\s(?:type|size|material|rgba|density|friction|axis|range|ref|springref|stiffness|damping|frictionloss|armature|actuatorfrcrange|"
    r'ctrlrange|forcerange|gear|kp|kv|dampratio)="[^"]*"'
)
"""Attributes in a default class that each of its elements has in a field of its own when it is read."""


_FOLDERS = re.compile(r'\s(?:assetdir|meshdir|texturedir)="[^"]*"')
"""Attributes of <compiler> that are part of the path of each file."""


def without_inherited(text: str) -> str:
    """An element of the file; of default classes only what no element has in a field, of <compiler> what no file has in its path."""
    if text.startswith("<compiler"):
        return _FOLDERS.sub("", text)
    return _IN_ELEMENTS.sub("", text) if text.startswith("<default") else text
