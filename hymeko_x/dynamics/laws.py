"""The values of forces by expression, on any number type."""

from __future__ import annotations

import ast
import operator
from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.dynamics.numbers import Number, Numbers

_OPERATORS: Mapping[type[ast.operator], Callable[[Number, Number], Number]] = MappingProxyType(
    {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.Pow: operator.pow}
)


def evaluate(tree: ast.expr, values: Mapping[str, Number], numbers: Numbers) -> Number:
    """The value of a law, its names standing for these numbers."""
    match tree:
        case ast.Constant(value=int() | float() as number):
            return numbers.exact(float(number)) if isinstance(number, float) else number
        case ast.Name(id=name):
            return values[name]
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -evaluate(operand, values, numbers)
        case ast.UnaryOp(operand=operand):
            return evaluate(operand, values, numbers)
        case ast.BinOp(left=left, op=op, right=right):
            return _OPERATORS[type(op)](evaluate(left, values, numbers), evaluate(right, values, numbers))
        case ast.Call(func=ast.Name(id=name), args=[argument]):
            return numbers.functions[name](evaluate(argument, values, numbers))
    raise AssertionError(ast.dump(tree))
