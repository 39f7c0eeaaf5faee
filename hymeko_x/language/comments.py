"""Comments are not part of the grammar; those at top level are found again beside the tree and put in their place."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from hymeko_x.language.syntax import Comment, Document, Item, Node

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.language.machine import Gap, Lines

TOKENS = re.compile(
    r'"""[\s\S]*?"""|"[^"\\]*(?:\\[\s\S][^"\\]*)*"|\'[^\'\\]*(?:\\[\s\S][^\'\\]*)*\'|`[^`\\\n]*(?:\\.[^`\\\n]*)*`'
    r"|#[^\n]*|//[^\n]*|/\*[\s\S]*?\*/|[{}\[\]()]"
)
"""Everything in which a bracket or comment sign means something else, comments, and brackets."""
_COMMENT = re.compile(r"#[^\n]*|//[^\n]*|/\*[\s\S]*?\*/")


def weave_comments(document: Document, text: str, gaps: list[Gap], lines: Lines) -> Document:
    """The document with the comments in the gaps of its outermost levels among its items and those of its nodes."""
    outer: list[Item] = []
    inner: list[Comment] = []
    for depth, comment in _comments(text, gaps, lines):
        if depth == 0:
            outer.append(comment)
        else:
            inner.append(comment)
    if not outer and not inner:
        return document
    items = [_with_inner(item, inner, document.items[number + 1 :]) for number, item in enumerate(document.items)]
    return document._replace(items=tuple(_merged(items, outer)))


def comment_text(token: str) -> str:
    """What a comment says, without its signs and the blanks around it."""
    if token.startswith("#"):
        return token[1:].strip()
    return (token[2:] if token.startswith("//") else token[2:-2]).strip()


def _comments(text: str, gaps: list[Gap], lines: Lines) -> Iterator[tuple[int, Comment]]:
    """Every comment outside all blocks (0) or directly in an outermost block (1)."""
    for start, end, depth in gaps:
        for match in _COMMENT.finditer(text, start, end):
            yield depth, Comment(comment_text(match[0]), *lines.place(match.start()))


def _with_inner(item: Item, comments: list[Comment], following: tuple[Item, ...]) -> Item:
    """A node with the comments of its own block."""
    if not isinstance(item, Node):
        return item
    end = min((place for place in map(_place, following) if place), default=(1 << 60, 0))
    own: list[Item] = [comment for comment in comments if _place(item) < _place(comment) < end]
    return item._replace(items=tuple(_merged(list(item.items), own))) if own else item


def _merged(items: list[Item], comments: list[Item]) -> list[Item]:
    """Both in the order of their places; items without a place stay behind their predecessor."""
    merged: list[Item] = []
    rest = list(reversed(comments))
    for item in items:
        while rest and _place(item) and _place(rest[-1]) < _place(item):
            merged.append(rest.pop())
        merged.append(item)
    return [*merged, *reversed(rest)]


def _place(item: Item) -> tuple[int, int]:
    return (item.line, item.column) if item.line else ()  # type: ignore[return-value]
