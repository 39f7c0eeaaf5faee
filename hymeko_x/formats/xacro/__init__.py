"""The words of xacro: its reserved names, and how it turns texts into values."""

from __future__ import annotations

import math
import re
from contextlib import suppress
from keyword import kwlist

FORMAT = "xacro"
NAMESPACE = "http://www.ros.org/wiki/xacro"
PREFIX = "xacro:"

TAGS = frozenset(
    ("arg", "attribute", "call", "element", "if", "include", "insert_block", "macro", "property", "unless"),
)
"""Elements of xacro itself, which no macro may be called."""

_FUNCTIONS = (
    *("list", "dict", "map", "len", "str", "float", "int", "bool", "True", "False", "min", "max", "round", "sorted", "range"),
    *("python", "math", "xacro", "load_yaml", "abs_filename", "dotify", "arg"),
)
GLOBALS = frozenset((*_FUNCTIONS, *(name for name in vars(math) if not name.startswith("_"))))
"""The names that every expression has already; a parameter of such a name is a warning."""

TAKEN = TAGS | GLOBALS | frozenset(kwlist)
"""Names that macros, parameters and properties never get here."""


def macros_file(robot: str) -> str:
    """The name of the file with a robot's macros, beside the robot's own."""
    return f"{re.sub('[^A-Za-z0-9]+', '_', robot).strip('_') or 'robot'}.macros.xacro"


def literal(text: str) -> str | int | float | bool:
    """The value of a parameter inside a macro that is given this text.

    Source: xacro 2.1, ``Table._eval_literal``.
    """
    if len(text) >= 2 and text[0] == "'" and text[-1] == "'":
        return text[1:-1]
    if "_" in text:
        return text
    with suppress(ValueError):
        return int(text)
    with suppress(ValueError):
        return float(text)
    return {"true": True, "True": True, "false": False, "False": False}.get(text, text)


def survives(text: str) -> bool:
    """Whether a parameter that is given this text prints as it again."""
    return str(literal(text)) == text
