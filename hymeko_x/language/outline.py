"""The outline of HyMeKo text: nodes with their fields, an arc being a field as well, read by the machine that reads the language."""

from __future__ import annotations

import re
from collections import Counter
from itertools import accumulate
from typing import TYPE_CHECKING, Any, NamedTuple

from hymeko_x.language.parser import machine
from hymeko_x.outline import BlockStyle, OutlineBlock, OutlineField

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from hymeko_x.language.machine import Convert, Reduce

STYLE = BlockStyle("", "", rb"[ \t]*(?://[^\n]*|#[^\n]*|/\*[^\n]*?\*/[ \t]*)?")

NAME = "name of the node"
"""The name of the field that is a node's own name."""

TYPES = "types of the node"
"""The name of the field that is everything behind its colon."""

ALONE = "collision"
"""The name that stands for a whole shape when it is alone: a block without content."""

_SIGNED = ("signature", "stereotypes", "stereotype", "use", "parameters", "parameter", "arguments")
_VALUES = ("vector", "ref", "path", "relation", "type", *_SIGNED)
_FIELDS = ("bare", "field", "import_", "short_import", "using", "constant")
_ARCS = ("group", "plain_arc", "role_arc", "weighted_arc", "quoted_arc", "legacy_edge")
_NODES = ("node", "tagged_node", "edge", "typed_edge", "changed_node", "changed_edge", "array", "edge_array")
_TYPES = ("signature", "stereotypes")
_NAME = re.compile(r"`(?:[^`\\]|\\.)*`|[^\W\d]\w*")
_ARC = re.compile(r"(?:\[.*\]\s*)?(.*)", re.DOTALL)


class _Span(NamedTuple):
    """A piece of text; ``kind`` is its rule, ``parts`` are the pieces in it."""

    kind: str
    start: int
    end: int
    parts: tuple[Any, ...] = ()


class _Terminals(dict[str, "Convert"]):
    """Every token is a piece; where the last one ended is remembered, which is where a rule ends."""

    def __init__(self) -> None:
        super().__init__()
        self.end = 0

    def get(self, kind: str, default: Any = None) -> Any:
        def piece(text: str, offset: int) -> _Span:
            self.end = offset + len(text)
            return _Span(kind, offset, self.end)

        return piece


def block_of(text: str, file: str) -> OutlineBlock:
    """The block of the whole of a text that can be parsed; offsets are those of its UTF-8 bytes."""
    terminals = _Terminals()
    actions = {name: _action(name, terminals) for name in ("start", "block", "argument", *_VALUES, *_FIELDS, *_ARCS, *_NODES)}
    top: _Span = machine().run(text, terminals, actions, [])
    byte = _byte_offsets(text)
    whole = OutlineBlock("", "", file, 0, byte(len(text)), 0, 0, (0, byte(len(text))))
    stack: list[tuple[OutlineBlock, Sequence[Any]]] = [(whole, top.parts)]
    while stack:
        block, items = stack.pop()
        counts: Counter[str] = Counter()
        for item in items:
            if item.kind in _NODES:
                inner, content = _node(item, text, file, byte)
                block.add(inner)
                stack.append((inner, content))
            elif item.kind == "bare" and text[item.start : item.end] == ALONE:
                start, end = byte(item.start), byte(item.end)
                block.add(
                    OutlineBlock("", ALONE, file, start, end, end, end, (end, end), {NAME: OutlineField(ALONE, start, end, start, end)})
                )
            elif item.kind in (*_FIELDS, *_ARCS):
                name, value = _field(item, text)
                counts[name] += 1
                block.fields[name if counts[name] == 1 else f"{name}#{counts[name]}"] = _placed(item, value, text, byte)
    return whole


def _action(name: str, terminals: _Terminals) -> Reduce:
    return lambda parts, start: _Span(name, start, max(terminals.end, start), tuple(parts))


def _byte_offsets(text: str) -> Callable[[int], int]:
    """From characters to bytes."""
    if text.isascii():
        return lambda place: place
    places = [0, *accumulate(len(character.encode()) for character in text)]
    return places.__getitem__


def _node(item: _Span, text: str, file: str, byte: Callable[[int], int]) -> tuple[OutlineBlock, tuple[Any, ...]]:
    content = item.parts[-1]
    words = [part for part in item.parts[:-1] if part.kind in ("NAME", "path", "EDGE_WORD", "STRING")]
    own = next(part for part in words if part.kind in ("NAME", "path"))
    name = text[own.start : own.end]
    tag = "" if words[0] is own else text[words[0].start : words[0].end]
    inside = byte(content.start) + 1, byte(content.end) - 1
    fields = {NAME: OutlineField(name, byte(own.start), byte(own.end), byte(own.start), byte(own.end))}
    types = next(
        (part for given in item.parts for part in (given, *given.parts) if given.kind in _TYPES and part.kind == "stereotypes"), None
    )
    if types is not None:
        start, end = byte(types.start), byte(types.end)
        fields[TYPES] = OutlineField(text[types.start : types.end].lstrip(": "), start, end, start, end)
    return OutlineBlock(tag, name, file, byte(item.start), byte(item.end), inside[0], inside[0], inside, fields), content.parts


def _field(item: _Span, text: str) -> tuple[str, _Span]:
    """The name of a field, and where its value is; of an arc its role, direction and place, and all of it."""
    if item.kind in _ARCS:
        parts = [part for part in item.parts if part.kind in ("NAME", "relation")]
        words = [text[part.start : part.end] for part in parts]
        return " ".join([*words[:-1], words[-1].strip()[:1]]) if words else "arc", item
    name = _NAME.match(text, item.start)
    return name[0] if name else text[item.start : item.end], item.parts[-1] if item.kind == "field" else item


def _placed(item: _Span, value: _Span, text: str, byte: Callable[[int], int]) -> OutlineField:
    start = item.start
    while start and text[start - 1].isspace():
        start -= 1
    return OutlineField(text[value.start : value.end], byte(start), byte(item.end), byte(value.start), byte(value.end))
