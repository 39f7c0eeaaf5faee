"""The one tree of XML: nodes with their positions, from which a reader takes what it understands; what stays is unread.

Nothing recurses, so that depth costs nothing.
"""

from __future__ import annotations

import math
import re
import sys
from functools import lru_cache
from typing import TYPE_CHECKING
from xml.parsers import expat

from msgspec import Struct

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse

if TYPE_CHECKING:
    from collections.abc import Container, Iterator

    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Id

COMMENT_NODE = "#comment"
INSTRUCTION_NODE = "#instruction"
"""The tags of comments and processing instructions, which no element can have; their content is ``text``."""
MAX_DEPTH = 2048


class XmlNode(Struct, eq=False):
    """An XML element whose attributes, children and text are taken out one by one.

    ``owner`` is the element of the mechanism that the node became; a node without one belongs to its parent's.
    ``start`` and ``end`` are where the element starts, and where its end tag does, in the bytes of the file. ``text_index`` is the number
    of children before its text.
    """

    tag: str
    attributes: dict[str, str]
    parent: XmlNode | None = None
    file: str = ""
    line: int | None = None
    start: int = 0
    end: int = 0
    children: list[XmlNode] = []
    taken: bool = False
    owner: Id | None = None
    text: str | None = None
    text_index: int = 0

    @property
    def origin(self) -> Origin:
        """Where the element starts."""
        return Origin(self.file, self.line)

    @property
    def subject(self) -> str:
        """The element that the node belongs to, in the words of its file: ``joint 'elbow'``; the root element if there is none."""
        node = self._owning()
        return f"<{node.tag}>" if node.owner is None else f"{node.tag} '{node.owner.name}'"

    @property
    def element(self) -> str:
        """The element of the mechanism that the node belongs to, for a diagnostic; empty for the mechanism itself."""
        owner = self._owning().owner
        return "" if owner is None else str(owner)

    @property
    def is_element(self) -> bool:
        """False for a comment or a processing instruction."""
        return self.tag[0] != "#"

    def _owning(self) -> XmlNode:
        node = self
        while node.owner is None and node.parent is not None:
            node = node.parent
        return node

    def walk(self) -> Iterator[XmlNode]:
        """The node and everything in it, in document order."""
        stack = [self]
        while stack:
            node = stack.pop()
            yield node
            stack.extend(reversed(node.children))

    # ---- taking ----------------------------------------------------------------------------------------------------------

    def take(self, attribute: str) -> str | None:
        """The value of an attribute, or None when there is none."""
        return self.attributes.pop(attribute, None)

    def take_child(self, tag: str) -> XmlNode | None:
        """The first unread child of this name, or None."""
        for child in self.children:
            if child.tag == tag and not child.taken:
                child.taken = True
                return child
        return None

    def take_child_of(self, tags: Container[str]) -> XmlNode | None:
        """The first unread child with one of these names, or None."""
        for child in self.children:
            if child.tag in tags and not child.taken:
                child.taken = True
                return child
        return None

    def take_children(self, tag: str) -> Iterator[XmlNode]:
        """All unread children of this name, one after the other."""
        for child in self.children:
            if child.tag == tag and not child.taken:
                child.taken = True
                yield child

    def take_text(self) -> str:
        """The text of the element, stripped; none, and nothing taken, where there are elements between the words."""
        if self.children:
            return ""
        text = (self.text or "").strip()
        self.text = None
        return text

    def take_whole_text(self) -> str:
        """The text of the element, which then has no attribute left either."""
        self.attributes.clear()
        return self.take_text()

    def leave(self, child: XmlNode) -> None:
        """Undo the taking of a child: it becomes an extra as a whole, as written."""
        child.taken = False

    def detach(self, *tags: str) -> list[XmlNode]:
        """Remove the children with one of these names from the tree, in order: for readers that keep what the tree still contains."""
        found = [child for child in self.children if child.tag in tags]
        if found:
            self.children = [child for child in self.children if child.tag not in tags]
        return found

    def release(self) -> None:
        """Break the tree up: nodes that refer to each other would wait for the collector of cycles, and a large robot has millions."""
        stack = [self]
        while stack:
            node = stack.pop()
            stack.extend([child for child in node.children if child.children])
            node.children = []

    # ---- looking without taking ------------------------------------------------------------------------------------------

    def child(self, tag: str) -> XmlNode | None:
        """The first child of this name, unread or not, or None."""
        for child in self.children:
            if child.tag == tag:
                return child
        return None

    def has(self, *tags: str) -> bool:
        """Whether a child with one of these names is unread."""
        return any(child.tag in tags and not child.taken for child in self.children)

    def has_taken(self, tag: str) -> bool:
        """Whether a child of this name was taken."""
        return any(child.tag == tag and child.taken for child in self.children)

    def unread_children(self) -> list[XmlNode]:
        """The child elements that are unread."""
        return [child for child in self.children if not child.taken and child.is_element]


# ---- building ----------------------------------------------------------------------------------------------------------------


class XmlDocument(Struct, frozen=True):
    """A read file: its root, the comments and processing instructions around it, and the text that was read, in UTF-8."""

    root: XmlNode
    preceding: tuple[XmlNode, ...]
    following: tuple[XmlNode, ...]
    data: bytes


_WORDS = re.compile(rb">\s*+[^<]")
"""What follows a tag, or a sign in an attribute, and is no tag; possessive, so that one pass finds it."""


def _has_text(data: bytes) -> bool:
    """Whether there is anything but blanks between elements; in doubt, as in UTF-16, there is."""
    return b"<![CDATA[" in data or _WORDS.search(data) is not None


class TreeBuilder:
    """Makes a tree of what expat finds.

    ``comments`` keeps comments and instructions at every depth, not only around the root and in it. ``deepest`` bounds the nesting.
    ``lines`` are the line numbers of the elements where those of the text are others.
    """

    def __init__(
        self,
        file: str,
        data: bytes,
        report: Report,
        lines: Iterator[int] | None = None,
        *,
        comments: bool = False,
        deepest: int | None = MAX_DEPTH,
    ) -> None:
        self._file = file
        self._data = data
        self._report = report
        self._lines = lines
        self._comments = comments
        self._deepest = deepest
        self._open = [XmlNode("#outside", {}, None, file, 1)]
        parser = expat.ParserCreate()
        parser.buffer_text = True
        parser.XmlDeclHandler = self._declaration
        parser.StartDoctypeDeclHandler = self._doctype
        parser.EntityDeclHandler = self._entity
        parser.CommentHandler = lambda text: self._aside(COMMENT_NODE, text.strip())
        parser.ProcessingInstructionHandler = lambda target, text: self._aside(INSTRUCTION_NODE, f"{target} {text}".strip())
        self._parser = parser

    def document(self) -> XmlDocument:
        """The finished document. Raises: ExpatError where the text is not well-formed."""
        self._handle_elements()
        try:
            self._parser.Parse(self._data, True)
        finally:
            self._release_parser()
        around, self._open[0].children = self._open[0].children, []
        place = next(place for place, node in enumerate(around) if node.is_element)
        root = around[place]
        root.parent = None
        return XmlDocument(root, tuple(around[:place]), tuple(around[place + 1 :]), self._data)

    def _handle_elements(self) -> None:
        """The handlers of elements and text, which are called for every element: closures are quicker than methods."""
        parser, file, lines, stack, make = self._parser, self._file, self._lines, self._open, XmlNode
        most = (self._deepest or sys.maxsize - 1) + 1

        def start(tag: str, attributes: dict[str, str]) -> None:
            around, line = stack[-1], parser.CurrentLineNumber if lines is None else next(lines)
            node = make(tag, attributes, around, file, line, parser.CurrentByteIndex)
            around.children.append(node)
            stack.append(node)
            if len(stack) > most:
                raise refuse(codes.TOO_LARGE, f"the elements are nested more than {most - 1} deep", Origin(file, line))

        def end(tag: str) -> None:
            stack.pop().end = parser.CurrentByteIndex

        def characters(text: str) -> None:
            node = stack[-1]
            if node.text is not None:
                node.text += text
            elif not text.isspace():
                node.text = text
                node.text_index = len(node.children)

        parser.StartElementHandler = start
        parser.EndElementHandler = end
        if _has_text(self._data):  # else there is nothing but blanks, of which a file has thousands
            parser.CharacterDataHandler = characters

    def _release_parser(self) -> None:
        """Part the parser and its handlers: they refer to each other, and would wait for the collector of cycles with the whole text."""
        self._parser.StartElementHandler = self._parser.EndElementHandler = None
        del self._parser

    def _aside(self, tag: str, text: str) -> None:
        if self._comments or len(self._open) < 3:
            around = self._open[-1]
            node = XmlNode(tag, {}, around, self._file, self._parser.CurrentLineNumber, self._parser.CurrentByteIndex)
            node.text = text
            around.children.append(node)

    def _declaration(self, version: str, encoding: str | None, standalone: int) -> None:
        del encoding, standalone
        if version not in ("1.0", "1.1"):
            self._report.warn(codes.REPAIRED_XML, f"the version in the XML declaration is '{version}'; read as 1.0", self._here())

    def _doctype(self, name: str, *_: object) -> None:
        self._report.warn(codes.REPAIRED_XML, f"'<!DOCTYPE {name}>' is left out: robot files have no document type", self._here())

    def _entity(self, *_: object) -> None:
        raise refuse(codes.ENTITIES, "the file defines XML entities, which are never expanded", self._here())

    def _here(self) -> Origin:
        return Origin(self._file, self._parser.CurrentLineNumber)


# ---- numbers ---------------------------------------------------------------------------------------------------------------


@lru_cache(4096)
def read_numbers(text: str) -> tuple[float, ...] | None:
    """The decimal numbers of a text, separated by blanks, or None if one of them is not a finite decimal number.

    Digits of other scripts, blanks that are no ASCII and underscores mean something to Python, and nothing to any format.
    """
    try:
        numbers = tuple(map(float, text.split()))
    except ValueError:
        return None
    if "_" in text or not text.isascii():
        return None
    return numbers if math.isfinite(sum(numbers)) or all(map(math.isfinite, numbers)) else None
