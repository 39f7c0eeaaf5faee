"""Texts in xacro's spelling: characters with a meaning for xacro are escaped, and holes become expressions with the same text."""

from __future__ import annotations

import math
import re
from types import MappingProxyType
from typing import TYPE_CHECKING

from hymeko_x.factor.forms import Call, Hole, Signed, fill
from hymeko_x.formats.xacro import survives

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.factor.forms import Factored, Item, Piece, Text

_BEFORE_BRACE = re.compile(r"\$+(?=[{(])")
_LONE = re.compile(r"\$(?=\$)")
_MATHS = ("pi/2", "pi", "pi/4", "pi/3", "pi/6", "2*pi", "3*pi/4", "2*pi/3", "3*pi/2", "5*pi/6", "pi/8", "pi/12")
_DECIMAL = re.compile(r"(\d+(?:\.\d+)?)(e[+-]?\d+)?")


def _constants() -> dict[str, str]:
    """The digits of multiples of pi, and the expressions for them."""
    found: dict[str, str] = {}
    for words in _MATHS:
        value = 1.0
        for sign, factor in re.findall(r"(^|[*/])(pi|\d+)", words):
            number = math.pi if factor == "pi" else int(factor)
            value = value / number if sign == "/" else value * number
        found.setdefault(repr(value), words)
    return found


CONSTANTS = MappingProxyType(_constants())
_NUMBER = re.compile(rf"(?<![\w.])(-?)({'|'.join(sorted(map(re.escape, CONSTANTS), key=len, reverse=True))})(?![\w.])")


def spelled(text: Text) -> str:
    """A text as it stands in an attribute or between tags, before XML's own escapes."""
    if isinstance(text, str):
        return _plain(text)
    return "".join([_spelled(piece) for piece in text])


def argument(text: Text, *, quoted: bool) -> str:
    """The value of a parameter. In quotes it stays the text that it is; xacro would read it as a number or a truth value."""
    value = spelled(text)
    if isinstance(text, str):
        quoted = not survives(text)
    return f"'{value}'" if quoted else value


def default(text: str) -> str:
    """A default in a list of parameters."""
    value = spelled(text)
    return value if survives(text) and re.fullmatch(r"[\w./+-]+", value) else f"'{value}'"


def _plain(text: str) -> str:
    if "$" not in text:
        return _NUMBER.sub(lambda found: f"${{{found[1]}{CONSTANTS[found[2]]}}}", text)
    parts = _BEFORE_BRACE.split(text)
    signs = [f"{found}$" for found in _BEFORE_BRACE.findall(text)]
    lone = [_LONE.sub("${'%c'%36}", part) for part in parts]
    return "".join([piece for pair in zip(lone, [*signs, ""], strict=True) for piece in pair])


def _spelled(piece: Piece) -> str:
    match piece:
        case Hole(name):
            return f"${{{name}}}"
        case Signed():
            return _product(piece)
        case _:
            return _plain(piece)


def _product(signed: Signed) -> str:
    """A number with the sign of parameters: ``${-side*0.05}``, where that prints as the same digits."""
    sign = "-" if signed.negative else ""
    factors = "*".join(signed.factors)
    number = CONSTANTS.get(signed.magnitude) or (signed.magnitude if _is_exponential(signed.magnitude) else None)
    if number is not None:
        return f"${{{sign}{factors}*{number}}}"
    found = _DECIMAL.fullmatch(signed.magnitude)
    if found and all(_is_kept(found[1])):
        end = found[2] or ""
        return f"${{{sign}{factors}}}{end}" if found[1] == "1" else f"${{{sign}{factors}*{found[1]}}}{end}"
    wanted = "1" if signed.negative else "-1"
    return f"${{'-' if {factors}=={wanted} else ''}}{signed.magnitude}"


def _is_exponential(magnitude: str) -> bool:
    """Whether a number has an exponent, and is written as Python prints it: ``1.61e-08``."""
    return "e" in magnitude and str(float(magnitude)) == magnitude


def _is_kept(digits: str) -> Iterator[bool]:
    """Whether a number that xacro multiplies by 1 or -1 prints as it was written."""
    yield not re.match(r"0\d", digits)
    number = float(digits) if "." in digits else int(digits)
    yield str(number) == digits


def arguments_to_quote(factored: Factored) -> set[tuple[int, str]]:
    """Identity of the call and name of each argument with holes that xacro, in one of its expansions, would read as another number."""
    macros = {macro.name: macro for macro in factored.macros}
    known = {value.name: value.text for value in factored.values}
    found: set[tuple[int, str]] = set()
    stack: list[tuple[Item, dict[str, str]]] = [(item, known) for item in factored.items]
    while stack:
        item, scope = stack.pop()
        if not isinstance(item, Call):
            stack += [(child, scope) for child in item.children]
            continue
        given = {name: fill(text, scope) for name, text in item.arguments}
        found.update((id(item), name) for name, text in given.items() if not survives(text))
        macro = macros[item.macro]
        inner = known | {parameter.name: parameter.default for parameter in macro.parameters if parameter.default is not None} | given
        stack += [(part, inner) for part in macro.body]
    return found
