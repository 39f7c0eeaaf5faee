"""XML text, line by line and without a tree, so that depth costs nothing."""

from __future__ import annotations

import re
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING

from hymeko_x.formats.mjcf.tree import COMMENT
from hymeko_x.ir.values import IDENTITY, NO_ROTATION, ZERO, numbers_text
from hymeko_x.xml.text import quoted

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from hymeko_x.formats.mjcf.tree import Element
    from hymeko_x.ir.values import Pose

_DEEPEST = 40
"""Deeper elements are not indented further, so that the text stays linear in their number."""
_INDENTS = tuple("  " * depth for depth in range(_DEEPEST + 1))

_NO_ATTRIBUTES: Mapping[str, str | None] = MappingProxyType({})

Attributes = dict[str, str | None]
"""The attributes of an element in the order of printing; None is not printed."""


def _indent(inside: Sequence[str]) -> str:
    """What stands before an element inside of these."""
    return _INDENTS[min(len(inside), _DEEPEST)]


class Leaf:
    """An element without children whose attributes may still change: what a default class says, it need not."""

    __slots__ = ("about", "attributes", "indent", "tag")

    def __init__(self, tag: str, attributes: dict[str, str], indent: str, about: str) -> None:
        self.tag = tag
        self.attributes = attributes
        self.indent = indent
        self.about = about

    def __str__(self) -> str:
        return f"{self.indent}<{self.tag}{_attributes_text(self.attributes)}/>"


class Text:
    """XML under construction: elements are opened, closed and left in document order; two blanks per level.

    ``inside`` are the tags of the elements around it, where it is a part that another text takes over.
    """

    def __init__(self, *inside: str) -> None:
        self._lines: list[str | Leaf] = []
        self._open = list(inside)
        self._indent = _indent(inside)
        self.leaves: list[Leaf] = []

    def open(self, tag: str, attributes: Mapping[str, str | None]) -> None:
        """Start an element that has children."""
        self._line(f"<{tag}{_attributes_text(attributes)}>")
        self._open.append(tag)
        self._indent = _indent(self._open)

    def close(self) -> None:
        """End the innermost open element."""
        tag = self._open.pop()
        self._indent = _indent(self._open)
        self._line(f"</{tag}>")

    def leaf(self, tag: str, attributes: Mapping[str, str | None]) -> None:
        """Add an element without children."""
        self._line(f"<{tag}{_attributes_text(attributes)}/>")

    def later(self, tag: str, attributes: Attributes, about: str) -> None:
        """Add an element without children that is one of ``leaves`` until the text is done; ``about`` names what it belongs to."""
        said = {name: value for name, value in attributes.items() if value is not None}
        leaf = Leaf(tag, said, self._indent, about)
        self._lines.append(leaf)
        self.leaves.append(leaf)

    def insert(self, place: int, other: Text) -> None:
        """Put the lines of another text before a line of this one."""
        self._lines[place:place] = other._lines

    @property
    def place(self) -> int:
        """How many lines there are."""
        return len(self._lines)

    def section(self, tag: str, attributes: Mapping[str, str | None] = _NO_ATTRIBUTES) -> None:
        """Start a section: an element with an empty line before it."""
        self._lines.append("")
        self.open(tag, attributes)

    def raw(self, line: str) -> None:
        """Add XML that is ready."""
        self._line(line)

    def tree(self, element: Element) -> None:
        """Add an element with everything in it; at top level with an empty line before it."""
        if len(self._open) == 1:
            self._lines.append("")
        stack: list[Element | None] = [element]
        while stack:
            node = stack.pop()
            if node is None:
                self.close()
            elif node.tag == COMMENT:
                self._line(f"<!-- {node.words} -->")
            elif node.children:
                self.open(node.tag, node.attributes)
                stack += [None, *reversed(node.children)]
            else:
                self.leaf(node.tag, node.attributes)

    def bytes(self) -> bytes:
        """The text so far in UTF-8, with a newline at its end."""
        return ("\n".join([line if type(line) is str else str(line) for line in self._lines]) + "\n").encode()

    def _line(self, text: str) -> None:
        self._lines.append(self._indent + text)


_ESCAPES = {"\n": "&#10;", "\r": "&#13;", "\t": "&#9;"}
_PLAIN = re.compile("[ !#-%'-;=?-~]*")
"""Texts that stand in quotes as they are, as nearly all do."""
_IN_TAG = re.compile("[ !-%'-;=?-~]*")
"""The same, and the quotes around them."""
_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def _attributes_text(attributes: Mapping[str, str | None]) -> str:
    said = [f' {name}="{value}"' for name, value in attributes.items() if value is not None]
    text = "".join(said)
    if _IN_TAG.fullmatch(text) and text.count('"') == 2 * len(said):
        return text
    return "".join([f" {name}={_quoted(value)}" for name, value in attributes.items() if value is not None])


def _quoted(value: str) -> str:
    """The value in quotes; a character that XML cannot hold in any spelling becomes ``_``."""
    if _PLAIN.fullmatch(value):
        return f'"{value}"'
    return quoted(_NOT_XML.sub("_", value), _ESCAPES)


@lru_cache(4096)  # about every second one was there before: the same axes, ranges and limbs
def numbers(*values: float) -> str:
    """Numbers separated by blanks, each the shortest that reads back to the same double; no negative zero."""
    return numbers_text(tuple([value + 0.0 for value in values]))


def number(value: float | None, default: float | None = None) -> str | None:
    """One number, or None where it is unspecified or the target's own default."""
    return None if value is None or value == default else numbers(value)


def pose_attributes(pose: Pose) -> Attributes:
    """``pos`` in m and ``quat`` (w, x, y, z), each only where it is not the default."""
    if pose is IDENTITY:
        return {}
    return {
        "pos": None if pose.xyz == ZERO else numbers(*pose.xyz),
        "quat": None if pose.quat == NO_ROTATION else numbers(*pose.quat),
    }
