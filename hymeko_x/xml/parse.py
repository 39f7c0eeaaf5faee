"""From bytes to a tree of nodes, leniently: what other readers of real robot files overlook is repaired and reported.

Strict first, with expat. Then known mistakes are repaired in the text (line numbers stay as they are) and the result is
read strictly again. Only then libxml2's recovery has a try, which may leave things out. Entities are never expanded,
nothing recurses, and nothing is ever fetched.
"""

from __future__ import annotations

import codecs
import re
from typing import TYPE_CHECKING
from xml.parsers import expat

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, Report, refuse
from hymeko_x.frozen import frozen
from hymeko_x.xml.tree import COMMENT_NODE, INSTRUCTION_NODE, Node

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.source import Source

MAX_BYTES = 256 * 1024 * 1024
MAX_DEPTH = 2048


@frozen
class Document:
    """A read file: its root, the comments and processing instructions around it, and the text that was read, in UTF-8."""

    root: Node
    preceding: tuple[Node, ...]
    following: tuple[Node, ...]
    data: bytes


def parse(source: Source, report: Report) -> Document:
    """The XML of a source.

    Raises: Refusal with HX004 (not XML), HX007 (too large or too deep), HX008 (it defines entities).
    """
    if len(source.data) > MAX_BYTES:
        raise refuse(codes.TOO_LARGE, f"the file has {len(source.data)} bytes, at most {MAX_BYTES} are read", Origin(source.name))
    said = Report()
    try:
        document = Builder(source.name, _utf8(source, said), said).document()
    except expat.ExpatError as error:
        from hymeko_x.xml.repair import read_again  # with lxml, which well-formed files do not need

        said = Report()
        document = read_again(source, said, error)
    report.extend(said)
    return document


def _utf8(source: Source, report: Report) -> bytes:
    """The same text in UTF-8 where it is in the other encoding that its mark or its declaration names."""
    declared = _ENCODING.match(source.data[:200])
    marked = source.data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    if not marked and (declared is None or declared[1].lower() in (b"utf-8", b"utf8", b"us-ascii", b"ascii")):
        return source.data.removeprefix(codecs.BOM_UTF8)
    from hymeko_x.xml.repair import decoded, without_declaration

    text, wrong = decoded(source.data)
    text, said = without_declaration(text)
    for repaired in filter(None, (wrong, said)):
        report.warn(codes.REPAIRED_XML, repaired, Origin(source.name, 1))
    return text.encode()


# ---- building ----------------------------------------------------------------------------------------------------------------


_WORDS = re.compile(rb">\s*+[^<]")
"""What follows a tag, or a sign in an attribute, and is no tag; blanks are given back to nobody, so that it is found in one go."""


def has_words(data: bytes) -> bool:
    """Whether there is anything but blanks between elements; in doubt, as in UTF-16, there is."""
    return b"<![CDATA[" in data or _WORDS.search(data) is not None


_ENCODING = re.compile(rb"""\s*<\?xml[^?>]*encoding\s*=\s*["']([\w.-]+)""")


class Builder:
    """Makes nodes of what expat finds."""

    def __init__(self, file: str, data: bytes, report: Report, lines: Iterator[int] | None = None) -> None:
        self._file = file
        self._data = data
        self._report = report
        self._lines = lines
        self._outside = Node("#outside", {}, None, file, 1, 0)
        parser = expat.ParserCreate()
        parser.buffer_text = True
        parser.XmlDeclHandler = self._declaration
        parser.StartDoctypeDeclHandler = self._doctype
        parser.EntityDeclHandler = self._entity
        self._parser = parser

    def document(self) -> Document:
        """The finished document. Raises: ExpatError where the text is not well-formed."""
        self._set_handlers()
        self._parser.Parse(self._data, True)
        around = self._outside.kids
        place = next(place for place, node in enumerate(around) if node.is_element)
        root = around[place]
        root.parent = None
        return Document(root, tuple(around[:place]), tuple(around[place + 1 :]), self._data)

    def _set_handlers(self) -> None:
        """The handlers of elements and text, which share what stands open; called for every element, so they are closures."""
        parser, file, lines, make = self._parser, self._file, self._lines, Node
        current = self._outside
        depth = 0

        def start(tag: str, attributes: dict[str, str]) -> None:
            nonlocal current, depth
            line = parser.CurrentLineNumber if lines is None else next(lines)
            node = make(tag, attributes, current, file, line, parser.CurrentByteIndex)
            current.adopt(node)
            current = node
            depth += 1
            if depth > MAX_DEPTH:
                raise refuse(codes.TOO_LARGE, f"the elements are nested more than {MAX_DEPTH} deep", Origin(file, line))

        def end(tag: str) -> None:
            nonlocal current, depth
            current.end = parser.CurrentByteIndex
            depth -= 1
            current = current.parent  # type: ignore[assignment]

        def characters(text: str) -> None:
            if current.text is not None:
                current.text += text
            elif not text.isspace():
                current.text = text
                current.text_index = len(current.kids)

        def aside(tag: str, text: str) -> None:
            if depth > 1:  # inside of the root's children nobody keeps it
                return
            node = make(tag, {}, current, file, parser.CurrentLineNumber, parser.CurrentByteIndex)
            node.text = text
            current.adopt(node)

        parser.StartElementHandler = start
        parser.EndElementHandler = end
        if has_words(self._data):  # else there is nothing but blanks, of which a file has thousands
            parser.CharacterDataHandler = characters
        parser.CommentHandler = lambda text: aside(COMMENT_NODE, text)
        parser.ProcessingInstructionHandler = lambda target, text: aside(INSTRUCTION_NODE, f"{target} {text}".strip())

    def _declaration(self, version: str, encoding: str | None, standalone: int) -> None:
        del encoding, standalone
        if version not in ("1.0", "1.1"):
            said = f"the XML declaration says version '{version}'; read as 1.0"
            self._report.warn(codes.REPAIRED_XML, said, Origin(self._file, self._parser.CurrentLineNumber))

    def _doctype(self, name: str, *_: object) -> None:
        said = f"'<!DOCTYPE {name}>' is left out: robot files have no document type"
        self._report.warn(codes.REPAIRED_XML, said, Origin(self._file, self._parser.CurrentLineNumber))

    def _entity(self, *_: object) -> None:
        place = Origin(self._file, self._parser.CurrentLineNumber)
        raise refuse(codes.ENTITIES, "the file defines XML entities, which are never expanded", place)
