"""Default classes of robots from elsewhere: attributes that geoms, joints or actuators share are written once.

Works on the finished sections. What most joints share goes into the nameless default, what most visual shapes share into
``visual``; sets that only some share become classes of their own, called after their elements, as the factoring of
:mod:`hymeko_x.factor.sets` finds them. No element inherits an attribute that it did not have, so that MuJoCo compiles the same model.
"""

from __future__ import annotations

import re
from operator import itemgetter
from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec import Struct, field

from hymeko_x.factor.sets import Costs, common_words, share
from hymeko_x.formats.mjcf import CLASSES, MAIN
from hymeko_x.formats.mjcf.classes import PARTIAL, Classes
from hymeko_x.formats.mjcf.tree import parse_text
from hymeko_x.ir.names import free_name
from hymeko_x.ir.parts import Role
from hymeko_x.xml.printing import Tag

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from hymeko_x.backends.mjcf.sheet import MjcfSheet
    from hymeko_x.factor.sets import Row

_ROLES: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        CLASSES[Role.VISUAL]: {"contype": "0", "conaffinity": "0", "group": "2"},
        CLASSES[Role.COLLISION]: {"group": "3"},
    }
)
"""The attributes of geoms that are only seen and of those that only touch."""
_MASSLESS = {"density": "0"}

ROLE_CLASSES = Classes(
    [
        parse_text(
            '<default><geom density="0"/><default class="visual"><geom contype="0" conaffinity="0" group="2"/></default>'
            '<default class="collision"><geom group="3"/></default></default>'
        )
    ]
)
"""The classes of every robot from elsewhere. Geoms have no mass: bodies have their inertials."""

_LIKENESS = frozenset(("type", "size", "material", "rgba", "density", "friction"))
_MOTION = frozenset(("type", "axis", "range", "ref", "springref", "stiffness", "damping", "frictionloss", "armature", "actuatorfrcrange"))
_POWER = frozenset(("ctrllimited", "ctrlrange", "forcelimited", "forcerange", "gear", "kp", "kv", "dampratio"))
_SHARED: Mapping[str, frozenset[str]] = MappingProxyType(
    {"geom": _LIKENESS, "joint": _MOTION, "motor": _POWER, "position": _POWER, "velocity": _POWER}
)
"""The attributes that a class may have: neither names nor poses."""
_ASIDE = frozenset(("type", "material", "rgba"))
"""Attributes that alone make no class of shapes: they are as short to read where they stand."""

_AROUND = len('=""')
_DEFINITION = len('<default class="collision_black"></default></>')
_COSTS = Costs(_DEFINITION, _AROUND, len('class="knee"'), 1)
_REFINING = Costs(_DEFINITION, _AROUND, len("_black"), 1)


class Class(Struct):
    """A default class: its name, the tag and the attributes that it is about, and the name of the class around it."""

    name: str
    tag: str
    attributes: dict[str, str]
    around: str


class Defaults(Struct):
    """The classes found, those that refine another one behind it, and the names that are taken."""

    classes: list[Class] = field(default_factory=list)
    taken: set[str] = field(default_factory=lambda: {MAIN, *CLASSES.values()})

    def free(self, wanted: str) -> str:
        """The name as a class may have it, with a number behind it when it is taken."""
        name = free_name(re.sub(r"\W+", "_", wanted), self.taken.__contains__, "_")
        self.taken.add(name)
        return name


def shared_attributes(tags: Iterable[Tag]) -> Defaults:
    """The classes of these elements, which keep only the attributes that their class does not give."""
    groups: dict[tuple[str, str | None], list[Tag]] = {}
    for tag in tags:
        groups.setdefault((tag.name, tag.attributes.get("class")), []).append(tag)
    defaults = Defaults()
    acting = sum(name not in ("geom", "joint") for name, _ in groups)
    for (name, own_class), group in groups.items():
        if len(group) < 2 or name not in _SHARED:
            continue
        around = own_class or (MAIN if name == "joint" or (name != "geom" and acting == 1) else None)
        if around is not None:
            _share_among_most(name, around, group, defaults)
        _share_among_some(name, own_class, group, defaults)
    return defaults


def _row(element: Tag) -> Row:
    """The attributes of an element that a class may have."""
    allowed = _SHARED[element.name]
    return [(name, text) for name, text in element.attributes.items() if name in allowed]


def _share_among_most(tag: str, around: str, group: list[Tag], defaults: Defaults) -> None:
    """An attribute that most elements have goes into the class that all have anyway; the others have their own."""
    texts: dict[str, dict[str, int]] = {}
    for element in group:
        for name, text in _row(element):
            counts = texts.setdefault(name, {})
            counts[text] = counts.get(text, 0) + 1
    own = {}
    for name, counts in texts.items():
        text, uses = max(counts.items(), key=itemgetter(1))
        if uses == len(group) or (sum(counts.values()) == len(group) and uses > len(group) / 2 and name not in PARTIAL):
            own[name] = text
    if own:
        defaults.classes.append(Class(around, tag, own, ""))
        for element in group:
            _leave_to_class(element, own)


def _leave_to_class(element: Tag, own: Mapping[str, str]) -> None:
    element.attributes = {name: text for name, text in element.attributes.items() if own.get(name) != text}


def _share_among_some(tag: str, own_class: str | None, group: list[Tag], defaults: Defaults) -> None:
    """Classes for sets of attributes that several elements share, with everything else that those have in common."""
    names: dict[int, str] = {}
    found = share([_reasons(element) for element in group], _COSTS if own_class is None else _REFINING)
    for number, shared in sorted(enumerate(found), key=lambda item: (item[1].members[0], item[0])):
        members = [group[member] for member in shared.members]
        around = own_class or MAIN if shared.refines is None else names[shared.refines]
        common = frozenset(_row(members[0])).intersection(*map(_row, members[1:]))
        own = {name: text for name, text in _row(members[0]) if (name, text) in common}
        if not own:  # the class around has them already
            names[number] = around
            continue
        name = names[number] = defaults.free(_name(tag, own_class, own, members))
        defaults.classes.append(Class(name, tag, own, around))
        for element in members:
            _leave_to_class(element, own)
            element.attributes["class"] = name
    for element in group:
        first: dict[str, str] = {name: element.attributes[name] for name in ("name", "class") if name in element.attributes}
        element.attributes = {**first, **element.attributes}


def _reasons(element: Tag) -> Row:
    """The attributes for which an element may share a class. The size of a shape means something with its type only."""
    if element.name != "geom":
        return _row(element)
    row = [(name, text) for name, text in _row(element) if name not in _ASIDE]
    return [(name, f"{element.attributes.get('type')} {text}" if name == "size" else text) for name, text in row]


def _name(tag: str, own_class: str | None, own: Mapping[str, str], members: list[Tag]) -> str:
    """The name of a class: the words that its elements' names share, or else their type."""
    words = common_words([element.owner.name for element in members if element.owner])
    if tag != "geom":
        return words or f"{own.get('type', tag)}_kind"
    kind = words if words != "link" else own.get("type", "")
    return "_".join(filter(None, (own_class, kind or "shape")))


# ---- the section -----------------------------------------------------------------------------------------------------------


def write_defaults(sheet: MjcfSheet, place: int) -> None:
    """<default> at its place behind the settings, with the classes of the elements that are written there."""
    tags = [tag for tag in _walk(sheet.root) if tag.owner is not None]
    roles = {tag.attributes.get("class") for tag in tags if tag.name == "geom"}
    shared = {(MAIN, "geom"): dict(_MASSLESS)} if roles else {}
    shared |= {(role, "geom"): dict(attributes) for role, attributes in _ROLES.items() if role in roles}
    inside: dict[str, list[str]] = {MAIN: [role for role in _ROLES if role in roles]}
    for found in shared_attributes(tags).classes:
        shared.setdefault((found.name, found.tag), {}).update(found.attributes)
        if found.around:
            inside.setdefault(found.around, []).append(found.name)
    if shared:
        sheet.root.children[place:place] = ["", _class_tag(MAIN, {}, shared, inside)]


def _walk(root: Tag) -> Iterable[Tag]:
    """All elements in document order."""
    stack = [root]
    while stack:
        tag = stack.pop()
        yield tag
        stack += [child for child in reversed(tag.children) if isinstance(child, Tag)]


def _class_tag(
    name: str, attributes: dict[str, str], shared: Mapping[tuple[str, str], dict[str, str]], inside: Mapping[str, list[str]]
) -> Tag:
    """A class with its elements and the classes in it, of which a few are in each other at most."""
    own = [Tag(tag, found) for (owner, tag), found in shared.items() if owner == name]
    return Tag("default", attributes, [*own, *(_class_tag(inner, {"class": inner}, shared, inside) for inner in inside.get(name, ()))])
