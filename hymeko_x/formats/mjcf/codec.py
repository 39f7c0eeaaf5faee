"""What the attributes of MJCF elements mean, and how they are said: the same table for reader and writer.

A :class:`Group` turns the attributes that belong together into one value of the IR and back; ``seen`` is what
MuJoCo makes of them, so that two ways of saying the same can be told from two ways of saying almost the same.
"""

from __future__ import annotations

import math
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from msgspec import Struct, field

from hymeko_x.formats.mjcf.classes import ANY_TURN, TURNS
from hymeko_x.ir.values import (
    NO_ROTATION,
    ZERO,
    Pose,
    Written,
    number_text,
    numbers_text,
    pose,
)
from hymeko_x.ir.written import pose_as_written
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from hymeko_x.ir.values import Vec3

DEGREE = math.pi / 180.0
"""MuJoCo multiplies with this number, and so does everybody who wants the same bits."""


class BadAttribute(Exception):
    """An attribute that MuJoCo refuses; the reader knows the place."""

    def __init__(self, attribute: str, expected: str) -> None:
        super().__init__(attribute, expected)
        self.attribute = attribute
        self.expected = expected


class Settings(Struct, frozen=True):
    """What <compiler> says about the meaning of numbers and file names."""

    degree: bool = True
    eulerseq: str = "xyz"
    autolimits: bool = True
    inertia_from_geoms: bool = False
    mesh_folder: str = ""
    texture_folder: str = ""
    strip_path: bool = False


def _unknown(value: Any, said: Mapping[str, str], settings: Settings) -> bool:
    """What nobody can tell without writing the value."""
    return False


class Group(Struct, frozen=True, eq=False):
    """Attributes that make one value. Each is equal to itself alone.

    ``needs``: attributes of other groups on which their meaning depends. ``exact``: what is written always says the same.
    ``repeats``: whether what is written surely says the same as the attributes that the value was just read from, which is seen
    without writing it, since numbers survive being written; where it does not know, it is asked what is written.
    """

    key: str
    names: tuple[str, ...]
    read: Callable[[Mapping[str, str], Settings], Any]
    write: Callable[[Any, Settings], dict[str, str]]
    seen: Callable[[Mapping[str, str], Settings], Any]
    needs: tuple[str, ...] = ()
    exact: bool = False
    repeats: Callable[[Any, Mapping[str, str], Settings], bool] = _unknown


Asked = tuple[Group, tuple[str, ...]]
"""A group, and those of its attributes that an element says itself."""


class Plan(Struct, frozen=True):
    """How to read all groups of an element without asking each of them: most elements say few of their attributes.

    ``silent`` are the values of the groups of which the element itself says nothing, only ``base``, which its class gives;
    ``places`` are, by attribute, the groups that look at it, and ``always`` those that have to be asked anyway.
    """

    groups: tuple[Group, ...]
    base: Mapping[str, str]
    silent: Mapping[str, Any]
    places: Mapping[str, tuple[int, ...]]
    always: frozenset[int]
    known: dict[tuple[str, ...], list[Asked]] = field(default_factory=dict)

    def said_in(self, attributes: Iterable[str]) -> list[Asked]:
        """The groups that these attributes are for, in order."""
        names = tuple(attributes)
        asked = self.known.get(names)
        if asked is None:
            found = set(self.always)
            for name in names:
                found.update(self.places.get(name, ()))
            groups = [self.groups[place] for place in sorted(found)]
            asked = self.known[names] = [(group, tuple([name for name in group.names if name in names])) for group in groups]
        return asked


def plan_of(groups: tuple[Group, ...], settings: Settings, base: Mapping[str, str]) -> Plan:
    """The plan for elements to which their class gives ``base``, in a file with these settings."""
    silent, always = _said_by(base, groups, settings) if base else _unsaid(groups, settings)
    return Plan(groups, base, silent, _places_of(groups), always)


@lru_cache(256)
def _places_of(groups: tuple[Group, ...]) -> Mapping[str, tuple[int, ...]]:
    places: dict[str, tuple[int, ...]] = {}
    for place, group in enumerate(groups):
        for name in (*group.names, *group.needs):
            places[name] = (*places.get(name, ()), place)
    return MappingProxyType(places)


@lru_cache(256)
def _unsaid(groups: tuple[Group, ...], settings: Settings) -> tuple[Mapping[str, Any], frozenset[int]]:
    return _said_by({}, groups, settings)


def _said_by(base: Mapping[str, str], groups: tuple[Group, ...], settings: Settings) -> tuple[Mapping[str, Any], frozenset[int]]:
    """The values of the groups, and the places of those that have none."""
    silent: dict[str, Any] = {}
    always: set[int] = set()
    for place, group in enumerate(groups):
        try:
            silent[group.key] = group.read(base, settings)
        except BadAttribute:
            always.add(place)
    return MappingProxyType(silent), frozenset(always)


# ---- numbers ---------------------------------------------------------------------------------------------------------------


def numbers_of(said: Mapping[str, str], name: str, least: int, most: int) -> tuple[float, ...] | None:
    """The numbers of an attribute, or None when it is not there. Raises: BadAttribute."""
    text = said.get(name)
    if text is None:
        return None
    found = read_numbers(text)
    if found is None or not least <= len(found) <= most:
        count = f"{least}" if least == most else f"{least} to {most}"
        raise BadAttribute(name, f"{count} finite number{'s' if most > 1 else ''}")
    return found


def vector_of(said: Mapping[str, str], name: str, default: Vec3) -> Vec3:
    """Three numbers."""
    found = numbers_of(said, name, 3, 3)
    return default if found is None else found  # type: ignore[return-value]


def radians(degrees: float) -> float:
    """An angle in rad, in MuJoCo's own arithmetic."""
    return degrees * DEGREE


@lru_cache(65536)
def degrees_text(angle: float) -> str:
    """The shortest number of degrees that MuJoCo turns into this angle in rad, bit for bit where there is one."""
    guess = angle / DEGREE
    for digits in range(1, 18):
        near = float(f"{guess:.{digits}g}")
        if near * DEGREE == angle:
            return number_text(near)
    for near in (math.nextafter(guess, math.inf), math.nextafter(guess, -math.inf)):
        if near * DEGREE == angle:
            return number_text(near)
    return number_text(guess)


def angle_text(angle: float, degree: bool) -> str:
    """An angle in rad in the unit of the file."""
    return degrees_text(angle) if degree else number_text(angle)


def plain(said: Mapping[str, str], names: tuple[str, ...]) -> tuple[Any, ...]:
    """Attributes as numbers where they are numbers, else as text: what does not depend on spelling."""
    return tuple([None if (text := said.get(name)) is None else read_numbers(text) or text for name in names])


_TURN_COUNTS = MappingProxyType({"quat": 4, "axisangle": 4, "xyaxes": 6})

# ---- orientations -----------------------------------------------------------------------------------------------------------


def written_turn(said: Mapping[str, str], settings: Settings) -> Written | None:
    """The orientation as it is written; angles in rad. None for none, or for no rotation. Raises: BadAttribute."""
    if ANY_TURN.isdisjoint(said):
        return None
    turn = next(turn for turn in TURNS if turn in said)
    count = _TURN_COUNTS.get(turn, 3)
    numbers = numbers_of(said, turn, count, count)
    assert numbers is not None
    if turn == "euler":
        if settings.degree:
            numbers = tuple([radians(angle) for angle in numbers])
        return Written(f"euler:{settings.eulerseq}", numbers)
    if turn == "axisangle" and settings.degree:
        numbers = (*numbers[:3], radians(numbers[3]))
    return Written(turn, numbers)


def read_pose(said: Mapping[str, str], settings: Settings) -> Pose:
    """``pos`` and an orientation, or ``fromto``. Raises: BadAttribute."""
    if "fromto" in said:
        points = numbers_of(said, "fromto", 6, 6)
        assert points is not None
        written: Written | None = Written("fromto", points)
    else:
        written = written_turn(said, settings)
    xyz = vector_of(said, "pos", ZERO)
    if written is None:
        return Pose(xyz)
    try:
        if written.kind == "quat":
            return pose(xyz, written.numbers)  # type: ignore[arg-type]
        return pose_as_written(xyz, written)
    except ZeroDivisionError as error:
        name = "euler" if written.kind.startswith("euler") else written.kind
        raise BadAttribute(name, "numbers that are a rotation") from error


def write_turn(quat: tuple[float, ...], written: Written | None, settings: Settings) -> dict[str, str]:
    """The orientation as its author wrote it, else as a quaternion; nothing for no rotation."""
    if written is None:
        return {} if quat == NO_ROTATION else {"quat": numbers_text(quat)}
    kind, numbers = written
    if kind == f"euler:{settings.eulerseq}":
        return {"euler": " ".join([angle_text(angle, settings.degree) for angle in numbers])}
    if kind == "axisangle":
        return {"axisangle": f"{numbers_text(numbers[:3])} {angle_text(numbers[3], settings.degree)}"}
    if kind in ("quat", "xyaxes", "zaxis"):
        return {kind: numbers_text(numbers)}
    return {"quat": numbers_text(quat)}


def write_pose(value: Pose, settings: Settings) -> dict[str, str]:
    """``pos`` and the orientation, or ``fromto``."""
    if value.written is not None and value.written.kind == "fromto":
        return {"fromto": numbers_text(value.written.numbers)}
    said = {} if value.xyz == ZERO else {"pos": numbers_text(value.xyz)}
    return said | write_turn(value.quat, value.written, settings)


def same_pose(a: Pose, b: Pose) -> bool:
    """Whether two poses are equal and written alike."""
    return a == b and a.written == b.written


POSE_NAMES = ("pos", "quat", "euler", "axisangle", "xyaxes", "zaxis")


def seen_pose(said: Mapping[str, str], settings: Settings) -> Any:
    if "fromto" in said:
        return plain(said, ("fromto",))
    turn = plain(said, TURNS)
    return read_numbers(said.get("pos", "0 0 0")), turn if any(turn) else ((1.0, 0.0, 0.0, 0.0), *[None] * 4)


_OTHER_TURNS = ANY_TURN - {"quat"} | {"fromto"}


def repeats_pose(value: Pose, said: Mapping[str, str], settings: Settings) -> bool:
    """A position and a quaternion, each said if and only if it is not that of the identity, are written as they were read."""
    turned = value.written is not None or value.quat != NO_ROTATION
    return ("pos" in said) == (value.xyz != ZERO) and ("quat" in said) == turned and _OTHER_TURNS.isdisjoint(said)


POSE = Group("pose", POSE_NAMES, read_pose, write_pose, seen_pose, repeats=repeats_pose)
SITE_POSE = Group("pose", (*POSE_NAMES, "fromto"), read_pose, write_pose, seen_pose, repeats=repeats_pose)


# ---- plain groups ------------------------------------------------------------------------------------------------------------


def real(name: str, default: float | None = None) -> Group:
    """One number."""

    def read(said: Mapping[str, str], settings: Settings) -> float | None:
        found = numbers_of(said, name, 1, 1)
        return default if found is None else found[0]

    def write(value: float | None, settings: Settings) -> dict[str, str]:
        return {} if value is None else {name: number_text(value)}

    return Group(name, (name,), read, write, seen_numbers(name, default), exact=True)


def first_real(name: str, default: float) -> Group:
    """One number, of which some formats want more (coefficients of a polynomial); only the first one is typed."""

    def read(said: Mapping[str, str], settings: Settings) -> float:
        found = numbers_of(said, name, 1, 3)
        return default if found is None else found[0]

    def write(value: float, settings: Settings) -> dict[str, str]:
        return {name: number_text(value)}

    return Group(name, (name,), read, write, seen_numbers(name, default))


def reals(name: str, least: int, most: int) -> Group:
    """Some numbers; empty when there are none."""

    def read(said: Mapping[str, str], settings: Settings) -> tuple[float, ...]:
        return numbers_of(said, name, least, most) or ()

    def write(value: tuple[float, ...], settings: Settings) -> dict[str, str]:
        return {name: numbers_text(value)} if value else {}

    return Group(name, (name,), read, write, seen_numbers(name, None), exact=True)


def text(name: str) -> Group:
    """A text, such as a reference."""
    return Group(
        name,
        (name,),
        lambda said, settings: said.get(name),
        lambda value, settings: {} if value is None else {name: value},
        lambda said, settings: said.get(name),
        exact=True,
    )


def seen_numbers(name: str, default: float | None) -> Callable[[Mapping[str, str], Settings], Any]:
    def seen(said: Mapping[str, str], settings: Settings) -> Any:
        found = said.get(name)
        return ((default,) if default is not None else None) if found is None else read_numbers(found)

    return seen


# ---- free parameters ----------------------------------------------------------------------------------------------------------

_NAMES_ONLY = frozenset(
    {"plugin", "instance", "target", "objname", "refname", "key", "value", "file", "texture", "model", "prefix", "input"}
)


def parameter_value(name: str, said: str) -> float | str | tuple[float, ...]:
    """An attribute as a number, numbers or text; text wherever numbers would not say the same."""
    found = None if name in _NAMES_ONLY else read_numbers(said)
    if not found:
        return said
    return found[0] if len(found) == 1 else found


def parameter_text(value: float | str | tuple[float, ...]) -> str:
    """A parameter as an attribute's text."""
    if isinstance(value, str):
        return value
    return numbers_text(value) if isinstance(value, tuple) else number_text(value)
