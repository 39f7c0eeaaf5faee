"""Default classes: what geoms, joints and actuators share is said once, in classes that are called after their elements.

Works on the printed attributes, when all sections are there. What most joints share goes into the nameless default, what most
shapes for the eye share into ``visual``; sets that only some share become classes of their own, as the factoring of
:mod:`hymeko_x.factor.sets` finds them. Nobody inherits what he does not say himself, so that MuJoCo compiles the same model.
"""

from __future__ import annotations

import re
from operator import itemgetter
from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec import Struct, field

from hymeko_x.factor.sets import Costs, common_words, share
from hymeko_x.formats.mjcf import CLASSES, MAIN
from hymeko_x.formats.mjcf.classes import PARTIAL
from hymeko_x.ir.parts import Role

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from hymeko_x.backends.mjcf.text import Leaf, Text
    from hymeko_x.factor.sets import Row

_LIKENESS = frozenset(("type", "size", "material", "rgba", "density", "friction"))
_MOTION = frozenset(("type", "axis", "range", "ref", "springref", "stiffness", "damping", "frictionloss", "armature", "actuatorfrcrange"))
_POWER = frozenset(("ctrllimited", "ctrlrange", "forcelimited", "forcerange", "gear", "kp", "kv", "dampratio"))
_SHARED: Mapping[str, frozenset[str]] = MappingProxyType(
    {"geom": _LIKENESS, "joint": _MOTION, "motor": _POWER, "position": _POWER, "velocity": _POWER}
)
"""What a class may say: what an element is like, neither what it is called nor where it is."""
_ASIDE = frozenset(("type", "material", "rgba"))
"""What alone makes no class of shapes: it is as short to read where it stands."""

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
        """The name as a class may have it, with a number behind it when somebody has it."""
        wanted = re.sub(r"\W+", "_", wanted)
        name, number = wanted, 2
        while name in self.taken:
            name, number = f"{wanted}_{number}", number + 1
        self.taken.add(name)
        return name


def shared_attributes(leaves: Iterable[Leaf]) -> Defaults:
    """The classes of these elements, which from now on say of themselves only what their class does not."""
    groups: dict[tuple[str, str | None], list[Leaf]] = {}
    for leaf in leaves:
        groups.setdefault((leaf.name, leaf.attributes.get("class")), []).append(leaf)
    defaults = Defaults()
    acting = sum(tag not in ("geom", "joint") for tag, _ in groups)
    for (tag, own_class), group in groups.items():
        if len(group) < 2 or tag not in _SHARED:
            continue
        around = own_class or (MAIN if tag == "joint" or (tag != "geom" and acting == 1) else None)
        if around is not None:
            _say_for_most(tag, around, group, defaults)
        _say_for_some(tag, own_class, group, defaults)
    return defaults


def _row(leaf: Leaf) -> Row:
    """What a class may say of an element."""
    allowed = _SHARED[leaf.name]
    return [(name, text) for name, text in leaf.attributes.items() if name in allowed]


def _say_for_most(tag: str, around: str, group: list[Leaf], defaults: Defaults) -> None:
    """What most say stands in the class that all have anyway; whoever is different says so."""
    texts: dict[str, dict[str, int]] = {}
    for leaf in group:
        for name, text in _row(leaf):
            counts = texts.setdefault(name, {})
            counts[text] = counts.get(text, 0) + 1
    said = {}
    for name, counts in texts.items():
        text, uses = max(counts.items(), key=itemgetter(1))
        if uses == len(group) or (sum(counts.values()) == len(group) and uses > len(group) / 2 and name not in PARTIAL):
            said[name] = text
    if said:
        defaults.classes.append(Class(around, tag, said, ""))
        for leaf in group:
            _leave_to_class(leaf, said)


def _leave_to_class(leaf: Leaf, said: Mapping[str, str]) -> None:
    leaf.attributes = {name: text for name, text in leaf.attributes.items() if said.get(name) != text}


def _say_for_some(tag: str, own_class: str | None, group: list[Leaf], defaults: Defaults) -> None:
    """Classes of their own for sets that several share, with whatever else those have in common."""
    names: dict[int, str] = {}
    found = share([_reasons(leaf) for leaf in group], _COSTS if own_class is None else _REFINING)
    for number, shared in sorted(enumerate(found), key=lambda item: (item[1].members[0], item[0])):
        members = [group[member] for member in shared.members]
        around = own_class or MAIN if shared.refines is None else names[shared.refines]
        common = frozenset(_row(members[0])).intersection(*map(_row, members[1:]))
        said = {name: text for name, text in _row(members[0]) if (name, text) in common}
        if not said:  # the class around says it already
            names[number] = around
            continue
        name = names[number] = defaults.free(_name(tag, own_class, said, members))
        defaults.classes.append(Class(name, tag, said, around))
        for leaf in members:
            _leave_to_class(leaf, said)
            leaf.attributes["class"] = name
    for leaf in group:
        first: dict[str, str] = {name: leaf.attributes[name] for name in ("name", "class") if name in leaf.attributes}
        leaf.attributes = {**first, **leaf.attributes}


def _reasons(leaf: Leaf) -> Row:
    """What an element may share a class for. The size of a shape means something with its type only."""
    if leaf.name != "geom":
        return _row(leaf)
    row = [(name, text) for name, text in _row(leaf) if name not in _ASIDE]
    return [(name, f"{leaf.attributes.get('type')} {text}" if name == "size" else text) for name, text in row]


def _name(tag: str, own_class: str | None, said: Mapping[str, str], members: list[Leaf]) -> str:
    """What a class is called: after the words that its elements' names share, or after what they look like."""
    words = common_words([leaf.about for leaf in members])
    if tag != "geom":
        return words or f"{said.get('type', tag)}_kind"
    look = words if words != "link" else said.get("type", "")
    return "_".join(filter(None, (own_class, look or "shape")))


# ---- printing --------------------------------------------------------------------------------------------------------------

_WEIGHTLESS = {"density": "0"}
_ROLES: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        CLASSES[Role.VISUAL]: {"contype": "0", "conaffinity": "0", "group": "2"},
        CLASSES[Role.COLLISION]: {"group": "3"},
    }
)
"""What is for the eye and what is for contact."""


def write_defaults(text: Text, leaves: Iterable[Leaf]) -> None:
    """<default> with the classes of these elements. Geoms weigh nothing: bodies say what they weigh."""
    leaves = list(leaves)
    roles = {leaf.attributes.get("class") for leaf in leaves if leaf.name == "geom"}
    said = {(MAIN, "geom"): dict(_WEIGHTLESS)} if roles else {}
    said |= {(role, "geom"): dict(attributes) for role, attributes in _ROLES.items() if role in roles}
    inside: dict[str, list[str]] = {MAIN: [role for role in _ROLES if role in roles]}
    for found in shared_attributes(leaves).classes:
        said.setdefault((found.name, found.tag), {}).update(found.attributes)
        if found.around:
            inside.setdefault(found.around, []).append(found.name)
    if said:
        text.section("default")
        _write_class(text, MAIN, said, inside)
        text.close()


def _write_class(text: Text, name: str, said: Mapping[tuple[str, str], Mapping[str, str]], inside: Mapping[str, list[str]]) -> None:
    """What is in a class, and the classes in it, of which a few are in each other at most."""
    for (owner, tag), attributes in said.items():
        if owner == name:
            text.leaf(tag, attributes)
    for inner in inside.get(name, ()):
        text.open("default", {"class": inner})
        _write_class(text, inner, said, inside)
        text.close()
