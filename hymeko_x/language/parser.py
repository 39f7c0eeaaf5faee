"""HyMeKo text to syntax tree, built while the LALR(1) machine reads, with the comments in their places."""

from __future__ import annotations

from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.language.comments import with_comments
from hymeko_x.language.errors import excerpt, explain_syntax_error
from hymeko_x.language.machine import MAX_DEPTH, Lines, Machine, ParseError, TooDeep
from hymeko_x.language.syntax import (
    ArcItem,
    Constant,
    Document,
    Field,
    Import,
    Item,
    Node,
    Parameter,
    QuotedName,
    Ref,
    Stereotype,
    Using,
    Value,
)
from hymeko_x.language.terminals import TERMINALS, Malformed, statements

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.language.machine import Gap, Reduce


def parse(text: str, name: str = "<text>") -> Document:
    """The syntax tree of a HyMeKo text. ``name`` is the file's name for messages.

    Raises: Refusal (HX060) with the line, a caret, what was expected and a hint; HX007 for brackets nested too deep.
    """
    lines = Lines(text)
    gaps: list[Gap] = []
    try:
        document = machine().run(text, {**TERMINALS, **statements(lines.place)}, {**_ACTIONS, **_item_actions(lines.place)}, gaps)
    except TooDeep as error:
        line, column = lines.place(error.offset)
        raise refuse(codes.TOO_LARGE, f"brackets are nested more than {MAX_DEPTH} levels deep", Origin(name, line, column)) from error
    except Malformed as error:
        line, column = lines.place(error.offset)
        raise refuse(codes.SYNTAX, str(error), Origin(name, line, column), excerpt=excerpt(text, line, column, 1)) from error
    except ParseError as error:
        raise explain_syntax_error(text, name, error.offset) from error
    return with_comments(document, text, gaps, lines)


class _Block(tuple[Item, ...]):
    """The items between braces."""

    __slots__ = ()


class _Group(tuple[ArcItem, ...]):
    """Arcs in parentheses."""

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
    """Everything between a node's name and its block."""

    parameters: tuple[Parameter, ...] | None
    stereotypes: tuple[Stereotype, ...]
    uses: tuple[Ref, ...]


# ---- rules ---------------------------------------------------------------------------------------------------------------


def _ungrouped(items: list[Any]) -> list[Any]:
    """The items of a block with the arcs of groups in their place."""
    if _Group not in map(type, items):
        return items
    return [inner for item in items for inner in (item if type(item) is _Group else (item,))]


def _start(parts: list[Any], _: int) -> Document:
    parts = _ungrouped(parts)
    if parts and type(parts[0]) is str:
        return Document(tuple(parts[1:]), parts[0][1:-1].strip())
    return Document(tuple(parts))


def _signature(parts: list[Any], _: int) -> _Signature:
    parameters = next((tuple(part) for part in parts if type(part) is _Parameters), None)
    stereotypes = next((tuple(part) for part in parts if type(part) is _Stereotypes), ())
    return _Signature(parameters, stereotypes, tuple(part for part in parts if type(part) is Ref))


def _relation(parts: list[Any], _: int) -> Ref:
    """A reference with its direction; the tag between them (``<isa>``) is that of every type, and adds nothing."""
    words = [part for part in parts[:-1] if type(part) is str]
    return Ref(parts[-1].path, words[-1], words[0] if len(words) > 1 else "")


def _constant(text: str, place: tuple[int, int]) -> Constant:
    name, _, value = text[len("const") : -1].partition("=")
    return Constant(name.strip(), value.strip(), *place)


def _quoted_ref(direction: str, target: str) -> Ref:
    return Ref((QuotedName(target[3:-1]),), direction)


_ACTIONS: Mapping[str, Reduce] = MappingProxyType(
    {
        "start": _start,
        "block": lambda parts, _: _Block(_ungrouped(parts)),
        "ref": lambda parts, _: Ref(tuple(parts)),
        "path": lambda parts, _: Ref(tuple(parts)),
        "relation": _relation,
        "vector": lambda parts, _: tuple(parts),
        "type": lambda parts, _: _TypeName(", ".join(part.dotted for part in parts)),
        "signature": _signature,
        "stereotypes": lambda parts, _: _Stereotypes(parts),
        "stereotype": lambda parts, _: Stereotype(parts[0], parts[1] if len(parts) > 1 else None),
        "use": lambda parts, _: parts[-1],
        "parameters": lambda parts, _: _Parameters(parts),
        "parameter": lambda parts, _: Parameter(parts[0], parts[1] if len(parts) > 1 else None),
        "arguments": lambda parts, _: tuple(parts),
        "argument": lambda parts, _: (parts[0], parts[1]),
    }
)
"""The value of a rule that has no place, from its children."""


class _Items:
    """Makes items of the children of their rules and the offset of the first character, whose line and column is ``place``."""

    def __init__(self, place: Callable[[int], tuple[int, int]]) -> None:
        self._place = place

    def node(self, edge: str, parts: list[Any], offset: int) -> Node:
        line, column = self._place(offset)
        if len(parts) == 2:
            return Node(parts[0], tuple(parts[-1]), edge=edge, line=line, column=column)
        signature: _Signature = parts[1]
        return Node(parts[0], tuple(parts[-1]), signature.stereotypes, signature.parameters, signature.uses, edge, line, column)

    def changed(self, edge: str, parts: list[Any], offset: int) -> Node:
        return self.node(edge, [parts[0].path[-1], *parts[1:]], offset)._replace(within=parts[0].path[:-1])

    def array(self, edge: str, parts: list[Any], offset: int) -> Node:
        types = [_Signature(None, tuple(parts[2]), ())] if len(parts) > 3 else []
        return self.node(edge, [parts[0], *types, parts[-1]], offset)._replace(size=parts[1])

    def arc(self, role: str, weight: tuple[Value, ...] | None, parts: list[Any], offset: int) -> ArcItem:
        return ArcItem(parts[0], role, weight, tuple(parts[1]) if len(parts) > 1 else (), *self._place(offset))

    def weighted_arc(self, parts: list[Any], offset: int) -> ArcItem:
        return self.arc("", parts[0], parts[1:], offset) if type(parts[1]) is Ref else self.arc(parts[1], parts[0], parts[2:], offset)

    def group_arc(self, parts: list[Any], offset: int) -> ArcItem:
        role = parts[0] if type(parts[0]) is not Ref else ""
        weight = parts[-1] if type(parts[-1]) is not Ref else None
        return ArcItem(parts[1] if role else parts[0], role, weight, (), *self._place(offset))


def _item_actions(place: Callable[[int], tuple[int, int]]) -> dict[str, Reduce]:
    """What makes an item of each rule; ``place`` gives line and column of an offset."""
    items = _Items(place)
    node, changed, array, arc = items.node, items.changed, items.array, items.arc
    return {
        "bare": lambda parts, offset: Field(parts[0], None, parts[1] if len(parts) > 1 else "", *place(offset)),
        "field": lambda parts, offset: Field(parts[0], parts[-1], parts[1] if len(parts) == 3 else "", *place(offset)),
        "import_": lambda parts, offset: Import(parts[1], parts[3] if len(parts) > 2 else "", *place(offset)),
        "short_import": lambda parts, offset: Import(parts[1], parts[3] if len(parts) > 2 else "", *place(offset)),
        "using": lambda parts, offset: Using(parts[1], parts[3] if len(parts) > 2 else parts[1].path[-1], *place(offset)),
        "constant": lambda parts, offset: _constant(parts[0], place(offset)),
        "tagged_node": lambda parts, offset: node("", [parts[0], parts[-1]], offset),
        "group": lambda parts, _: _Group(parts),
        "group_arc": items.group_arc,
        "headed_node": _headed_node,
        "node": lambda parts, offset: node("", parts, offset),
        "edge": lambda parts, offset: node(parts[0], parts[1:], offset),
        "changed_node": lambda parts, offset: changed("", parts, offset),
        "changed_edge": lambda parts, offset: changed(parts[0], parts[1:], offset),
        "array": lambda parts, offset: array("", parts, offset),
        "edge_array": lambda parts, offset: array(parts[0], parts[1:], offset),
        "typed_edge": lambda parts, offset: node(parts[0], parts[1:], offset),
        "plain_arc": lambda parts, offset: arc("", None, parts, offset),
        "role_arc": lambda parts, offset: arc(parts[0], None, parts[1:], offset),
        "weighted_arc": items.weighted_arc,
        "quoted_arc": lambda parts, offset: arc("", None, [_quoted_ref(*parts)], offset),
        "legacy_edge": lambda parts, offset: arc(parts[0], None, [_quoted_ref(*parts[1:])], offset),
    }


def _headed_node(parts: list[Any], _: int) -> Node:
    name, edge, types, parameters, line, column = parts[0]
    return Node(name, tuple(_ungrouped(parts[1:])), types, parameters, (), edge, line, column)


@cache
def machine() -> Machine:
    """The machine; a text is also read with other actions for the same rules (:mod:`hymeko_x.language.outline`)."""
    return Machine(frozenset({*_ACTIONS, *_item_actions(Lines("").place)}))
