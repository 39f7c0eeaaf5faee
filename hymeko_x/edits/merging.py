"""The difference between two prints of a robot, carried over to its author's text: a merge of three outlines.

``before`` and ``after`` are prints by the same writer, ``own`` is the author's text of what is printed as ``before``. A field that differs
is replaced where the author has it, number by number; a block that is new is inserted behind the one that precedes it in the print; what
is gone is removed, and what is elsewhere is moved with the author's own text.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.edits.fields import edit_fields
from hymeko_x.edits.matching import NO_NAMES, match
from hymeko_x.edits.splicing import Splices, reindented, unit_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Set

    from hymeko_x.edits.matching import Named, Pairs
    from hymeko_x.outline import Outline, OutlineBlock


def merged(own: Outline, before: Outline, after: Outline, replaced: Set[int] = frozenset(), written: Named = NO_NAMES) -> dict[str, bytes]:
    """The files of ``own`` that change, by the names that the outline has for them.

    ``replaced`` are places in ``after`` of blocks that are put in as they are printed, whatever the author wrote there; ``written`` are
    blocks of ``own`` by their tags and the names that the prints have for them.
    """
    merge = _Merge(own, before, after, replaced, written)
    merge.remove()
    merge.edit()
    merge.write()
    return {name: own.files[name].authored(splices.result()) for name, splices in merge.splices.items() if splices.edits}


class _Merge:
    """What is known of the three outlines, and the edits so far.

    ``since``: the block of ``before`` for one of ``after``; ``mine``: the author's for one of ``before``; ``kept``: the author's for one
    of ``after``, unless that is put in as it is printed; ``texts``: what is put somewhere, as it would stand at the margin.
    """

    def __init__(self, own: Outline, before: Outline, after: Outline, replaced: Set[int], written: Named) -> None:
        self.own, self.before, self.after = own, before, after
        self.splices = {name: Splices(file.data, own.style) for name, file in own.files.items()}
        self.print = Splices(after.files[after.main].data, after.style)
        self.print_unit = unit_of(self.print.data, after.root.walk())
        self.unit = unit_of(own.files[own.main].data, own.root.walk())
        self.since: Pairs = match(after.root, before.root)
        self.mine: Pairs = match(before.root, own.root, written)
        self.replaced = {block for block in after.root.walk() if block.start in replaced or self._is_changed_name(block)}
        self.kept = {
            block: place for block in after.root.walk() if (place := self._place(block)) is not None and block not in self.replaced
        }
        self.moved = {block for block in self.kept if self._is_moved(block)}
        self.texts: dict[OutlineBlock, bytes] = {}

    def _place(self, block: OutlineBlock) -> OutlineBlock | None:
        """The author's block for one of the later print."""
        earlier = self.since.get(block)
        return None if earlier is None else self.mine.get(earlier)

    def _is_changed_name(self, block: OutlineBlock) -> bool:
        """Whether the author has a name alone for a block, and it or a block beside it changed."""
        place = self._place(block)
        if place is None or not place.is_name_alone or block.parent is None:
            return False
        return any(not are_same(other, self.since[other]) for other in block.parent.children if other in self.since)

    def _is_moved(self, block: OutlineBlock) -> bool:
        """Whether a block stands in another one than before."""
        earlier = self.since[block]
        if block.parent is None or earlier.parent is None:
            return False
        return self.since.get(block.parent) is not earlier.parent or self._is_new(block.parent)

    def _is_put(self, block: OutlineBlock) -> bool:
        """Whether a block's text is put somewhere."""
        return block in self.moved or self._is_new(block)

    def _is_new(self, block: OutlineBlock) -> bool:
        """Whether a block is put in as it is printed: it was not there, or not so and the author does not have it."""
        if block in self.kept:
            return False
        earlier = self.since.get(block)
        return block in self.replaced or earlier is None or not are_same(block, earlier)

    # ---- steps -----------------------------------------------------------------------------------------------------------------

    def remove(self) -> None:
        """Take out what the later print does not have, and what is elsewhere there."""
        staying = {self.since[block] for block in (*self.kept, *self.replaced) if block in self.since and block not in self.moved}
        for block in self.before.root.walk():
            place = self.mine.get(block)
            if place is not None and block not in staying:
                self.splices[place.file].remove(place)

    def edit(self) -> None:
        """Carry the fields over that differ in blocks that stay."""
        for block, place in self.kept.items():
            edit_fields(self.splices[place.file], place, self.since[block], block, self.print.data)

    def write(self) -> None:
        """Put in what is new or moved, from the inside out, so that what is inside of it is ready."""
        for block in reversed(list(self.after.root.walk())):
            if block in self.kept:
                self._fill(block, self.kept[block])
            if self._is_put(block):
                self.texts[block] = self._text(block)

    def _text(self, block: OutlineBlock) -> bytes:
        """The text of a new or moved block, as it would stand at the margin."""
        place = self.kept.get(block)
        if place is not None:
            splices = self.splices[place.file]
            return reindented(splices.within(place), splices.indent(place) or b"", self.unit, b"", self.unit, b"\n")
        splices = Splices(self.print.data, self.print.style)
        for inner in self._moved_in(block):
            indent = self.print.indent(inner) or b""
            splices.put(inner.start, inner.end, reindented(self.texts[inner], b"", self.unit, indent, self.print_unit, b"\n"))
        line = block.parent if block.parent is not None and block.tag == self.print.style.head_tag else block
        return reindented(splices.within(block), self.print.indent(line) or b"", self.print_unit, b"", self.unit, b"\n")

    def _moved_in(self, block: OutlineBlock) -> Iterator[OutlineBlock]:
        """The outermost blocks in a new one that the author has already."""
        stack = [*block.children]
        while stack:
            inner = stack.pop()
            if inner in self.moved:
                yield inner
            else:
                stack += inner.children

    # ---- places ------------------------------------------------------------------------------------------------------------------

    def _fill(self, block: OutlineBlock, around: OutlineBlock) -> None:
        """Put the new and the moved blocks of a kept one in: beside their siblings, or at the end of the content."""
        inside: list[bytes] = []
        for child in block.children:
            if child not in self.texts:
                continue
            place = self._place(child) if child in self.replaced else None
            if place is not None:
                splices = self.splices[place.file]
                splices.put(place.start, place.end, self._at(self.texts[child], splices, splices.indent(place) or b""))
                continue
            if child.tag == self.own.style.head_tag and (at := _behind_head(around)) is not None:
                splices = self.splices[around.file]
                splices.put(at, at, b" " + self._at(self.texts[child], splices, splices.indent(around) or b""))
                continue
            anchor = self._anchor(child, around)
            if anchor is None:
                inside.append(self.texts[child])
            else:
                self._insert_beside(self.texts[child], *anchor)
        if inside:
            self._insert_inside(inside, around)

    def _at(self, text: bytes, splices: Splices, indent: bytes) -> bytes:
        return reindented(text, b"", self.unit, indent, self.unit, splices.newline)

    def _anchor(self, block: OutlineBlock, around: OutlineBlock) -> tuple[OutlineBlock, bool] | None:
        """The author's block beside which a new one is put, and whether behind it: if possible one of its kind, that precedes it."""
        assert block.parent is not None
        row = block.parent.children
        number = row.index(block)
        before = [place for other in reversed(row[:number]) if (place := self._beside(other, around)) is not None]
        same = next((place for place in before if place.tag == block.tag), None)
        if before:
            return same or before[0], True
        after = next((place for other in row[number + 1 :] if (place := self._beside(other, around)) is not None), None)
        return None if after is None else (after, False)

    def _beside(self, block: OutlineBlock, around: OutlineBlock) -> OutlineBlock | None:
        """The author's block, if it stands in what its print stands in; none for metadata in the head of that."""
        place = None if block in self.moved or block.tag == self.own.style.head_tag else self.kept.get(block)
        return place if place is not None and place.parent is not None and place.parent.tag == around.tag else None

    def _insert_beside(self, text: bytes, place: OutlineBlock, behind: bool) -> None:
        splices = self.splices[place.file]
        indent, end = splices.indent(place), splices.end_of_line(place.end)
        if indent is None or end is None:
            at = place.end if behind else place.start
            splices.put(at, at, self._at(text, splices, b""))
        elif behind:
            gap = splices.newline if splices.stands_apart(place) else b""
            splices.put(end, end, gap + splices.newline + indent + self._at(text, splices, indent))
        else:
            start = place.start - len(indent)
            splices.put(start, start, indent + self._at(text, splices, indent) + splices.newline)

    def _insert_inside(self, texts: list[bytes], around: OutlineBlock) -> None:
        """Put texts at the end of a block's content, which may have to be opened."""
        splices = self.splices[around.file]
        outer = splices.indent(around) or b""
        indent = outer + self.unit
        lines = b"".join(splices.newline + indent + self._at(text, splices, indent) for text in texts) + splices.newline + outer
        if around.inside is None:
            style = self.own.style
            splices.put(around.head, around.end, style.opening.encode() + lines + style.closing.format(tag=around.tag).encode())
            return
        start, end = around.inside
        at = start + len(splices.data[start:end].rstrip())
        splices.put(at, end, lines)


def _behind_head(block: OutlineBlock) -> int | None:
    """Where the fields in the head of a block end; None where it has none there."""
    return max((field.end for field in block.fields.values() if field.end <= block.head), default=None)


def are_same(block: OutlineBlock, other: OutlineBlock) -> bool:
    """Whether two blocks of prints have the same text, but for its place."""
    stack = [(block, other)]
    while stack:
        a, b = stack.pop()
        if a.tag != b.tag or len(a.children) != len(b.children) or a.fields.keys() != b.fields.keys():
            return False
        if any(value.text != b.fields[name].text for name, value in a.fields.items()):
            return False
        stack += zip(a.children, b.children, strict=True)
    return True
