"""Extras from blocks such as ``mjcf { condim 4 }``, and from texts such as ``urdf "<x/>"``."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.frontends.hymeko.comments import standing_comment
from hymeko_x.ir.mechanism import Extra
from hymeko_x.language.markup import (
    INDENT,
    NAMESPACES,
    ONE_LINE,
    PLACE,
    TEXT,
    Spacing,
    is_step,
    markup_of,
    separate,
    text_of_value,
    usual_spacing,
)
from hymeko_x.language.syntax import Comment, Field, Item, Node, Ref, is_field, is_list
from hymeko_x.xml.namespaces import KNOWN_PREFIXES, PREFIX, with_declared, with_texts

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.frontends.hymeko.values import ValueReader
    from hymeko_x.ir.mechanism import Mechanism


class _Home(NamedTuple):
    """Where the content of a block belongs: the format, the path of the node, and whether that is the whole mechanism."""

    format: str
    path: str
    at_root: bool


def read_foreign(node: Node, reader: ValueReader, *, at_root: bool = False, place: int = 0) -> list[Extra]:
    """The attributes and elements in the block of a format; the first element without a place of its own stands at ``place``.

    Raises: Refusal (HX062) for items that XML cannot represent.
    """
    found: list[Extra] = []
    stack = [(_Home(node.name, "", at_root), node, place)]
    while stack:
        home, block, first = stack.pop()
        inner = [item for item in block.items if is_step(item)]
        found.extend(_read_place(home, block, first, reader))
        stack.extend((home._replace(path=str(item.name)[:-1]), item, 0) for item in reversed(inner) if isinstance(item, Node))
    return found


def _read_place(home: _Home, block: Node, place: int, reader: ValueReader) -> list[Extra]:
    """The extras of one node: its attributes, and its children in order."""
    spacing = usual_spacing(home.format, at_root=home.at_root)
    found: list[Extra] = []
    for item in block.items:
        if is_step(item):
            continue
        if is_field(item, (PLACE,)):
            place = reader.whole(item.value, item)
        elif is_field(item, (INDENT,)):
            spacing = _read_indent(item, reader)
        elif isinstance(item, Comment) and home.path:
            continue  # it has no place of its own
        elif isinstance(item, Comment):
            found.append(standing_comment(item, place))
            place += not found[-1].path
        elif is_field(item, (NAMESPACES,)) and is_list(item.value) and block.parameters is None:
            found.extend(_read_namespaces(home, item, reader))
        elif isinstance(item, Field) and block.parameters is None:
            found.append(Extra(home.format, f"{home.path}/@{item.name}" if home.path else f"@{item.name}", read_text(item, reader)))
        else:
            for element in separate(item):
                found.append(Extra(home.format, home.path, _markup(element, spacing, reader), place))
                place += 1
    return found


def _read_namespaces(home: _Home, item: Field, reader: ValueReader) -> Iterator[Extra]:
    """The declarations of prefixes that are known by name: ``xmlns [xacro controller]``."""
    for name in item.value if is_list(item.value) else ():
        prefix = text_of_value(name) or ""
        if prefix not in KNOWN_PREFIXES:
            raise reader.refuse(item, f"the namespace of '{prefix}' is not known", hint=f'`{PREFIX}{prefix}` "..." names it')
        yield Extra(home.format, f"@{PREFIX}{prefix}", KNOWN_PREFIXES[prefix])


def with_namespaces(mechanism: Mechanism) -> Mechanism:
    """The mechanism in whose elements of a format each prefix is declared that they use and the whole declares."""
    return with_texts(mechanism, with_declared)


def _markup(item: Item, spacing: Spacing | None, reader: ValueReader) -> str:
    """The XML of one child."""
    if isinstance(item, Field):
        item = Node(item.name, (Field(TEXT, read_text(item, reader)),), parameters=(), line=item.line, column=item.column)
    text = markup_of(item, spacing) if isinstance(item, Node) else None
    if text is None:
        raise reader.refuse(item, "this stands for no XML: elements hold attributes, texts and elements")
    return text


def read_text(item: Field, reader: ValueReader) -> str:
    """The text behind a field: that of a number, of a list of numbers, or of a word."""
    text = text_of_value(item.value)
    if text is None:
        raise reader.refuse(item, f"'{item.name}' takes a number, a word, a text or a list of numbers")
    return text


def _read_indent(item: Field, reader: ValueReader) -> Spacing | None:
    if isinstance(item.value, Ref) and item.value.path == (ONE_LINE,):
        return None
    values = item.value if is_list(item.value) else ()
    if len(values) == 2 and all(isinstance(value, str) for value in values):
        return Spacing(*map(str, values))
    base, step = reader.numbers(item.value, "", item, 2)
    return Spacing(" " * int(base), " " * int(step))


def read_extras(item: Field, reader: ValueReader) -> list[Extra]:
    """The extras of one field: :func:`read_extra`, or several attributes, ``mjcf ["@condim" "1" "@group" "2"]``."""
    values = item.value if is_list(item.value) else ()
    if item.name == "extra" or len(values) < 4 or len(values) % 2:
        return [read_extra(item, reader)]
    texts = [reader.text(value, item) for value in values]
    if not all(path.startswith("@") for path in texts[::2]):
        return [read_extra(item, reader)]
    return [Extra(item.name, path, text) for path, text in zip(texts[::2], texts[1::2], strict=True)]


def read_extra(item: Field, reader: ValueReader) -> Extra:
    """``urdf "<x/>"``, ``urdf ["path" "text"]``, ``urdf ["path" 3 "text"]``, or ``extra ["format" "path" 3 "text"]``."""
    value = item.value
    parts = list(value) if is_list(value) else [value]
    name = item.name
    if name == "extra" and parts:
        name = reader.text(parts.pop(0), item)
    if len(parts) == 1:
        return Extra(name, "", reader.text(parts[0], item))
    if len(parts) == 2:
        return Extra(name, reader.text(parts[0], item), reader.text(parts[1], item))
    if len(parts) == 3:
        return Extra(name, reader.text(parts[0], item), reader.text(parts[2], item), reader.whole(parts[1], item))
    raise reader.refuse(item, f"'{item.name}' takes a text, [path text] or [path place text]")
