"""Differences between a robot and what was written of it that are none, because <gazebo> fragments say the same as elements of SDF."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.backends.sdf.gazebo import Fields, extras_of
from hymeko_x.backends.sdf.joints import joint_tag
from hymeko_x.backends.sdf.sensors import joint_sensor_tag, sensor_tag
from hymeko_x.backends.sdf.sheet import SdfSheet
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import fragments
from hymeko_x.formats.sdf.notations import is_from_sdf
from hymeko_x.ir.mechanism import ROOT, WORLD, Id
from hymeko_x.ir.parts import Joint
from hymeko_x.xml.printing import ready
from hymeko_x.xml.text import unescaped
from hymeko_x.xml.tree import XmlNode

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from hymeko_x.compare.diff import Difference
    from hymeko_x.ir.mechanism import Extra, Mechanism

_SDF = f"{words.FORMAT} "
_WORLD = "world/"
_ITSELF = "."
_SENSORS = ("sensor", "camera")
_IN_MODEL = ("joint", "loop", "body", "frame")
_FRAGMENT = f"<{fragments.TAG}"
_TOKEN = re.compile(r"<!--.*?-->|<(/?)([^\s/>]+)([^>]*?)(/?)>|([^<]+)", re.DOTALL)
_ATTRIBUTE = re.compile(r"""([^\s=]+)\s*=\s*(?:"([^"]*)"|'([^']*)')""")


def held(mechanism: Mechanism, image: Mechanism) -> Callable[[Difference], bool]:
    """Whether a difference from ``mechanism`` to ``image``, of which one came from SDF, is in the fragments that the other one has."""
    given = [] if is_from_sdf(mechanism) == is_from_sdf(image) else [*_given(image if is_from_sdf(mechanism) else mechanism)]
    if not given:
        return lambda _: False
    return _held_in_fragments(given, mechanism) if is_from_sdf(mechanism) else _obeyed(given, image)


def _held_in_fragments(given: list[_Given], mechanism: Mechanism) -> Callable[[Difference], bool]:
    """Whether what the image of a robot from SDF does not have is in its fragments."""
    found, sheet = _values_of(given), SdfSheet(mechanism, "")

    def is_held(difference: Difference) -> bool:
        key, field, before, _ = difference
        if before is not None and field.startswith(_SDF):
            return found.has(key, _path(field), before)
        if before is not None and not field:
            return key in mechanism.graph and any(found.has(*place) for place in _places_of(key, sheet))
        return _is_value_of(key, field, mechanism, found.fields)

    return is_held


def _places_of(key: Id, sheet: SdfSheet) -> Iterator[tuple[Id, str, str]]:
    """Where a fragment would hold a closure, a sensor or what leads to one, and as which text."""
    scope = words.split_scope(key.name)[0]
    if key.kind == "loop":
        yield ROOT, "model", ready(joint_tag(key, scope, sheet), 0)
    edge = sheet.mechanism.graph.edges.get(key)
    elements = [key] if edge is None else [arc.target for arc in edge.arcs]
    for element in (element for element in elements if element.kind in _SENSORS):
        bodies = [body for body in (sheet.places.mounts.get(element, (WORLD,))[0],) if body != WORLD]
        joints = [joint for joint, sensors in sheet.joint_sensors.items() if element in sensors]
        for view in (view for body in bodies for view in sheet.mechanism.mounts[body] if view.mounted == element):
            yield view.body, "", ready(sensor_tag(view, words.split_scope(view.body.name)[0], view.body, sheet), 0)
        for joint in joints:
            yield joint, "", ready(joint_sensor_tag(element, words.split_scope(joint.name)[0], sheet), 0)


def _obeyed(given: list[_Given], image: Mechanism) -> Callable[[Difference], bool]:
    """Whether an image from SDF has what the fragments of a robot say, so that neither they are missing nor it is new."""
    wanted, written = _values_of(given), _Values()
    for key in wanted.texts:
        for extra in image.extras.get(key, ()):
            written.add(key, extra)

    def has(key: Id, extra: Extra) -> bool:
        kinds = _SENSORS if extra.text.startswith("<sensor") else _IN_MODEL if key == ROOT else ()
        return any(Id(kind, _name_in(key, extra.text)) in image.graph for kind in kinds) or written.has(key, extra.path, extra.text)

    def is_obeyed(one: _Given) -> bool:
        is_known = bool(one.extras or one.fields) or one.tag in fragments.OBEYED
        return (
            is_known and all(_is_value_of(*place, image, wanted.fields) for place in one.fields) and all(has(*pair) for pair in one.extras)
        )

    lost = {one.fragment for one in given if not is_obeyed(one)}

    def is_held(difference: Difference) -> bool:
        key, field, before, after = difference
        if before is not None and before.startswith(_FRAGMENT):
            return before not in lost
        if after is not None and field.startswith(_SDF):
            return wanted.has(key, _path(field), after)
        if before is None and not field:
            return any(Id(kind, key.name) in wanted.texts for kind in _SENSORS if key.kind in (kind, "mount"))
        return _is_value_of(key, field, image, wanted.fields)

    return is_held


def _path(field: str) -> str:
    """The path that the name of a field of extras has behind the format."""
    path = field.removeprefix(_SDF)
    return "" if path == "content" else path.removeprefix(_WORLD)


def _is_value_of(key: Id, field: str, mechanism: Mechanism, fields: Fields) -> bool:
    """Whether a field of a joint's only dof or of a shape has in the fragments the value that it has in the mechanism."""
    name = field.removeprefix("dofs[0].")
    edge = mechanism.graph.edges.get(key) if (key, name) in fields else None
    if edge is None:
        return False
    if isinstance(edge.data, Joint):
        return len(edge.data.dofs) == 1 and bool(getattr(edge.data.dofs[0], name) == fields[key, name])
    return bool(getattr(edge.data, name) == fields[key, name])


# ---- what fragments give ---------------------------------------------------------------------------------------------------------


class _Given(NamedTuple):
    """What an element of a fragment gives to a robot: extras, and values of joints and shapes."""

    fragment: str
    tag: str
    extras: list[tuple[Id, Extra]]
    fields: Fields


def _given(mechanism: Mechanism) -> Iterator[_Given]:
    """What each element of each fragment of a mechanism gives."""
    for text in (extra.text for extra in mechanism.extras.get(ROOT, ()) if extra.text.startswith(_FRAGMENT)):
        fragment = fragments.parsed(text)
        if fragment is None:
            continue
        for child in (child for child in fragment.children if child.is_element):
            fields: Fields = {}
            alone = XmlNode(fragments.TAG, fragment.attributes, children=[child])
            yield _Given(text, child.tag, [*extras_of(alone, mechanism, fields)], fields)


def _values_of(given: list[_Given]) -> _Values:
    found = _Values()
    for one in given:
        found.fields.update(one.fields)
        for key, extra in one.extras:
            found.add(key, extra)
    return found


class _Values:
    """What extras hold, by element of the mechanism and with its path; and values of joints and shapes."""

    def __init__(self) -> None:
        self.fields: Fields = {}
        self.texts: dict[Id, list[tuple[str, str]]] = {}
        self._elements: dict[Id, set[tuple[str, str]]] = {}

    def add(self, key: Id, extra: Extra) -> None:
        """Take in an extra of an element; a sensor or the closure of a loop is an element of its own."""
        path, text = extra.path.removeprefix(_WORLD), extra.text
        self.texts.setdefault(key, []).append((path, text))
        own = ("loop",) if key == ROOT and text.startswith("<joint") else _SENSORS if text.startswith("<sensor") else ()
        for kind in own:
            self.texts.setdefault(Id(kind, _name_in(key, text)), []).append((_ITSELF, text))

    def has(self, key: Id, path: str, text: str) -> bool:
        """Whether an extra of an element is there, as a whole or in parts."""
        if key not in self.texts or (path, text) in self.texts[key]:
            return key in self.texts
        if not text.startswith("<"):
            return (path, text) in self._elements_of(key)
        known, elements, place = self._elements_of(key), _elements(text), 0
        while place < len(elements):
            inner, content, below = elements[place]
            if (_below(path, inner), content) in known:
                place += abs(below)
            elif below <= 0:
                return False
            place += 1
        return True

    def _elements_of(self, key: Id) -> set[tuple[str, str]]:
        """The elements and attributes that the extras of an element consist of."""
        found = self._elements.get(key)
        if found is None:
            found = self._elements[key] = set()
            for path, text in self.texts[key]:
                found.update((_below(path, inner), content) for inner, content, _ in _elements(text))
        return found


def _below(path: str, inner: str) -> str:
    """A path in an extra as one in the element of the mechanism, which the extra itself may be."""
    return inner.partition("/")[2] if path == _ITSELF else f"{path}/{inner}".lstrip("/")


def _name_in(key: Id, text: str) -> str:
    """The name of the element that a text begins with, in the model of an element of the mechanism."""
    start = _TOKEN.match(text)
    names = {name: a or b for name, a, b in _ATTRIBUTE.findall(start[3])} if start is not None else {}
    return words.split_scope(key.name)[0] + unescaped(names.get("name", ""))


@lru_cache(1024)
def _elements(text: str) -> tuple[tuple[str, str, int], ...]:
    """The elements of a piece of XML and their attributes, outer ones first: path, content, and how many of them are below each.

    That number is negative for an element that is more than its elements. The content is without layout, comments and declared namespaces.
    """
    found: list[tuple[str, str, int]] = []
    tokens: list[str] = []
    around: list[tuple[str, int, int]] = []
    for close, name, between, empty, text_inside in _TOKEN.findall(text):
        if text_inside:
            tokens += [inside] if (inside := " ".join(text_inside.split())) else []
        elif name and not close:
            path = f"{around[-1][0]}/{name}" if around else name
            pairs = sorted((name, a or b) for name, a, b in _ATTRIBUTE.findall(between) if not name.startswith("xmlns")) if between else ()
            around.append((path, len(found), len(tokens)))
            tokens.append(f"<{name} {pairs}" if pairs else f"<{name}")
            found += [(path, "", 0), *((f"{path}/@{name}", unescaped(value), 0) for name, value in pairs)]
        if (close or empty) and around:
            path, place, first = around.pop()
            tokens.append(">")
            below = len(found) - place - 1
            is_more = len(tokens) - first > 2 and not tokens[first + 1].startswith("<")
            found[place] = path, "\n".join(tokens[first:]), -below if is_more or " " in tokens[first] else below
    return tuple(found)
