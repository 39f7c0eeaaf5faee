"""The fields of parts, and whether values are the same to the last bit. Looked up once per class: every comparison goes through here."""

from __future__ import annotations

from functools import cache
from math import copysign
from operator import attrgetter
from typing import TYPE_CHECKING, Any, NamedTuple

from msgspec import NODEFAULT, Struct
from msgspec.msgpack import Encoder

if TYPE_CHECKING:
    from collections.abc import Callable


Parameters = tuple[tuple[str, "float | str | tuple[float, ...]"], ...]
"""Named parameters of kinds that differ too much to be typed (an actuator's gains, a sensor's noise), in order."""

DataValue = float | str | tuple[Any, ...] | None
"""A value of plain data: a number, a text, a list of values of any shape; None is a value that is left open."""
Data = tuple[tuple[str, DataValue], ...]
"""Named values of the vertices and edges of plain hypergraphs, in order."""

NUMBERS = (float, int)
"""The types of numbers, as a test of millions of values needs them."""
_MANY = 64
"""Numbers of a row that are compared all at once: the points of a mesh."""


class Attribute(NamedTuple):
    """A field of a part."""

    name: str
    default: object
    compare: bool


class FieldLayout(NamedTuple):
    """The fields of a class, with what gets all their values at once, and those that count in comparisons."""

    attributes: tuple[Attribute, ...]
    values: Callable[[object], tuple[Any, ...]]
    counting: tuple[Attribute, ...]
    compared: Callable[[object], tuple[Any, ...]]


class Noted(Struct, frozen=True, forbid_unknown_fields=True):
    """A value that also keeps how its author wrote it, or where: such fields are ``uncompared``."""

    uncompared = ("written",)  # not annotated: it is no field

    def __eq__(self, other: object) -> bool:
        if self is other:
            return True
        if other.__class__ is not self.__class__:
            return NotImplemented
        compared = layout_of(self.__class__).compared  # type: ignore[union-attr]
        return compared(self) == compared(other)

    __ne__ = object.__ne__  # the opposite of __eq__, which a Struct's own is not

    def __hash__(self) -> int:
        return hash(layout_of(self.__class__).compared(self))  # type: ignore[union-attr]


def attributes_of(part: object) -> tuple[Attribute, ...]:
    """The fields of a part, with their defaults (NODEFAULT for those that have none)."""
    layout = layout_of(type(part))
    assert layout is not None, f"{type(part).__name__} is no part"
    return layout.attributes


def _layout_of(kind: Any) -> FieldLayout | None:
    if not issubclass(kind, Struct):
        return None
    names, uncompared = kind.__struct_fields__, kind.uncompared if issubclass(kind, Noted) else ()
    defaults = (*[NODEFAULT] * (len(names) - len(kind.__struct_defaults__)), *kind.__struct_defaults__)
    attributes = tuple(Attribute(name, default, name not in uncompared) for name, default in zip(names, defaults, strict=True))
    counting = tuple(f for f in attributes if f.compare)
    return FieldLayout(attributes, getter([f.name for f in attributes]), counting, getter([f.name for f in counting]))


def getter(names: list[str]) -> Callable[[Any], tuple[Any, ...]]:
    """A function that returns these attributes of an object, as a tuple however many there are."""
    if len(names) > 1:
        return attrgetter(*names)
    return lambda value: tuple([getattr(value, name) for name in names])


layout_of: Callable[[Any], FieldLayout | None] = cache(_layout_of)
"""The fields of a part; None for every other type."""


_bytes_of = Encoder().encode


def have_same_bytes(a: object, b: object) -> bool:
    """Whether two values of a type are the same to the last bit, as a writer of bytes sees at once; if not, they still may be.

    Floats are written with all their bits, and the names of fields as well. What cannot be written is left to :func:`identical`.
    """
    try:
        return a is b or _bytes_of(a) == _bytes_of(b)
    except (TypeError, ValueError, OverflowError):
        return False


def identical(a: object, b: object) -> bool:
    """Whether two values are the same to the last bit, notations and the sign of zero included."""
    if a is b:
        return True
    kind = type(a)
    if kind is tuple and type(b) is tuple:
        return len(a) == len(b) and _are_identical(a, b)  # type: ignore[arg-type]
    if isinstance(a, NUMBERS) and isinstance(b, NUMBERS):
        return (a == b and (a != 0.0 or copysign(1.0, a) == copysign(1.0, b))) or (a != a and b != b)
    if isinstance(a, str) or kind is not type(b):
        return a == b
    if isinstance(a, tuple):
        assert isinstance(b, tuple)
        return len(a) == len(b) and _are_identical(a, b)
    layout = layout_of(kind)
    return a == b if layout is None else _are_identical(layout.values(a), layout.values(b))


def _are_identical(a: tuple[object, ...], b: tuple[object, ...]) -> bool:
    if len(a) > _MANY and have_same_bytes(a, b):
        return True
    for x, y in zip(a, b, strict=True):
        if x is y:
            continue
        kind = type(x)
        if kind is float and type(y) is float:
            if x != y:
                if x == x or y == y:
                    return False
            elif x == 0.0 and copysign(1.0, x) != copysign(1.0, y):
                return False
        elif kind is str or (kind is int and type(y) is int):
            if x != y:
                return False
        elif not identical(x, y):
            return False
    return True
