"""The builder of a URDF robot, and the readers of what several elements contain: names, poses and numbers."""

from __future__ import annotations

from collections import Counter
from enum import Enum
from typing import TYPE_CHECKING, Any, TypeVar

from msgspec import Struct, field

from hymeko_x import codes
from hymeko_x.formats import urdf as words
from hymeko_x.formats.urdf import notations
from hymeko_x.ir.builder import Builder
from hymeko_x.ir.mechanism import ROOT, Provenance
from hymeko_x.ir.values import IDENTITY, NO_ROTATION, ZERO, Pose, pose, pose_from_rpy
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.diagnostics import Code, Origin, Report
    from hymeko_x.ir.mechanism import Extra, Id, Mechanism
    from hymeko_x.ir.notations import Notation
    from hymeko_x.ir.parts import Rgba
    from hymeko_x.ir.values import Vec3
    from hymeko_x.xml.tree import XmlNode
    from hymeko_x.xml.unread import Unread

E = TypeVar("E", bound=Enum)


class MaterialDefinition(Struct):
    """A material as far as it is known: colour, texture, and where in the file it is defined and used."""

    id: Id
    rgba: Rgba | None = None
    texture: str | None = None
    at_robot: bool = False
    inline: int = 0
    uses: int = 0
    first_use: Origin | None = None

    @property
    def is_empty(self) -> bool:
        """Whether it has neither colour nor texture."""
        return self.rgba is None and self.texture is None


class UrdfBuilder(Builder):
    """A URDF robot so far; ``links`` and ``joints`` by the names in the file, first one wins."""

    report: Report
    unread: Unread
    links: dict[str, Id] = field(default_factory=dict)
    joints: dict[str, Id] = field(default_factory=dict)
    meshes: dict[tuple[str, tuple[float, ...]], Id] = field(default_factory=dict)
    textures: dict[str, Id] = field(default_factory=dict)
    materials: dict[str, list[MaterialDefinition]] = field(default_factory=dict)
    actuators: dict[str, Id] = field(default_factory=dict)
    drives: dict[str, Id] = field(default_factory=dict)
    choices: dict[Notation[Any], dict[Id, Enum]] = field(default_factory=dict)
    habits: list[tuple[str, bool, Id]] = field(default_factory=list)
    usual: dict[Notation[Any], Enum] = field(default_factory=dict)
    version: str = "1.0"

    def own(self, node: XmlNode, kind: str, name: str) -> Id:
        """A fresh id for a node, whose unread content belongs to it from now on."""
        node.owner = key = self.fresh(kind, name, node.origin)
        return key

    def warn(self, code: Code, node: XmlNode, message: str) -> None:
        """Report something odd about a node, and how it is read."""
        self.report.warn(code, message, node.origin, element=node.element)

    def error(self, code: Code, node: XmlNode, message: str) -> None:
        """Report something wrong about a node, and what is used instead."""
        self.report.error(code, message, node.origin, element=node.element)

    def choose(self, key: Id, choice: Notation[E], value: E) -> None:
        """Keep which of several ways of writing the author chose, where most elements of a file choose alike."""
        self.choices.setdefault(choice, {})[key] = value

    def _settle_choices(self) -> None:
        """The usual choice becomes part of the style, the others are noted at their elements."""
        for choice, made in self.choices.items():
            usual = Counter(made.values()).most_common(1)[0][0]
            if usual != notations.USUAL[choice]:
                self.usual[choice] = usual
            for key, value in made.items():
                if value != usual:
                    self.note(key, choice, value)

    def follow(self, key: Id, habit: str, *, follows: bool) -> None:
        """Keep whether an element with a default value follows a habit."""
        self.habits.append((habit, follows, key))

    def _settle_habits(self) -> frozenset[str]:
        """The habits that most elements follow; those that do otherwise get a note."""
        votes = Counter([(habit, follows) for habit, follows, _ in self.habits])
        found = frozenset(habit for habit, follows in votes if follows and votes[habit, True] > votes[habit, False])
        otherwise: dict[Id, list[str]] = {}
        for habit, follows, key in self.habits:
            if follows != (habit in found):
                otherwise.setdefault(key, []).append(habit)
        for key, habits in otherwise.items():
            self.note(key, notations.OTHERWISE, tuple(sorted(habits)))
        return found

    def close(self, node: XmlNode) -> None:
        """Collect what is unread in a top-level element, and report children that it may have only once."""
        for member in self.unread.close(node):
            for child in member.unread_children():
                if child.tag in words.SINGLE and member.has_taken(child.tag):
                    message = f"{member.subject}: <{member.tag}> contains <{child.tag}> more than once"
                    self.warn(codes.REPEATED, member, f"{message}; the first one counts, the others are kept as written")
        node.release()

    def finish(self, name: str, around: list[Extra], file: str) -> Mechanism:
        """The finished mechanism; ``around`` are the extras from before and after the root element, and ``file`` is its name."""
        self._settle_choices()
        habits = self._settle_habits()
        if habits or self.usual:
            usual = tuple((choice.name.removeprefix("urdf."), str(value.value)) for choice, value in self.usual.items())
            self.note(ROOT, notations.STYLE, notations.Style(habits, usual))
        for key, extras in self.unread.finish().items():
            self.add_extras(key, *extras)
        self.add_extras(ROOT, *around)
        self.layout.extend(self.unread.layout)
        return self.build(name, Provenance(words.FORMAT, file=file))


def take_name(node: XmlNode, kind: str, known: dict[str, Id], builder: UrdfBuilder) -> Id:
    """The id of a link, joint or transmission from its name; a name that is missing or taken is reported."""
    name = node.take("name")
    report = builder.warn if known is builder.drives else builder.error  # nothing refers to a transmission
    if not name:
        problem = f"has no name; it is called '{node.tag}'" if name is None else "has an empty name"
        report(codes.BAD_NAME, node, f"a <{node.tag}> {problem}")
    key = builder.own(node, kind, node.tag if name is None else name)
    first = known.setdefault(key.name if name is None else name, key)
    if name is not None and first != key:
        other = builder.origins[first]
        message = f"there are two <{node.tag}> called '{name}' (the other one: {other}); this one is called '{key.name}'"
        report(codes.DUPLICATE_NAME, node, message)
    return key


# ---- poses -------------------------------------------------------------------------------------------------------------------


def read_origin(node: XmlNode, key: Id, builder: UrdfBuilder, *, turned: bool = True) -> Pose:
    """The pose of the <origin> in a node of an element: position in m, fixed-axis roll-pitch-yaw in rad; the identity without one.

    ``turned`` false: there is nothing that could be turned, so that the angles stay as written.
    """
    origin, (is_written, no_xyz, no_rpy) = node.take_child("origin"), notations.origin_habits(node.tag)
    if origin is None:
        builder.follow(key, is_written, follows=False)
        return IDENTITY
    lacks_xyz, lacks_rpy = "xyz" not in origin.attributes, "rpy" not in origin.attributes
    xyz: Any = take_numbers(origin, "xyz", 3, builder, instead="0 0 0 is used") or ZERO
    unturned = not turned and read_numbers(origin.attributes.get("rpy", "")) != ZERO
    found = Pose(xyz) if unturned else _turned(origin, xyz, builder)
    is_in_place, is_unturned = found.xyz == ZERO, found.written is None and found.quat == NO_ROTATION
    if is_in_place:
        builder.follow(key, no_xyz, follows=lacks_xyz)
    if is_unturned:
        builder.follow(key, no_rpy, follows=lacks_rpy)
    if is_in_place and is_unturned:
        builder.follow(key, is_written, follows=True)
    return found


def _turned(origin: XmlNode, xyz: Vec3, builder: UrdfBuilder) -> Pose:
    rpy: Any = take_numbers(origin, "rpy", 3, builder, instead="0 0 0 is used") or ZERO
    if rpy == ZERO and builder.version != "1.0":
        quat = take_numbers(origin, "quat_xyzw", 4, builder, instead="no rotation is used")
        if quat is not None and any(quat):
            qx, qy, qz, qw = quat
            return pose(xyz, (qw, qx, qy, qz))
    return pose_from_rpy(xyz, rpy)


# ---- numbers -----------------------------------------------------------------------------------------------------------------


def take_numbers(node: XmlNode, attribute: str, count: int, builder: UrdfBuilder, *, instead: str) -> tuple[float, ...] | None:
    """The ``count`` numbers of an attribute; None when it is missing or bad.

    A bad one is reported and not taken, so that it becomes an extra and is written back as it was; ``instead`` tells what
    the caller uses (``0 is used``).
    """
    text = node.attributes.get(attribute)
    if text is None:
        return None
    numbers = read_numbers(text)
    if numbers is not None and len(numbers) == count:
        del node.attributes[attribute]
        return numbers
    _report_bad_numbers(node, attribute, count, builder, instead)
    return None


def take_each_number(node: XmlNode, attributes: Iterable[str], builder: UrdfBuilder, *, instead: str) -> list[float | None]:
    """The one number of each of these attributes; None where it is missing or bad. See :func:`take_numbers`."""
    found: list[float | None] = []
    there = node.attributes
    for attribute in attributes:
        numbers = read_numbers(there.get(attribute, ""))
        if numbers and len(numbers) == 1:
            del there[attribute]
            found.append(numbers[0])
            continue
        found.append(None)
        if attribute in there:
            _report_bad_numbers(node, attribute, 1, builder, instead)
    return found


def take_number(node: XmlNode, attribute: str, builder: UrdfBuilder, *, instead: str) -> float | None:
    """The one number of an attribute; None when it is missing or bad. See :func:`take_numbers`."""
    return take_each_number(node, (attribute,), builder, instead=instead)[0]


def _report_bad_numbers(node: XmlNode, attribute: str, count: int, builder: UrdfBuilder, instead: str) -> None:
    text = node.attributes[attribute]
    expected = "one finite number" if count == 1 else f"{count} finite numbers separated by blanks"
    is_template = "${" in text or "$(" in text
    builder.report.error(
        codes.LEFTOVER_TEMPLATE if is_template else codes.BAD_NUMBER,
        f"{node.subject}: <{node.tag} {attribute}> is '{shortened(text)}', expected {expected}; {instead}, and the text is kept as written",
        node.origin,
        element=node.element,
        hint="expand the file with xacro first" if is_template else "",
    )


def shortened(text: str, limit: int = 60) -> str:
    """A text for a message: at most ``limit`` characters."""
    return text if len(text) <= limit else text[: limit - 3] + "..."
