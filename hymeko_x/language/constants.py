"""Constants: ``const K = 2 * L;`` makes ``K`` a number in the values and expressions of the whole text."""

from __future__ import annotations

import re
from graphlib import CycleError, TopologicalSorter
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

    Raises: Refusal (HX023) for two constants of one name, HX064 for a constant without a value, HX067 for constants in a circle.
    """
    found = _by_name(_constants(items), file)
    if not found:
        return items
    numbers: dict[str, float | str] = {}
    for name in _in_order(found, file):
        numbers[name] = _evaluated(found[name], numbers, file)
    return _filled(items, numbers)


def _constants(items: tuple[Item, ...]) -> list[Constant]:
    """Those that stand in the text itself, and in its outermost blocks."""
    blocks = [items, *(item.items for item in items if isinstance(item, Node))]
    return [item for block in blocks for item in block if isinstance(item, Constant)]


def _by_name(constants: list[Constant], file: str) -> dict[str, Constant]:
    found: dict[str, Constant] = {}
    for constant in constants:
        first = found.setdefault(constant.name, constant)
        if first is not constant:
            message = f"the constant '{constant.name}' is defined twice; the first definition is in line {first.line}"
            raise refuse(codes.DUPLICATE_NAME, message, origin_of(constant, file), hint="give one of them another name")
    return found


def _in_order(found: Mapping[str, Constant], file: str) -> list[str]:
    """The names, each behind those in its expression."""
    uses = {name: [other for other in _NAMES.findall(constant.text) if other in found] for name, constant in found.items()}
    try:
        return [*TopologicalSorter(uses).static_order()]
    except CycleError as error:
        way = [*reversed(error.args[1])]
        message, hint = f"the value of '{way[0]}' leads back to itself: {' -> '.join(way)}", "give one of them a number"
        raise refuse(codes.CIRCULAR_VALUE, message, origin_of(found[way[0]], file), hint=hint) from error


def _evaluated(constant: Constant, numbers: Mapping[str, float | str], file: str) -> float | str:
    """The value of a constant; ``numbers`` has those of the constants in it."""
    try:
        return evaluate(constant.text, numbers)
    except ExpressionError as error:
        message = f"const {constant.name} = {constant.text}: {error}"
        hint = "a constant is arithmetic on plain numbers and other constants: const AREA = pi * R ** 2;"
        raise refuse(codes.BAD_EXPRESSION, message, origin_of(constant, file), hint=hint) from error


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
