"""Values of the IR as values of the language, and back: any part, pose, notation, id or number.

A part is a list of its class and of the fields that are not defaults (``[Limits lower -1 upper 1]``), an id a path of kind and name
(``body.torso``), a rotation with its notation ``[rpy [0 0 1.57]]``.
"""

from __future__ import annotations

from enum import Enum
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from msgspec import NODEFAULT, Struct

from hymeko_x.ir import geometry, lumped, parts, values
from hymeko_x.ir.digits import are_numbers
from hymeko_x.ir.fields import NUMBERS, attributes_of, identical
from hymeko_x.ir.graph import Arc
from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.types import is_sound, settled
from hymeko_x.ir.values import ZERO, Written
from hymeko_x.ir.written import pose_as_written
from hymeko_x.language.syntax import Ref, is_list

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.language.syntax import Value

_CLASSES: Mapping[str, type] = MappingProxyType(
    {
        kind.__name__: kind
        for module in (geometry, lumped, parts, values)
        for kind in vars(module).values()
        if isinstance(kind, type) and kind.__module__ == module.__name__ and issubclass(kind, Struct)
    }
    | {"Arc": Arc}
)
_WORDS: Mapping[str, object] = MappingProxyType(
    {"none": None, "true": True, "false": False} | {word.value: word for kind in (parts.Role, parts.DofKind) for word in kind}
)


def name_ref(name: str) -> Ref:
    """A bare name."""
    return Ref((name,))


def encoded(value: object) -> Value:
    """A value of the IR as a value of the language, as deep as the parts are."""
    if isinstance(value, bool) or value is None:
        return name_ref("none" if value is None else str(value).lower())
    if isinstance(value, NUMBERS):
        return float(value)
    if isinstance(value, str):
        return value
    if isinstance(value, Enum):
        return name_ref(str(value.value))
    if isinstance(value, Id):
        return Ref((value.kind, value.name))
    if isinstance(value, Written):
        return (name_ref("Written"), value.kind, value.numbers)
    if isinstance(value, tuple):
        return value if are_numbers(value) else tuple([encoded(item) for item in value])
    return (name_ref(type(value).__name__), *(word for name, inner in given_fields(value) for word in (name_ref(name), inner)))


def given_fields(part: object) -> Iterator[tuple[str, Value]]:
    """The fields of a part that are not their defaults."""
    for item in attributes_of(part):
        value = getattr(part, item.name)
        if item.default is NODEFAULT or not identical(value, item.default):
            yield item.name, encoded(value)


def encoded_turn(turn: tuple[values.Quat, Written | None]) -> Value:
    """A rotation with its notation: the quaternion, or the notation alone where that means exactly this quaternion."""
    quat, written = turn
    if written is None:
        return quat
    if identical(pose_as_written(ZERO, written).quat, quat):
        return (name_ref(written.kind), written.numbers)
    return (name_ref(written.kind), written.numbers, quat)


def decoded(value: Value | None) -> Any:
    """The value that :func:`encoded` was given.

    Raises: ValueError, LookupError or TypeError for other values.
    """
    if isinstance(value, Ref):
        return Id(*map(str, value.path)) if len(value.path) == 2 else _WORDS[value.dotted]
    if not is_list(value):
        return value
    head = value[0] if value else None
    if isinstance(head, Ref) and head.path[0] == "Written":
        return Written(str(value[1]), tuple(map(_number, _items(value[2]))))
    if isinstance(head, Ref) and len(head.path) == 1 and head.path[0] in _CLASSES:
        return _part(_CLASSES[head.path[0]], value[1:])
    return tuple(decoded(item) for item in value)


def _part(kind: type, words: tuple[Value, ...]) -> object:
    names = [name_of(word) for word in words[::2]]
    part: object = kind(**{name: settled(kind, name, decoded(word)) for name, word in zip(names, words[1::2], strict=True)})
    if kind is not Arc and not is_sound(part):
        raise ValueError(f"no {kind.__name__}: {part!r}")
    return part


def decoded_turn(value: Value | None) -> tuple[values.Quat, Written | None]:
    """The rotation that :func:`encoded_turn` was given.

    Raises: ValueError, LookupError or TypeError for other values.
    """
    items = _items(value)
    if len(items) == 4:
        return tuple(map(_number, items)), None  # type: ignore[return-value]
    written = Written(name_of(items[0]), tuple(map(_number, _items(items[1]))))
    if len(items) == 3:
        return decoded_turn(items[2])[0], written
    return pose_as_written(ZERO, written).quat, written


def _items(value: Value | None) -> tuple[Value, ...]:
    if not is_list(value):
        raise ValueError(f"{value!r} is no list")
    return value


def _number(value: Value) -> float:
    if not isinstance(value, float):
        raise ValueError(f"{value!r} is no number")
    return value


def name_of(value: object) -> str:
    """The name that a reference of one word is. Raises: ValueError for anything else."""
    if not isinstance(value, Ref) or len(value.path) != 1:
        raise ValueError(f"{value!r} is no name")
    return str(value.path[0])
