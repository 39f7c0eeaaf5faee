"""Values of HyMeKo text: numbers with units in SI, texts, colours and poses, or a refusal at the item that holds them."""

from __future__ import annotations

from math import isfinite
from types import MappingProxyType
from typing import TYPE_CHECKING, cast

from msgspec import Struct, field

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, Refusal, Report, refuse
from hymeko_x.formats.hymeko.units import BASE_UNITS, MOST_DIGITS, fits, fitting_units, rounded, unit_dimension, unit_factor
from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.values import Pose, Vec3, Written, pose, pose_from_rpy
from hymeko_x.ir.written import NOTATIONS, number_count, pose_as_written
from hymeko_x.language.syntax import ArcItem, Field, Item, Node, Quantity, Query, Ref, Value, is_field, is_list, origin_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.parts import DataValue, Rgba

ParameterValue = float | str | tuple[float, ...]

DEFAULT_UNITS: Mapping[str, float] = MappingProxyType({"length": 1.0, "angle": unit_factor("deg") or 0.0, "mass": 1.0, "time": 1.0})
"""Plain numbers are metres, kilograms, seconds and, as published, degrees."""


class ValueReader(Struct):
    """Reads the values of one file. ``units`` are the factors of plain numbers by dimension, and ``digits`` those of plain angles."""

    file: str
    report: Report
    units: Mapping[str, float] = field(default_factory=lambda: DEFAULT_UNITS)
    digits: int = 0

    def origin(self, item: Item) -> Origin:
        """The place of an item."""
        return origin_of(item, self.file)

    def refuse(self, item: Item, message: str, *, hint: str = "") -> Refusal:
        """A refusal (HX062) at an item."""
        if not hint and isinstance(item, Field) and item.value is None:
            hint = f"a value that is a name stands behind '=': {item.name}=name"
        return refuse(codes.BAD_VALUE, message, self.origin(item), hint=hint)

    def number(self, value: Value | None, dimension: str, item: Item) -> float:
        """A number in SI: plain, by the units in force, or with a unit of its own."""
        if type(value) is float:
            plain = value * self.units.get(dimension, 1.0)
            return rounded(plain, self.digits) if dimension == "angle" else plain
        if isinstance(value, Quantity):
            factor = unit_factor(value.unit)
            if factor is None:
                hint = "lengths m mm, angles rad deg, mass kg g, time s ms, and products such as kg*m^2 or rad/s"
                raise self.refuse(item, f"'{value.unit}' is not a unit that is known", hint=hint)
            if not fits(value.unit, dimension):
                kind = unit_dimension(value.unit)
                message = f"{name_of(item)} takes a unit of {dimension}, and '{value.unit}' is {f'one of {kind}' if kind else 'none'}"
                raise self.refuse(item, message, hint=f"such as {', '.join(fitting_units(dimension))}")
            return value.number * factor
        raise self.refuse(item, f"{name_of(item)} takes a number, not {describe(value)}", hint=_hint(value))

    def whole(self, value: Value | None, item: Item) -> int:
        """A whole number."""
        number = self.number(value, "", item)
        if not number.is_integer():
            raise self.refuse(item, f"{name_of(item)} takes whole numbers, not {number}")
        return int(number)

    def numbers(self, value: Value | None, dimension: str, item: Item, count: int | None = None) -> tuple[float, ...]:
        """A list of numbers in SI, of the given length if there is one."""
        if not is_list(value):
            hint = _hint(value)
            if value is None and isinstance(item, Field):
                hint = f"numbers stand in brackets: {item.name} [1 2 3]; a name stands behind '=': {item.name}=name"
            raise self.refuse(item, f"{name_of(item)} takes a list of numbers, not {describe(value)}", hint=hint)
        factor = self.units.get(dimension, 1.0)
        is_rounded = self.digits and dimension == "angle"
        values = tuple([part * factor if type(part) is float and not is_rounded else self.number(part, dimension, item) for part in value])
        if count is not None and len(values) != count:
            raise self.refuse(item, f"{name_of(item)} takes {count} numbers, not {len(values)}")
        return values

    def vec3(self, value: Value | None, dimension: str, item: Item) -> Vec3:
        """Three finite numbers in SI."""
        return cast("Vec3", self.finite(self.numbers(value, dimension, item, 3), item))

    def finite(self, numbers: tuple[float, ...], item: Item) -> tuple[float, ...]:
        """The numbers of a mass, a size or a place. Raises: Refusal (HX062) for one that is infinite or none."""
        if not all(map(isfinite, numbers)):
            raise self.refuse(item, f"{name_of(item)} takes finite numbers, not {numbers_text(numbers)}")
        return numbers

    def rgba(self, value: Value | None, item: Item) -> Rgba:
        """``[r g b a]``, or ``[r g b]`` for an opaque colour."""
        numbers = self.numbers(value, "", item)
        if len(numbers) not in (3, 4):
            raise self.refuse(item, f"{name_of(item)} takes [r g b] or [r g b a], not {len(numbers)} numbers")
        r, g, b, a = (*numbers, 1.0)[:4]
        return (r, g, b, a)

    def text(self, value: Value | None, item: Item) -> str:
        """A string, or a bare name."""
        if isinstance(value, str):
            return value
        if isinstance(value, Ref) and len(value.path) == 1 and not value.direction:
            return value.path[0]
        raise self.refuse(item, f"{name_of(item)} takes a text, not {describe(value)}")

    def pose(self, value: Value | None, item: Item) -> Pose:
        """``[x y z]``, ``[[x y z] [roll pitch yaw]]`` or ``[[x y z] [w x y z]]``; the rotation keeps its notation."""
        if not is_list(value):
            raise self.refuse(item, f"a pose is [x y z] or [[x y z] [roll pitch yaw]], not {describe(value)}")
        if len(value) == 2 and value[0] == "fromto":
            return self._as_written((0.0, 0.0, 0.0), "fromto", value[1], item)
        if not value or not is_list(value[0]):
            return Pose(self.vec3(value, "length", item))
        xyz = self.vec3(value[0], "length", item)
        if len(value) == 1:
            return Pose(xyz)
        if len(value) == 3 and isinstance(value[1], str):
            return self._as_written(xyz, value[1], value[2], item)
        if len(value) == 2 and is_list(value[1]):
            return self._rotated(xyz, value[1], item)
        raise self.refuse(item, f"a pose has a position and a rotation, not {len(value)} parts")

    def parameter(self, item: Field) -> ParameterValue:
        """A free value: a number, a text, or a list of numbers."""
        value = item.value
        if value is None:
            return ""
        if is_list(value):
            return self.numbers(value, "", item)
        if isinstance(value, Ref) and (len(value.path) > 1 or value.direction):
            hint = f"a text stands in quotes: \"{value.dotted}\"; an arc is written {value.direction or '+'} {value.dotted}, without '='"
            raise self.refuse(item, f"{name_of(item)} takes a value, not {describe(value)}", hint=hint)
        if isinstance(value, Ref):
            return value.path[0]
        return value if isinstance(value, str) else self.number(value, "", item)

    def datum(self, item: Field) -> DataValue:
        """The value of a field of plain data."""
        return "" if item.value is None and not item.type else None if item.value is None else self.data(item.value, item)

    def data(self, value: Value | None, item: Item) -> DataValue:
        """A value of plain data: a number, a text, a list of any shape, or None for a value that is left open."""
        if is_list(value):
            return tuple([self.data(part, item) for part in value])
        if isinstance(value, Query):
            return None
        if isinstance(value, float | Quantity):
            return self.number(value, "", item)
        return self.text(value, item)

    def _as_written(self, xyz: Vec3, kind: str, value: Value, item: Item) -> Pose:
        """A rotation with its notation: ``"euler:xyz" [a b c]``, ``"zaxis" [x y z]`` ...

        Raises: Refusal (HX062).
        """
        count = number_count(kind)
        if count is None:
            raise self.refuse(item, f"'{kind}' is not a notation of rotations; there are {', '.join(NOTATIONS)}")
        plain = self.numbers(value, "length" if kind == "fromto" else "angle" if kind.startswith("euler") else "", item, count)
        if kind == "axisangle":
            plain = (*plain[:3], self.number(cast("tuple[Value, ...]", value)[3], "angle", item))
        try:
            return pose_as_written(xyz, Written(kind, plain))
        except (ZeroDivisionError, ValueError) as error:
            raise self.refuse(item, f"{plain} is no rotation") from error

    def _rotated(self, xyz: Vec3, rotation: tuple[Value, ...], item: Item) -> Pose:
        if len(rotation) == 3:
            return pose_from_rpy(xyz, self.vec3(rotation, "angle", item))
        w, x, y, z = self.numbers(rotation, "", item, 4)
        try:
            return pose(xyz, (w, x, y, z))
        except ZeroDivisionError as error:
            raise self.refuse(item, f"the quaternion [{numbers_text((w, x, y, z))}] is no rotation") from error


def describe(value: Value | None) -> str:
    """A value in the words of an error message."""
    if value is None:
        return "nothing"
    if isinstance(value, str):
        return f"the text {value!r}"
    if isinstance(value, Ref):
        return f"the reference '{value.dotted}'"
    if isinstance(value, Quantity):
        return "a quantity"
    if is_list(value):
        return "a list"
    return f"the number {value}" if isinstance(value, float) else "an open question"


def _hint(value: Value | None) -> str:
    """What to write instead of a value that is left open."""
    return "data alone leaves values open; a field that is not known is left out" if isinstance(value, Query) else ""


def name_of(item: Item) -> str:
    """An item in the words of an error message."""
    if isinstance(item, ArcItem):
        return f"the arc to '{item.ref.dotted}'"
    return "an import" if not isinstance(item, Node | Field) else f"'{item.name}'"


_UNIT_NAMES = MappingProxyType(
    {
        "degree": "deg",
        "degrees": "deg",
        "radian": "rad",
        "radians": "rad",
        "meter": "m",
        "metre": "m",
        "millimeter": "mm",
        "kilogram": "kg",
        "second": "s",
    }
)


def _unit_words(item: Field) -> tuple[str, ...]:
    """A dimension, or its unit; in older texts both: ``angle "degree"``."""
    if not isinstance(item.value, str):
        return (item.name,)
    return item.name, _UNIT_NAMES.get(item.value, item.value)


def read_units(node: Node, reader: ValueReader) -> dict[str, float]:
    """The factors that a ``units { angle rad length mm }`` block sets."""
    words = [word for item in node.items if isinstance(item, Field) and item.name != "digits" for word in _unit_words(item)]
    factors = dict(reader.units)
    for dimension, unit in zip(words[::2], words[1::2], strict=False):
        known = BASE_UNITS.get(dimension)
        if known is None:
            raise reader.refuse(node, f"'{dimension}' is not a dimension; there are {', '.join(BASE_UNITS)}")
        if unit not in known:
            raise reader.refuse(node, f"'{unit}' is not a unit of {dimension}; there are {', '.join(known)}")
        factors[dimension] = known[unit]
    if len(words) % 2:
        raise reader.refuse(node, f"'{words[-1]}' stands without its unit")
    return factors


def read_digits(node: Node, reader: ValueReader) -> int:
    """How many digits of a radian plain angles have by ``units { digits 12 }``; 0 is as many as a double has."""
    item = next((item for item in node.items if is_field(item, ("digits",))), None)
    if not isinstance(item, Field):
        return reader.digits
    digits = reader.whole(item.value, item)
    if not 0 < digits <= MOST_DIGITS:
        raise reader.refuse(item, f"angles have 1 to {MOST_DIGITS} digits, not {digits}")
    return digits
