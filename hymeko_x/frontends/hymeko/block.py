"""A block of HyMeKo text as its readers see it: fields asked for by name, with units, and what nobody asked for."""

from __future__ import annotations

from math import isfinite
from types import MappingProxyType
from typing import TYPE_CHECKING, cast

from msgspec import Struct, field

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, Refusal, Report, refuse
from hymeko_x.formats.hymeko import CHILD_CLASS, FOREIGN
from hymeko_x.frontends.hymeko.foreign import is_foreign, read_extras, read_foreign, read_text
from hymeko_x.ir.mechanism import Extra
from hymeko_x.ir.values import Pose, Vec3, Written, numbers_text, pose, pose_from_rpy
from hymeko_x.ir.written import NOTATIONS, number_count, pose_as_written
from hymeko_x.language.syntax import ArcItem, Comment, Field, Item, Node, Quantity, QuotedName, Ref, Value, is_list
from hymeko_x.language.units import BASE_UNITS, unit_dimension, unit_factor

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from hymeko_x.formats.hymeko import Word
    from hymeko_x.ir.parts import Rgba

Parameter = float | str | tuple[float, ...]

DEFAULT_UNITS: Mapping[str, float] = MappingProxyType({"length": 1.0, "angle": unit_factor("deg") or 0.0, "mass": 1.0, "time": 1.0})
"""Plain numbers are metres, kilograms, seconds and, as published, degrees."""


class Context(Struct):
    """What a reader needs besides the block: file name, report, and the factors of plain numbers by dimension."""

    file: str
    report: Report
    units: Mapping[str, float] = field(default_factory=lambda: DEFAULT_UNITS)

    def origin(self, item: Item) -> Origin:
        """The place of an item."""
        return Origin(self.file, item.line or None, item.column or None)

    def refuse(self, item: Item, message: str, *, hint: str = "") -> Refusal:
        """A refusal (HX062) at an item."""
        if not hint and isinstance(item, Field) and item.value is None:
            hint = f"a value that is a name stands behind '=': {item.name}=name"
        return refuse(codes.BAD_VALUE, message, self.origin(item), hint=hint)

    def factor(self, dimension: str) -> float:
        """What a plain number of this dimension is multiplied with."""
        return self.units.get(dimension, 1.0) if dimension else 1.0

    # ---- values --------------------------------------------------------------------------------------------------------

    def number(self, value: Value | None, dimension: str, item: Item) -> float:
        """A number in SI: plain, by the units in force, or with a unit of its own."""
        if type(value) is float:
            factor = self.factor(dimension)
            return value if factor == 1.0 else value * factor
        if isinstance(value, Quantity):
            factor_of_unit = unit_factor(value.unit)
            if factor_of_unit is None:
                raise self.refuse(
                    item,
                    f"'{value.unit}' is not a unit that is known",
                    hint="lengths m mm, angles rad deg, mass kg g, time s ms, and products such as kg*m^2 or rad/s",
                )
            kind = unit_dimension(value.unit)
            if dimension in BASE_UNITS and kind and kind != dimension:
                message = f"{_name_of(item)} takes a unit of {dimension}, and '{value.unit}' is one of {kind}"
                raise self.refuse(item, message, hint=f"such as {', '.join(list(BASE_UNITS[dimension])[:4])}")
            return value.number * factor_of_unit
        raise self.refuse(item, f"{_name_of(item)} takes a number, not {describe(value)}")

    def whole(self, value: Value | None, item: Item) -> int:
        """A whole number."""
        number = self.number(value, "", item)
        if not number.is_integer():
            raise self.refuse(item, f"{_name_of(item)} takes whole numbers, not {number}")
        return int(number)

    def numbers(self, value: Value | None, dimension: str, item: Item, count: int | None = None) -> tuple[float, ...]:
        """A list of numbers in SI, of the given length if there is one."""
        if not is_list(value):
            raise self.refuse(item, f"{_name_of(item)} takes a list of numbers, not {describe(value)}")
        values = tuple(self.number(part, dimension, item) for part in cast("tuple[Value, ...]", value))
        if count is not None and len(values) != count:
            raise self.refuse(item, f"{_name_of(item)} takes {count} numbers, not {len(values)}")
        return values

    def vec3(self, value: Value | None, dimension: str, item: Item) -> Vec3:
        """Three numbers in SI."""
        return cast("Vec3", self.numbers(value, dimension, item, 3))

    def rgba(self, value: Value | None, item: Item) -> Rgba:
        """``[r g b a]``, or ``[r g b]`` for an opaque colour."""
        numbers = self.numbers(value, "", item)
        if len(numbers) not in (3, 4):
            raise self.refuse(item, f"{_name_of(item)} takes [r g b] or [r g b a], not {len(numbers)} numbers")
        r, g, b, a = (*numbers, 1.0)[:4]
        return (r, g, b, a)

    def text(self, value: Value | None, item: Item) -> str:
        """A string, or a bare name."""
        if isinstance(value, str):
            return value
        if isinstance(value, Ref) and len(value.path) == 1 and not value.direction:
            return value.path[0]
        raise self.refuse(item, f"{_name_of(item)} takes a text, not {describe(value)}")

    def pose(self, value: Value | None, item: Item) -> Pose:
        """``[x y z]``, ``[[x y z] [roll pitch yaw]]`` or ``[[x y z] [w x y z]]``; the rotation's notation is remembered."""
        if not is_list(value):
            raise self.refuse(item, f"a pose is [x y z] or [[x y z] [roll pitch yaw]], not {describe(value)}")
        values = cast("tuple[Value, ...]", value)
        if len(values) == 2 and values[0] == "fromto":
            return self._as_written((0.0, 0.0, 0.0), "fromto", values[1], item)
        if not values or not is_list(values[0]):
            return Pose(self.vec3(value, "length", item))
        xyz = self.vec3(values[0], "length", item)
        if len(values) == 1:
            return Pose(xyz)
        if len(values) == 3 and isinstance(values[1], str):
            return self._as_written(xyz, values[1], values[2], item)
        if len(values) != 2 or not is_list(values[1]):
            raise self.refuse(item, f"a pose has a position and a rotation, not {len(values)} parts")
        return self._rotated(xyz, cast("tuple[Value, ...]", values[1]), item)

    def parameter(self, item: Field) -> float | str | tuple[float, ...]:
        """A free value: a number, a text, or a list of numbers."""
        value = item.value
        if value is None:
            return ""
        if is_list(value):
            return self.numbers(value, "", item)
        if isinstance(value, Ref):
            return value.dotted
        return value if isinstance(value, str) else self.number(value, "", item)

    def _as_written(self, xyz: Vec3, kind: str, value: Value, item: Item) -> Pose:
        """A rotation whose notation is said: ``"euler:xyz" [a b c]``, ``"zaxis" [x y z]``, and so on."""
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
            rpy = self.vec3(rotation, "angle", item)
            if not all(map(isfinite, rpy)):
                raise self.refuse(item, f"{rpy} are no angles of a rotation")
            return pose_from_rpy(xyz, rpy)
        w, x, y, z = self.numbers(rotation, "", item, 4)
        try:
            return pose(xyz, (w, x, y, z))
        except ZeroDivisionError as error:
            raise self.refuse(item, f"the quaternion [{numbers_text((w, x, y, z))}] is no rotation") from error


class Block:
    """The items of one block. Every ``take`` removes what it found; ``rest`` is what nobody took.

    In an ``open`` block fields may repeat: what is no word of the part is one of its parameters, in order.
    """

    def __init__(self, items: Iterable[Item], context: Context, *, open: bool = False) -> None:
        self.context = context
        self.free: list[Field] | None = [] if open else None
        self.fields: dict[str, Field] = {}
        self.nodes: list[Node] = []
        self.arcs: list[ArcItem] = []
        self.extras: list[Extra] = []
        self.written: dict[str, str] = {}
        self.classes: tuple[str, ...] = ()
        self.unnamed = False
        self._comments = 0
        for item in items:
            if isinstance(item, Field):
                self._field(item)
            elif isinstance(item, Node):
                self._node(item)
            elif isinstance(item, ArcItem):
                self.arcs.append(item)
            elif isinstance(item, Comment):
                self._comments += 1
                self.extras.append(Extra("comment", "", item.text, self._comments - 1))

    def _node(self, item: Node) -> None:
        if is_foreign(item):
            self.extras += read_foreign(item, self.context)
        elif is_written(item):
            self.written.update(read_written_block(item, self.context))
        else:
            self.nodes.append(item)

    def _field(self, item: Field) -> None:
        if self.free is not None:
            self.free.append(item)
        if isinstance(item.name, QuotedName) and self.free is not None:
            return
        if item.name in FOREIGN or item.name == "extra":
            self.extras += read_extras(item, self.context)
        elif item.name == "class":
            self.classes = read_classes(item, self.context)
        elif item.name == "written":
            self.written.update(read_written(item, self.context))
        elif item.name == CHILD_CLASS:
            self.written[CHILD_CLASS] = self.context.text(item.value, item)
        elif item.name == "unnamed" and item.value is None:
            self.unnamed = True
        elif item.name in self.fields and self.free is None:
            raise self.context.refuse(
                item, f"'{item.name}' is given twice", hint=f"it is first given in line {self.fields[item.name].line}"
            )
        else:
            self.fields.setdefault(item.name, item)

    def take_rest(self, read: Callable[[Field], Parameter]) -> list[tuple[str, Parameter]]:
        """The fields of an open block that are neither words nor settings, in order, as names and values."""
        left = [item for item in self.free or () if isinstance(item.name, QuotedName) or item.name in self.fields]
        self.fields.clear()
        return [(str(item.name), read(item)) for item in left]

    def take(self, name: str, *aliases: str) -> Field | None:
        """The field of this name, or of one of the aliases."""
        for word in (name, *aliases):
            found = self.fields.pop(word, None)
            if found is not None:
                return found
        return None

    def take_text(self, name: str) -> str | None:
        """The field's text, or None when it is not there."""
        found = self.take(name)
        return None if found is None else self.context.text(found.value, found)

    def take_role(self, role: str) -> ArcItem | None:
        """The first arc of this role."""
        for position, arc in enumerate(self.arcs):
            if arc.role == role:
                return self.arcs.pop(position)
        return None

    def take_node(self, name: str) -> Node | None:
        """The first node of this name."""
        for position, node in enumerate(self.nodes):
            if node.name == name:
                return self.nodes.pop(position)
        return None

    def take_words(self, words: Iterable[Word], motion: str = "") -> dict[str, object]:
        """The attributes that these words set; ``motion`` is what the dimension of that name stands for."""
        found: dict[str, object] = {}
        for word in words:
            item = self.fields.pop(word.word, None)
            if item is not None:
                found[word.attribute] = self._word(word, item, motion if word.dimension == "motion" else word.dimension)
        return found

    def _word(self, word: Word, item: Field, dimension: str) -> object:
        context, value = self.context, item.value
        match word.form:
            case "number":
                return context.number(value, dimension, item)
            case "vec3":
                return context.vec3(value, dimension, item)
            case "numbers":
                return (context.number(value, dimension, item),) if type(value) is float else context.numbers(value, dimension, item)
            case "rgba":
                return context.rgba(value, item)
            case "integers" | "pixels":
                count = 2 if word.form == "pixels" else None
                return tuple(context.whole(part, item) for part in context.numbers(value, "", item, count))
            case "flag":
                return self._flag(item)
            case _:
                return context.text(value, item)

    def _flag(self, item: Field) -> bool:
        word = "true" if item.value is None else self.context.text(item.value, item)
        if word not in ("true", "false"):
            raise self.context.refuse(item, f"{_name_of(item)} is true or false, not '{word}'")
        return word == "true"

    def rest(self, element: str) -> None:
        """Report what nobody took (HX061) and keep it as an extra of HyMeKo itself.

        Raises: Refusal for nodes and arcs that mean nothing here.
        """
        from hymeko_x.language.printer import print_item

        left: list[Field | Node | ArcItem] = [*self.fields.values(), *self.nodes, *self.arcs]
        for item in left:
            origin = self.context.origin(item)
            name = item.name if not isinstance(item, ArcItem) else item.role or item.ref.dotted
            self.context.report.warn(codes.UNKNOWN_TYPE, f"{element} has no '{name}'; it is kept as it is", origin, element=element)
            self.extras.append(Extra("hymeko", "", print_item(item)))


def read_classes(item: Field, context: Context) -> tuple[str, ...]:
    """``class "a"`` or, of a joint with several dofs, ``class ["a" "" "b"]``."""
    values = cast("tuple[Value, ...]", item.value) if is_list(item.value) else (item.value,)
    return tuple(context.text(value, item) for value in values)


def read_written(item: Field, context: Context) -> dict[str, str]:
    """``written ["key" "text" ...]``: how something was written, by key."""
    if not is_list(item.value) or len(cast("tuple[Value, ...]", item.value)) % 2:
        raise context.refuse(item, "'written' takes a list of keys and texts")
    texts = [context.text(part, item) for part in cast("tuple[Value, ...]", item.value)]
    return dict(zip(texts[::2], texts[1::2], strict=True))


def is_written(node: Node) -> bool:
    """Whether it is the block ``written { .. }``."""
    return node.name == "written" and not node.edge and not isinstance(node.name, QuotedName) and not node.stereotypes


def read_written_block(node: Node, context: Context) -> dict[str, str]:
    """``written { key text .. }``."""
    return {str(item.name): read_text(item, context) for item in node.items if isinstance(item, Field)}


def read_units(node: Node, context: Context) -> dict[str, float]:
    """The factors that a ``units { angle rad length mm }`` block sets."""
    words = [item.name for item in node.items if isinstance(item, Field)]
    factors = dict(context.units)
    for dimension, unit in zip(words[::2], words[1::2], strict=False):
        known = BASE_UNITS.get(dimension)
        if known is None:
            raise context.refuse(node, f"'{dimension}' is not a dimension; there are {', '.join(BASE_UNITS)}")
        if unit not in known:
            raise context.refuse(node, f"'{unit}' is not a unit of {dimension}; there are {', '.join(known)}")
        factors[dimension] = known[unit]
    if len(words) % 2:
        raise context.refuse(node, f"'{words[-1]}' stands without its unit")
    return factors


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


def _name_of(item: Item) -> str:
    if isinstance(item, ArcItem):
        return f"the arc to '{item.ref.dotted}'"
    return "an import" if not isinstance(item, Node | Field) else f"'{item.name}'"
