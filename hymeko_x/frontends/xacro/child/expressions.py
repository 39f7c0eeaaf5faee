"""The fence around Python in ${...} and $(eval ...): which names and attributes an expression may use."""

from __future__ import annotations

import ast
import builtins
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from hymeko_x.frontends.xacro.child.channel import Trouble
from hymeko_x.frontends.xacro.child.dom import EXPRESSION

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from types import CodeType

FORBIDDEN_ATTRIBUTES = frozenset(
    ("gi_frame", "gi_code", "gi_yieldfrom", "cr_frame", "cr_code", "ag_frame", "ag_code", "tb_frame", "f_back", "f_builtins", "f_globals")
)
"""Attributes without underscores that lead from a value to the frame that made it, and from there to everything."""

FUNCTIONS = (
    *("abs", "all", "any", "bool", "complex", "dict", "divmod", "enumerate", "filter", "float", "frozenset", "int", "isinstance", "len"),
    *("list", "map", "max", "min", "ord", "range", "repr", "reversed", "round", "set", "slice", "sorted", "str", "sum", "tuple", "zip"),
)
"""The built-in functions of $(eval ...)."""


@lru_cache(4096)
def compiled(text: str) -> CodeType:
    """The code of an expression, after a look at every name in it, in lambdas and comprehensions too.

    xacro itself looks only at the names outside of those.
    """
    tree = ast.parse(text.strip(), EXPRESSION, "eval")
    for node in ast.walk(tree):
        name = node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""
        if name.startswith("__") or (isinstance(node, ast.Attribute) and name in FORBIDDEN_ATTRIBUTES):
            raise Trouble("forbidden", name=name, text=text)
    return compile(tree, EXPRESSION, "eval")


def safe_eval(text: str, symbols: dict[str, Any], local: Mapping[str, Any] | None = None) -> Any:
    """The value of a ${...}, in place of the function of this name in xacro."""
    code = compiled(text)
    symbols.update(__builtins__={})
    return eval(code, symbols, local)


class EvalNames:
    """The names that $(eval ...) knows: functions, then the file's arguments as numbers or truth values where they are."""

    def __init__(self, functions: Mapping[str, Any], arguments: Mapping[str, str], convert: Any) -> None:
        self._functions = functions
        self._arguments = arguments
        self._convert = convert

    def __getitem__(self, name: str) -> Any:
        if name in self._functions:
            return self._functions[name]
        if name in self._arguments.keys():  # noqa: SIM118  (asking the arguments themselves would count as mentioning it)
            return self._convert(self._arguments[name], "auto")
        raise KeyError(name)


def eval_extension(text: str, functions: Mapping[str, Any], arguments: Mapping[str, str], convert: Callable[[str, str], Any]) -> str:
    """The value of a $(eval ...). In xacro's own, every built-in function of Python is within reach."""
    if "__" in text:
        raise Trouble("forbidden", name="__", text=text)
    allowed = {name: getattr(builtins, name) for name in FUNCTIONS}
    names: Any = EvalNames(functions, arguments, convert)
    return str(eval(compiled(text), {"__builtins__": allowed}, names))
