"""Forces by expression: ``k*x + 3e5*x**3``."""

from __future__ import annotations

import ast
import warnings
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Origin

_OPERATORS = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Pow)
_FUNCTIONS = ("sin", "cos", "tan", "atan", "sqrt", "exp", "log", "abs", "sign", "tanh")
_LONGEST = 1000
"""Characters; keeps Python's own recursive parser far from its limits."""


def parse_law(text: str, names: tuple[str, ...], element: str, origin: Origin | None) -> ast.expr:
    """The tree of a law in these names.

    Raises: Refusal (HX406) for anything else than arithmetic on the names and the known functions.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", SyntaxWarning)
            tree = ast.parse(text.strip()[:_LONGEST], mode="eval").body
        wrong = "" if len(text) <= _LONGEST else f"more than {_LONGEST} characters"
        wrong = wrong or next(filter(None, (_wrong(node, names) for node in ast.walk(tree))), "")
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        wrong = "what is not arithmetic"
    if wrong:
        message = f"the law of {element} has {wrong}; it is arithmetic on {', '.join(names)} with {', '.join(_FUNCTIONS)}"
        raise refuse(codes.BAD_NETWORK, message, origin, element=element)
    return tree


def _wrong(node: ast.AST, names: tuple[str, ...]) -> str:
    match node:
        case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
            return ""
        case ast.Name(id=name) if name in names or name in _FUNCTIONS:
            return ""
        case ast.Call(func=ast.Name(id=name), args=[_], keywords=[]) if name in _FUNCTIONS:
            return ""
        case ast.UnaryOp(op=ast.USub() | ast.UAdd()) | ast.USub() | ast.UAdd() | ast.Load() | ast.operator():
            return ""
        case ast.BinOp(op=op) if isinstance(op, _OPERATORS):
            return ""
        case ast.Name(id=name):
            return f"the unknown name '{name}'"
    return f"'{ast.unparse(node)}'"
