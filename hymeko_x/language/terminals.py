"""The values of tokens: of numbers, texts and names, and the items that whole statements (statements.lark) are."""

from __future__ import annotations

import re
import sys
from types import MappingProxyType
from typing import TYPE_CHECKING

from hymeko_x.language.syntax import ArcItem, Expression, Field, Quantity, Query, QuotedName, Ref, Stereotype, Value

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.language.machine import Convert

KEYWORDS = ("inf", "nan", "rel", "seq", "concurrent", "import", "using", "const", "as", "use")
"""Words that are no names without backticks."""
_QUANTITY = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(.*)", re.DOTALL)
_ESCAPE = re.compile(r"\\(u[0-9a-fA-F]{4}|U[0-9a-fA-F]{8}|.)", re.DOTALL)
_ESCAPED = {"n": "\n", "t": "\t", "r": "\r", "0": "\0"}


class Malformed(Exception):
    """A token that the lexer accepts and that has no value."""

    def __init__(self, offset: int, message: str) -> None:
        super().__init__(message)
        self.offset = offset


def _unescape(text: str, offset: int) -> str:
    """The characters behind the escapes of a quoted string or name: \\n, \\t, \\r, \\0, \\uXXXX, and any character itself."""
    if "\\" not in text:
        return text

    def plain(match: re.Match[str]) -> str:
        word = match[1]
        if len(word) == 1:
            return _ESCAPED.get(word, word)
        number = int(word[1:], 16)
        if number > sys.maxunicode or 0xD800 <= number < 0xE000:
            raise Malformed(offset, f"'{match[0]}' is not a character")
        return chr(number)

    return _ESCAPE.sub(plain, text)


def _quantity(text: str, offset: int) -> Quantity:
    match = _QUANTITY.fullmatch(text)
    assert match is not None, text
    return Quantity(float(match[1]), match[2])


def _numbers(text: str, offset: int) -> tuple[float, ...]:
    try:
        return tuple(map(float, text[1:-1].replace(",", " ").split()))
    except ValueError as error:
        raise _malformed_number(text, offset) from error


def _matrix(text: str, offset: int) -> tuple[tuple[float, ...], ...]:
    rows = text[1 : text.rindex("]")].replace("[", "").replace(",", " ").split("]")[:-1]
    try:
        return tuple(tuple(map(float, row.split())) for row in rows)
    except ValueError as error:
        raise _malformed_number(text, offset) from error


def _list_value(text: str, offset: int) -> tuple[Value, ...]:
    return _matrix(text, offset) if "[" in text[1:] else _numbers(text, offset)


def _malformed_number(text: str, offset: int) -> Malformed:
    """The error of a list of numbers, at the first word that is no number."""
    for match in re.finditer(r"[^\s,\[\]]+", text):
        try:
            float(match[0])
        except ValueError:
            return Malformed(offset + match.start(), f"'{match[0]}' is not a number; expected numbers such as 1, -0.5 or 1e-3")
    return Malformed(offset, "this is not a list of numbers")


def _string(text: str, offset: int) -> str:
    return text[3:-3] if text.startswith('"""') else _unescape(text[1:-1], offset)


TERMINALS: Mapping[str, Convert] = MappingProxyType(
    {
        "NUMBER": lambda text, _: float(text),
        "QUANTITY": _quantity,
        "STRING": _string,
        "EXPRESSION": lambda text, _: Expression(text[2 if text[0] == "$" else 1 : -1].strip()),
        "QUERY": lambda text, _: Query(),
        "NUMBERS": _numbers,
        "MATRIX": _matrix,
        "NAME": lambda text, offset: QuotedName(_unescape(text[1:-1], offset)) if text[0] == "`" else text,
    }
)
"""The value of a token, from its text and offset; other tokens are their text."""


# ---- statements -------------------------------------------------------------------------------------------------------


class _Statements:
    """Makes items of whole statements (statements.lark), from their text and offset."""

    def __init__(self, place: Callable[[int], tuple[int, int]]) -> None:
        self._place = place

    def field(self, text: str, offset: int) -> Field:
        match = _FIELD.match(text)
        assert match is not None, text
        name, value = match.groups()
        line, column = self._place(offset)
        convert = _BY_FIRST_LETTER.get(value[0])
        if convert is not None:
            return Field(name, convert(value, offset + len(text) - len(value)), "", line, column)
        is_number = value[0].isdecimal() or value[0] in "+-." or value in ("inf", "nan")
        return Field(name, float(value) if is_number else Ref((value,)), "", line, column)

    def arc(self, text: str, offset: int) -> ArcItem:
        weight, bracket, end = text.rpartition("]")
        match = _ARC.match(end)
        assert match is not None, text
        role, direction, path = match.groups()
        return ArcItem(
            Ref(tuple(path.split(".")), direction),
            role or "",
            _list_value(weight + bracket, offset) if bracket else None,
            (),
            *self._place(offset),
        )

    def head(self, text: str, offset: int) -> tuple[str, str, tuple[Stereotype, ...], tuple[()] | None, int, int]:
        """The name of a node, its edge word, its type, its parameters if it has an empty list of them, line and column."""
        match = _HEAD.match(text)
        assert match is not None, text
        edge, name, parameters, kind = match.groups()
        return (name, edge, (Stereotype(Ref(tuple(kind.split(".")))),) if kind else (), () if parameters else None, *self._place(offset))


_FIELD = re.compile(r"(\w+)\s*=?\s*(.*)", re.DOTALL)
_ARC = re.compile(r"\s*(\w+)?\s*([^\w\s]+)\s*([\w.]+)")
_HEAD = re.compile(r"(@?)(\w+)\s*(\()?[\s)]*(?::\s*([\w.]+))?")
_BY_FIRST_LETTER: Mapping[str, Convert] = MappingProxyType({'"': _string, "'": _string, "[": _list_value})


def statements(place: Callable[[int], tuple[int, int]]) -> dict[str, Convert]:
    """What makes an item of a whole statement."""
    make = _Statements(place)
    return {"FIELD": make.field, "SHORT_ARC": make.arc, "HEAD": make.head}
