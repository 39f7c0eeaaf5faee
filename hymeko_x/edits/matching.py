"""Which block of one outline is which of another one: by name, by content, and by what stands around them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from operator import attrgetter
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterable

    from hymeko_x.outline import OutlineBlock

Pairs = dict["OutlineBlock", "OutlineBlock"]
"""The block of the other outline, for each block that it has."""


Named = Mapping[tuple[str, str], "OutlineBlock"]
"""Blocks by their tags, and names that they may have in another way."""
NO_NAMES: Named = MappingProxyType({})


def match(first: OutlineBlock, second: OutlineBlock, written: Named = NO_NAMES) -> Pairs:
    """The blocks of ``second`` by those of ``first`` that they are. Linear but for sorting.

    ``written`` are blocks of ``second`` by what the outermost ones of ``first`` are called; these are matched at first.

    Blocks in matched blocks are matched by their names; then those that stand elsewhere now, whose name is unique; then what has the
    same content, with another name; and what is left in its order.
    """
    matching = _Matching(first, second)
    matching.pair(first, second)
    for block in first.children:
        if (block.tag, block.name) in written:
            matching.pair(block, written[block.tag, block.name])
    matching.descend()
    matching.match_moved(first, second)
    matching.match_rest()
    return matching.pairs


class _Matching:
    """The pairs so far, and those whose inner blocks have not been looked at."""

    def __init__(self, first: OutlineBlock, second: OutlineBlock) -> None:
        self.pairs: Pairs = {}
        self.taken: set[OutlineBlock] = set()
        self._contents = {**_contents(first), **_contents(second)}
        self._waiting: list[tuple[OutlineBlock, OutlineBlock]] = []
        self._open: list[tuple[OutlineBlock, OutlineBlock]] = []

    def pair(self, first: OutlineBlock, second: OutlineBlock) -> None:
        """They are the same from now on."""
        self.pairs[first] = second
        self.taken.add(second)
        self._waiting.append((first, second))

    def descend(self) -> None:
        """Match the named blocks inside of matched ones."""
        while self._waiting:
            first, second = self._waiting.pop()
            self._open.append((first, second))
            self._match(first, second, lambda block: (block.tag, block.name) if block.name else None)

    def match_moved(self, first: OutlineBlock, second: OutlineBlock) -> None:
        """Match blocks with a name that is unique in both, wherever they stand."""
        mine, theirs = (_unique(block for block in root.walk() if not self._is_matched(block)) for root in (first, second))
        for key, block in mine.items():
            other = theirs.get(key)
            if other is not None:
                self.pair(block, other)
        self.descend()

    def match_rest(self) -> None:
        """Match what has the same content, and then what has the same tag, inside of matched blocks."""
        while self._open:
            first, second = self._open.pop()
            self._match_by_children(first)
            for key in _KEYS:
                self._match(first, second, lambda block, key=key: key(self._contents[block]))  # type: ignore[misc]
            self._match_in_order(first, second)
            self.descend()

    def _match_in_order(self, first: OutlineBlock, second: OutlineBlock) -> None:
        """Match what has the same tag and, if it has another name, something in common."""
        self._match(first, second, lambda block: None if block.name else block.tag)
        waiting: dict[str, list[OutlineBlock]] = defaultdict(list)
        for other in reversed(self._inside(first, second)):
            if other not in self.taken:
                waiting[other.tag].append(other)
        for block in first.children:
            row = waiting.get(block.tag)
            if block not in self.pairs and row and self._are_alike(block, row[-1]):
                self.pair(block, row.pop())

    def _are_alike(self, block: OutlineBlock, other: OutlineBlock) -> bool:
        """Whether two blocks have no two names, or a field or an inner block in common."""
        if not (block.name and other.name):
            return True
        fields = {(name, value_of(field.text)) for name, field in block.fields.items()}
        if any((name, value_of(field.text)) in fields for name, field in other.fields.items()):
            return True
        inner = {self._contents[child].named for child in block.children}
        return any(self._contents[child].named in inner for child in other.children)

    def _match_by_children(self, first: OutlineBlock) -> None:
        """Match what has a child that is matched already, in whichever of several blocks of one tag it stands."""
        for block in first.children:
            if block in self.pairs:
                continue
            others = (self.pairs[child].parent for child in block.children if child in self.pairs)
            other = next((parent for parent in others if parent is not None and parent.tag == block.tag), None)
            if other is not None and other not in self.taken:
                self.pair(block, other)

    def _inside(self, first: OutlineBlock, second: OutlineBlock) -> list[OutlineBlock]:
        """What is in a block; and in those after it that are one with it in the other text: bare ones of its tag, such as <actuator>."""
        if second.parent is None or not _is_bare(second) or first.parent is None:
            return second.children
        mine, theirs = ([block for block in outer.children if block.tag == second.tag] for outer in (first.parent, second.parent))
        if len(mine) > 1 or len(theirs) == 1 or not all(map(_is_bare, theirs)):
            return second.children
        return [child for block in theirs for child in block.children]

    def _is_matched(self, block: OutlineBlock) -> bool:
        return block in self.pairs or block in self.taken

    def _match(self, first: OutlineBlock, second: OutlineBlock, key: Callable[[OutlineBlock], Hashable]) -> None:
        waiting: dict[Hashable, list[OutlineBlock]] = defaultdict(list)
        for block in reversed(self._inside(first, second)):
            if block not in self.taken:
                waiting[key(block)].append(block)
        waiting.pop(None, None)
        if not waiting:
            return
        for block in first.children:
            if block not in self.pairs and (found := waiting.get(key(block))):
                self.pair(block, found.pop())


def _is_bare(block: OutlineBlock) -> bool:
    """Whether a block is a group alone, without a name or a field."""
    return not (block.name or block.fields)


def _unique(blocks: Iterable[OutlineBlock]) -> dict[tuple[str, str], OutlineBlock]:
    """The blocks by tag and name, as far as no other one has both."""
    found: dict[tuple[str, str], list[OutlineBlock]] = defaultdict(list)
    for block in blocks:
        if block.name:
            found[block.tag, block.name].append(block)
    return {key: same[0] for key, same in found.items() if len(same) == 1}


class _Content(NamedTuple):
    """Hashes of a block with everything in it: with its own name, and without it."""

    named: int
    nameless: int


_KEYS = (attrgetter("named"), attrgetter("nameless"))


def _contents(root: OutlineBlock) -> dict[OutlineBlock, _Content]:
    """A hash of each block's content: its tag, its fields, and what is in it, with numbers as numbers."""
    hashes: dict[OutlineBlock, _Content] = {}
    for block in reversed(list(root.walk())):
        fields = sorted((name, value_of(field.text)) for name, field in block.fields.items() if field.text != block.name)
        nameless = hash((block.tag, tuple(fields), tuple(hashes[child].named for child in block.children)))
        hashes[block] = _Content(hash((block.name, nameless)), nameless)
    return hashes


def value_of(text: str) -> str:
    """The value of a field, the same for every spelling of the same numbers."""
    numbers = read_numbers(text)
    return text if numbers is None else " ".join(map(repr, numbers))
