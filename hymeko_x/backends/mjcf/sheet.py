"""The open MJCF document: settings and classes, the names of elements, the attributes of one element, and the printing of all.

A mechanism that came from MJCF is written as its author wrote it: with the classes, sections and notations of its file. Every other
one is the simple case: angles in radians, every element named, and the classes of :mod:`hymeko_x.backends.mjcf.classes`.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, TypeVar
from xml.parsers.expat import ExpatError

from msgspec import Struct, field

from hymeko_x.formats.mjcf import words
from hymeko_x.formats.mjcf.classes import Classes, merge
from hymeko_x.formats.mjcf.codec import BadAttribute, Settings, parameter_text, parameter_value, undone
from hymeko_x.formats.mjcf.inherited import InheritedValues
from hymeko_x.formats.mjcf.schema import attributes_of, kinds_of
from hymeko_x.formats.mjcf.tree import COMMENT, parse_text
from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.kinematics import dof_number
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import Joint, Mesh, Shape, Texture
from hymeko_x.source import file_stem
from hymeko_x.xml.printing import Tag

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from hymeko_x.formats.mjcf.codec import AttributeGroup
    from hymeko_x.ir.mechanism import Extra, Id, Mechanism, RobotArc
    from hymeko_x.ir.notations import Notation
    from hymeko_x.ir.parts import Dof, Parameters
    from hymeko_x.xml.tree import XmlNode

T = TypeVar("T")

Attributes = dict[str, str | None]
"""The attributes of an element in the order of printing; None is not printed."""

_EMPTY: Mapping[str, str] = {}
_SIGNED_ZERO = re.compile(r"-0(?!\S)(?<!\S-0)")
"""A zero with a sign. It begins with its letters, by which a search finds it faster than by what may not stand before them."""
_REFERENCES = frozenset(("mesh", "material", "texture"))
_PLAIN: Mapping[str, str] = {
    "body": "body",
    "shape": "body/geom",
    "joint": "body/joint",
    "frame": "body/site",
    "coupling": "equality/joint",
}
"""The places in the schema of elements of which a number or a word of MJCF stands for itself, by the kinds of elements."""
_NAMED_APART = frozenset(("mesh", "texture"))
"""The kinds of elements that have a name beside that of their id."""
_OF_ROOTS = frozenset(("mocap", "sleep"))
"""The words that only bodies right in the world have."""


class MjcfSheet(Struct):
    """The document, its settings and its classes. ``kept``: the sections and comments at top level that are written as they were."""

    mechanism: Mechanism
    root: Tag
    from_mjcf: bool
    settings: Settings
    classes: Classes
    kept: list[tuple[str, Extra]] = field(default_factory=list)
    rank: Mapping[Id, int] = field(default_factory=dict)
    inherited: InheritedValues = field(default_factory=InheritedValues)

    # ---- names -----------------------------------------------------------------------------------------------------------

    def name(self, key: Id) -> str | None:
        """The name to print; None for an element of a file in MJCF that its author left unnamed."""
        part = self.mechanism.graph.vertices.get(key) if key.kind in _NAMED_APART else None
        if isinstance(part, Mesh | Texture) and part.name:
            return part.name
        if not self.from_mjcf:
            return key.name
        if isinstance(part, Mesh) and part.uri and file_stem(part.uri) == key.name:
            return None
        return None if self.mechanism.notation(key, UNNAMED) else key.name

    def reference(self, arc: RobotArc) -> str:
        """The name by which others refer to an element, or to the dof of a joint that the arc means."""
        key = arc.target
        if key.kind == "joint":
            dof = self.dof(arc)
            return (dof.name if dof else None) or (arc.role if dof is None else "") or key.name
        if key.kind == "shape":
            edge = self.mechanism.graph.edges.get(key)
            return (edge.data.name if edge is not None and isinstance(edge.data, Shape) else None) or key.name
        part = self.mechanism.graph.vertices.get(key)
        return (part.name if isinstance(part, Mesh | Texture) else None) or key.name

    def dof(self, arc: RobotArc) -> Dof | None:
        """The dof that an arc to a joint means; None where the joint is fixed."""
        edge = self.mechanism.graph.edges.get(arc.target)
        if edge is None or not isinstance(edge.data, Joint) or not edge.data.dofs:
            return None
        return edge.data.dofs[dof_number(edge.data, arc.role) or 0]

    # ---- what the author wrote ---------------------------------------------------------------------------------------------

    def base(self, tag: str, own_class: str | None, childclass: str | None = None) -> Mapping[str, str]:
        """What an element inherits."""
        return self.classes.of(tag, own_class or childclass)

    def own_class(self, key: Id, number: int = 0) -> str | None:
        """The class that the element's author gave it; of a joint, that of one dof."""
        found = self.mechanism.stereotypes.get(key, ()) if self.from_mjcf else ()
        name = found[number] if number < len(found) else ""
        return name if name and self.classes.has(name) else None

    def note(self, key: Id, notation: Notation[T]) -> T | None:
        """How the author wrote something of the element in MJCF, or None."""
        return self.mechanism.notation(key, notation) if self.from_mjcf else None

    def notations(self, key: Id) -> Mapping[str, str]:
        """The attributes and the rest that the author wrote in MJCF in another way than the writer does, by the names of the notations."""
        return self.mechanism.notations.get(key, _EMPTY) if self.from_mjcf else _EMPTY

    def extras(self, key: Id) -> tuple[Extra, ...]:
        """The extras of an element that are written: all of a robot from MJCF, and of meshes and textures.

        Of others, as of a hand from MJCF on an arm from URDF, only numbers and words of MJCF, which mean the same without their file.
        """
        found = self.mechanism.extras.get(key, ())
        if not found or self.from_mjcf or key.kind in _NAMED_APART:
            return found
        own = [extra for extra in found if extra.format == words.NAME]
        if not own:
            return ()
        known = kinds_of(_PLAIN.get(key.kind, "")).keys() - _OF_ROOTS
        return tuple([extra for extra in own if extra.path.rpartition("@")[2] in known])

    def kept_attributes(self, key: Id, path: str = "") -> dict[str, str]:
        """The attributes that the IR cannot represent, of the element's node at this path."""
        if key not in self.mechanism.extras:
            return {}
        start = f"{path}/@" if path else "@"
        own = [extra for extra in self.extras(key) if extra.format == words.NAME and extra.path.startswith(start)]
        return {extra.path.removeprefix(start): extra.text for extra in own}

    def inside(self, key: Id, path: str = "") -> list[str]:
        """The elements and comments that stand inside an element, as they are."""
        if key not in self.mechanism.extras:
            return []
        found = [extra for extra in self.extras(key) if extra.path == path and extra.format in (words.NAME, "comment")]
        return [_line_of(extra) for extra in sorted(found, key=lambda extra: extra.index)]

    # ---- attributes --------------------------------------------------------------------------------------------------------

    def attributes(
        self,
        values: Mapping[str, Any],
        groups: tuple[AttributeGroup, ...],
        base: Mapping[str, str],
        notations: Mapping[str, str],
        kept: dict[str, str],
        prefix: str = "",
    ) -> dict[str, str]:
        """The attributes of these values that the class does not give, as the author wrote them where that still means the same."""
        found: dict[str, str] = {}
        start = f"{prefix}@"
        written = {name.removeprefix(start): text for name, text in notations.items() if name.startswith(start)} if notations else {}
        for group, inherited in self.inherited.of(groups, base, self.settings):
            value, needs = values[group.key], group.needs
            context = _chosen({**kept, **found}, needs) if needs and not (needs.isdisjoint(found) and needs.isdisjoint(kept)) else _EMPTY
            if written and (noted := _chosen(written, group.names)) and self._means(group, merge({**base, **context}, noted), value):
                found |= noted
            elif not (self._means(group, {**base, **context}, value) if context else group.same(inherited, value)):
                texts = group.write(value, self.settings)
                found |= _others({**texts, **undone(group, base, texts)}, base) if base else texts
        return found if self.from_mjcf else _unsigned(found)

    def _means(self, group: AttributeGroup, attributes: Mapping[str, str], value: Any) -> bool:
        try:
            return group.same(group.read(attributes, self.settings), value)
        except BadAttribute:
            return False

    def numbers(self, values: tuple[float, ...]) -> str:
        """The text of these numbers."""
        text = numbers_text(values)
        return text if self.from_mjcf else _SIGNED_ZERO.sub("0", text)

    def parameters(self, parameters: Parameters, path: str, base: Mapping[str, str]) -> dict[str, str]:
        """The parameters that are attributes of the element of this place of the schema, as far as its class does not give them."""
        known = attributes_of(path)
        return {
            name: parameter_text(value)
            for name, value in parameters
            if name in known and (name not in base or parameter_value(name, base[name]) != value)
        }

    # ---- sections ----------------------------------------------------------------------------------------------------------

    def section(self, tag: str, attributes: Mapping[str, str] = _EMPTY) -> Tag:
        """A new section at the end of the document, behind an empty line."""
        section = Tag(tag, dict(attributes))
        self.root.children += "", section
        return section

    def lines_in(self, section: str) -> list[tuple[int, str]]:
        """What stands in a section and is written as it is, with its place among all elements."""
        found = [extra for extra in self.extras(ROOT) if extra.path == section and extra.format in (words.NAME, "comment")]
        return [(extra.index, _line_of(extra)) for extra in sorted(found, key=lambda extra: extra.index)]

    def write_section(self, section: str, items: list[tuple[Id, Tag]]) -> None:
        """A section: its elements in order, and between them what is written as it is."""
        rest = list(reversed(self.lines_in(section)))
        if not items and not rest:
            return
        children = self.section(section).children
        for key, tag in items:
            while rest and rest[-1][0] <= self.rank.get(key, 0):
                children.append(rest.pop()[1])
            children.append(tag)
        children += [line for _, line in reversed(rest)]

    def write_kept(self, section: str) -> None:
        """The sections of this name that are written as they are, each behind the comments before it; for ``""`` all that is left."""
        if not self.kept:
            return
        waiting: list[tuple[str, Extra]] = []
        left: list[tuple[str, Extra]] = []
        for tag, extra in self.kept:
            waiting.append((tag, extra))
            if tag == COMMENT:
                continue
            if section in ("", tag):
                self._keep(waiting)
            else:
                left += waiting
            waiting = []
        if section:
            left += waiting
        else:
            self._keep(waiting)
        self.kept = left

    def _keep(self, items: list[tuple[str, Extra]]) -> None:
        for _, extra in items:
            tag = _as_tag(extra)
            self.root.children += [tag] if isinstance(tag, str) else ["", tag]


def _unsigned(attributes: dict[str, str]) -> dict[str, str]:
    """Attributes with numbers without the sign of a zero, which only robots from MJCF keep."""
    texts = " ".join(attributes.values())
    if "-0" not in texts or _SIGNED_ZERO.search(texts) is None:
        return attributes
    return {name: text if name in _REFERENCES else _SIGNED_ZERO.sub("0", text) for name, text in attributes.items()}


def _others(attributes: Mapping[str, str], base: Mapping[str, str]) -> dict[str, str]:
    """The attributes that a class does not give in the same way."""
    return {name: text for name, text in attributes.items() if base.get(name) != text}


def _chosen(attributes: Mapping[str, str], names: Iterable[str]) -> dict[str, str]:
    """The attributes of these names that are there."""
    return {name: attributes[name] for name in names if name in attributes}


def open_sheet(mechanism: Mechanism, others: Classes) -> MjcfSheet:
    """An empty document with the mechanism's own settings and classes; with ``others`` where it did not come from MJCF."""
    if not words.from_mjcf(mechanism):
        root = Tag(
            "mujoco", {"model": mechanism.name} if mechanism.name else {}, [Tag("compiler", {"angle": "radian", "autolimits": "true"})]
        )
        return MjcfSheet(
            mechanism, root, False, Settings(degree=False, eulerseq="XYZ", plain_turns=True), others, [*_sections_for_all(mechanism)]
        )
    own = [extra for extra in mechanism.extras.get(ROOT, ()) if extra.format in (words.NAME, "comment")]
    kept = {extra.path[1:]: extra.text for extra in own if extra.format == words.NAME and extra.path[:1] == "@"}
    name = {} if mechanism.notation(ROOT, UNNAMED) else {"model": mechanism.name}
    standing = sorted([extra for extra in own if not extra.path], key=lambda extra: extra.index)
    nodes = [_parsed(extra) for extra in standing]
    tags = [COMMENT if extra.format == "comment" else "" if node is None else node.tag for extra, node in zip(standing, nodes, strict=True)]
    sections = [node for node in nodes if node is not None]
    settings = words.settings_of([node.attributes for node in sections if node.tag == "compiler"])
    classes = Classes([node for node in sections if node.tag == "default"])
    rank = _ranks(mechanism, {extra.index for extra in standing})
    return MjcfSheet(mechanism, Tag("mujoco", name | kept), True, settings, classes, list(zip(tags, standing, strict=True)), rank)


def _sections_for_all(mechanism: Mechanism) -> Iterator[tuple[str, Extra]]:
    """The sections that a robot from elsewhere was given for MuJoCo, with their tags; its angles and classes are the writer's own."""
    for extra in mechanism.extras.get(ROOT, ()):
        node = _parsed(extra) if extra.format == words.NAME and not extra.path else None
        if node is not None and node.tag in words.KEPT_SECTIONS and node.tag not in ("compiler", "default"):
            yield node.tag, extra


def tag_of(name: str, attributes: Attributes, children: Iterable[Tag | str] = (), owner: Id | None = None) -> Tag:
    """An element with the attributes that are not None. ``owner``: the element of the mechanism whose name a class may be called after."""
    tag = Tag(name, {attribute: text for attribute, text in attributes.items() if text is not None}, children)
    tag.owner = owner
    return tag


def _ranks(mechanism: Mechanism, taken: set[int]) -> dict[Id, int]:
    """The place of every element among everything that stands at top level."""
    found: dict[Id, int] = {}
    place = 0
    for key in mechanism.layout:
        while place in taken:
            place += 1
        found[key] = place
        place += 1
    return found


def _parsed(extra: Extra) -> XmlNode | None:
    if extra.format == "comment":
        return None
    try:
        return parse_text(extra.text)
    except ExpatError:
        return None


def _line_of(extra: Extra) -> str:
    return f"<!-- {extra.text} -->" if extra.format == "comment" else extra.text


def _as_tag(extra: Extra) -> Tag | str:
    """A section or comment that is written as it was."""
    node = _parsed(extra)
    if node is None:
        return _line_of(extra)
    top = Tag(node.tag, node.attributes)
    stack = [(node, top)]
    while stack:
        element, tag = stack.pop()
        for child in element.children:
            if child.tag == COMMENT:
                tag.children.append(f"<!-- {child.text} -->")
            else:
                inner = Tag(child.tag, child.attributes)
                tag.children.append(inner)
                stack.append((child, inner))
    return top
