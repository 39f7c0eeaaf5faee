"""HyMeKo text to syntax tree, built while the LALR(1) machine reads."""

from __future__ import annotations

import re
import sys
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.language.comments import weave_comments
from hymeko_x.language.excerpts import excerpt
from hymeko_x.language.machine import MAX_DEPTH, Lines, Machine, ParseError, TooDeep
from hymeko_x.language.syntax import (
    ArcItem,
    Document,
    Expression,
    Field,
    Import,
    Item,
    Node,
    Parameter,
    Quantity,
    Query,
    QuotedName,
    Ref,
    Stereotype,
    Value,
)

if TYPE_CHECKING:
    from hymeko_x.language.machine import Convert, Gap, Reduce

_QUANTITY = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(.*)", re.DOTALL)
_ESCAPE = re.compile(r"\\(u[0-9a-fA-F]{4}|U[0-9a-fA-F]{8}|.)", re.DOTALL)
_ESCAPED = {"n": "\n", "t": "\t", "r": "\r", "0": "\0"}


def parse(text: str, name: str = "<text>") -> Document:
    """The syntax tree of a HyMeKo text. ``name`` is the file's name for messages.

    Raises: Refusal (HX060) with the line, a caret, what was expected and a hint; HX007 for brackets nested too deep.
    """
    lines = Lines(text)
    builder = _TreeBuilder(lines)
    gaps: list[Gap] = []
    try:
        document = _tables().run(text, builder.terminals, builder.actions, gaps)
    except TooDeep as error:
        line, column = lines.place(error.offset)
        raise refuse(codes.TOO_LARGE, f"brackets are nested more than {MAX_DEPTH} levels deep", Origin(name, line, column)) from error
    except _Malformed as error:
        line, column = lines.place(error.offset)
        raise refuse(codes.SYNTAX, str(error), Origin(name, line, column), excerpt=excerpt(text, line, column, 1)) from error
    except ParseError as error:
        from hymeko_x.language.errors import explain_syntax_error  # with lark, which nothing else here needs

        raise explain_syntax_error(text, name) from error
    return weave_comments(document, text, gaps, lines)


@cache
def _tables() -> Machine:
    return Machine(frozenset(_RULES))


class _Malformed(Exception):
    """A token that the lexer lets through and that means nothing."""

    def __init__(self, offset: int, message: str) -> None:
        super().__init__(message)
        self.offset = offset


def unescape(text: str, offset: int) -> str:
    """The characters behind the escapes of a quoted string or name: \\n, \\t, \\r, \\0, \\uXXXX, and any character itself."""
    if "\\" not in text:
        return text

    def plain(match: re.Match[str]) -> str:
        word = match[1]
        if len(word) == 1:
            return _ESCAPED.get(word, word)
        number = int(word[1:], 16)
        if number > sys.maxunicode or 0xD800 <= number < 0xE000:
            raise _Malformed(offset, f"'{match[0]}' is not a character")
        return chr(number)

    return _ESCAPE.sub(plain, text)


def _numbers(text: str) -> tuple[float, ...]:
    return tuple(map(float, text.replace(",", " ").split()))


def _malformed_number(text: str, offset: int) -> _Malformed:
    """What is wrong with a list of numbers, at the number that is none."""
    for match in re.finditer(r"[^\s,\[\]]+", text):
        try:
            float(match[0])
        except ValueError:
            return _Malformed(offset + match.start(), f"'{match[0]}' is not a number; expected numbers such as 1, -0.5 or 1e-3")
    return _Malformed(offset, "this is not a list of numbers")


class _Block(tuple[Item, ...]):
    """The items between braces."""

    __slots__ = ()


class _TypeName(str):
    """The text of a field's ``<type>``."""

    __slots__ = ()


class _Parameters(tuple[Parameter, ...]):
    """A parameter list."""

    __slots__ = ()


class _Stereotypes(tuple[Stereotype, ...]):
    """The types behind a colon."""

    __slots__ = ()


class _Signature(NamedTuple):
    """What stands between a node's name and its block."""

    parameters: tuple[Parameter, ...] | None
    stereotypes: tuple[Stereotype, ...]
    uses: tuple[Ref, ...]


class _TreeBuilder:
    """Makes the tree while the machine reads: one method a terminal (text and offset), one a rule (children and offset)."""

    def __init__(self, lines: Lines) -> None:
        self._place = lines.place
        names = ("number", "quantity", "string", "expression", "query", "numbers", "matrix", "name")
        self.terminals: dict[str, Convert] = {name.upper(): getattr(self, f"_{name}") for name in names}
        self.actions: dict[str, Reduce] = {rule: getattr(self, f"on_{rule}") for rule in _RULES}

    # ---- terminals ---------------------------------------------------------------------------------------------------------

    def _number(self, text: str, offset: int) -> float:
        return float(text)

    def _quantity(self, text: str, offset: int) -> Quantity:
        match = _QUANTITY.fullmatch(text)
        assert match is not None, text
        return Quantity(float(match[1]), match[2])

    def _string(self, text: str, offset: int) -> str:
        return text[3:-3] if text.startswith('"""') else unescape(text[1:-1], offset)

    def _expression(self, text: str, offset: int) -> Expression:
        return Expression(text[2:-1].strip())

    def _query(self, text: str, offset: int) -> Query:
        return Query()

    def _numbers(self, text: str, offset: int) -> tuple[float, ...]:
        try:
            return _numbers(text[1:-1])
        except ValueError as error:
            raise _malformed_number(text, offset) from error

    def _matrix(self, text: str, offset: int) -> tuple[tuple[float, ...], ...]:
        rows = text[1 : text.rindex("]")].replace("[", "").split("]")[:-1]
        try:
            return tuple(map(_numbers, rows))
        except ValueError as error:
            raise _malformed_number(text, offset) from error

    def _name(self, text: str, offset: int) -> str:
        if text[0] != "`":
            return text
        if len(text) == 2:
            return QuotedName("")
        return QuotedName(unescape(text[1:-1], offset))

    # ---- references and values ---------------------------------------------------------------------------------------------

    def on_ref(self, parts: list[str], offset: int) -> Ref:
        return Ref(tuple(parts))

    def on_relation(self, parts: list[Any], offset: int) -> Ref:
        modifier = parts[0] if len(parts) == 3 else ""
        return Ref(parts[-1].path, parts[-2], modifier)

    def on_vector(self, parts: list[Value], offset: int) -> tuple[Value, ...]:
        return tuple(parts)

    def on_type(self, parts: list[Ref], offset: int) -> str:
        return _TypeName(parts[0].dotted)

    # ---- items -------------------------------------------------------------------------------------------------------------

    def on_start(self, parts: list[Any], offset: int) -> Document:
        if parts and type(parts[0]) is str:
            return Document(tuple(parts[1:]), parts[0][1:-1].strip())
        return Document(tuple(parts))

    def on_block(self, parts: list[Item], offset: int) -> tuple[Item, ...]:
        return _Block(parts)

    def on_bare(self, parts: list[str], offset: int) -> Field:
        return Field(parts[0], None, parts[1] if len(parts) > 1 else "", *self._place(offset))

    def on_field(self, parts: list[Any], offset: int) -> Field:
        return Field(parts[0], parts[-1], parts[1] if len(parts) == 3 else "", *self._place(offset))

    def on_import_(self, parts: list[str], offset: int) -> Import:
        return Import(parts[1], parts[3] if len(parts) > 2 else "", *self._place(offset))

    def on_node(self, parts: list[Any], offset: int) -> Node:
        return self._node("", parts, offset)

    def on_edge(self, parts: list[Any], offset: int) -> Node:
        return self._node(parts[0], parts[1:], offset)

    def on_typed_edge(self, parts: list[Any], offset: int) -> Node:
        return self._node(parts[0], parts[1:], offset)

    def _node(self, edge: str, parts: list[Any], offset: int) -> Node:
        line, column = self._place(offset)
        items = tuple(parts[-1])
        if len(parts) == 2:
            return Node(parts[0], items, edge=edge, line=line, column=column)
        signature: _Signature = parts[1]
        return Node(parts[0], items, signature.stereotypes, signature.parameters, signature.uses, edge, line, column)

    def on_plain_arc(self, parts: list[Any], offset: int) -> ArcItem:
        return self._arc("", None, parts, offset)

    def on_role_arc(self, parts: list[Any], offset: int) -> ArcItem:
        return self._arc(parts[0], None, parts[1:], offset)

    def on_weighted_arc(self, parts: list[Any], offset: int) -> ArcItem:
        if type(parts[1]) is Ref:
            return self._arc("", parts[0], parts[1:], offset)
        return self._arc(parts[1], parts[0], parts[2:], offset)

    def _arc(self, role: str, weight: tuple[Value, ...] | None, parts: list[Any], offset: int) -> ArcItem:
        items = tuple(parts[1]) if len(parts) > 1 else ()
        return ArcItem(parts[0], role, weight, items, *self._place(offset))

    def on_quoted_arc(self, parts: list[str], offset: int) -> ArcItem:
        return ArcItem(_quoted_ref(*parts), "", None, (), *self._place(offset))

    def on_legacy_edge(self, parts: list[str], offset: int) -> ArcItem:
        return ArcItem(_quoted_ref(*parts[1:]), parts[0], None, (), *self._place(offset))

    # ---- signatures ----------------------------------------------------------------------------------------------------------

    def on_signature(self, parts: list[Any], offset: int) -> _Signature:
        parameters = next((tuple(part) for part in parts if type(part) is _Parameters), None)
        stereotypes = next((tuple(part) for part in parts if type(part) is _Stereotypes), ())
        return _Signature(parameters, stereotypes, tuple(part for part in parts if type(part) is Ref))

    def on_stereotypes(self, parts: list[Stereotype], offset: int) -> tuple[Stereotype, ...]:
        return _Stereotypes(parts)

    def on_stereotype(self, parts: list[Any], offset: int) -> Stereotype:
        return Stereotype(parts[0], parts[1] if len(parts) > 1 else None)

    def on_use(self, parts: list[Any], offset: int) -> Ref:
        ref: Ref = parts[-1]
        return ref

    def on_parameters(self, parts: list[Parameter], offset: int) -> tuple[Parameter, ...]:
        return _Parameters(parts)

    def on_parameter(self, parts: list[Any], offset: int) -> Parameter:
        return Parameter(parts[0], parts[1] if len(parts) > 1 else None)

    def on_arguments(self, parts: list[tuple[str, Value]], offset: int) -> tuple[tuple[str, Value], ...]:
        return tuple(parts)

    def on_argument(self, parts: list[Any], offset: int) -> tuple[str, Value]:
        return parts[0], parts[1]


_RULES = tuple(name.removeprefix("on_") for name in vars(_TreeBuilder) if name.startswith("on_"))


def _quoted_ref(direction: str, target: str) -> Ref:
    return Ref((QuotedName(target[3:-1]),), direction)
