"""Extras that are XML as blocks of the language, and back to the last character.

``<option timestep="0.01"><flag gravity="disable"/></option>`` is ``option { timestep 0.01 flag { gravity=disable } }``.
Fields are attributes; where an element holds texts, its attributes stand in parentheses and its fields are elements with a
text: ``<gazebo reference="hip"><mu1>0.9</mu1></gazebo>`` is ``gazebo(hip) { mu1 0.9 }``, for a name alone in parentheses is the
attribute ``reference``. Comments are comments.
Numbers and words are plain where their text is the shortest there is, everything else is quoted. Entities stay as they are.
"""

from __future__ import annotations

import re
from typing import NamedTuple, TypeGuard

from hymeko_x import formats
from hymeko_x.ir.digits import number_text
from hymeko_x.language.syntax import Comment, Field, Item, Node, Parameter, QuotedName, Ref, Value, is_list
from hymeko_x.xml.text import comment_markup

TEXT = QuotedName("text()")
"""The field that holds the text of an element with attributes."""
COMMENT = QuotedName("//")
"""The field that holds a comment, with the blanks that it has, which is not a comment of the text with one blank on each side."""
NAMESPACES = "xmlns"
"""The field that declares prefixes of namespaces by name alone, in the block of the whole."""
REFERENCE = "reference"
"""The attribute that a name alone in parentheses stands for."""

_NAME = r"[^\W\d][\w:.-]*"
_TOKEN = re.compile(
    rf'<(?P<tag>{_NAME})(?P<attributes>(?: {_NAME}="[^"<]*")*)(?P<ends>/?)>|</(?P<closed>{_NAME})>|(?P<text>[^<]+)'
    r"|<!--(?P<comment>(?:[^-]|-(?!->))*)-->"
)
_ATTRIBUTE = re.compile(rf' ({_NAME})="([^"<]*)"')
_NUMBERS = re.compile(r"[-\d][-\de.]*(?: [-\d][-\de.]*)*")
_WORD = re.compile(r"[^\W\d]\w*")
_NO_WORDS = frozenset({"inf", "nan"})
_MAX_DEPTH = 50


class Spacing(NamedTuple):
    """White space between the tags of pretty XML: the white space before the closing tag, and that which every level adds."""

    base: str
    step: str


def value_of_text(text: str) -> Value:
    """A number, a list of numbers or a word where that reads back to the same characters, else the text."""
    if _NUMBERS.fullmatch(text):
        try:
            numbers = tuple(map(float, text.split(" ")))
        except ValueError:
            return text
        if " ".join(map(number_text, numbers)) == text:
            return numbers[0] if len(numbers) == 1 else numbers
        return text
    return Ref((text,)) if _WORD.fullmatch(text) and text not in _NO_WORDS else text


def text_of_value(value: Value | None) -> str | None:
    """The text that a value stands for; None for what cannot stand for one."""
    if isinstance(value, str):
        return value
    if type(value) is float:
        return number_text(value)
    if isinstance(value, Ref):
        return value.path[0] if len(value.path) == 1 and not value.direction else None
    if is_list(value):
        parts = [number_text(part) if type(part) is float else None for part in value]
        return None if None in parts else " ".join(map(str, parts))
    return None


def are_several(value: object) -> TypeGuard[tuple[Value, ...]]:
    """Whether a value is a list of words and texts, which stands for as many elements; a list of numbers is one text."""
    return type(value) is tuple and all(
        isinstance(part, str) or (isinstance(part, Ref) and text_of_value(part) is not None) for part in value
    )


def is_foreign(item: Item) -> bool:
    """Whether an item is the block of another format."""
    return isinstance(item, Node) and item.name in formats.FOREIGN and not item.edge and not isinstance(item.name, QuotedName)


def is_step(item: Item) -> bool:
    """Whether an item in the block of another format leads to a node of the element: `joint/`."""
    return isinstance(item, Node) and isinstance(item.name, QuotedName) and item.name.endswith("/")


def sound_comment(text: str) -> bool:
    """Whether a comment reads back as it is."""
    return text == text.strip() and "\0" not in text and ("*/" not in text or "\n" not in text) and "\r" not in text


def separate(item: Item) -> list[Item]:
    """The elements of an item with several names alone or a list of texts in parentheses: one for each, which is like the others."""
    parameters = item.parameters if isinstance(item, Node) else None
    names = [parameter for parameter in parameters or () if parameter.default is None]
    if isinstance(item, Node) and parameters is not None and len(names) > 1:
        first = parameters.index(names[0])
        others = [[parameter for parameter in part if parameter.default is not None] for part in (parameters[:first], parameters[first:])]
        return [item._replace(parameters=(*others[0], name, *others[1])) for name in names]
    place = next((place for place, each in enumerate(parameters or ()) if are_several(each.default)), None)
    if place is None or not isinstance(item, Node) or parameters is None:
        return [item]
    several = parameters[place]
    assert is_list(several.default)
    return [
        item._replace(parameters=(*parameters[:place], several._replace(default=text), *parameters[place + 1 :]))
        for text in several.default
    ]


class _Open(NamedTuple):
    """An element that is being read."""

    tag: str
    attributes: list[tuple[str, str]]
    children: list[Node | Field | Comment]
    texts: list[str]


def block_of(xml: str) -> tuple[Node, Spacing | None] | None:
    """The block of one XML element, and its white space; None where it would not read back the same."""
    node = _read(xml)
    if node is None:
        return None
    spacing = _spacing(xml)
    return (node, spacing) if markup_of(node, spacing) == xml else None


def _read(xml: str) -> Node | None:
    root = _Open("", [], [], [])
    stack = [root]
    position = 0
    while position < len(xml):
        match = _TOKEN.match(xml, position)
        if match is None:
            return None
        position = match.end()
        if (text := match["text"]) is not None:
            stack[-1].texts.append(text)
        elif (comment := match["comment"]) is not None:
            text = comment[1:-1]
            is_plain = bool(text) and match[0] == comment_markup(text) and sound_comment(text)
            stack[-1].children.append(Comment(text) if is_plain else Field(COMMENT, comment))
        elif (tag := match["tag"]) is not None:
            stack.append(_Open(tag, _ATTRIBUTE.findall(match["attributes"]), [], []))
            if match["ends"]:
                _close(stack, empty=True)
        elif len(stack) < 2 or match["closed"] != stack[-1].tag:
            return None
        else:
            _close(stack, empty=False)
        if len(stack) > _MAX_DEPTH:
            return None
    only = root.children[0] if len(stack) == 1 and len(root.children) == 1 and not root.texts else None
    return None if only is None or isinstance(only, Comment) else _as_node(only)


def _as_node(item: Node | Field) -> Node:
    """An element with a text alone, as a block of its own."""
    return item if isinstance(item, Node) else Node(item.name, (Field(TEXT, item.value),), parameters=())


def _close(stack: list[_Open], *, empty: bool) -> None:
    """Put the innermost element into the one around it."""
    tag, attributes, children, texts = stack.pop()
    text = "".join(texts)
    if not children and not empty and not attributes:
        stack[-1].children.append(Field(tag, value_of_text(text)))
        return
    if not children and not empty:
        children = [Field(TEXT, value_of_text(text))]
    values = [(name, value_of_text(value)) for name, value in attributes]
    parameters = tuple(_parameter(name, value) for name, value in values)
    if any(isinstance(child, Field) for child in children) or any(parameter.default is None for parameter in parameters):
        node = Node(tag, tuple(children), parameters=parameters)
    else:
        node = Node(tag, (*(Field(name, value) for name, value in values), *children))
    stack[-1].children.append(node)


def _parameter(name: str, value: Value) -> Parameter:
    """An attribute in parentheses: a name alone where it is a reference by name."""
    if name != REFERENCE or not isinstance(value, str | Ref) or not value:
        return Parameter(name, value)
    return Parameter(value.path[0] if isinstance(value, Ref) else QuotedName(value))


def _spacing(xml: str) -> Spacing | None:
    """The white space behind the first and the last line break; None for XML in one line."""
    if "\n" not in xml:
        return None
    first = re.search(r"\n([ \t]*)", xml)
    last = re.search(r"\n([ \t]*)</[^<>]*>$", xml)
    if first is None or last is None or not first[1].startswith(last[1]):
        return None
    return Spacing(last[1], first[1].removeprefix(last[1]))


def markup_of(node: Node, spacing: Spacing | None) -> str | None:
    """The XML of a block; None where XML cannot represent it."""
    parts: list[str] = []
    stack: list[tuple[int, Item | str]] = [(0, node)]
    while stack:
        depth, item = stack.pop()
        if isinstance(item, str):
            parts.append(item)
            continue
        if isinstance(item, Comment):
            parts.append(comment_markup(item.text))
            continue
        if not isinstance(item, Node | Field):
            return None
        if isinstance(item, Field):
            text = text_of_value(item.value)
            if text is None:
                return None
            parts.append(_leaf(item.name, text))
            continue
        head, children = _parts_of(item)
        if head is None:
            return None
        if not children:
            parts.append(f"{head}/>")
            continue
        parts.append(f"{head}>")
        stack.append((depth, f"</{item.name}>"))
        alone = isinstance(children[0], Field) and children[0].name == TEXT
        if spacing is not None and not alone:
            stack.append((depth, _line(spacing, depth)))
        for child in reversed(children):
            stack.append((depth + 1, child))
            if spacing is not None and not alone:
                stack.append((depth, _line(spacing, depth + 1)))
    return "".join(parts)


def _leaf(name: str, text: str) -> str:
    """The XML of a field."""
    if isinstance(name, QuotedName) and name in (TEXT, COMMENT):
        return text if name == TEXT else f"<!--{text}-->"
    return f"<{name}>{text}</{name}>"


def _line(spacing: Spacing, depth: int) -> str:
    return "\n" + spacing.base + spacing.step * depth


def _parts_of(node: Node) -> tuple[str | None, tuple[Item, ...]]:
    """The beginning of the element's tag, and its children."""
    if node.parameters is None:
        values = [(item.name, item.value) for item in node.items if isinstance(item, Field)]
        children: tuple[Item, ...] = tuple(item for item in node.items if not isinstance(item, Field))
    else:
        values = [(REFERENCE, str(each.name)) if each.default is None else (each.name, each.default) for each in node.parameters]
        children = node.items
    texts = [(name, text_of_value(value)) for name, value in values]
    if any(text is None for _, text in texts):
        return None, ()
    return f"<{node.name}" + "".join(f' {name}="{text}"' for name, text in texts), children


PLACE = "place"
"""``place 3``: the number that the next child has among the children of its parent; those behind it count on."""
INDENT = "indent"
"""``indent [4 2]``: blanks before the closing tag of the children that follow, and more for every level; also as texts."""
ONE_LINE = "none"
"""``indent=none``: no white space between the tags."""

SECTION = re.compile(r"(?!preceding\b|following\b)\w+")
SECTION_COMMENT = re.compile(rf"\[({SECTION.pattern})\] (.+)", re.DOTALL)
"""A comment between the elements that stood in a section of its format: ``// [asset] meshes``."""

_NESTED = Spacing("    ", "  ")
_OUTER = Spacing("  ", "  ")


def usual_spacing(format: str, *, at_root: bool) -> Spacing | None:
    """The white space between the tags of a format's children that is not written: of the whole, or of an element."""
    if any(row.name == format and row.has_compact_extras for row in formats.FORMATS):
        return None
    return _OUTER if at_root else _NESTED
