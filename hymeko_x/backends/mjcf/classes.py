"""Default classes of robots from elsewhere: attributes that geoms, joints or actuators share are written once.

Works on the finished sections. What most joints share goes into the nameless default; sets that at least three elements share become
classes of their own, as the factoring of :mod:`hymeko_x.factor.sets` finds them, where the names of the elements tell what they are:
``hip``, ``calf``, ``collision_foot``. A class that elements have anyway - the nameless one, ``visual``, ``collision`` - gives no type,
material, size or range, which an element that a person adds would inherit by surprise. No element inherits an attribute that
it did not have, so that MuJoCo compiles the same model.
"""

from __future__ import annotations

import re
from collections import Counter
from itertools import chain
from operator import itemgetter
from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec import Struct, field

from hymeko_x.factor.sets import Costs, share
from hymeko_x.factor.words import by_meaning, distinguishing_words, limb, telling_words
from hymeko_x.formats.mjcf import CLASSES, MAIN
from hymeko_x.formats.mjcf.classes import PARTIAL, Classes
from hymeko_x.formats.mjcf.roles import ATTRIBUTES
from hymeko_x.formats.mjcf.tree import parse_text
from hymeko_x.ir.names import free_name
from hymeko_x.ir.parts import Body, Shape
from hymeko_x.xml.printing import Tag, ready

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from hymeko_x.backends.mjcf.sheet import MjcfSheet
    from hymeko_x.factor.sets import Row
    from hymeko_x.ir.mechanism import Mechanism

_ROLES: Mapping[str, Mapping[str, str]] = MappingProxyType({name: ATTRIBUTES[role] for role, name in CLASSES.items()})
"""The attributes of geoms that are only seen and of those that only touch."""
_MASSLESS = {"density": "0"}

_OF_ROLES = [Tag("default", {"class": name}, [Tag("geom", dict(attributes))]) for name, attributes in _ROLES.items()]
ROLE_CLASSES = Classes([parse_text(ready(Tag("default", {}, [Tag("geom", dict(_MASSLESS)), *_OF_ROLES]), 0))])
"""The classes of every robot from elsewhere. Geoms have no mass: bodies have their inertials."""

_FEWEST_FILES = 3

_LIKENESS = frozenset(("type", "size", "material", "rgba", "density", "friction"))
_MOTION = frozenset(("type", "axis", "range", "ref", "springref", "stiffness", "damping", "frictionloss", "armature", "actuatorfrcrange"))
_POWER = frozenset(("ctrllimited", "ctrlrange", "forcelimited", "forcerange", "gear", "kp", "kv", "dampratio"))
_SHARED: Mapping[str, frozenset[str]] = MappingProxyType(
    {"geom": _LIKENESS, "joint": _MOTION, "motor": _POWER, "position": _POWER, "velocity": _POWER}
)
"""The attributes that a class may have: neither names nor poses."""
_ASIDE = frozenset(("type", "material", "rgba"))
"""Attributes that alone make no class of shapes: they are as short to read where they stand."""
_OWN = frozenset(("type", "size", "material", "rgba", "range", "ref", "springref"))
"""Attributes that an element has itself, or from a class that was made for such elements."""
_USUAL_AXIS = ("axis", "0 0 1")
"""MuJoCo's own default, which no class needs to give."""
_FEWEST = 3
"""Elements that make a class of their own worth its name."""

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
    """The classes found, those that refine another one behind it, and by the names that are taken the tags and the class around."""

    classes: list[Class] = field(default_factory=list)
    taken: dict[str, tuple[set[str], str]] = field(default_factory=lambda: {name: ({"geom"}, "") for name in (MAIN, *CLASSES.values())})

    def free(self, wanted: str, tag: str, around: str) -> str:
        """The name of a class for elements of this tag, with a number behind it when it is taken.

        Joints and their motors may share it inside the same class.
        """

        def is_taken(name: str) -> bool:
            tags, other = self.taken.get(name, (set[str](), around))
            return bool({tag, "geom"} & tags) or other != around

        name = free_name(re.sub(r"\W+", "_", wanted), is_taken, "_")
        self.taken.setdefault(name, (set(), around))[0].add(tag)
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
    given = _SHARED[tag] - _OWN
    for (name, text), uses in Counter(chain.from_iterable([element.attributes.items() for element in group])).items():
        if name in given and (name, text) != _USUAL_AXIS:
            texts.setdefault(name, {})[text] = uses
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
    split = _telling_words(group) if len(group) >= _FEWEST else []
    if not any(split):
        return  # no class would have a name
    start = len(defaults.classes)
    found = share([_reasons(element) for element in group], _COSTS if own_class is None else _REFINING)
    for shared in found:
        members = [group[member] for member in shared.members]
        meant = by_meaning([split[member] for member in shared.members], _FEWEST)
        groups = [(words, [members[place] for place in places]) for words, places in meant]
        for words, alike in _as_one_limb(groups) or groups:
            _make_class(tag, own_class, words, alike, defaults)
    order = {name: place for place, element in reversed([*enumerate(group)]) if (name := element.attributes.get("class"))}
    defaults.classes[start:] = sorted(defaults.classes[start:], key=lambda found: order.get(found.name, -1))


def _as_one_limb(groups: list[tuple[str, list[Tag]]]) -> list[tuple[str, list[Tag]]]:
    """Groups that would have equal classes as one, called after the limb of which all are parts; nothing where there is none."""
    everyone = [element for _, alike in groups for element in alike]
    word = limb(_names(everyone)) if len(groups) > 1 else ""
    return [(word, everyone)] if word and all(_common(alike) == _common(everyone) for _, alike in groups) else []


def _telling_words(group: list[Tag]) -> list[list[str]]:
    """The words of each element's name that tell what it is, without those that all of them have."""
    names = _names(group)
    return distinguishing_words(names) if len(names) > _FEWEST else [telling_words(name) for name in names]


def _common(elements: list[Tag]) -> frozenset[tuple[str, str]]:
    """The attributes that a class may have and all of these elements have, which are of one name."""
    allowed = _SHARED[elements[0].name]
    shared = set(elements[0].attributes.items()).intersection(*[element.attributes.items() for element in elements[1:]])
    return frozenset([pair for pair in shared if pair[0] in allowed])


def _names(elements: list[Tag]) -> list[str]:
    return [element.owner.name if element.owner else "" for element in elements]


def _make_class(tag: str, own_class: str | None, words: str, members: list[Tag], defaults: Defaults) -> None:
    """A class for what these elements share, in the class that they have, which is the same for all."""
    given = members[0].attributes.get("class")
    common = _common(members)
    own = {name: text for name, text in _row(members[0]) if (name, text) in common}
    if not own or any(element.attributes.get("class") != given for element in members):
        return  # the class around has them already
    around = given or MAIN
    name = defaults.free("_".join(filter(None, (own_class, words))), tag, around)
    defaults.classes.append(Class(name, tag, own, around))
    for element in members:
        _leave_to_class(element, own)
        element.attributes.pop("class", None)
        named = {"name": element.attributes["name"]} if "name" in element.attributes else {}
        element.attributes = {**named, "class": name, **element.attributes}


def _reasons(element: Tag) -> Row:
    """The attributes for which an element may share a class. The size of a shape means something with its type only."""
    if element.name != "geom":
        return _row(element)
    row = [(name, text) for name, text in _row(element) if name not in _ASIDE]
    return [(name, f"{element.attributes.get('type')} {text}" if name == "size" else text) for name, text in row]


# ---- the section -----------------------------------------------------------------------------------------------------------


def settle(sheet: MjcfSheet, place: int) -> None:
    """What all elements of the written document have in common: the classes at their place behind the settings, and <compiler>."""
    tags, compiler = _elements(sheet.root), sheet.root.child("compiler")
    if any("euler" in tag.attributes for tag in tags):
        compiler.attributes["eulerseq"] = sheet.settings.eulerseq
    _settle_folders([tag for tag in tags if "file" in tag.attributes], compiler)
    _write_defaults(sheet, [tag for tag in tags if tag.owner is not None], place)


def _write_defaults(sheet: MjcfSheet, tags: list[Tag], place: int) -> None:
    """<default> with the classes of the elements."""
    roles = {tag.attributes.get("class") for tag in tags if tag.name == "geom"}
    shared = {(MAIN, "geom"): dict(_MASSLESS)} if _need_no_mass(sheet.mechanism) else {}
    shared |= {(role, "geom"): dict(attributes) for role, attributes in _ROLES.items() if role in roles}
    inside: dict[str, list[str]] = {MAIN: [role for role in _ROLES if role in roles]}
    for found in shared_attributes(tags).classes:
        shared.setdefault((found.name, found.tag), {}).update(found.attributes)
        if found.around and found.name not in inside.setdefault(found.around, []):
            inside[found.around].append(found.name)
    if shared:
        sheet.root.children[place:place] = ["", _class_tag(MAIN, {}, shared, inside)]


def _need_no_mass(mechanism: Mechanism) -> bool:
    """Whether geoms have to be massless: MuJoCo would compute the mass of a body from them, or the robot gives their density as 0."""
    is_given = any(shape.density == 0 for _, shape, _ in mechanism.edges(Shape))
    return is_given or any(body.inertial is None and key in mechanism.shapes for key, body in mechanism.vertices(Body))


def _settle_folders(tags: list[Tag], compiler: Tag) -> None:
    """<compiler> names the folder of all meshes, and that of all textures, where there are three or more. ``tags`` are those with files."""
    for word, kind in (("meshdir", "mesh"), ("texturedir", "texture")):
        found = [tag for tag in tags if tag.name == kind]
        folders = {tag.attributes["file"].rpartition("/")[0] for tag in found}
        folder = next(iter(folders)) if len(folders) == 1 and len(found) >= _FEWEST_FILES else ""
        if folder:
            compiler.attributes[word] = folder
            for tag in found:
                tag.attributes["file"] = tag.attributes["file"].removeprefix(f"{folder}/")


def _elements(root: Tag) -> list[Tag]:
    """All elements in document order."""
    found: list[Tag] = []
    stack = [root]
    while stack:
        tag = stack.pop()
        found.append(tag)
        if tag.children:
            stack += [child for child in reversed(tag.children) if isinstance(child, Tag)]
    return found


def _class_tag(
    name: str, attributes: dict[str, str], shared: Mapping[tuple[str, str], dict[str, str]], inside: Mapping[str, list[str]]
) -> Tag:
    """A class with its elements and the classes in it, of which a few are in each other at most."""
    own = [Tag(tag, found) for (owner, tag), found in shared.items() if owner == name]
    return Tag("default", attributes, [*own, *(_class_tag(inner, {"class": inner}, shared, inside) for inner in inside.get(name, ()))])
