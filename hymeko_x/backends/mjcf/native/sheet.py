"""What the writers of all sections need: settings and classes of the file, names, and the attributes of an element."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any
from xml.parsers.expat import ExpatError

from hymeko_x.backends.mjcf.text import Text
from hymeko_x.formats.mjcf import words
from hymeko_x.formats.mjcf.classes import Classes, merge
from hymeko_x.formats.mjcf.codec import BadAttribute, plan_of
from hymeko_x.formats.mjcf.places import same_value
from hymeko_x.formats.mjcf.tree import parse_text
from hymeko_x.ir.mechanism import ROOT, file_stem
from hymeko_x.ir.parts import Joint, Mesh, Shape, Texture

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.backends.mjcf.text import Attributes
    from hymeko_x.formats.mjcf.codec import Group, Plan, Settings
    from hymeko_x.formats.mjcf.tree import Element
    from hymeko_x.ir.mechanism import Extra, Id, Mechanism, RobotArc

_NO_NOTES: Mapping[str, str] = {}
_REFUSED = object()
"""Is no value."""


@dataclass(slots=True)
class Sheet:
    """The text so far, and what the printed file says about itself."""

    mechanism: Mechanism
    text: Text = field(default_factory=Text)
    aside: list[tuple[str, Extra]] = field(default_factory=list)
    settings: Settings = field(init=False)
    classes: Classes = field(init=False)
    rank: dict[Id, int] = field(default_factory=dict)
    plans: dict[tuple[int, int], Plan] = field(default_factory=dict)

    def __post_init__(self) -> None:
        standing = sorted(
            (extra for extra in self.mechanism.extras.get(ROOT, ()) if not extra.path and extra.format in (words.NAME, "comment")),
            key=lambda extra: extra.index,
        )
        nodes: list[Element] = []
        for extra in standing:
            node = _parsed(extra)
            self.aside.append(("#comment" if extra.format == "comment" else "" if node is None else node.tag, extra))
            nodes += [node] if node is not None else []
        self.rank = _ranks(self.mechanism, [extra.index for extra in standing])
        self.settings = words.settings_of([node.attributes for node in nodes if node.tag == "compiler"])
        self.classes = Classes([node for node in nodes if node.tag == "default"])

    # ---- names -----------------------------------------------------------------------------------------------------------

    def name(self, key: Id) -> str | None:
        """The name to print; None for what its author left unnamed."""
        part = self.mechanism.graph.vertices.get(key)
        if isinstance(part, Mesh | Texture) and part.name:
            return part.name
        if isinstance(part, Mesh) and part.uri and file_stem(part.uri) == key.name:
            return None
        return None if self.mechanism.notation(key, "unnamed") else key.name

    def reference(self, arc: RobotArc) -> str:
        """The name by which others refer to an element, or to the dof of a joint that the arc means."""
        key = arc.target
        if key.kind == "joint":
            edge = self.mechanism.graph.edges.get(key)
            if edge is not None and isinstance(edge.data, Joint) and len(edge.data.dofs) == 1:
                return edge.data.dofs[0].name or key.name
            return arc.role or key.name
        if key.kind == "shape":
            edge = self.mechanism.graph.edges.get(key)
            return (edge.data.name if edge is not None and isinstance(edge.data, Shape) else None) or key.name
        part = self.mechanism.graph.vertices.get(key)
        if isinstance(part, Mesh | Texture):
            return part.name or key.name
        return key.name

    # ---- attributes --------------------------------------------------------------------------------------------------------

    def base(self, tag: str, own_class: str | None, childclass: str | None = None) -> Mapping[str, str]:
        """What an element inherits."""
        return self.classes.of(tag, own_class or childclass)

    def own_class(self, key: Id) -> str | None:
        """The class that the element's author gave it."""
        found = self.mechanism.stereotypes.get(key)
        return found[0] if found and found[0] and self.classes.has(found[0]) else None

    def notes(self, key: Id) -> Mapping[str, str]:
        """How the author wrote the element."""
        return self.mechanism.notations.get(key, _NO_NOTES)

    def said(self, key: Id, path: str = "") -> dict[str, str]:
        """The attributes that MJCF alone has a word for, by the path of the node they stand on."""
        own = self.mechanism.extras.get(key)
        if not own:
            return {}
        start = f"{path}/@" if path else "@"
        return {extra.path.removeprefix(start): extra.text for extra in own if extra.format == words.NAME and extra.path.startswith(start)}

    def inside(self, key: Id, path: str = "") -> list[str]:
        """The elements and comments that stand inside an element, as they are."""
        found = [extra for extra in self.mechanism.extras.get(key, ()) if extra.path == path and extra.format in (words.NAME, "comment")]
        return [_line_of(extra) for extra in sorted(found, key=lambda extra: extra.index)]

    def attributes(
        self,
        values: Mapping[str, Any],
        groups: tuple[Group, ...],
        base: Mapping[str, str],
        notes: Mapping[str, str],
        said: Mapping[str, str],
        prefix: str = "",
    ) -> dict[str, str]:
        """The attributes that say what the class does not, in their author's way where it still says the same."""
        found: dict[str, str] = {}
        inherited = self._inherited(groups, base)
        start = f"{prefix}@"
        written = {name.removeprefix(start): text for name, text in notes.items() if name.startswith(start)}
        for group in groups:
            value = values[group.key]
            context = {name: text for name in group.needs if (text := found.get(name) or said.get(name)) is not None} if group.needs else {}
            below = {**base, **context} if context else base
            noted = {name: written[name] for name in group.names if name in written} if written else {}
            if noted and self._means(group, merge(below, noted), value):
                found |= noted
            elif not (self._means(group, below, value) if context else same_value(inherited.get(group.key, _REFUSED), value)):
                new = group.write(value, self.settings)
                found |= {name: text for name, text in new.items() if base.get(name) != text}
        return found

    def _inherited(self, groups: tuple[Group, ...], base: Mapping[str, str]) -> Mapping[str, Any]:
        """What an element is that says nothing itself; without the values that MuJoCo would refuse."""
        place = id(groups), id(base) if base else 0
        plan = self.plans.get(place)
        if plan is None:
            plan = self.plans[place] = plan_of(groups, self.settings, base)
        return plan.silent

    def _means(self, group: Group, said: Mapping[str, str], value: Any) -> bool:
        try:
            return same_value(group.read(said, self.settings), value)
        except BadAttribute:
            return False

    def element(self, tag: str, attributes: Attributes, inside: list[str]) -> None:
        """Print an element with what stands in it."""
        if not inside:
            self.text.leaf(tag, attributes)
            return
        self.text.open(tag, attributes)
        for line in inside:
            self.text.raw(line)
        self.text.close()


def _ranks(mechanism: Mechanism, standing: list[int]) -> dict[Id, int]:
    """The place of every element among everything that stands at top level."""
    found: dict[Id, int] = {}
    place = 0
    taken = set(standing)
    for key in mechanism.layout:
        while place in taken:
            place += 1
        found[key] = place
        place += 1
    return found


def _parsed(extra: Extra) -> Element | None:
    if extra.format == "comment":
        return None
    try:
        return parse_text(extra.text)
    except ExpatError:
        return None


def _line_of(extra: Extra) -> str:
    return f"<!-- {extra.text} -->" if extra.format == "comment" else extra.text


def write_aside(sheet: Sheet, section: str) -> None:
    """The sections of this name that go along as they are, each behind the comments before it; for ``""`` all that is left."""
    waiting: list[tuple[str, Extra]] = []
    left: list[tuple[str, Extra]] = []
    for tag, extra in sheet.aside:
        waiting.append((tag, extra))
        if tag == "#comment":
            continue
        if section in ("", tag):
            _print(sheet, waiting)
        else:
            left += waiting
        waiting = []
    if section:
        left += waiting
    else:
        _print(sheet, waiting)
    sheet.aside = left


def _print(sheet: Sheet, items: list[tuple[str, Extra]]) -> None:
    for tag, extra in items:
        node = None if tag == "#comment" else _parsed(extra)
        if node is None:
            sheet.text.raw(_line_of(extra))
        else:
            sheet.text.tree(node)


def section_lines(sheet: Sheet, section: str) -> list[tuple[int, str]]:
    """What stands in a section and goes along as it is, with its place among all elements."""
    found = [extra for extra in sheet.mechanism.extras.get(ROOT, ()) if extra.path == section and extra.format in (words.NAME, "comment")]
    return [(extra.index, _line_of(extra)) for extra in sorted(found, key=lambda extra: extra.index)]


def write_section(sheet: Sheet, section: str, items: list[tuple[Id, str, Attributes, list[str]]]) -> None:
    """A section: its elements in order, and between them what goes along as it is."""
    rest = list(reversed(section_lines(sheet, section)))
    if not items and not rest:
        return
    sheet.text.section(section)
    for key, tag, attributes, inside in items:
        while rest and rest[-1][0] <= sheet.rank.get(key, 0):
            sheet.text.raw(rest.pop()[1])
        sheet.element(tag, attributes, inside)
    for _, line in reversed(rest):
        sheet.text.raw(line)
    sheet.text.close()
