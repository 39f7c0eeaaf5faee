"""MJCF as a tree of elements that know their place, read without recursion: depth costs nothing.

Attributes and children are taken out by the readers; what is left of an element goes along verbatim.
"""

from __future__ import annotations

from typing import TYPE_CHECKING
from xml.parsers import expat

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.xml.parse import MAX_BYTES, has_words
from hymeko_x.xml.parse import parse as parse_leniently
from hymeko_x.xml.text import attributes_text, escaped

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.diagnostics import Report
    from hymeko_x.source import Source

COMMENT = "#comment"
"""The tag of a comment, whose text is in ``words``."""


class Element:
    """One XML element: its tag, attributes, children and text, with the file and line where it starts."""

    __slots__ = ("attributes", "children", "file", "line", "tag", "words")

    def __init__(self, tag: str, attributes: dict[str, str], file: str = "", line: int | None = None) -> None:
        self.tag = tag
        self.attributes = attributes
        self.children: list[Element] = []
        self.words = ""
        self.file = file
        self.line = line

    @property
    def origin(self) -> Origin:
        """Where it starts."""
        return Origin(self.file, self.line)

    def take(self, attribute: str) -> str | None:
        """The value of an attribute, or None when there is none; it counts as read."""
        return self.attributes.pop(attribute, None)

    def take_children(self, *tags: str) -> list[Element]:
        """The children with one of these tags, in order; they count as read."""
        found = [child for child in self.children if child.tag in tags]
        if found:
            self.children = [child for child in self.children if child.tag not in tags]
        return found

    def walk(self) -> Iterator[Element]:
        """The element and everything in it, in document order."""
        stack = [self]
        while stack:
            element = stack.pop()
            yield element
            stack.extend(reversed(element.children))


def parse(source: Source, report: Report) -> Element:
    """The root of an XML file; comments before it are the first children.

    Raises: Refusal with HX004 (not XML), HX007 (too large), HX008 (it defines entities).
    """
    if len(source.data) > MAX_BYTES:
        raise refuse(codes.TOO_LARGE, f"the file has {len(source.data)} bytes, at most {MAX_BYTES} are read", Origin(source.name))
    builder = _Builder(source.name)
    try:
        return builder.read(source.data)
    except expat.ExpatError:
        return _Builder(source.name).read(parse_leniently(source, report).data)


def parse_text(text: str) -> Element:
    """The element that a piece of text is. Raises: ExpatError when it is none."""
    return _Builder("").read(text.encode())


class _Builder:
    def __init__(self, file: str) -> None:
        self._file = file
        self._stack: list[Element] = [Element("", {})]
        parser = expat.ParserCreate()
        parser.buffer_text = True
        parser.CommentHandler = self._comment
        parser.EntityDeclHandler = self._entity
        parser.ProcessingInstructionHandler = self._instruction
        self._parser = parser

    def read(self, data: bytes) -> Element:
        self._set_handlers(data)
        self._parser.Parse(data, True)
        around = self._stack[0].children
        root = next(child for child in around if child.tag != COMMENT)
        root.children[:0] = [child for child in around if child.tag == COMMENT]
        return root

    def _set_handlers(self, data: bytes) -> None:
        """The handlers of elements and text; called for every element, so they are closures."""
        parser, file, stack, make = self._parser, self._file, self._stack, Element

        def start(tag: str, attributes: dict[str, str]) -> None:
            element = make(tag, attributes, file, parser.CurrentLineNumber)
            stack[-1].children.append(element)
            stack.append(element)

        def end(tag: str) -> None:
            stack.pop()

        def characters(text: str) -> None:
            if not text.isspace():
                stack[-1].words += text

        parser.StartElementHandler = start
        parser.EndElementHandler = end
        if has_words(data):  # else there is nothing but blanks, of which a file has thousands
            parser.CharacterDataHandler = characters

    def _comment(self, text: str) -> None:
        element = Element(COMMENT, {}, self._file, self._parser.CurrentLineNumber)
        element.words = text.strip()
        self._stack[-1].children.append(element)

    def _instruction(self, target: str, data: str) -> None:
        """Before the root they are read over; inside of it MuJoCo stops reading."""
        if len(self._stack) > 1:
            place = Origin(self._file, self._parser.CurrentLineNumber)
            raise refuse(codes.NOT_XML, f"a processing instruction (<?{target} ...?>) cannot stand inside of an element", place)

    def _entity(self, *_: object) -> None:
        raise refuse(codes.ENTITIES, "the file defines XML entities, which are never expanded", Origin(self._file))


def verbatim(element: Element) -> str:
    """The element with everything in it as one line of XML; of a comment its text in comment signs."""
    pieces: list[str] = []
    stack: list[Element | str] = [element]
    while stack:
        item = stack.pop()
        if isinstance(item, str):
            pieces.append(item)
        elif item.tag == COMMENT:
            pieces.append(f"<!--{item.words}-->")
        else:
            start = item.tag + attributes_text(item.attributes)
            if item.children or item.words:
                pieces.append(f"<{start}>{escaped(item.words.strip())}")
                stack.append(f"</{item.tag}>")
                stack.extend(reversed(item.children))
            else:
                pieces.append(f"<{start}/>")
    return "".join(pieces)
