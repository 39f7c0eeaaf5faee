"""What other formats said, from blocks such as ``mjcf { condim 4 }`` or from texts such as ``urdf "<x/>"``, as extras."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, cast

from hymeko_x.formats.hymeko import FOREIGN
from hymeko_x.ir.mechanism import Extra
from hymeko_x.language.foreign import INDENT, ONE_LINE, PLACE, usual_spacing
from hymeko_x.language.markup import TEXT, Spacing, markup_of, text_of_value
from hymeko_x.language.syntax import Field, Item, Node, QuotedName, Ref, is_list

if TYPE_CHECKING:
    from hymeko_x.frontends.hymeko.block import Context
    from hymeko_x.language.syntax import Value


class _Home(NamedTuple):
    """Where a block's content stands: the format, the path of the node, and whether that is the whole mechanism."""

    form: str
    path: str
    at_root: bool


def is_foreign(item: Item) -> bool:
    """Whether an item is the block of another format."""
    return isinstance(item, Node) and item.name in FOREIGN and not item.edge and not isinstance(item.name, QuotedName)


def read_foreign(node: Node, context: Context, *, at_root: bool = False, place: int = 0) -> list[Extra]:
    """The attributes and elements in the block of a format; the first element without a place of its own stands at ``place``.

    Raises: Refusal (HX062) for what XML has no place for.
    """
    found: list[Extra] = []
    stack = [(_Home(node.name, "", at_root), node, place)]
    while stack:
        home, block, first = stack.pop()
        inner = [item for item in block.items if _is_step(item)]
        found.extend(_read_place(home, block, first, context))
        stack.extend((home._replace(path=str(item.name)[:-1]), item, 0) for item in reversed(inner) if isinstance(item, Node))
    return found


def _is_step(item: Item) -> bool:
    return isinstance(item, Node) and isinstance(item.name, QuotedName) and item.name.endswith("/")


def _read_place(home: _Home, block: Node, place: int, context: Context) -> list[Extra]:
    """The extras of one node: its attributes, and its children in order."""
    spacing = usual_spacing(home.form, at_root=home.at_root)
    found: list[Extra] = []
    for item in block.items:
        if _is_step(item):
            continue
        if isinstance(item, Field) and item.name == PLACE and not isinstance(item.name, QuotedName):
            place = context.whole(item.value, item)
        elif isinstance(item, Field) and item.name == INDENT and not isinstance(item.name, QuotedName):
            spacing = _read_indent(item, context)
        elif isinstance(item, Field) and block.parameters is None:
            found.append(Extra(home.form, f"{home.path}/@{item.name}" if home.path else f"@{item.name}", read_text(item, context)))
        else:
            found.append(Extra(home.form, home.path, _markup(item, spacing, context), place))
            place += 1
    return found


def _markup(item: Item, spacing: Spacing | None, context: Context) -> str:
    """The XML of one child."""
    if isinstance(item, Field):
        item = Node(item.name, (Field(TEXT, read_text(item, context)),), parameters=(), line=item.line, column=item.column)
    text = markup_of(item, spacing) if isinstance(item, Node) else None
    if text is None:
        raise context.refuse(item, "this stands for no XML: elements hold attributes, texts and elements")
    return text


def read_text(item: Field, context: Context) -> str:
    """The text behind a field: a number, a list of numbers and a word stand for what they look like."""
    text = text_of_value(item.value)
    if text is None:
        raise context.refuse(item, f"'{item.name}' takes a number, a word, a text or a list of numbers")
    return text


def _read_indent(item: Field, context: Context) -> Spacing | None:
    if isinstance(item.value, Ref) and item.value.path == (ONE_LINE,):
        return None
    values = cast("tuple[Value, ...]", item.value) if is_list(item.value) else ()
    if len(values) == 2 and all(isinstance(value, str) for value in values):
        return Spacing(*map(str, values))
    base, step = context.numbers(item.value, "", item, 2)
    return Spacing(" " * int(base), " " * int(step))


# ---- as it is ----------------------------------------------------------------------------------------------------------------


def read_extras(item: Field, context: Context) -> list[Extra]:
    """What one field keeps: :func:`read_extra`, or several attributes, ``mjcf ["@condim" "1" "@group" "2"]``."""
    values = cast("tuple[Value, ...]", item.value) if is_list(item.value) else ()
    if item.name == "extra" or len(values) < 4 or len(values) % 2:
        return [read_extra(item, context)]
    texts = [context.text(value, item) for value in values]
    if not all(path.startswith("@") for path in texts[::2]):
        return [read_extra(item, context)]
    return [Extra(item.name, path, text) for path, text in zip(texts[::2], texts[1::2], strict=True)]


def read_extra(item: Field, context: Context) -> Extra:
    """``urdf "<x/>"``, ``urdf ["path" "text"]``, ``urdf ["path" 3 "text"]``, or ``extra ["format" "path" 3 "text"]``."""
    value = item.value
    parts = list(cast("tuple[Value, ...]", value)) if is_list(value) else [value]
    name = item.name
    if name == "extra" and parts:
        name = context.text(parts.pop(0), item)
    if len(parts) == 1:
        return Extra(name, "", context.text(parts[0], item))
    if len(parts) == 2:
        return Extra(name, context.text(parts[0], item), context.text(parts[1], item))
    if len(parts) == 3:
        return Extra(name, context.text(parts[0], item), context.text(parts[2], item), context.whole(parts[1], item))
    raise context.refuse(item, f"'{item.name}' takes a text, [path text] or [path place text]")
