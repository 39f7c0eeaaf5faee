"""Values of HyMeKo text: numbers, words, rotations and poses, with angles in the unit that takes fewer letters."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x.formats.hymeko import TURNING
from hymeko_x.formats.hymeko.units import MOST_DIGITS, rounded, unit_factor
from hymeko_x.ir import parts
from hymeko_x.ir.digits import number_text
from hymeko_x.ir.values import NO_ROTATION, Pose
from hymeko_x.language.syntax import Quantity, Query, Ref
from hymeko_x.language.terminals import KEYWORDS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.ir.values import Written
    from hymeko_x.language.syntax import Value

_DEGREE = unit_factor("deg") or 1.0
_DIGITS = (6, 10, 13, 15, 16, 17)
_FEW_DIGITS = (2, 3, 4, 5)
_FEWEST = 5
"""An angle with fewer digits is not taken for one that was rounded."""
_UNITS_BLOCK = 15  # letters of `units { angle rad }`
_WORD = re.compile(r"[^\W\d]\w*")


class Angles(Struct, frozen=True):
    """The unit of plain angles: degrees or radians. ``digits`` are those that an angle in radians has; 0 = as many as a double."""

    degrees: bool
    digits: int = 0

    def value(self, radians: float) -> Value:
        """An angle in the unit in force; with a unit of its own where degrees are longer, or not the same double."""
        if not self.degrees:
            return radians
        plain = in_degrees(radians, self.digits)
        is_short = plain is not None and len(number_text(plain)) <= len(number_text(radians)) + 3
        return plain if plain is not None and is_short else Quantity(radians, "rad")

    def length(self, radians: float) -> int:
        """The letters of an angle."""
        value = self.value(radians)
        return len(number_text(value)) if type(value) is float else len(number_text(radians)) + 3

    def values(self, radians: Iterable[float]) -> tuple[Value, ...]:
        """Several angles."""
        return tuple(map(self.value, radians))

    def rotation(self, written: Written) -> tuple[Value, ...]:
        """The numbers of a rotation, those of them that are angles in the unit in force."""
        kind, numbers = written
        if kind == "rpy" or kind.startswith("euler:"):
            return self.values(numbers)
        return (*numbers[:3], self.value(numbers[3])) if kind == "axisangle" else numbers


_PLAIN_DIGITS = 9


class ExplicitAngles(Angles, frozen=True):
    """Every angle with its unit: degrees where they are a short number, else radians."""

    degrees: bool = True

    def value(self, radians: float) -> Value:
        """An angle with its unit."""
        plain = in_degrees(radians)
        is_short = plain is not None and len(number_text(plain)) <= _PLAIN_DIGITS
        return Quantity(plain, "deg") if plain is not None and is_short else Quantity(radians, "rad")


def value_of(value: object) -> Value:
    """A part's value as a value of the language."""
    if isinstance(value, bool):
        return Ref(("true" if value else "false",))
    if isinstance(value, int):
        return float(value)
    if isinstance(value, tuple):
        return tuple(value if isinstance(value, str) else value_of(value) for value in value)
    if isinstance(value, str) and _WORD.fullmatch(value) and value not in KEYWORDS:
        return Ref((value,))
    if value is None:
        return Query()
    assert isinstance(value, float | str), value
    return value


def pose_value(pose: Pose, angles: Angles) -> tuple[Value, ...]:
    """``[x y z]`` for a translation, else ``[[x y z] rotation]``, roll-pitch-yaw if written so, else a quaternion.

    Other notations have their kind before it: ``[[x y z] "zaxis" [0 1 0]]``, and ``["fromto" [two points]]``.
    """
    if pose.written is not None:
        rotation = angles.rotation(pose.written)
        if pose.written.kind in ("rpy", "quat"):
            return (pose.xyz, rotation)
        if pose.written.kind == "fromto":
            return ("fromto", rotation)
        return (pose.xyz, pose.written.kind, rotation)
    if pose.quat == NO_ROTATION:
        return pose.xyz
    return (pose.xyz, pose.quat)


def in_degrees(radians: float, rounding: int = 0) -> float | None:
    """The shortest number of degrees that reads back to the same double, rounded to so many digits in radians; or None."""
    for digits in (*_FEW_DIGITS, *_DIGITS) if rounding else _DIGITS:
        plain = float(f"{radians / _DEGREE:.{digits}g}")
        if rounded(plain * _DEGREE, rounding) == radians:
            return plain
    return None


def shortest_angles(mechanism: Mechanism, *, may_round: bool) -> Angles:
    """The unit, and the rounding if there may be one, with which all angles of the mechanism together take fewest letters."""
    count = Counter(_angles(mechanism))
    digits = Counter(len(number_text(abs(angle)).replace(".", "").lstrip("0")) for angle in count)
    usual = [number for number, _ in digits.most_common() if may_round and _FEWEST <= number < MOST_DIGITS]
    settings = [Angles(True), Angles(False), *(Angles(True, number) for number in dict.fromkeys((*usual[:2], *sorted(usual)[-1:])))]

    def length(angles: Angles) -> int:
        block = 0 if angles == settings[0] else _UNITS_BLOCK
        return block + sum(number * angles.length(angle) for angle, number in count.items())

    return min(settings, key=length)


def _angles(mechanism: Mechanism) -> Iterator[float]:
    """The numbers of the mechanism that are angles."""
    for edge in mechanism.graph.edges.values():
        if isinstance(edge.data, parts.Joint | parts.Loop):
            for dof in edge.data.dofs:
                yield from _of_dof(dof)
        for arc in edge.arcs:
            if isinstance(arc.weight, Pose):
                yield from _of_pose(arc.weight)
    for part in mechanism.graph.vertices.values():
        if isinstance(part, parts.Body) and part.inertial is not None and part.inertial.written is not None:
            yield from _of_pose(part.inertial.written.frame)
        elif isinstance(part, parts.Camera) and part.fovy is not None:
            yield part.fovy


def _of_dof(dof: parts.Dof) -> Iterator[float]:
    if dof.kind not in TURNING:
        return
    limits = dof.limits
    found = [limits.lower, limits.upper, limits.velocity, limits.acceleration, limits.jerk]
    if dof.safety is not None:
        found += [dof.safety.soft_lower, dof.safety.soft_upper]
    if dof.calibration is not None:
        found += [dof.calibration.rising, dof.calibration.falling, dof.calibration.reference]
    yield from (value for value in found if value is not None)
    yield from (value for value in (dof.ref, dof.spring_ref) if value)


def _of_pose(pose: Pose) -> Iterator[float]:
    if pose.written is None:
        return
    kind, numbers = pose.written
    if kind == "rpy" or kind.startswith("euler:"):
        yield from numbers
    elif kind == "axisangle":
        yield numbers[3]
