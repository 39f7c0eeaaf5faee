"""The number types that equations are computed with: arrays of floats, sympy expressions, casadi expressions.

Every equation of this room is written once, with ``+ - * /`` and the functions of a :class:`Numbers`.
"""

from __future__ import annotations

import ast
import operator
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from msgspec import Struct

from hymeko_x.ir.digits import number_text

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

Number = Any
"""A float, an array of floats (one entry per configuration), or an expression."""

_NAMES = ("sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sqrt", "exp", "log", "abs", "sign", "tanh")


class Numbers(Struct, frozen=True):
    """One number type: how a float becomes one of its numbers, and its functions by name."""

    name: str
    exact: Callable[[float], Number]
    functions: Mapping[str, Callable[..., Number]]

    def sin(self, x: Number) -> Number:
        """The sine of an angle in rad."""
        return self.functions["sin"](x)

    def cos(self, x: Number) -> Number:
        """The cosine of an angle in rad."""
        return self.functions["cos"](x)


@cache
def floats() -> Numbers:
    """Floats, and numpy arrays of them: each number may have a value per configuration."""
    import numpy as np

    renamed = {"asin": "arcsin", "acos": "arccos", "atan": "arctan", "atan2": "arctan2"}
    return Numbers("float", float, MappingProxyType({name: getattr(np, renamed.get(name, name)) for name in _NAMES}))


@cache
def symbols() -> Numbers:
    """Expressions of sympy. Floats become the fractions that their shortest decimals stand for: 0.1 is 1/10."""
    import sympy

    renamed = {"abs": "Abs"}
    functions = {name: getattr(sympy, renamed.get(name, name)) for name in _NAMES}
    return Numbers("sympy", lambda value: sympy.Rational(number_text(value)), MappingProxyType(functions))


@cache
def graphs() -> Numbers:
    """Expression graphs of casadi, with derivatives and generated C code."""
    import casadi

    renamed = {"abs": "fabs"}
    return Numbers("casadi", float, MappingProxyType({name: getattr(casadi, renamed.get(name, name)) for name in _NAMES}))


_PLAIN = frozenset({int, float})


def is_zero(x: Number) -> bool:
    """Whether a number is zero by its form, so that a product with it need not be computed."""
    kind = type(x)
    if kind in _PLAIN:
        return bool(x == 0)
    return kind.__module__ != "numpy" and getattr(x, "is_Number", False) is True and bool(x == 0)


def is_one(x: Number) -> bool:
    """Whether a number is one by its form."""
    return type(x) in _PLAIN and bool(x == 1)


def add(a: Number, b: Number) -> Number:
    """a + b, where zeros cost nothing."""
    return b if is_zero(a) else a if is_zero(b) else a + b


def times(a: Number, b: Number) -> Number:
    """a * b, where zeros and ones cost nothing."""
    if is_zero(a) or is_zero(b):
        return 0
    return b if is_one(a) else a if is_one(b) else a * b


def dot(a: Sequence[Number], b: Sequence[Number]) -> Number:
    """The sum of the products."""
    total: Number = 0
    for x, y in zip(a, b, strict=True):
        total = add(total, times(x, y))
    return total


Matrix = list[list[Number]]


def factorize(matrix: Matrix) -> tuple[Matrix, list[Number]]:
    """The factors L (unit lower triangular) and d of a symmetric positive definite matrix L diag(d) L'. Zeros stay zeros.

    Source: Golub & Van Loan, Matrix Computations, algorithm 4.1.2.
    """
    n = len(matrix)
    lower: Matrix = [[0] * n for _ in range(n)]
    diagonal: list[Number] = []
    for j in range(n):
        scaled = [times(lower[j][k], diagonal[k]) for k in range(j)]
        diagonal.append(add(matrix[j][j], -1 * dot(lower[j][:j], scaled)))
        for i in range(j + 1, n):
            rest = add(matrix[i][j], -1 * dot(lower[i][:j], scaled))
            lower[i][j] = 0 if is_zero(rest) else rest / diagonal[j]
    return lower, diagonal


def solve(factors: tuple[Matrix, list[Number]], right: Sequence[Number]) -> list[Number]:
    """The solution x of L diag(d) L' x = right."""
    lower, diagonal = factors
    n = len(diagonal)
    x: list[Number] = []
    for i in range(n):
        x.append(add(right[i], -1 * dot(lower[i][:i], x)))
    x = [0 if is_zero(value) else value / d for value, d in zip(x, diagonal, strict=True)]
    for i in reversed(range(n)):
        x[i] = add(x[i], -1 * dot([lower[k][i] for k in range(i + 1, n)], x[i + 1 :]))
    return x


# ---- laws --------------------------------------------------------------------------------------------------------------------------


_OPERATORS: Mapping[type[ast.operator], Callable[[Number, Number], Number]] = MappingProxyType(
    {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.Pow: operator.pow}
)


def evaluate(tree: ast.expr, values: Mapping[str, Number], numbers: Numbers) -> Number:
    """The value of a force's law, which is an expression, its names standing for these numbers."""
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
