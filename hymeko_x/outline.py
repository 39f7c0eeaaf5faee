"""The outline of a text: where its elements and their values stand in the bytes, so that one value can be changed and nothing else.

Every format that is text has a function ``outline(source, report) -> Outline`` in its frontend's room; the rest of the program knows
blocks and fields only.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct, field

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping


class OutlineField(Struct, frozen=True):
    """A named value of a block: its text as it stands, between ``value_start`` and ``value_end``.

    ``start`` and ``end`` are the whole of it, with the white space before it and its name: what goes when it is removed.
    """

    text: str
    start: int
    end: int
    value_start: int
    value_end: int


class OutlineBlock(Struct, eq=False):
    """An element of a text with its own fields and the blocks in it.

    ``file`` is the name of the file that it stands in, ``start`` and ``end`` its bytes there, ``inside`` where the blocks in it begin and
    end; None for a block that is written without a content, whose head ends at ``head``. Its fields begin at ``first``.
    """

    tag: str
    name: str
    file: str
    start: int
    end: int
    first: int
    head: int
    inside: tuple[int, int] | None
    fields: dict[str, OutlineField] = field(default_factory=dict)
    children: list[OutlineBlock] = field(default_factory=list)
    parent: OutlineBlock | None = None

    @property
    def is_name_alone(self) -> bool:
        """Whether the block is a name that stands for all of it."""
        return self.inside == (self.end, self.end)

    def add(self, child: OutlineBlock) -> None:
        """Put a block into this one."""
        child.parent = self
        self.children.append(child)

    def walk(self) -> Iterator[OutlineBlock]:
        """The block and every block in it, in the order of the text."""
        stack = [self]
        while stack:
            block = stack.pop()
            yield block
            stack.extend(reversed(block.children))


class TextFile(Struct, frozen=True):
    """A file of an outline: the path that its ``Files`` found, and its bytes as the offsets count them.

    ``opening`` is what the author has in the place of the first ``read`` bytes, which a reader repaired.
    """

    path: str
    data: bytes
    opening: bytes = b""
    read: int = 0

    def authored(self, edited: bytes) -> bytes:
        """The edited bytes with the author's own ones at their beginning, where no edit is."""
        return self.opening + edited[self.read :]


class BlockStyle(Struct, frozen=True):
    """How a format writes around its blocks.

    ``opening`` and ``closing`` (with ``{tag}``) go around the content of a block that had none; ``trailing`` is the pattern of what may
    follow a block on its line and belongs to it: blanks and a comment. ``escapes``: how a quotation mark is written between two of them.
    ``has_lines``: each field has a line of its own. ``derived`` are fields that follow from others, and are written only where the author
    has them. ``head_tag`` is the tag of a block that stands in the head of the one around it, behind the fields there.
    """

    opening: str
    closing: str
    trailing: bytes
    escapes: Mapping[bytes, bytes] = field(default_factory=dict)
    has_lines: bool = False
    derived: frozenset[str] = frozenset()
    head_tag: str | None = None


class Outline(Struct, frozen=True):
    """The blocks of a text with the files that it includes, by the names that the blocks have for them; ``main`` names the first one."""

    root: OutlineBlock
    files: Mapping[str, TextFile]
    main: str
    style: BlockStyle
