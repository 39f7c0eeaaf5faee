"""Arithmetic in ``${ }``: numbers, parameters, the usual operators and a few functions, and items with their expressions evaluated."""

from __future__ import annotations

import ast
import math
import operator
import re
import warnings
from collections.abc import Callable, Mapping
from types import MappingProxyType

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.language.syntax import (
    ArcItem,
    Comment,
    Constant,
    Expression,
    Field,
    Import,
    Item,
    Node,
    Ref,
    Stereotype,
    Using,
    Value,
    origin_of,
)

Environment = Mapping[str, float | str]
"""The parameters of a template with their values."""

CONSTANTS: Mapping[str, float] = MappingProxyType({"pi": math.pi, "tau": math.tau, "e": math.e, "inf": math.inf})
_MATH = ["sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sqrt", "hypot", "radians", "degrees", "exp", "log", "floor", "ceil"]
FUNCTIONS: Mapping[str, Callable[..., float]] = MappingProxyType(
    {name: getattr(math, name) for name in _MATH} | {"abs": abs, "min": min, "max": max}
)
_OPERATORS: Mapping[type[ast.operator], Callable[[float, float], float]] = MappingProxyType(
    {
        ast.Add: operator.add,
        ast.Sub: operator.sub,
        ast.Mult: operator.mul,
        ast.Div: operator.truediv,
        ast.Mod: operator.mod,
        ast.FloorDiv: operator.floordiv,
        ast.Pow: math.pow,  # a ValueError where the result is no real number
    }
)
_WORDS: Mapping[type[Exception], str] = MappingProxyType(
    {
        ZeroDivisionError: "it divides by zero",
        OverflowError: "its value is too large",
        RecursionError: "it is nested too deep",
    }
)
INDEX = "i"
"""The number of an element of an array, from 0, in the expressions of the array."""
_LATER = "the number of an element that is not made yet"
_NAMES = re.compile(r"(?<![\w.])[^\W\d]\w*")
MAX_TEXT = 100_000
"""Characters of a text with `${ }` in it."""
_INTERPOLATION = re.compile(r"\$\{([^{}]*)\}")
_MAX_LENGTH = 1000  # characters; keeps Python's own recursive parser far from its limits


class ExpressionError(ValueError):
    """The message for the author of an expression that has no value."""


def evaluate(text: str, parameters: Environment) -> float | str:
    """The value of an expression. A parameter alone may be a text; everything else is a number.

    Raises: ExpressionError for anything that is not arithmetic on known names with a finite result.
    """
    if text in parameters:
        return parameters[text]
    if len(text) > _MAX_LENGTH:
        raise ExpressionError(f"the expression has more than {_MAX_LENGTH} characters")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", SyntaxWarning)  # for texts such as 1or 2
            tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
        raise ExpressionError("it is not arithmetic") from error
    try:
        value = _evaluate(tree.body, parameters)
    except ExpressionError:
        raise
    except (ZeroDivisionError, OverflowError, RecursionError, ValueError, TypeError) as error:
        raise ExpressionError(_WORDS.get(type(error), f"it has no value: {error}")) from error
    if not math.isfinite(value):
        raise ExpressionError(f"its value is {value}")
    return value


def _evaluate(node: ast.expr, parameters: Environment) -> float:
    match node:
        case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
            return float(number)
        case ast.Name(id=name):
            return _named(name, parameters)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_evaluate(operand, parameters)
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return _evaluate(operand, parameters)
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
            return _OPERATORS[type(op)](_evaluate(left, parameters), _evaluate(right, parameters))
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]) if name in FUNCTIONS:
            return float(FUNCTIONS[name](*[_evaluate(argument, parameters) for argument in arguments]))
    raise ExpressionError(f"'{ast.unparse(node)}' is not arithmetic; there are + - * / % ** ( ) and {', '.join(FUNCTIONS)}")


def _named(name: str, parameters: Environment) -> float:
    value = parameters.get(name, CONSTANTS.get(name))
    if value is None:
        known = ", ".join([*parameters, *CONSTANTS])
        raise ExpressionError(f"'{name}' is not known here; there is {known}")
    if isinstance(value, str):
        raise ExpressionError(f"'{name}' is the text {value!r}, not a number")
    return value


def fill(item: Item, environment: Environment, file: str) -> Item:
    """The item of a template with every expression replaced by its value.

    Raises: Refusal (HX064) at the item, HX007 for texts that grow too long.
    """
    if not environment and not _calculates(item):
        return item
    match item:
        case Field(value=None) | Import() | Using() | Constant() | Comment():
            return item
        case Field():
            assert item.value is not None
            return item._replace(value=fill_value(item.value, environment, item, file))
        case ArcItem():
            return _filled_arc(item, environment, file)
        case Node():
            return _filled_node(item, environment, file)


def _filled_node(node: Node, environment: Environment, file: str) -> Node:
    """The node; expressions of an array that use the number of its elements wait for that."""
    inner = environment
    if node.size is not None:
        node = node._replace(size=fill_value(node.size, environment, node, file))
        inner = {**environment, INDEX: _LATER}
    items = tuple(fill(item, inner, file) for item in node.items)
    types = tuple(_filled_arguments(stereotype, inner, node, file) for stereotype in node.stereotypes)
    return node._replace(name=fill_text(node.name, environment, node, file), items=items, stereotypes=types)


def _filled_arguments(stereotype: Stereotype, environment: Environment, node: Node, file: str) -> Stereotype:
    if not stereotype.arguments:
        return stereotype
    return stereotype._replace(arguments=tuple((name, fill_value(value, environment, node, file)) for name, value in stereotype.arguments))


def _filled_arc(arc: ArcItem, environment: Environment, file: str) -> ArcItem:
    weight = arc.weight
    if weight is not None:
        weight = tuple(fill_value(value, environment, arc, file) for value in weight)
    items = tuple(fill(inner, environment, file) for inner in arc.items)
    role = fill_text(arc.role, environment, arc, file)
    return arc._replace(ref=_filled_ref(arc.ref, environment, arc, file), role=role, weight=weight, items=items)


def _filled_ref(ref: Ref, environment: Environment, item: Item, file: str) -> Ref:
    return ref._replace(path=tuple(fill_text(step, environment, item, file) for step in ref.path))


def fill_value(value: Value, environment: Environment, item: Item, file: str) -> Value:
    """A value of the item with its expressions evaluated."""
    if type(value) is float:
        return value
    if type(value) is str:
        return fill_text(value, environment, item, file)
    if isinstance(value, Expression):
        if _waits(value.text, environment):
            return Expression(_with_numbers(value.text, environment))
        return _value_of(value.text, environment, item, file)
    if type(value) is tuple:
        return tuple(fill_value(part, environment, item, file) for part in value)
    return _filled_ref(value, environment, item, file) if isinstance(value, Ref) else value


def fill_text(text: str, environment: Environment, item: Item, file: str) -> str:
    """A name or string of the item with its ``${ }`` filled in, inside a template."""
    if not environment or "${" not in text:
        return text

    def interpolated(match: re.Match[str]) -> str:
        if _waits(match[1], environment):
            return f"${{{_with_numbers(match[1], environment)}}}"
        value = _value_of(match[1], environment, item, file)
        if isinstance(value, str):
            return value
        return str(int(value)) if value.is_integer() else repr(value)

    filled = _INTERPOLATION.sub(interpolated, text)
    if len(filled) > MAX_TEXT:
        raise refuse(codes.TOO_LARGE, f"a text grows to more than {MAX_TEXT} characters", origin_of(item, file))
    return type(text)(filled)


def _waits(text: str, environment: Environment) -> bool:
    """Whether an expression uses the number of an element of an array that is not made yet."""
    return environment.get(INDEX) is _LATER and INDEX in _NAMES.findall(text)


def _with_numbers(text: str, environment: Environment) -> str:
    """An expression with the numbers of the parameters that are known."""

    def known(match: re.Match[str]) -> str:
        value = environment.get(match[0])
        return f"({value!r})" if isinstance(value, float) else match[0]

    return _NAMES.sub(known, text)


def _value_of(text: str, environment: Environment, item: Item, file: str) -> float | str:
    try:
        return evaluate(text.strip(), environment)
    except ExpressionError as error:
        raise refuse(codes.BAD_EXPRESSION, f"${{{text}}}: {error}", origin_of(item, file)) from error


def _calculates(item: Item | Value | None) -> bool:
    """Whether there is an expression in it."""
    match item:
        case Expression():
            return True
        case Field():
            return _calculates(item.value)
        case ArcItem():
            return _calculates(item.weight) or any(map(_calculates, item.items))
        case Node():
            return any(map(_calculates, item.items)) or any(kind.arguments for kind in item.stereotypes)
        case tuple():
            return any(_calculates(part) for part in item if type(part) is not float)
    return False
