"""Extras as HyMeKo text: comments, blocks of attributes and elements of a format, or the texts as they are."""

from __future__ import annotations

from itertools import takewhile
from typing import TYPE_CHECKING

from hymeko_x.formats.hymeko import FOREIGN
from hymeko_x.language import markup
from hymeko_x.language.classes import definitions_of, is_section
from hymeko_x.language.markup import INDENT, NAMESPACES, PLACE, TEXT, block_of, markup_of, sound_comment, usual_spacing
from hymeko_x.language.printer import print_item
from hymeko_x.language.syntax import Comment, Field, Item, Node, QuotedName, Ref, Value, is_list
from hymeko_x.xml.namespaces import KNOWN_PREFIXES, PREFIX, with_declared, with_texts, without_declared

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from hymeko_x.ir.mechanism import Extra, Mechanism
    from hymeko_x.language.markup import Spacing

_FORMATS = FOREIGN - {"hymeko"}
_WIDEST = 110
"""Letters of an element with a list of texts, without its content."""
_OWN_WORDS = frozenset({PLACE, INDENT, TEXT, markup.COMMENT, NAMESPACES})


def without_namespaces(mechanism: Mechanism) -> Mechanism:
    """The mechanism in whose elements of a format no prefix is declared that the whole declares, where that can be undone."""

    def bare(text: str, declared: Mapping[str, str]) -> str:
        short = without_declared(text, declared)
        return short if with_declared(short, declared) == text else text

    return with_texts(mechanism, bare)


def with_extras(items: list[Item], extras: Iterable[Extra]) -> list[Item]:
    """The items of a block with the extras of its element: comments before them, those of formats behind."""
    by_format = _by_format(extras)
    comments = _comments(by_format.pop("comment", []))
    return [*comments, *items, *(item for format, found in by_format.items() for item in _of_format(format, found, at_root=False))]


def foreign_items(extras: Iterable[Extra]) -> list[Item]:
    """The items of the extras of the whole: a block for each format, and verbatim the texts that no block represents."""
    return [item for format, found in _by_format(extras).items() for item in _of_format(format, found, at_root=True)]


def _by_format(extras: Iterable[Extra]) -> dict[str, list[Extra]]:
    by_format: dict[str, list[Extra]] = {}
    for extra in extras:
        by_format.setdefault(extra.format, []).append(extra)
    return by_format


def standing_items(extras: list[Extra], *, classes: bool = False) -> list[Item]:
    """The extras that stand among the elements of the root, in order: comments, and one block for neighbours of one format.

    ``classes``: default classes are stereotypes.
    """
    items: list[Item] = []
    for extra in extras:
        node = _standing_block(extra)
        definitions = definitions_of(node) if classes and node is not None and is_section(extra) else None
        if definitions is not None:
            items += definitions
            continue
        block = _block_before(items, extra.format) if node is not None else None
        if node is not None and block is not None:
            _join(items, block, node)
        elif node is not None:
            items.append(Node(extra.format, (node,)))
        elif extra.format == "comment" and is_standing(extra):
            items.append(Comment(f"[{extra.path}] {extra.text}" if extra.path else extra.text))
        else:
            items.append(verbatim(extra, at_root=True))
    return items


def _block_before(items: Sequence[Item], format: str) -> int | None:
    """The place of the last block of a format if only comments stand behind it."""
    place = next((place for place in range(len(items) - 1, -1, -1) if not isinstance(items[place], Comment)), -1)
    return place if place >= 0 and isinstance(items[place], Node) and getattr(items[place], "name", "") == format else None


def _join(items: list[Item], place: int, node: Node) -> None:
    """Put an element, and the comments before it, into the block that stands at a place."""
    block = items[place]
    assert isinstance(block, Node)
    comments = tuple(items[place + 1 :])
    items[place:] = [block._replace(items=(*block.items, *comments, node) if comments else _with_element(block.items, node))]


def _with_element(items: tuple[Item, ...], node: Node) -> tuple[Item, ...]:
    """The elements of a block with one more, which is one element with the last one where they differ in one text in parentheses."""
    last = items[-1]
    merged = _merged(last, node) if isinstance(last, Node) else None
    return (*items, node) if merged is None else (*items[:-1], merged)


def _merged(first: Node, second: Node) -> Node | None:
    """Two elements as one with several names or a list of texts; None where they differ otherwise, or that is long."""
    old, new = first.parameters or (), second.parameters or ()
    names = [parameter for parameter in old if parameter.default is None]
    name = next((parameter for parameter in new if parameter.default is None), None)
    if names and name is not None:
        place = old.index(names[0])
        others = (*old[:place], *old[place + len(names) :])
        alike = (*others[:place], name, *others[place:]) == new and name not in names and first._replace(parameters=new) == second
        return _short(second._replace(parameters=(*others[:place], *names, name, *others[place:]))) if alike else None
    differing = [place for place, pair in enumerate(zip(old, new, strict=False)) if pair[0] != pair[1]]
    if len(old) != len(new) or len(differing) != 1 or first._replace(parameters=new) != second:
        return None
    place = differing[0]
    known = old[place].default
    texts = (*(known if is_list(known) else (known,)), new[place].default)
    if old[place].name != new[place].name or not markup.are_several(texts):
        return None
    return _short(second._replace(parameters=(*old[:place], new[place]._replace(default=texts), *old[place + 1 :])))


def _short(node: Node) -> Node | None:
    return node if len(print_item(node._replace(items=()))) <= _WIDEST else None


def is_standing(extra: Extra) -> bool:
    """Whether an extra of the whole has its place among the elements: also comments in a section, ``// [asset] text``."""
    if extra.format != "comment":
        return not extra.path
    if not sound_comment(extra.text):
        return False
    return bool(extra.text and markup.SECTION.fullmatch(extra.path)) if extra.path else markup.SECTION_COMMENT.match(extra.text) is None


def _standing_block(extra: Extra) -> Node | None:
    """The block of an element with the usual white space."""
    if extra.format not in _FORMATS or extra.path:
        return None
    found = block_of(extra.text)
    usual = usual_spacing(extra.format, at_root=True)
    return found[0] if found is not None and markup_of(found[0], usual) == extra.text else None


def is_comment_in_block(extra: Extra) -> bool:
    """Whether an extra of an element is a comment that reads back as it is from the element's block."""
    return extra.format == "comment" and not extra.path and sound_comment(extra.text)


def comments_of(extras: Iterable[Extra]) -> list[Item]:
    """The comments of an element, in order."""
    return [Comment(extra.text) for extra in sorted(extras, key=lambda extra: extra.index)]


def _comments(extras: list[Extra]) -> list[Item]:
    return comments_of(extras) if all(map(is_comment_in_block, extras)) else [verbatim(extra) for extra in extras]


def _of_format(format: str, extras: list[Extra], *, at_root: bool) -> list[Item]:
    """The block of one format, then the texts that it cannot represent. Those of one place stay together, because they are in order."""
    places: dict[str, list[Extra]] = {}
    for extra in extras:
        places.setdefault(_home(extra.path), []).append(extra)
    own: list[Item] = []
    left: list[Item] = []
    inner: list[Item] = []
    for home, found in places.items():
        items = _place_items(found, format, at_root=at_root) if format in _FORMATS else None
        if items is None:
            left.extend(verbatim(extra) for extra in found)
        elif home:
            inner.extend(_wrapped(QuotedName(f"{home}/"), items))
        else:
            own = items
    return [*_wrapped(format, own, inner), *left]


def _home(path: str) -> str:
    """The path of the node on which an attribute or a child stands."""
    if path.startswith("@") and "/@" not in path:
        return ""
    return path.rsplit("/@", 1)[0] if "/@" in path else path


def _wrapped(name: str, items: list[Item], inner: Iterable[Item] = ()) -> list[Node]:
    """The block of a place: attributes and elements, and in a block with parentheses the elements that are a text alone."""
    texts = [item for item in items if isinstance(item, Node) and _is_text(item)]
    if not texts:
        return [Node(name, (*items, *inner))] if items or inner else []
    attributes = tuple(item for item in items if isinstance(item, Field) and item.name not in (PLACE, INDENT))
    children = tuple(
        Field(item.name, item.items[0].value) if item in texts else item  # type: ignore[union-attr]
        for item in items
        if item not in attributes
    )
    first = [Node(name, (*attributes, *inner))] if attributes or inner else []
    return [*first, Node(name, children, parameters=())]


def _is_text(node: Node) -> bool:
    return node.parameters == () and len(node.items) == 1 and getattr(node.items[0], "name", "") == TEXT


def _place_items(extras: list[Extra], format: str, *, at_root: bool) -> list[Item] | None:
    """The attributes and elements of one place; None where a block cannot represent one of them."""
    known = list(takewhile(_is_known_namespace, extras))
    names = tuple(Ref((extra.path.removeprefix(f"@{PREFIX}"),)) for extra in known)
    items: list[Item] = [Field(NAMESPACES, names)] if names else []
    extras = extras[len(known) :]
    children: list[Item] = []
    place = 0
    spacing = usual_spacing(format, at_root=at_root)
    for extra in extras:
        if extra.path.startswith("@") or "/@" in extra.path:
            name = extra.path.rsplit("@", 1)[-1]
            if extra.index or not name or name in _OWN_WORDS:
                return None
            items.append(Field(name, markup.value_of_text(extra.text)))
            continue
        found = block_of(extra.text)
        if found is None or extra.path.endswith("text()"):
            return None
        node, own = found
        if markup_of(node, spacing) != extra.text:
            children.append(_indent(own))
            spacing = own
        if extra.index != place:
            children.append(Field(PLACE, float(extra.index)))
        place = extra.index + 1
        children.append(node)
    return [*items, *children]


def _is_known_namespace(extra: Extra) -> bool:
    return KNOWN_PREFIXES.get(extra.path.removeprefix(f"@{PREFIX}")) == extra.text and extra.path.startswith("@")


def _indent(spacing: Spacing | None) -> Field:
    if spacing is None:
        return Field(INDENT, Ref((markup.ONE_LINE,)))
    if spacing.base.strip(" ") or spacing.step.strip(" "):
        return Field(INDENT, (spacing.base, spacing.step))
    return Field(INDENT, (float(len(spacing.base)), float(len(spacing.step))))


def verbatim(extra: Extra, *, at_root: bool = False) -> Field:
    """A format's own text: ``urdf "<x/>"``, ``urdf ["path" "text"]``, ``urdf ["path" 3 "text"]``, ``extra ["format" ..]``."""
    named = extra.format in _FORMATS
    values: list[Value] = [] if named else [extra.format]
    place = 0 if at_root else extra.index
    if extra.path or place or not named:
        values.append(extra.path)
    if place:
        values.append(float(place))
    values.append(extra.text)
    name = extra.format if named else "extra"
    return Field(name, values[0] if len(values) == 1 else tuple(values))
