"""Comments are not part of the grammar; those at top level are found again beside the tree and put in their place."""

from __future__ import annotations

import re
from bisect import bisect_left
from typing import TYPE_CHECKING

from hymeko_x.language.machine import GAP_DEPTH
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


_Place = tuple[int, int]
_END = (1 << 60, 0)


def weave_comments(document: Document, text: str, gaps: list[Gap], lines: Lines) -> Document:
    """The document with the comments in the gaps of its outermost levels among its items and those of its nodes."""
    levels: list[list[Comment]] = [[] for _ in range(GAP_DEPTH + 1)]
    for depth, comment in _comments(text, gaps, lines):
        levels[depth].append(comment)
    if not any(levels):
        return document
    return document._replace(items=_woven(document.items, levels, 0, (0, 0), _END))


def comment_text(token: str) -> str:
    """What a comment says, without its signs and the blanks around it."""
    if token.startswith("#"):
        return token[1:].strip()
    return (token[2:] if token.startswith("//") else token[2:-2]).strip()


def _comments(text: str, gaps: list[Gap], lines: Lines) -> Iterator[tuple[int, Comment]]:
    """Every comment outside all blocks (0), directly in an outermost block (1), or in one of its nodes (2)."""
    for start, end, depth in gaps:
        for match in _COMMENT.finditer(text, start, end):
            yield depth, Comment(comment_text(match[0]), *lines.place(match.start()))


def _woven(items: tuple[Item, ...], levels: list[list[Comment]], depth: int, start: _Place, end: _Place) -> tuple[Item, ...]:
    """The items of one block with the comments between two places; nodes with those of their own blocks."""
    found: list[Item] = []
    ends = [*(_place(item) or end for item in items[1:]), end]
    for item, behind in zip(items, ends, strict=False):
        place = _place(item)
        if isinstance(item, Node) and place and any(_between(level, place, behind) for level in levels[depth + 1 :]):
            item = item._replace(items=_woven(item.items, levels, depth + 1, place, behind))
        found.append(item)
    return tuple(_merged(found, list(_between(levels[depth], start, end))))


def _between(comments: list[Comment], start: _Place, end: _Place) -> list[Comment]:
    """The comments between two places; they are in order."""
    return comments[bisect_left(comments, start, key=_place) : bisect_left(comments, end, key=_place)]


def _merged(items: list[Item], comments: list[Comment]) -> list[Item]:
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
