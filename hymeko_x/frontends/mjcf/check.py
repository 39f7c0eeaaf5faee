"""Words and values that MJCF does not have are refused, as MuJoCo refuses them."""

from __future__ import annotations

import re
from functools import lru_cache
from math import isinf
from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.formats.mjcf.classes import ANY_TURN
from hymeko_x.formats.mjcf.schema import EXCLUSIVE, REMOVED, attributes_of, children, kinds_of, schema
from hymeko_x.formats.mjcf.tree import COMMENT
from hymeko_x.frontends.mjcf.rules import complaint, limits_of, rules_of
from hymeko_x.ir.digits import number_text
from hymeko_x.source import file_stem
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from hymeko_x.diagnostics import Refusal
    from hymeko_x.formats.mjcf.schema import AttributeKind
    from hymeko_x.frontends.mjcf.builder import MjcfBuilder
    from hymeko_x.frontends.mjcf.rules import Rule
    from hymeko_x.xml.tree import XmlNode

_NUMBER = re.compile(r"[+-]?(?:(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?|0x[\da-f.]+(?:p[+-]?\d+)?|inf(?:inity)?|nan)", re.ASCII | re.IGNORECASE)
_WHOLE = re.compile(r"[+-]?\d+", re.ASCII)
_GREATEST = 2**31
_READ_ELSEWHERE = frozenset({"vertex", "face"})
_NAMED_APART: Mapping[str, str] = MappingProxyType(
    {
        "asset/hfield": "hfield",
        "custom/numeric": "numeric",
        "custom/text": "text",
        "custom/tuple": "tuple",
        "deformable/flex": "flex",
        "deformable/skin": "skin",
        "keyframe/key": "key",
        "body/frame": "frame",
        "equality/connect": "equality",
        "equality/weld": "equality",
        "equality/joint": "equality",
        "equality/tendon": "equality",
        "equality/flex": "equality",
        "equality/flexstrain": "equality",
    }
)
"""Elements of which the IR has no part, and those that share their names with such: what their names must not be twice among."""
_REFERENCES: Mapping[str, tuple[tuple[str, str], ...]] = MappingProxyType(
    {
        "body/geom": (("hfield", "hfield"),),
        "body/site": (("material", "material"), ("mesh", "mesh")),
        "body/camera": (("target", "body"),),
        "body/light": (("target", "body"), ("texture", "texture")),
        "asset/skin": (("material", "material"),),
        "asset/skin/bone": (("body", "body"),),
        "deformable/skin": (("material", "material"),),
        "deformable/skin/bone": (("body", "body"),),
        "tendon/spatial": (("material", "material"),),
        "equality/joint": (("joint1", "joint"),),
        "equality/tendon": (("tendon1", "tendon"), ("tendon2", "tendon")),
        "equality/flex": (("flex", "flex"),),
        "equality/flexstrain": (("flex", "flex"),),
    }
)
"""The attributes that refer without an arc in the IR, by the element's place, each with the kind that it refers to."""


class Reference(Struct, frozen=True):
    """An element that names another one."""

    element: XmlNode
    kind: str
    name: str


class Words(Struct, frozen=True):
    """The ``names`` of elements of which the IR has no part, by kind, with their places; ``references`` that have no arc; all ``tags``."""

    names: Mapping[tuple[str, str], Origin]
    references: list[Reference]
    tags: frozenset[str]


class _Place(Struct, frozen=True):
    """What is known of the elements of a place of the schema.

    ``filled`` are the numbers that may not be empty, ``named`` the kind that the elements' names must not be twice among.
    """

    attributes: frozenset[str]
    kinds: Mapping[str, AttributeKind]
    filled: frozenset[str]
    required: tuple[str, ...]
    exclusive: Sequence[tuple[str, ...]]
    rules: tuple[Rule, ...]
    limits: tuple[Rule, ...]
    references: tuple[tuple[str, str], ...]
    named: str | None


@lru_cache(512)
def _place_of(path: str) -> _Place:
    return _Place(
        attributes_of(path),
        MappingProxyType({name: kind for name, kind in kinds_of(path).items() if name not in _READ_ELSEWHERE}),
        frozenset(schema().filled.get(path, ())),
        schema().required.get(path, ()),
        EXCLUSIVE.get(path, ()),
        rules_of(path),
        limits_of(path),
        _REFERENCES.get(path, ()),
        _NAMED_APART.get(path),
    )


def check_words(root: XmlNode) -> Words:
    """The names and references in a tree of known words. Empty numbers are taken out: to MuJoCo they are not there.

    Raises: Refusal (HX020, HX021, HX023, HX027, HX047) at the first element, attribute or value that MuJoCo 4.0 does not know there;
        HX007 at the first count that would make MuJoCo fill the memory.
    """
    stack = [(root, "mujoco")]
    sound: set[tuple[str, ...]] = set()  # places with the names of attributes that an element may have there: most have the same ones
    names: dict[tuple[str, str], Origin] = {}
    references: list[Reference] = []
    tags: set[str] = set()
    while stack:
        element, path = stack.pop()
        place = _place_of(path)
        tags.add(element.tag)
        form = (path, *element.attributes)
        if form not in sound:
            _check_attributes(element, path, place)
        if element.attributes:
            _check_values(element, place)
        if form not in sound or len(element.attributes) + 1 < len(form):
            _check_needs(element, place)
            sound.add((path, *element.attributes))
        if place.rules and (broken := complaint(element, place.rules)) is not None:
            raise refuse(codes.BAD_NUMBER, broken, element.origin)
        if place.limits and (broken := complaint(element, place.limits)) is not None:
            raise refuse(codes.TOO_LARGE, broken, element.origin)
        if place.references:
            references += _references_of(element, place.references)
        if place.named is not None:
            _check_name(element, place.named, names)
        if element.children:
            stack += _known_children(element, path)
    return Words(names, references, frozenset(tags))


def _known_children(element: XmlNode, path: str) -> list[tuple[XmlNode, str]]:
    """The elements inside with their places in the schema, the last one first."""
    known = children().get(path, {})
    below = []
    for child in element.children:
        if child.tag == COMMENT:
            continue
        place = known.get(child.tag)
        if place is None:
            changed = REMOVED.get(f"{element.tag}/{child.tag}") or REMOVED.get(child.tag)
            raise _unknown(child, f"<{element.tag}> has no <{child.tag}>", child.tag, list(known), changed)
        below.append((child, place))
    below.reverse()
    return below


def _check_attributes(element: XmlNode, path: str, place: _Place) -> None:
    known = place.attributes
    own = element.attributes.keys()
    if not own <= known:
        for name in own:
            if name not in known and (path != "mujoco" or not (":" in name or name.startswith("xmlns"))):
                changed = REMOVED.get(f"{element.tag}@{name}")
                raise _unknown(element, f"<{element.tag}> has no attribute '{name}'", name, sorted(known), changed)
    if len(own) > 1 and len(turns := ANY_TURN & own) > 1:
        found = ", ".join(name for name in own if name in turns)
        raise refuse(codes.REPEATED, f"<{element.tag}> has more than one orientation: {found}", element.origin)


def _check_values(element: XmlNode, place: _Place) -> None:
    attributes = element.attributes
    if "plugin" in attributes and attributes["plugin"] in REMOVED:
        plugin = attributes["plugin"]
        raise refuse(codes.UNKNOWN_WORD, f"there is no plugin '{plugin}'", element.origin, hint=REMOVED[plugin])
    kinds = place.kinds
    for name, text in tuple(attributes.items()):
        kind = kinds.get(name)
        if kind is None:
            continue
        if not kind.words and not kind.whole and (numbers := read_numbers(text)) and kind.least <= len(numbers) <= kind.most:
            continue
        if not kind.words and not text.strip() and name not in place.filled:
            del attributes[name]
        elif not _fits(text, kind):
            raise refuse(codes.BAD_NUMBER, f"<{element.tag} {name}> is '{_short(text)}', expected {kind}", element.origin)
        elif not kind.words and ("x" in text or "X" in text):
            attributes[name] = _as_decimals(text)


def _check_needs(element: XmlNode, place: _Place) -> None:
    attributes = element.attributes
    for name in place.required:
        if name not in attributes:
            raise refuse(codes.MISSING_ATTRIBUTE, f"<{element.tag}> needs {name}", element.origin)
    for names in place.exclusive:
        found = [name for name in names if name in attributes]
        if len(found) > 1:
            raise refuse(codes.REPEATED, f"<{element.tag}> has {' and '.join(found)}, of which it may have one", element.origin)


_LONGEST = 1000
"""How long a whole number may be: Python reads no longer ones."""


def _fits(text: str, kind: AttributeKind) -> bool:
    if not kind.words and not text.isascii():
        return False
    if kind.words:
        return all(word in kind.words for word in text.split()) if kind.several else text in kind.words
    numbers = None if kind.whole else read_numbers(text)
    if numbers is not None:
        return kind.least <= len(numbers) <= kind.most
    words = text.split()
    return kind.least <= len(words) <= kind.most and all(map(_is_whole if kind.whole else _is_number, words))


def _is_whole(word: str) -> bool:
    return len(word) < _LONGEST and _WHOLE.fullmatch(word) is not None and abs(int(word)) < _GREATEST


def _is_number(word: str) -> bool:
    """Whether MuJoCo reads it as a number: also nan, infinities and hexadecimal ones; not one that is too large for a double."""
    if _NUMBER.fullmatch(word) is None:
        return False
    if "x" in word.lower():
        return _of_hexadecimal(word) is not None
    return not word.lstrip("+-")[0].isdigit() or not isinf(float(word))


def _of_hexadecimal(word: str) -> float | None:
    try:
        return float.fromhex(word)
    except (OverflowError, ValueError):
        return None


def _as_decimals(text: str) -> str:
    """Numbers of which some are hexadecimal, which only MuJoCo reads, as decimal ones."""
    return " ".join(number_text(float.fromhex(word)) if "x" in word.lower() else word for word in text.split())


def _short(text: str) -> str:
    return text if len(text) <= 60 else f"{text[:60]}..."


def _check_name(element: XmlNode, kind: str, names: dict[tuple[str, str], Origin]) -> None:
    name = element.attributes.get("name") or file_stem(element.attributes.get("file", ""))
    key = (kind, name)
    if not element.attributes.get("name") and not element.attributes.get("file"):
        return
    if key in names:
        raise refuse(codes.DUPLICATE_NAME, f"{kind} '{key[1]}' is defined twice; the first one: {names[key]}", element.origin)
    names[key] = element.origin


def _unknown(element: XmlNode, message: str, word: str, known: list[str], changed: str | None) -> Refusal:
    """The refusal of a word; the hint names what became of it, or what was meant."""
    from difflib import get_close_matches

    near = get_close_matches(word, known, n=2)
    hint = changed or (f"did you mean {' or '.join(near)}?" if near else "")
    return refuse(codes.UNKNOWN_WORD, message, element.origin, hint=hint)


# ---- references that have no arc -------------------------------------------------------------------------------------------------


def _references_of(element: XmlNode, attributes: tuple[tuple[str, str], ...]) -> list[Reference]:
    """What the element refers to by these attributes."""
    found = [(kind, element.attributes.get(attribute)) for attribute, kind in attributes]
    return [Reference(element, kind, name) for kind, name in found if name]


def check_references(found: Iterable[Reference], builder: MjcfBuilder) -> None:
    """Raises: Refusal (HX040) at the first one that leads nowhere."""
    for reference in found:
        if reference.kind != "body" or reference.name != "world":
            builder.find(reference.element, reference.kind, reference.name)
