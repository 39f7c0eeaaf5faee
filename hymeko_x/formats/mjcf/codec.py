"""What the attributes of MJCF elements mean: one table for reader and writer.

A :class:`AttributeGroup` turns the attributes that belong together into one value of the IR and back; ``seen`` is what
MuJoCo makes of them, so that two texts of the same meaning are distinguished from two of almost the same.
"""

from __future__ import annotations

import math
from functools import lru_cache
from operator import eq
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from msgspec import Struct

from hymeko_x.formats.mjcf.classes import ANY_TURN, TURNS
from hymeko_x.ir.decimals import shortest
from hymeko_x.ir.digits import number_text, numbers_text
from hymeko_x.ir.values import NO_ROTATION, ZERO, Pose, Written, pose
from hymeko_x.ir.written import pose_as_written
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.ir.values import Vec3

DEGREE = math.pi / 180.0
"""MuJoCo multiplies with this number; another one would give other bits."""


class BadAttribute(Exception):
    """An attribute that MuJoCo refuses; the reader knows the place."""

    def __init__(self, attribute: str, expected: str) -> None:
        super().__init__(attribute, expected)
        self.attribute = attribute
        self.expected = expected


class Settings(Struct, frozen=True):
    """What <compiler> settles about the meaning of numbers and file names.

    ``plain_turns``: rotations that no author wrote in MJCF are written in the shortest way that means the same: quarter turns with
    quaternions of ones, which MuJoCo normalises, and roll, pitch and yaw as they are.
    """

    degree: bool = True
    eulerseq: str = "xyz"
    autolimits: bool = True
    inertia_from_geoms: bool = False
    mesh_folder: str = ""
    texture_folder: str = ""
    strip_path: bool = False
    plain_turns: bool = False


class AttributeGroup(Struct, frozen=True, eq=False):
    """Attributes that make one value. Each is equal to itself alone.

    ``needs``: attributes of other groups on which their meaning depends. ``exact``: what is written always means the same.
    ``same``: whether two values are equal, and written in the same way where that is noted.
    """

    key: str
    names: tuple[str, ...]
    read: Callable[[Mapping[str, str], Settings], Any]
    write: Callable[[Any, Settings], dict[str, str]]
    seen: Callable[[Mapping[str, str], Settings], Any]
    needs: frozenset[str] = frozenset()
    exact: bool = False
    same: Callable[[Any, Any], bool] = eq


# ---- numbers ---------------------------------------------------------------------------------------------------------------


def numbers_of(attributes: Mapping[str, str], name: str, least: int, most: int) -> tuple[float, ...] | None:
    """The numbers of an attribute, or None when it is not there. Raises: BadAttribute."""
    text = attributes.get(name)
    if text is None:
        return None
    found = read_numbers(text)
    if found is None or not least <= len(found) <= most:
        count = f"{least}" if least == most else f"{least} to {most}"
        raise BadAttribute(name, f"{count} finite number{'s' if most > 1 else ''}")
    return found


def vector_of(attributes: Mapping[str, str], name: str, default: Vec3) -> Vec3:
    """Three numbers."""
    found = numbers_of(attributes, name, 3, 3)
    return default if found is None else found  # type: ignore[return-value]


def radians(degrees: float) -> float:
    """An angle in rad, in MuJoCo's own arithmetic."""
    return degrees * DEGREE


_USUAL_DIGITS = 12
"""Numbers of fewer characters are what an author meant; of longer ones the bits count."""


@lru_cache(65536)
def degrees_text(angle: float) -> str:
    """The shortest number of degrees that MuJoCo turns into this angle in rad, to rounding; bit for bit where that is as short."""
    guess = angle / DEGREE
    short = shortest(guess)
    if len(number_text(short)) < _USUAL_DIGITS:
        return number_text(short)
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


def angles_text(angles: tuple[float, ...], degree: bool) -> str:
    """Angles in rad in the unit of the file, separated by blanks."""
    return " ".join(map(degrees_text, angles)) if degree else numbers_text(angles)


def plain(attributes: Mapping[str, str], names: tuple[str, ...]) -> tuple[Any, ...]:
    """Attributes as numbers where they are numbers, else as text: what does not depend on spelling."""
    return tuple([None if (text := attributes.get(name)) is None else read_numbers(text) or text for name in names])


_TURN_COUNTS = MappingProxyType({"quat": 4, "axisangle": 4, "xyaxes": 6})

# ---- orientations -----------------------------------------------------------------------------------------------------------


def written_turn(attributes: Mapping[str, str], settings: Settings) -> Written | None:
    """The orientation as it is written; angles in rad. None for none, or for no rotation. Raises: BadAttribute."""
    if ANY_TURN.isdisjoint(attributes):
        return None
    turn = next(turn for turn in TURNS if turn in attributes)
    count = _TURN_COUNTS.get(turn, 3)
    numbers = numbers_of(attributes, turn, count, count)
    assert numbers is not None
    if turn == "euler":
        if settings.degree:
            numbers = tuple([radians(angle) for angle in numbers])
        return Written(f"euler:{settings.eulerseq}", numbers)
    if turn == "axisangle" and settings.degree:
        numbers = (*numbers[:3], radians(numbers[3]))
    return Written(turn, numbers)


def read_pose(attributes: Mapping[str, str], settings: Settings) -> Pose:
    """``pos`` and an orientation, or ``fromto``. Raises: BadAttribute."""
    if "fromto" in attributes:
        points = numbers_of(attributes, "fromto", 6, 6)
        assert points is not None
        written: Written | None = Written("fromto", points)
    else:
        written = written_turn(attributes, settings)
    xyz = vector_of(attributes, "pos", ZERO)
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
    if written is None or (written.kind == "rpy" and (settings.plain_turns or settings.eulerseq != "XYZ")):
        return {} if quat == NO_ROTATION else _plain_turn(quat, written) if settings.plain_turns else {"quat": numbers_text(quat)}
    kind, numbers = written
    if kind in (f"euler:{settings.eulerseq}", "rpy"):
        return {"euler": angles_text(numbers, settings.degree)}
    if kind == "axisangle":
        return {"axisangle": f"{numbers_text(numbers[:3])} {angle_text(numbers[3], settings.degree)}"}
    if kind in ("quat", "xyaxes", "zaxis"):
        return {kind: numbers_text(numbers)}
    return {"quat": numbers_text(quat)}


def _plain_turn(quat: tuple[float, ...], rpy: Written | None) -> dict[str, str]:
    """A quaternion, or the angles about fixed axes that the author wrote (``eulerseq="XYZ"``), whichever is shorter."""
    text = numbers_text(_with_ones(quat))
    angles = text if rpy is None else numbers_text(rpy.numbers)
    return {"euler": angles} if len(angles) < len(text) else {"quat": text}


def _with_ones(quat: tuple[float, ...]) -> tuple[float, ...]:
    """A quarter turn as ``1 0 0 1``, which is the same rotation; every other one as it is."""
    if not _OF_QUARTER_TURNS.issuperset(map(abs, quat)):
        return quat
    return tuple([math.copysign(1.0, value) if value else 0.0 for value in quat])


_OF_QUARTER_TURNS = frozenset((0.0, math.sqrt(0.5)))


def write_pose(value: Pose, settings: Settings) -> dict[str, str]:
    """``pos`` and the orientation; of a pose between two points, which only sites and geoms have, as a quaternion."""
    attributes = {} if value.xyz == ZERO else {"pos": numbers_text(value.xyz)}
    return attributes | write_turn(value.quat, value.written, settings)


def write_pose_or_ends(value: Pose, settings: Settings) -> dict[str, str]:
    """``fromto``, or as :func:`write_pose`."""
    if value.written is not None and value.written.kind == "fromto":
        return {"fromto": numbers_text(value.written.numbers)}
    return write_pose(value, settings)


POSE_NAMES = ("pos", "quat", "euler", "axisangle", "xyaxes", "zaxis")


def seen_pose(attributes: Mapping[str, str], settings: Settings) -> Any:
    """The numbers of a pose as they are written, to compare two notations of one pose."""
    if "fromto" in attributes:
        return plain(attributes, ("fromto",))
    turn = plain(attributes, TURNS)
    return read_numbers(attributes.get("pos", "0 0 0")), turn if any(turn) else ((1.0, 0.0, 0.0, 0.0), *[None] * 4)


def same_pose(a: object, b: object) -> bool:
    """Whether two poses, or what stands for none, are equal and written in the same way, which equality does not see."""
    return a == b and isinstance(a, Pose) and isinstance(b, Pose) and a.written == b.written


POSE = AttributeGroup("pose", POSE_NAMES, read_pose, write_pose, seen_pose, same=same_pose)
SITE_POSE = AttributeGroup("pose", (*POSE_NAMES, "fromto"), read_pose, write_pose_or_ends, seen_pose, same=same_pose)


_AT_HOME: Mapping[str, str] = MappingProxyType(
    {"pos": "0 0 0", "quat": "1 0 0 0", "euler": "0 0 0", "axisangle": "0 0 1 0", "xyaxes": "1 0 0 0 1 0", "zaxis": "0 0 1"}
)
"""The attributes of a pose that is none, which are written where a class gives another one."""


def undone(group: AttributeGroup, base: Mapping[str, str], texts: Mapping[str, str]) -> dict[str, str]:
    """What undoes the position or the orientation of a class in an element that has none."""
    lacking = [name for name in group.names if name in base and name in _AT_HOME and name not in texts]
    if not lacking or "fromto" in texts:
        return {}
    is_turned = any(name in TURNS for name in texts)
    return {name: _AT_HOME[name] for name in lacking if not (is_turned and name in TURNS)}


# ---- plain groups ------------------------------------------------------------------------------------------------------------


def real(name: str, default: float | None = None) -> AttributeGroup:
    """One number."""

    def read(attributes: Mapping[str, str], settings: Settings) -> float | None:
        found = numbers_of(attributes, name, 1, 1)
        return default if found is None else found[0]

    def write(value: float | None, settings: Settings) -> dict[str, str]:
        return {} if value is None else {name: number_text(value)}

    return AttributeGroup(name, (name,), read, write, seen_numbers(name, default), exact=True)


def first_real(name: str) -> AttributeGroup:
    """One number, of which some formats want more (coefficients of a polynomial); only the first one is typed, 0 by default."""

    def read(attributes: Mapping[str, str], settings: Settings) -> float:
        found = numbers_of(attributes, name, 1, 3)
        return 0.0 if found is None else found[0]

    def write(value: float, settings: Settings) -> dict[str, str]:
        return {name: number_text(value)}

    return AttributeGroup(name, (name,), read, write, seen_numbers(name, 0.0))


def reals(name: str, least: int, most: int, engine: tuple[float, ...] = ()) -> AttributeGroup:
    """Some numbers; empty when there are none. ``engine``: what MuJoCo takes then, written where a class would give others."""

    def read(attributes: Mapping[str, str], settings: Settings) -> tuple[float, ...]:
        return numbers_of(attributes, name, least, most) or ()

    def write(value: tuple[float, ...], settings: Settings) -> dict[str, str]:
        return {name: numbers_text(value or engine)} if value or engine else {}

    return AttributeGroup(name, (name,), read, write, seen_numbers(name, None), exact=True)


def text(name: str) -> AttributeGroup:
    """A text, such as a reference."""
    return AttributeGroup(
        name,
        (name,),
        lambda attributes, settings: attributes.get(name),
        lambda value, settings: {} if value is None else {name: value},
        lambda attributes, settings: attributes.get(name),
        exact=True,
    )


def seen_numbers(name: str, default: float | None) -> Callable[[Mapping[str, str], Settings], Any]:
    """A function that gives the numbers of an attribute as they are written, or the default as one number."""

    def seen(attributes: Mapping[str, str], settings: Settings) -> Any:
        found = attributes.get(name)
        return ((default,) if default is not None else None) if found is None else read_numbers(found)

    return seen


# ---- free parameters ----------------------------------------------------------------------------------------------------------

_NAMES_ONLY = frozenset(
    {"plugin", "instance", "target", "objname", "refname", "key", "value", "file", "texture", "model", "prefix", "input"}
)


def parameter_value(name: str, attributes: str) -> float | str | tuple[float, ...]:
    """An attribute as a number, numbers or text; text wherever numbers would not mean the same."""
    found = None if name in _NAMES_ONLY else read_numbers(attributes)
    if not found:
        return attributes
    return found[0] if len(found) == 1 else found


def parameter_text(value: float | str | tuple[float, ...]) -> str:
    """A parameter as an attribute's text."""
    if isinstance(value, str):
        return value
    return numbers_text(value) if isinstance(value, tuple) else number_text(value)
