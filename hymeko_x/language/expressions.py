"""Arithmetic in ``${ }``: numbers, parameters, the usual operators and a few functions. Nothing else can be said."""

from __future__ import annotations

import ast
import math
import warnings
from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

CONSTANTS: Mapping[str, float] = MappingProxyType({"pi": math.pi, "tau": math.tau, "e": math.e, "inf": math.inf})
FUNCTIONS: Mapping[str, Callable[..., float]] = MappingProxyType(
    {
        name: getattr(math, name)
        for name in (
            "sin",
            "cos",
            "tan",
            "asin",
            "acos",
            "atan",
            "atan2",
            "sqrt",
            "hypot",
            "radians",
            "degrees",
            "exp",
            "log",
            "floor",
            "ceil",
        )
    }
    | {"abs": abs, "min": min, "max": max}
)
_OPERATORS: Mapping[type[ast.operator], Callable[[float, float], float]] = MappingProxyType(
    {
        ast.Add: lambda a, b: a + b,
        ast.Sub: lambda a, b: a - b,
        ast.Mult: lambda a, b: a * b,
        ast.Div: lambda a, b: a / b,
        ast.Mod: lambda a, b: a % b,
        ast.FloorDiv: lambda a, b: a // b,
    }
)
_WORDS: Mapping[type[Exception], str] = MappingProxyType(
    {
        ZeroDivisionError: "it divides by zero",
        OverflowError: "its value is too large",
        RecursionError: "it is nested too deep",
    }
)
_MAX_LENGTH = 1000  # characters; keeps Python's own recursive parser far from its limits


class ExpressionError(ValueError):
    """Says what is wrong with an expression, in words for its author."""


def evaluate(text: str, parameters: Mapping[str, float | str]) -> float | str:
    """The value of an expression. A parameter alone may be a text; everything else is a number.

    Raises: ExpressionError for anything that is not arithmetic on known names with a finite result.
    """
    if text in parameters:
        return parameters[text]
    if len(text) > _MAX_LENGTH:
        raise ExpressionError(f"the expression has more than {_MAX_LENGTH} characters")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", SyntaxWarning)  # what Python would rather not read, such as 1or 2
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


def _evaluate(node: ast.expr, parameters: Mapping[str, float | str]) -> float:
    match node:
        case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
            return float(number)
        case ast.Name(id=name):
            return _named(name, parameters)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_evaluate(operand, parameters)
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return _evaluate(operand, parameters)
        case ast.BinOp(left=left, op=ast.Pow(), right=right):
            return _power(_evaluate(left, parameters), _evaluate(right, parameters))
        case ast.BinOp(left=left, op=operator, right=right) if type(operator) in _OPERATORS:
            return _OPERATORS[type(operator)](_evaluate(left, parameters), _evaluate(right, parameters))
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]) if name in FUNCTIONS:
            return float(FUNCTIONS[name](*[_evaluate(argument, parameters) for argument in arguments]))
    raise ExpressionError(f"'{ast.unparse(node)}' is not arithmetic; there are + - * / % ** ( ) and {', '.join(FUNCTIONS)}")


def _named(name: str, parameters: Mapping[str, float | str]) -> float:
    value = parameters.get(name, CONSTANTS.get(name))
    if value is None:
        known = ", ".join([*parameters, *CONSTANTS])
        raise ExpressionError(f"'{name}' is not known here; there is {known}")
    if isinstance(value, str):
        raise ExpressionError(f"'{name}' is the text {value!r}, not a number")
    return value


def _power(base: float, exponent: float) -> float:
    return math.pow(base, exponent)  # a ValueError where the result is no real number
