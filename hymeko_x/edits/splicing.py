"""Pieces of text put into a file, taken out of it and moved within it, so that every other byte stays."""

from __future__ import annotations

import re
from bisect import bisect_left
from itertools import pairwise
from typing import TYPE_CHECKING

from msgspec import Struct, field

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.outline import BlockStyle, OutlineBlock

_BLANKS = re.compile(rb"[ \t]*")
_EMPTY_LINE = re.compile(rb"\n[ \t]*\r?\n")


class Edit(Struct, frozen=True, order=True):
    """The bytes between two places of a file, and what comes there instead. Of several at one place, ``turn`` is the order."""

    start: int
    end: int
    turn: int
    text: bytes


class Splices(Struct):
    """The edits of one file so far."""

    data: bytes
    style: BlockStyle
    edits: list[Edit] = field(default_factory=list)

    def put(self, start: int, end: int, text: bytes) -> None:
        """Replace what stands between two places."""
        self.edits.append(Edit(start, end, len(self.edits), text))

    def result(self) -> bytes:
        """The whole file with its edits. An edit inside of another one's bytes is left out."""
        return self._spliced(0, len(self.data), sorted(self.edits))

    def within(self, block: OutlineBlock) -> bytes:
        """The text of a block with the edits inside of it."""
        inner = [edit for edit in self.edits if block.start < edit.start and edit.end < block.end]
        return self._spliced(block.start, block.end, sorted(inner))

    def _spliced(self, start: int, end: int, edits: Iterable[Edit]) -> bytes:
        pieces: list[bytes] = []
        at = start
        for edit in edits:
            if edit.start >= at:
                pieces += [self.data[at : edit.start], edit.text]
                at = edit.end
        return b"".join([*pieces, self.data[at:end]])

    # ---- lines -------------------------------------------------------------------------------------------------------------

    @property
    def newline(self) -> bytes:
        """How lines end in the file."""
        return b"\r\n" if b"\r\n" in self.data else b"\n"

    def indent(self, block: OutlineBlock) -> bytes | None:
        """The blanks before a block that is the first thing on its line; None where something else is."""
        line = self.data.rfind(b"\n", 0, block.start) + 1
        before = self.data[line : block.start]
        return before if not before.strip(b" \t\xef\xbb\xbf") else None

    def end_of_line(self, place: int) -> int | None:
        """Where the line ends on which a place is, if nothing but blanks and a comment follows; None otherwise."""
        found = re.compile(self.style.trailing).match(self.data, place)
        end = place if found is None else found.end()
        return end if self.data[end : end + 1] in (b"\n", b"\r", b"") else None

    def stands_apart(self, block: OutlineBlock) -> bool:
        """Whether empty lines are between a block and those before and behind it in the same one."""
        row = [] if block.parent is None else [other for other in block.parent.children if other.tag != self.style.head_tag]
        at = row.index(block) if block in row else 0
        pairs = list(pairwise(row[max(at - 1, 0) : at + 2]))
        return bool(pairs) and all(_EMPTY_LINE.search(self.data, before.end, after.start) for before, after in pairs)

    def remove(self, block: OutlineBlock) -> None:
        """Take a block out, with its lines where it has them for itself."""
        indent = self.indent(block)
        end = _BLANKS.match(self.data, block.end).end()  # type: ignore[union-attr]
        if indent is None or self.data[end : end + 1] not in (b"\n", b"\r", b""):
            self.put(block.start, block.end, b"")
            return
        after = self.data.find(b"\n", end)
        self.put(block.start - len(indent), len(self.data) if after < 0 else after + 1, b"")


def unit_of(data: bytes, blocks: Iterable[OutlineBlock]) -> bytes:
    """By how much the text indents what is inside of something: the difference that is most frequent."""
    counts: dict[bytes, int] = {}
    for block in blocks:
        if block.parent is None:
            continue
        inner, outer = (_indent(data, place) for place in (block.start, block.parent.start))
        if inner is not None and outer is not None and inner.startswith(outer) and inner != outer and block.file == block.parent.file:
            unit = inner[len(outer) :]
            counts[unit] = counts.get(unit, 0) + 1
    return max(counts, key=lambda unit: counts[unit], default=b"  ")


def _indent(data: bytes, place: int) -> bytes | None:
    before = data[data.rfind(b"\n", 0, place) + 1 : place]
    return before if not before.strip(b" \t") else None


def reindented(text: bytes, old: bytes, old_unit: bytes, new: bytes, unit: bytes, newline: bytes) -> bytes:
    """A piece of several lines for another place: the indentation of its first line becomes another one, deeper lines follow."""
    lines = text.replace(b"\r\n", b"\n").split(b"\n")
    found = [lines[0]]
    for line in lines[1:]:
        blanks = _BLANKS.match(line).end()  # type: ignore[union-attr]
        rest, inner = line[blanks:], line[:blanks].removeprefix(old)
        if not rest:
            found.append(b"")
        elif not line.startswith(old):
            found.append(new + rest)
        else:
            found.append(new + _deeper(inner, old_unit, unit) + rest)
    return newline.join(found)


def _deeper(inner: bytes, old_unit: bytes, unit: bytes) -> bytes:
    count, left = divmod(len(inner), len(old_unit)) if old_unit and inner.startswith(old_unit) else (0, len(inner))
    return unit * count + inner[len(inner) - left :]


class ByteLines:
    """The lines of places in a text, of which many are asked for."""

    def __init__(self, data: bytes) -> None:
        self._starts = [0, *(found.end() for found in re.finditer(b"\n", data))]

    def of(self, place: int) -> int:
        """The one-based line of a place."""
        return bisect_left(self._starts, place + 1)
