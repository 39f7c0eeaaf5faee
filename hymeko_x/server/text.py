"""Places in a text as editors count them, and the names in it, whether or not it can be parsed."""

from __future__ import annotations

import re
from bisect import bisect_left, bisect_right
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from lsprotocol import types

if TYPE_CHECKING:
    from collections.abc import Iterator

_SKIPPED = r'#[^\n]*|//[^\n]*|/\*[\s\S]*?(?:\*/|$)|"""[\s\S]*?(?:"""|$)|"(?:\\[\s\S]|[^"\\\n])*"?|\'(?:\\[\s\S]|[^\'\\\n])*\'?'
_NAME = r"`(?:\\.|[^`\\\n])*`|[^\W\d]\w*"
_WORDS = re.compile(rf"(?P<skipped>{_SKIPPED})|(?P<path>(?:{_NAME})(?:\.(?:{_NAME}))*)|(?P<mark>[{{}}()\[\]=:@])")
_STEPS = re.compile(_NAME)


class PathWord(NamedTuple):
    """One name of a path in the text: its offsets, and the steps of the path up to it, without backticks."""

    start: int
    end: int
    path: tuple[str, ...]


class TextPlaces:
    """Offsets of a text to lines and characters (UTF-16, from 0), and back."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._starts = [0, *(match.end() for match in re.finditer("\n", text))]

    def position(self, offset: int) -> types.Position:
        """The position of an offset."""
        line = bisect_right(self._starts, offset) - 1
        return types.Position(line, len(self._text[self._starts[line] : offset].encode("utf-16-le")) // 2)

    def range(self, start: int, end: int) -> types.Range:
        """The range between two offsets."""
        return types.Range(self.position(start), self.position(end))

    def offset(self, position: types.Position) -> int:
        """The offset of a position; one that is not there is the nearest."""
        if position.line >= len(self._starts):
            return len(self._text)
        start = self._starts[position.line]
        end = self._starts[position.line + 1] - 1 if position.line + 1 < len(self._starts) else len(self._text)
        line = self._text[start:end].encode("utf-16-le")[: 2 * position.character]
        return start + len(line.decode("utf-16-le", "ignore"))

    def of_line(self, line: int | None, column: int | None) -> types.Range:
        """The range of the word, or the character, at a one-based line and column; the whole line without a column."""
        number = min(max((line or 1) - 1, 0), len(self._starts) - 1)
        start = self._starts[number]
        end = self._starts[number + 1] - 1 if number + 1 < len(self._starts) else len(self._text)
        if column is None:
            return self.range(start, end)
        begin = min(start + column - 1, end)
        found = _STEPS.match(self._text, begin)
        return self.range(begin, max(found.end() if found else begin + 1, begin))


def unquoted(name: str) -> str:
    """A name without its backticks."""
    return re.sub(r"\\(.)", r"\1", name[1:-1]) if name.startswith("`") else name


@lru_cache(maxsize=8)
def _matches(text: str) -> list[re.Match[str]]:
    """The names, marks, comments and strings of a text, which is asked several times for one answer."""
    return list(_WORDS.finditer(text))


def words(text: str) -> Iterator[PathWord]:
    """Every name in the text outside of comments and strings."""
    for match in _matches(text):
        if match["path"] is not None:
            yield from _words_of(match)


def _words_of(match: re.Match[str]) -> Iterator[PathWord]:
    """The names of a path."""
    path: tuple[str, ...] = ()
    for step in _STEPS.finditer(match["path"]):
        path = (*path, unquoted(step[0]))
        yield PathWord(match.start() + step.start(), match.start() + step.end(), path)


class NodeDefinition(NamedTuple):
    """A node of the text: its path of names, the offsets of its name and of all of it, its types as written, and whether it is an edge."""

    path: tuple[str, ...]
    start: int
    end: int
    first: int
    last: int
    types: str
    is_edge: bool


class _Head:
    """The head of a node so far: where its name stands, and where its types begin."""

    def __init__(self) -> None:
        self.name: tuple[int, int] | None = None
        self.colon: int | None = None
        self.depth = 0
        self.edge: int | None = None

    def take(self, mark: str, last: tuple[int, int] | None, start: int) -> None:
        """Go on with a mark; ``last`` is the path before it."""
        if mark == "@" and not self.depth:
            self.edge, self.name, self.colon = start, None, None
        elif mark == "(" and not self.depth and self.colon is None:
            self.name = last
        elif mark == ":" and not self.depth:
            self.name = self.name or last
            self.colon = start
        self.depth += (mark in "([") - (mark in ")]")


def definitions(text: str) -> Iterator[NodeDefinition]:
    """The nodes of a text, whether or not it can be parsed, in the order in which they begin; an open one ends with the text."""
    found: list[NodeDefinition | None] = []
    stack: list[tuple[int, tuple[str, ...]]] = []
    head, last = _Head(), None
    for match in _matches(text):
        mark = match["mark"]
        if match["path"] is not None:
            if head.colon is None and not head.depth and head.name is not None:
                head.name = None  # what had parentheses was no node
            last = match.span("path")
        elif mark == "{":
            name = head.name or last
            path = stack[-1][1] if stack else ()
            if name is not None and not _is_arc(text, name[0]):
                path = (*path, *(unquoted(step) for step in _STEPS.findall(text[slice(*name)])))
                types = "" if head.colon is None else text[head.colon + 1 : match.start()].strip()
                first = name[0] if head.edge is None else head.edge
                found.append(NodeDefinition(path, *_last_step(text, name), first, len(text), types, head.edge is not None))
            else:
                found.append(None)
            stack.append((len(found) - 1, path))
            head, last = _Head(), None
        elif mark == "}":
            if stack:
                number, _ = stack.pop()
                closed = found[number]
                found[number] = None if closed is None else closed._replace(last=match.end())
            head, last = _Head(), None
        elif mark is not None:
            head.take(mark, last, match.start())
    yield from (one for one in found if one is not None)


def _is_arc(text: str, start: int) -> bool:
    """Whether the name at an offset is the target of an arc, whose block this is."""
    return text[max(start - 20, 0) : start].rstrip()[-1:] in ("+", "-", "~", ">")


def _last_step(text: str, path: tuple[int, int]) -> tuple[int, int]:
    """The offsets of the last name of a path."""
    *_, step = _STEPS.finditer(text, *path)
    return step.span()


def word_at(text: str, offset: int) -> PathWord | None:
    """The name at an offset, or right before it."""
    found = _matches(text)
    for match in found[bisect_left(found, offset, key=re.Match.end) :]:
        if match.start() > offset:
            return None
        if match["path"] is not None:
            return next((word for word in _words_of(match) if word.start <= offset <= word.end), None)
    return None


def heads(text: str, offset: int) -> list[str]:
    """The heads of the blocks around an offset, from the outermost: the text of each since the item before it."""
    begin = 0
    stack: list[str] = []
    for match in _matches(text):
        if match.start() >= offset:
            break
        mark = match["mark"]
        if mark == "{":
            stack.append(text[begin : match.start()])
        elif mark == "}" and stack:
            stack.pop()
        if mark in ("{", "}"):
            begin = match.end()
    return [re.split(r"[\n}{]", head.strip())[-1].strip() for head in stack]
