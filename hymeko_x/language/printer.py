"""Syntax tree to canonical HyMeKo text: one layout, the shortest numbers, commas only where the grammar needs them."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple, TypeGuard, TypeVar

from hymeko_x.ir.digits import are_numbers, number_text, numbers_text
from hymeko_x.language.syntax import (
    ArcItem,
    Comment,
    Constant,
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
    Using,
    Value,
)
from hymeko_x.language.terminals import KEYWORDS

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence


class TextBlock(NamedTuple):
    """A node whose signature and items are texts already, or blocks again."""

    signature: str
    items: tuple[str | TextBlock | Comment, ...]


Piece = Item | TextBlock | str
P = TypeVar("P", bound=Piece)
_OPEN = (Node, TextBlock)
_ON_LINES_OF_THEIR_OWN = (Node, TextBlock, Comment)

WIDTH = 120
INDENT = "  "
_PLAIN_NAME = re.compile(r"[^\W\d]\w*")
_FEW_ESCAPES = str.maketrans(
    {chr(code): f"\\u{code:04x}" for code in (*range(32), 0x7F, 0xFFFE, 0xFFFF) if chr(code) not in "\n\t"}
    | {"\\": "\\\\", "\r": "\\r", "\0": "\\0"}
)
"""Of control characters only line feeds and tabs stand in a text as they are; files that carry it cannot hold the others."""
_ESCAPES = {**_FEW_ESCAPES, **str.maketrans({"\n": "\\n", "\t": "\\t"})}


def print_document(document: Document) -> str:
    """The text of a whole document, ending in a newline."""
    items = [Field(document.header), *document.items] if document.header else [*document.items]
    lines: list[str] = []
    for item, following in _with_next(items):
        lines.extend(_lines(item))
        if following is not None and _needs_comma(item, following):
            lines[-1] += ","
    return "\n".join(lines) + "\n"


def print_block(block: TextBlock) -> str:
    """The text of a document that is one block, ending in a newline."""
    return "\n".join(_lines(block)) + "\n"


def print_item(item: Item) -> str:
    """The text of one item in one line."""
    match item:
        case Field():
            return print_field(item.name, item.value, item.type)
        case ArcItem():
            return _arc(item)
        case Comment():
            return f"/* {item.text} */"
        case Import():
            return f"import {print_text(item.path)}" + (f" as {print_name(item.alias)}" if item.alias else "")
        case Using():
            return f"using {_ref(item.ref)} as {print_name(item.alias)}"
        case Constant():
            return f"const {print_name(item.name)} = {item.text};"
        case Node():
            return f"{_signature(item)} {{ {_joined(item.items)} }}" if item.items else f"{_signature(item)} {{}}"


def print_field(name: str, value: Value | None, type: str = "") -> str:
    """A name with its value and the mark between them."""
    text = f"{print_name(name)} <{type}>" if type else print_name(name)
    if value is None:
        return text
    return f"{text}={_ref(value, '')}" if isinstance(value, Ref) else f"{text} {print_value(value)}"


@lru_cache(4096, typed=True)  # a text names its elements and fields again and again
def print_name(name: str) -> str:
    """A name, in backticks unless it is a plain word (or was quoted by its author)."""
    is_plain = (name.isidentifier() and name.isascii()) or _PLAIN_NAME.fullmatch(name)
    if is_plain and name not in KEYWORDS and not isinstance(name, QuotedName):
        return name
    return "`" + name.translate(_ESCAPES).replace("`", "\\`") + "`"


def print_text(text: str) -> str:
    """A string literal with as few escapes as possible."""
    escaped = text if text.isprintable() and "\\" not in text else text.translate(_FEW_ESCAPES)
    if '"' in text and escaped == text and '"""' not in text and not text.endswith('"'):
        return f"'{text}'" if "'" not in text else f'"""{text}"""'
    quote = "'" if '"' in text and "'" not in text else '"'
    return f"{quote}{escaped.replace(quote, chr(92) + quote)}{quote}"


def print_value(value: Value) -> str:
    """A value as it stands behind a field's name."""
    if type(value) is float:
        return number_text(value)
    if type(value) is tuple:
        return f"[{numbers_text(value) if are_numbers(value) else ' '.join(map(print_value, value))}]"  # type: ignore[arg-type]
    if isinstance(value, str):
        return print_text(value)
    match value:
        case Ref():
            return _ref(value)
        case Quantity():
            return f"{number_text(value.number)}{value.unit}"
        case Expression():
            return f"${{{value.text}}}"
        case Query():
            return "<?>"
    raise AssertionError(value)


# ---- layout ------------------------------------------------------------------------------------------------------------


def _lines(item: Item | TextBlock) -> list[str]:
    """The lines of an item: one if it fits, else its parts indented. Works through nested blocks with a stack."""
    lines: list[str] = []
    stack: list[tuple[int, Piece]] = [(0, item)]
    while stack:
        depth, part = stack.pop()
        indent = INDENT * depth
        if isinstance(part, str):
            lines.append(indent + part)
        elif isinstance(part, Comment):
            lines.extend(_comment_lines(part, indent))
        elif not isinstance(part, _OPEN) or not part.items:
            lines.append(indent + _text(part))
        elif not _is_long(part) and (text := _in_line(part, WIDTH - len(indent))) is not None:
            lines.append(indent + text)
        else:
            lines.append(f"{indent}{_head(part)} {{")
            stack.append((depth, "}"))
            stack.extend(reversed([(depth + 1, inner) for inner in _broken(part.items, WIDTH - len(indent) - len(INDENT))]))
    return lines


def _text(piece: Piece) -> str:
    """A piece in one line."""
    if isinstance(piece, TextBlock):
        return f"{piece.signature} {{ {_joined(piece.items)} }}" if piece.items else f"{piece.signature} {{}}"
    return piece if isinstance(piece, str) else print_item(piece)


def _in_line(node: Node | TextBlock, room: int) -> str | None:
    """A node with items in one line; None when that is longer than ``room`` or has line breaks."""
    head = _head(node)
    used = len(head) + 4
    texts = []
    for text in _texts(node.items):
        used += len(text) + 1
        if used > room or "\n" in text:
            return None
        texts.append(text)
    return f"{head} {{ {' '.join(texts)} }}"


def _head(node: Node | TextBlock) -> str:
    return node.signature if isinstance(node, TextBlock) else _signature(node)


def _is_long(node: Node | TextBlock) -> bool:
    """Whether a node surely needs several lines; spares printing a whole robot to find out."""
    return len(node.items) > WIDTH // 2 or Comment in map(type, node.items)


def _comment_lines(comment: Comment, indent: str) -> list[str]:
    """A line comment, or a block comment as it stands where the text has several lines."""
    text = comment.text
    return [f"{indent}// {text}".rstrip()] if "\n" not in text else [f"{indent}/* {text} */"]


def _broken(items: tuple[Piece, ...], width: int) -> list[Piece]:
    """The items of a block for several lines: nodes each on its own, runs of fields and arcs filled up to the width."""
    if _are_texts(items):
        return _filled(items, width)
    parts: list[Piece] = []
    run: list[Piece] = []
    for item, following in _with_next(items):
        if not isinstance(item, _ON_LINES_OF_THEIR_OWN):
            run.append(item)
            continue
        if run:
            parts += _filled(run, width, following if isinstance(item, Comment) else item)
            run = []
        parts.append(item)
    return parts + _filled(run, width)


def _filled(items: Sequence[Piece], width: int, following: Piece | None = None) -> list[Piece]:
    """Lines of items, each as full as the width allows; ``following`` is the piece behind them."""
    lines: list[Piece] = []
    line = ""
    for text in _texts(items, following):
        if line and len(line) + 1 + len(text) > width:
            lines.append(line)
            line = text
        else:
            line = f"{line} {text}" if line else text
    return [*lines, line] if line else lines


def _are_texts(items: Iterable[Piece]) -> TypeGuard[Sequence[str]]:
    """Whether all items are texts already, which need no comma."""
    return {*map(type, items)} <= {str}


def _texts(items: Sequence[Piece], behind: Piece | None = None) -> Iterable[str]:
    """Each item in one line, with the comma that the grammar needs before the next one."""
    if _are_texts(items):
        return items
    pairs = _with_next(items, behind)
    return (_text(item) + "," * (following is not None and _needs_comma(item, following)) for item, following in pairs)


def _with_next(items: Sequence[P], behind: P | None = None) -> Iterable[tuple[P, P | None]]:
    """Each item with the next one that is no comment."""
    if Comment not in map(type, items):
        return zip(items, (*items[1:], behind), strict=True) if items else ()
    pairs: list[tuple[P, P | None]] = []
    for item in reversed(items):
        pairs.append((item, behind))
        behind = behind if isinstance(item, Comment) else item
    return reversed(pairs)


def _joined(items: Sequence[Piece]) -> str:
    return " ".join(_texts(items))


def _needs_comma(item: Piece, following: Piece) -> bool:
    """After a bare name an arc or a quoted edge type could be taken for its value."""
    if not isinstance(item, Field) or item.value is not None:
        return False
    return isinstance(following, ArcItem) or (isinstance(following, Node) and following.edge not in ("", "@", "rel", "seq", "concurrent"))


# ---- items -------------------------------------------------------------------------------------------------------------


def _signature(node: Node) -> str:
    head = f"{_edge_word(node.edge)}{'.'.join(map(print_name, (*node.within, node.name)))}"
    if node.size is not None:
        head += f" {print_value(node.size)}"
    if node.parameters is not None:
        head += f"({', '.join(map(_parameter, node.parameters))})"
    if node.stereotypes:
        types = [_ref(kind.ref) + _arguments(kind.arguments) for kind in node.stereotypes]
        head += f" : {', '.join(types)}"
    return head + "".join(f" use {_ref(scope)}" for scope in node.uses)


def _edge_word(edge: str) -> str:
    if edge in ("", "@"):
        return edge
    return f"{edge} " if edge in ("rel", "seq", "concurrent") else f"{print_text(edge)} "


def _parameter(parameter: Parameter) -> str:
    name = print_name(parameter.name)
    return name if parameter.default is None else f"{name}={print_value(parameter.default)}"


def _arguments(arguments: tuple[tuple[str, Value], ...] | None) -> str:
    if arguments is None:
        return ""
    return f"({' '.join(f'{print_name(name)}={print_value(value)}' for name, value in arguments)})"


def _arc(arc: ArcItem) -> str:
    parts = [] if arc.weight is None else [print_value(arc.weight)]
    if arc.role:
        parts.append(print_name(arc.role))
    parts.append(_ref(arc.ref))
    if arc.items:
        parts.append(f"{{ {_joined(arc.items)} }}")
    return " ".join(parts)


def _ref(ref: Ref, between: str = " ") -> str:
    path = print_name(ref.path[0]) if len(ref.path) == 1 else ".".join(map(print_name, ref.path))
    modifier = f"{ref.modifier} " if ref.modifier else ""
    return f"{modifier}{ref.direction}{between}{path}" if ref.direction else path
