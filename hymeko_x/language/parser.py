"""HyMeKo text to syntax tree: lark's LALR(1) parser with the tree built while parsing."""

from __future__ import annotations

import re
from functools import cache
from importlib.resources import files
from typing import cast

from lark import Lark, Token, Transformer
from lark.exceptions import UnexpectedInput

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.language.comments import weave_comments
from hymeko_x.language.errors import explain_syntax_error
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

_QUANTITY = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(.*)", re.DOTALL)
_ESCAPE = re.compile(r"\\(u[0-9a-fA-F]{4}|U[0-9a-fA-F]{8}|.)", re.DOTALL)
_ESCAPED = {"n": "\n", "t": "\t", "r": "\r", "0": "\0"}


def parse(text: str, name: str = "<text>") -> Document:
    """The syntax tree of a HyMeKo text. ``name`` is the file's name for messages.

    Raises: Refusal (HX060) with the line, a caret, what was expected and a hint.
    """
    try:
        return weave_comments(cast("Document", _parser().parse(text)), text)
    except UnexpectedInput as error:
        raise explain_syntax_error(error, text, name) from error
    except _Malformed as error:
        raise refuse(codes.SYNTAX, str(error), Origin(name, error.token.line, error.token.column)) from error


def grammar_text() -> str:
    """The grammar, as lark reads it."""
    return files("hymeko_x.language").joinpath("hymeko.lark").read_text(encoding="utf-8")


@cache
def _parser() -> Lark:
    return Lark(grammar_text(), parser="lalr", transformer=_TreeBuilder(), maybe_placeholders=False)


class _Malformed(Exception):
    """A token that the lexer lets through and that means nothing."""

    def __init__(self, token: Token, message: str) -> None:
        super().__init__(message)
        self.token = token


def unescape(text: str) -> str:
    """The characters behind the escapes of a quoted string or name: \\n, \\t, \\r, \\0, \\uXXXX, and any character itself."""
    if "\\" not in text:
        return text

    def plain(match: re.Match[str]) -> str:
        word = match[1]
        return chr(int(word[1:], 16)) if len(word) > 1 else _ESCAPED.get(word, word)

    return _ESCAPE.sub(plain, text)


def _numbers(token: Token, text: str) -> tuple[float, ...]:
    try:
        return tuple(map(float, text.replace(",", " ").split()))
    except ValueError as error:
        raise _Malformed(token, f"{text.strip()!r} is not a list of numbers") from error


class _TreeBuilder(Transformer[Token, Document]):
    """Called by the parser at every reduction; each method gets the parts of its rule."""

    # ---- tokens ----------------------------------------------------------------------------------------------------------

    def NUMBER(self, token: Token) -> float:
        return float(token)

    def QUANTITY(self, token: Token) -> Quantity:
        match = _QUANTITY.fullmatch(token)
        assert match is not None, token
        return Quantity(float(match[1]), match[2])

    def STRING(self, token: Token) -> str:
        if token.startswith('"""'):
            return str(token[3:-3])
        return unescape(token[1:-1])

    def EXPRESSION(self, token: Token) -> Expression:
        return Expression(str(token[2:-1]).strip())

    def QUERY(self, _: Token) -> Query:
        return Query()

    def NUMBERS(self, token: Token) -> tuple[float, ...]:
        return _numbers(token, token[1:-1])

    def MATRIX(self, token: Token) -> tuple[tuple[float, ...], ...]:
        return tuple(_numbers(token, row) for row in token[1 : token.rindex("]")].replace("[", "").split("]")[:-1])

    # ---- references --------------------------------------------------------------------------------------------------------

    def ref(self, parts: list[Token]) -> Ref:
        if len(parts) == 1:
            return Ref((_name(parts[0]),))
        return Ref(tuple(map(_name, parts)))

    def relation(self, parts: list[Token | Ref]) -> tuple[Ref, Token]:
        target, direction = cast("Ref", parts[-1]), cast("Token", parts[-2])
        modifier = str(parts[0]) if len(parts) == 3 else ""
        return Ref(target.path, str(direction), modifier), direction

    def vector(self, parts: list[object]) -> tuple[Value, ...]:
        return tuple(map(_value, parts))

    # ---- items -------------------------------------------------------------------------------------------------------------

    def start(self, parts: list[object]) -> Document:
        header = ""
        if parts and isinstance(parts[0], Token):
            header, parts = parts[0][1:-1].strip(), parts[1:]
        return Document(tuple(cast("list[Item]", parts)), header)

    def block(self, parts: list[Item]) -> tuple[Item, ...]:
        return tuple(parts)

    def bare(self, parts: list[object]) -> Field:
        token = cast("Token", parts[0])
        kind = cast("str", parts[1]) if len(parts) > 1 else ""
        return Field(_name(token), None, kind, token.line or 0, token.column or 0)

    def field(self, parts: list[object]) -> Field:
        token = cast("Token", parts[0])
        kind = cast("str", parts[1]) if len(parts) == 3 else ""
        return Field(_name(token), _value(parts[-1]), kind, token.line or 0, token.column or 0)

    def type(self, parts: list[Ref]) -> str:
        return _TypeName(parts[0].dotted)

    def import_(self, parts: list[object]) -> Import:
        token = cast("Token", parts[0])
        alias = _name(cast("Token", parts[3])) if len(parts) > 2 else ""
        return Import(cast("str", parts[1]), alias, token.line or 0, token.column or 0)

    def node(self, parts: list[object]) -> Node:
        return _node("", parts)

    def edge(self, parts: list[object]) -> Node:
        return _node(str(parts[0]), parts[1:])

    def typed_edge(self, parts: list[object]) -> Node:
        return _node(cast("str", parts[0]), parts[1:])

    def plain_arc(self, parts: list[object]) -> ArcItem:
        ref, token = cast("tuple[Ref, Token]", parts[0])
        items = cast("tuple[Item, ...]", parts[1]) if len(parts) > 1 else ()
        return ArcItem(ref, "", None, items, token.line or 0, token.column or 0)

    def weighted_arc(self, parts: list[object]) -> ArcItem:
        weight = cast("tuple[Value, ...]", parts[0])
        role = _name(parts[1]) if isinstance(parts[1], Token) else ""
        ref, token = cast("tuple[Ref, Token]", parts[2] if role else parts[1])
        items = cast("tuple[Item, ...]", parts[-1]) if len(parts) > (3 if role else 2) else ()
        return ArcItem(ref, role, weight, items, token.line or 0, token.column or 0)

    def role_arc(self, parts: list[object]) -> ArcItem:
        token = cast("Token", parts[0])
        ref, _ = cast("tuple[Ref, Token]", parts[1])
        items = cast("tuple[Item, ...]", parts[2]) if len(parts) > 2 else ()
        return ArcItem(ref, _name(token), None, items, token.line or 0, token.column or 0)

    def quoted_arc(self, parts: list[Token]) -> ArcItem:
        token = parts[0]
        return ArcItem(_quoted_ref(parts), "", None, (), token.line or 0, token.column or 0)

    def legacy_edge(self, parts: list[Token]) -> ArcItem:
        token = parts[0]
        return ArcItem(_quoted_ref(parts[1:]), _name(token), None, (), token.line or 0, token.column or 0)

    # ---- signatures ----------------------------------------------------------------------------------------------------------

    def signature(self, parts: list[object]) -> _Signature:
        found = _Signature()
        for part in parts:
            if isinstance(part, _Parameters):
                found.parameters = tuple(part)
            elif isinstance(part, Ref):
                found.uses = (*found.uses, part)
            else:
                found.stereotypes = cast("tuple[Stereotype, ...]", part)
        return found

    def stereotypes(self, parts: list[Stereotype]) -> tuple[Stereotype, ...]:
        return tuple(parts)

    def stereotype(self, parts: list[object]) -> Stereotype:
        arguments = cast("tuple[tuple[str, Value], ...]", parts[1]) if len(parts) > 1 else None
        return Stereotype(cast("Ref", _value(parts[0])), arguments)

    def use(self, parts: list[Ref]) -> Ref:
        return parts[0]

    def parameters(self, parts: list[Parameter]) -> _Parameters:
        return _Parameters(parts)

    def parameter(self, parts: list[object]) -> Parameter:
        return Parameter(_name(cast("Token", parts[0])), _value(parts[1]) if len(parts) > 1 else None)

    def arguments(self, parts: list[tuple[str, Value]]) -> tuple[tuple[str, Value], ...]:
        return tuple(parts)

    def argument(self, parts: list[object]) -> tuple[str, Value]:
        return _name(cast("Token", parts[0])), _value(parts[1])


class _TypeName(str):
    """The text of a field's ``<type>``."""

    __slots__ = ()


class _Parameters(list[Parameter]):
    """A parameter list, told apart from a list of stereotypes."""


class _Signature:
    """What stands between a node's name and its block."""

    def __init__(self) -> None:
        self.parameters: tuple[Parameter, ...] | None = None
        self.stereotypes: tuple[Stereotype, ...] = ()
        self.uses: tuple[Ref, ...] = ()


def _name(token: Token) -> str:
    """The name itself: a quoted one without its backticks."""
    if token[0] == "`":
        return QuotedName(unescape(token[1:-1]))
    return str(token)


def _value(part: object) -> Value:
    """A value as it stands in the tree; a relation loses the token that told its place."""
    if type(part) is tuple and len(part) == 2 and type(part[0]) is Ref and type(part[1]) is Token:
        return part[0]
    return cast("Value", part)


def _quoted_ref(parts: list[Token]) -> Ref:
    direction, target = parts
    return Ref((QuotedName(target[3:-1]),), str(direction))


def _node(edge: str, parts: list[object]) -> Node:
    token = cast("Token", parts[0])
    items = cast("tuple[Item, ...]", parts[-1])
    name, line, column = _name(token), token.line or 0, token.column or 0
    if len(parts) == 2:
        return Node(name, items, edge=edge, line=line, column=column)
    signature = cast("_Signature", parts[1])
    return Node(name, items, signature.stereotypes, signature.parameters, signature.uses, edge, line, column)
