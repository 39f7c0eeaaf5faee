"""Transfer functions of linear systems, C (s I - A)^-1 B + D, by the algorithm of Faddeev and LeVerrier in exact arithmetic.

In floats the algorithm loses all digits of an arm's coefficients, so that floats are taken as the fractions that they are.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hymeko_x import codes
from hymeko_x.diagnostics import refuse

if TYPE_CHECKING:
    from collections.abc import Sequence

    import sympy

    Columns = Sequence[tuple[int, int | None]]
    """The columns of each input: its own, and that of its rate."""

_MOST = 30
"""States up to which the fractions of numbers are computed, within seconds."""


def transfer_functions(a: sympy.Matrix, b: sympy.Matrix, c: sympy.Matrix, d: sympy.Matrix, columns: Columns) -> list[list[Any]]:
    """The transfer functions from each of the inputs (columns) to each output (rows), as fractions in s.

    A position and its rate are one input: their transfer functions are added, the rate's times s.

    Raises: Refusal (HX408) for a system of numbers with more states than fractions are of use for.
    """
    if any(matrix.free_symbols for matrix in (a, b, c, d)):
        return _of_formulas(a, b, c, d, columns)
    if a.rows > _MOST:
        message = f"transfer functions of {a.rows} states are fractions of that degree; there are none of more than {_MOST}"
        raise refuse(codes.NO_FORM, message, hint="--form state-space has the same system as matrices")
    return _of_numbers(a, b, c, d, columns)


# ---- of formulas -------------------------------------------------------------------------------------------------------------


def _of_formulas(a: sympy.Matrix, b: sympy.Matrix, c: sympy.Matrix, d: sympy.Matrix, columns: Columns) -> list[list[Any]]:
    import sympy

    s = sympy.Symbol("s")
    adjugate, polynomial = _resolvent(a, s)
    whole = (c * adjugate * b + polynomial * d).applyfunc(sympy.expand)
    return [
        [sympy.cancel((whole[row, own] + (0 if rate is None else s * whole[row, rate])) / polynomial) for own, rate in columns]
        for row in range(whole.rows)
    ]


def _resolvent(a: sympy.Matrix, s: sympy.Symbol) -> tuple[sympy.Matrix, sympy.Expr]:
    """The adjugate of s I - A, and its determinant."""
    import sympy

    n = a.rows
    step = sympy.eye(n)
    adjugate, polynomial = step * s ** max(n - 1, 0), s**n
    for k in range(1, n + 1):
        product = a * step
        coefficient = sympy.together(-product.trace() / k)
        polynomial += coefficient * s ** (n - k)
        step = (product + coefficient * sympy.eye(n)).applyfunc(sympy.expand)
        if k < n:
            adjugate += step * s ** (n - 1 - k)
    return adjugate, polynomial


# ---- of numbers --------------------------------------------------------------------------------------------------------------


def _of_numbers(a: sympy.Matrix, b: sympy.Matrix, c: sympy.Matrix, d: sympy.Matrix, columns: Columns) -> list[list[Any]]:
    """By coefficients from the highest power of s to the lowest."""
    import sympy
    from sympy import QQ
    from sympy.polys.matrices import DomainMatrix

    given = (a, b, c, d)
    is_rounded = any(matrix.has(sympy.Float) for matrix in given)
    exact = [
        DomainMatrix([[QQ.from_sympy(sympy.Rational(x)) for x in row] for row in matrix.tolist()], matrix.shape, QQ) for matrix in given
    ]
    n, step, polynomial, parts = a.rows, DomainMatrix.eye(a.rows, QQ).to_dense(), [QQ(1)], []
    for k in range(1, n + 1):
        parts.append((exact[2] * step * exact[1]).to_list())
        product = (exact[0] * step).to_list()
        coefficient = -sum((product[i][i] for i in range(n)), QQ(0)) / k
        polynomial.append(coefficient)
        step = DomainMatrix([[x + coefficient * (i == j) for j, x in enumerate(row)] for i, row in enumerate(product)], (n, n), QQ)
    direct = exact[3].to_list()

    def numerator(row: int, column: int) -> list[Any]:
        return [
            direct[row][column] * own + strict
            for own, strict in zip(polynomial, [QQ(0), *(part[row][column] for part in parts)], strict=True)
        ]

    def function(row: int, own: int, rate: int | None) -> Any:
        found = [QQ(0), *numerator(row, own)]
        if rate is not None:
            found = [x + y for x, y in zip(found, [*numerator(row, rate), QQ(0)], strict=True)]
        return _rounded(found, polynomial) if is_rounded else _cancelled(found, polynomial)

    return [[function(row, own, rate) for own, rate in columns] for row in range(c.rows)]


def _cancelled(above: Sequence[Any], below: Sequence[Any]) -> Any:
    import sympy

    s = sympy.Symbol("s")
    return sympy.cancel(sympy.Poly(above, s, domain="QQ").as_expr() / sympy.Poly(below, s, domain="QQ").as_expr())


def _rounded(above: Sequence[Any], below: Sequence[Any]) -> Any:
    """A fraction of floats, without the powers of s that both have."""
    import sympy

    s = sympy.Symbol("s")
    if not any(above):
        return sympy.Integer(0)
    shared = min(next(k for k, x in enumerate(reversed(numbers)) if x) for numbers in (above, below))
    texts = []
    for numbers in (above, below):
        kept = list(numbers[: len(numbers) - shared])
        texts.append(
            sum(
                (sympy.Float(sympy.Rational(int(x.numerator), int(x.denominator))) * s**k for k, x in enumerate(reversed(kept)) if x),
                sympy.Integer(0),
            )
        )
    return texts[0] / texts[1]
