"""MJCF under construction: elements are opened, closed and added in document order."""

from __future__ import annotations

from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING

from hymeko_x.formats.mjcf.tree import COMMENT
from hymeko_x.ir.values import IDENTITY, NO_ROTATION, ZERO, numbers_text
from hymeko_x.xml.printing import Tag, render

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.formats.mjcf.tree import Element
    from hymeko_x.ir.values import Pose

_NO_ATTRIBUTES: Mapping[str, str | None] = MappingProxyType({})

Attributes = dict[str, str | None]
"""The attributes of an element in the order of printing; None is not printed."""


class Leaf(Tag):
    """An element without children whose attributes may still change: those of its default class are left out.

    ``about`` is the name of what it belongs to.
    """

    __slots__ = ("about",)

    def __init__(self, name: str, attributes: dict[str, str], about: str) -> None:
        super().__init__(name, attributes)
        self.about = about


class Text:
    """XML under construction. ``leaves`` are the elements that were added by :meth:`later`."""

    def __init__(self) -> None:
        self._root = Tag("", {})
        self._open = [self._root]
        self.leaves: list[Leaf] = []

    def open(self, tag: str, attributes: Mapping[str, str | None]) -> None:
        """Start an element that has children."""
        element = self._add(Tag(tag, _written(attributes)))
        element.has_end = True
        self._open.append(element)

    def close(self) -> None:
        """End the innermost open element."""
        self._open.pop()

    def leaf(self, tag: str, attributes: Mapping[str, str | None]) -> None:
        """Add an element without children."""
        self._add(Tag(tag, _written(attributes)))

    def later(self, tag: str, attributes: Attributes, about: str) -> None:
        """Add an element without children that is one of ``leaves`` until the text is done; ``about`` names what it belongs to."""
        leaf = Leaf(tag, _written(attributes), about)
        self._add(leaf)
        self.leaves.append(leaf)

    def insert(self, place: int, other: Text) -> None:
        """Put the elements of another text before a child of the element that is open."""
        self._open[-1].children[place:place] = other._root.children

    @property
    def place(self) -> int:
        """How many children the open element has."""
        return len(self._open[-1].children)

    def section(self, tag: str, attributes: Mapping[str, str | None] = _NO_ATTRIBUTES) -> None:
        """Start a section: an element with an empty line before it."""
        self.raw("")
        self.open(tag, attributes)

    def raw(self, line: str) -> None:
        """Add XML that is ready."""
        self._open[-1].children.append(line)

    def tree(self, element: Element) -> None:
        """Add an element with everything in it; at top level with an empty line before it."""
        if len(self._open) == 2:
            self.raw("")
        stack: list[tuple[Element, list[Tag | str]]] = [(element, self._open[-1].children)]
        while stack:
            node, row = stack.pop()
            if node.tag == COMMENT:
                row.append(f"<!-- {node.text} -->")
            else:
                tag = Tag(node.tag, node.attributes)
                row.append(tag)
                stack += [(child, tag.children) for child in reversed(node.children)]

    def bytes(self) -> bytes:
        """The text so far in UTF-8, with a newline at its end."""
        return "\n".join([line for child in self._root.children if isinstance(child, Tag) for line in [*render(child), ""]]).encode()

    def _add(self, tag: Tag) -> Tag:
        self._open[-1].children.append(tag)
        return tag


def _written(attributes: Mapping[str, str | None]) -> dict[str, str]:
    return {name: value for name, value in attributes.items() if value is not None}


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
