"""Whether values are of the types that the fields of parts have: what a file carries may be damaged, or made up."""

from __future__ import annotations

from functools import cache
from math import hypot, isfinite
from types import UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

from msgspec import Struct

from hymeko_x.ir import geometry, graph, mechanism, parts, values
from hymeko_x.ir.fields import attributes_of
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.values import Pose

_ROUNDING = 1e-6
"""How far from one the length of a unit quaternion may be."""


def is_sound(part: object) -> bool:
    """Whether a part, or an edge with its arcs, holds nothing but what its fields may hold. Depth is that of the parts."""
    if isinstance(part, Edge):
        shape = tuple if isinstance(part.data, parts.Relation) else tuple[float, ...]
        return is_sound(part.data) and isinstance(part.arcs, tuple) and all(_is_sound_arc(arc, shape) for arc in part.arcs)
    if isinstance(part, Pose) and not _is_placement(part):
        return False
    kind: Any = type(part)
    hints = hints_of(kind)
    fields = ((getattr(part, item.name), hints.get(item.name, Any)) for item in attributes_of(part))
    return all(fits(value, hint) for value, hint in fields)


def _is_placement(pose: Pose) -> bool:
    """Whether a pose is somewhere, and turned by a rotation."""
    if not fits(pose.xyz, values.Vec3) or not fits(pose.quat, values.Quat):
        return False
    return all(map(isfinite, pose.xyz)) and abs(hypot(*pose.quat) - 1) < _ROUNDING


def _is_sound_arc(arc: object, shape: Any) -> bool:
    """Whether an arc holds what it may; ``shape`` is that of a weight that is no pose."""
    if not isinstance(arc, Arc) or not isinstance(arc.target, Id) or arc.sign not in (-1, 0, 1) or not isinstance(arc.role, str):
        return False
    return arc.weight is None or fits(arc.weight, shape) or (isinstance(arc.weight, Pose) and is_sound(arc.weight))


def _is_data(value: object) -> bool:
    """Whether a value is one of plain data: a number, a text, nothing, or a list of such."""
    if isinstance(value, tuple):
        return all(map(_is_data, value))
    return value is None or (isinstance(value, float | int | str) and not isinstance(value, bool))


@cache
def hints_of(kind: Any) -> dict[str, Any]:
    """The types of a part's fields."""
    return get_type_hints(kind, {**vars(graph), **vars(geometry), **vars(mechanism), **vars(parts), **vars(values)})


_WHOLE = frozenset({int, tuple[int, ...], tuple[int, int] | None})
"""The types of fields that hold whole numbers."""


def settled(owner: type, name: object, value: object) -> object:
    """A value for a field of a part, with whole numbers where the field has such: a text knows but one kind of number."""
    if not isinstance(value, tuple | float) or hints_of(owner).get(name) not in _WHOLE:  # type: ignore[call-overload]
        return value
    return tuple(map(_whole, value)) if isinstance(value, tuple) else _whole(value)


def _whole(value: object) -> object:
    return int(value) if isinstance(value, float) and value.is_integer() else value


def fits(value: object, hint: Any) -> bool:
    """Whether a value, with all that is in it, is of a field's type."""
    if hint is Any:
        return True
    if hint is float:
        return isinstance(value, float | int) and not isinstance(value, bool)
    origin = get_origin(hint)
    if origin in (Union, UnionType):
        return any(fits(value, choice) for choice in get_args(hint))
    if origin is tuple:
        return _fits_tuple(value, get_args(hint))
    return isinstance(value, hint) and (not isinstance(value, Struct) or is_sound(value))


def _fits_tuple(value: object, kinds: tuple[Any, ...]) -> bool:
    if not isinstance(value, tuple):
        return False
    if kinds == (Any, Ellipsis):
        return _is_data(value)
    if kinds[-1:] == (Ellipsis,):
        return all(fits(item, kinds[0]) for item in value)
    return len(kinds) == len(value) and all(fits(item, kind) for item, kind in zip(value, kinds, strict=True))
