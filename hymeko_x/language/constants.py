"""Constants: ``const K = 2 * L;`` makes ``K`` a number in the values and expressions of the whole text."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.language.expressions import ExpressionError, evaluate
from hymeko_x.language.syntax import ArcItem, Constant, Expression, Field, Item, Node, Quantity, Ref, Value, is_list, origin_of

if TYPE_CHECKING:
    from collections.abc import Mapping

_NAMES = re.compile(r"(?<![\w.])[^\W\d]\w*")


def with_constants(items: tuple[Item, ...], file: str) -> tuple[Item, ...]:
    """The items of a text without its constants, and with numbers in their place.

    Raises: Refusal (HX064) for a constant without a value, HX067 for constants in a circle.
    """
    found = {constant.name: constant for constant in _constants(items)}
    if not found:
        return items
    numbers: dict[str, float | str] = {}
    for name in found:
        _evaluate(name, found, numbers, (), file)
    return _filled(items, numbers)


def _constants(items: tuple[Item, ...]) -> list[Constant]:
    """Those that stand in the text itself, and in its outermost blocks."""
    blocks = [items, *(item.items for item in items if isinstance(item, Node))]
    return [item for block in blocks for item in block if isinstance(item, Constant)]


def _evaluate(name: str, found: Mapping[str, Constant], numbers: dict[str, float | str], active: tuple[str, ...], file: str) -> None:
    """Add the value of a constant, after those of the constants in it."""
    if name in numbers:
        return
    constant = found[name]
    origin = origin_of(constant, file)
    if name in active:
        way = " -> ".join([*active[active.index(name) :], name])
        raise refuse(codes.CIRCULAR_VALUE, f"the value of '{name}' leads back to itself: {way}", origin)
    for other in _NAMES.findall(constant.text):
        if other in found:
            _evaluate(other, found, numbers, (*active, name), file)
    try:
        numbers[name] = evaluate(constant.text, numbers)
    except ExpressionError as error:
        raise refuse(codes.BAD_EXPRESSION, f"const {name} = {constant.text}: {error}", origin) from error


def _filled(items: tuple[Item, ...], numbers: Mapping[str, float | str]) -> tuple[Item, ...]:
    """The items with numbers; ``mass K`` is a field and its value, where ``K`` is a constant."""
    found: list[Item] = []
    for item in items:
        last = found[-1] if found else None
        if isinstance(item, Constant):
            continue
        if isinstance(item, Field) and item.value is None and item.name in numbers and isinstance(last, Field) and last.value is None:
            found[-1] = last._replace(value=numbers[item.name])
        elif isinstance(item, Field) and item.value is not None:
            found.append(item._replace(value=_value(item.value, numbers)))
        elif isinstance(item, ArcItem):
            weight = None if item.weight is None else tuple([_value(part, numbers) for part in item.weight])
            found.append(item._replace(weight=weight, items=_filled(item.items, numbers)))
        elif isinstance(item, Node):
            found.append(item._replace(items=_filled(item.items, numbers)))
        else:
            found.append(item)
    return tuple(found)


def _value(value: Value, numbers: Mapping[str, float | str]) -> Value:
    if isinstance(value, Ref):
        return numbers.get(value.path[0], value) if len(value.path) == 1 and not value.direction else value
    if isinstance(value, Expression):
        return Expression(_NAMES.sub(lambda match: f"({numbers[match[0]]!r})" if match[0] in numbers else match[0], value.text))
    if isinstance(value, Quantity) or not is_list(value):
        return value
    return tuple([part if type(part) is float else _value(part, numbers) for part in value])
