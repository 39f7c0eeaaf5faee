"""Comments of HyMeKo text: their places in its syntax tree, and blocks without them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from hymeko_x.language.markup import is_foreign, is_step
from hymeko_x.language.syntax import Comment, Item, Node

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from hymeko_x.language.machine import Gap, Lines
    from hymeko_x.language.syntax import Document

_COMMENT = re.compile(r"#[^\n]*|//[^\n]*|/\*[\s\S]*?\*/")

_Found = tuple[int, Comment]
"""A comment, and the number of brackets around it."""


def with_comments(document: Document, text: str, gaps: Sequence[Gap], lines: Lines) -> Document:
    """The document with every comment in the gaps between the tokens of its text.

    A comment inside of a node stands in the node's block; one inside of anything else, or of a template, stands before it.
    """
    comments = _comments(text, gaps, lines)
    return document._replace(items=_woven(document.items, comments, 0)) if comments else document


def comments_in(items: Iterable[Item]) -> Iterator[Comment]:
    """The comments among some items and in the blocks of those, in order; those in elements of another format belong to the elements."""
    for item in items:
        if isinstance(item, Comment):
            yield item
        elif isinstance(item, Node):
            yield from comments_in(filter(_is_own, item.items) if is_foreign(item) else item.items)


def without_comments(node: Node) -> Node:
    """The node with no comments in its block, apart from those in elements of another format."""
    if next(comments_in((node,)), None) is None:
        return node
    foreign = is_foreign(node)
    items = (item for item in node.items if not isinstance(item, Comment))
    bare = (without_comments(item) if isinstance(item, Node) and (not foreign or is_step(item)) else item for item in items)
    return node._replace(items=tuple(bare))


def _is_own(item: Item) -> bool:
    """Whether an item in the block of another format is a comment or a step to a node of the element (`joint/`): no element."""
    return isinstance(item, Comment) or (isinstance(item, Node) and is_step(item))


def comment_text(token: str) -> str:
    """The text of a comment, without its signs and the blanks around it."""
    if token.startswith("#"):
        return token[1:].strip()
    return (token[2:] if token.startswith("//") else token[2:-2]).replace("\r\n", "\n").strip()


def _comments(text: str, gaps: Sequence[Gap], lines: Lines) -> list[_Found]:
    """Every comment, in the order of the text."""
    if "#" not in text and "//" not in text and "/*" not in text:
        return []
    found = ((depth, match) for start, end, depth in gaps for match in _COMMENT.finditer(text, start, end))
    return [(depth, Comment(comment_text(match[0]), *lines.place(match.start()))) for depth, match in found]


def _woven(items: tuple[Item, ...], comments: list[_Found], depth: int, *, is_markup: bool = False) -> tuple[Item, ...]:
    """The items of a block that is inside this many brackets, with the comments in it; ``is_markup``: of another format."""
    woven: list[Item] = []
    first = _count_before(comments, 0, items[0] if items else None)
    woven.extend(comment for _, comment in comments[:first])
    for number, item in enumerate(items, 1):
        behind = _count_before(comments, first, items[number] if number < len(items) else None)
        inner = [found for found in comments[first:behind] if found[0] > depth]
        if inner and isinstance(item, Node):
            in_markup = is_markup or is_foreign(item)
            whole = item._replace(items=_woven(item.items, inner, depth + 1, is_markup=in_markup))
            if item.parameters is not None and not in_markup:
                woven.extend(comments_in(whole.items))
                whole = without_comments(whole)
            woven.append(whole)
        else:
            woven.extend(comment for _, comment in inner)
            woven.append(item)
        woven.extend(comment for level, comment in comments[first:behind] if level <= depth)
        first = behind
    return tuple(woven)


def _count_before(comments: list[_Found], first: int, item: Item | None) -> int:
    """How many of the comments stand before an item, if from ``first`` on one does; None is behind all of them."""
    if item is None:
        return len(comments)
    while first < len(comments) and (comments[first][1].line, comments[first][1].column) < (item.line, item.column):
        first += 1
    return first
