"""The DOM of minidom, which xacro works on: the origins of its elements through parsing, cloning and printing; and its speed."""

from __future__ import annotations

import sys
import xml.dom.minidom
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn
from xml.dom import expatbuilder
from xml.dom.minicompat import NodeList

from hymeko_x.frontends.xacro.child.channel import Trouble

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import FrameType


class SourcePlace(NamedTuple):
    """Where an element was written: file, line, and the macro around it (None at top level)."""

    file: str
    line: int
    macro: str | None = None


class KeepPlace:
    """Clones of an element come from the place of the element; a DOM UserDataHandler."""

    def handle(self, operation: int, key: str, data: object, source: object, target: Any) -> None:
        """Called by minidom with the clone as ``target``."""
        if target is not None:
            target.setUserData(key, data, self)


EXPRESSION = "<expression>"
"""The file name of the code of expressions."""
PLACE = "place"
KEEP_PLACE = KeepPlace()


class PlacingBuilder(expatbuilder.ExpatBuilderNS):
    """Builds the DOM as xacro's own parser does, with the place of every element beside it. Entities are refused."""

    def __init__(self, file: str) -> None:
        super().__init__()
        self._file = file

    def install(self, parser: Any) -> None:
        """Attach the handlers to a parser of expat."""
        super().install(parser)
        parser.EntityDeclHandler = self._refuse_entity

    def start_element_handler(self, name: str, attributes: list[str]) -> None:
        """Begin an element, and note its file and line."""
        around = self.curNode
        super().start_element_handler(name, attributes)
        self.curNode.setUserData(PLACE, SourcePlace(self._file, self.getParser().CurrentLineNumber, _macro_around(around)), KEEP_PLACE)

    def _refuse_entity(self, *declaration: object) -> NoReturn:
        raise Trouble("entities", file=self._file, line=self.getParser().CurrentLineNumber)


def _macro_around(node: Any) -> str | None:
    place = place_of(node)
    if place is None or node.tagName != "xacro:macro":
        return place.macro if place else None
    return str(node.getAttribute("name")).removeprefix("xacro:")


def place_of(node: Any) -> SourcePlace | None:
    """Where a node was written; for text and comments, where the element around it was."""
    while node is not None:
        found: SourcePlace | None = node.getUserData(PLACE)
        if found is not None:
            return found
        node = node.parentNode
    return None


def place_in(frame: FrameType) -> SourcePlace | None:
    """The place of the element that a function of xacro is working on; None for the frames of expressions."""
    if frame.f_code.co_filename == EXPRESSION:
        return None
    values = (frame.f_locals.get(name) for name in ("elt", "node", "tag"))
    return next((place for value in values if isinstance(value, xml.dom.minidom.Node) and (place := place_of(value))), None)


def current_place() -> SourcePlace | None:
    """The element that xacro is working on now."""
    return next((place for frame in _frames(sys._getframe(1)) if (place := place_in(frame))), None)


def _frames(frame: FrameType | None) -> Iterator[FrameType]:
    while frame is not None:
        yield frame
        frame = frame.f_back


class LineNotes:
    """Collects text that minidom writes and notes on which line each element starts."""

    def __init__(self) -> None:
        self.pieces: list[str] = []
        self.line = 1
        self.starts: list[tuple[int, SourcePlace]] = []

    def write(self, text: str) -> None:
        """Append a piece of text."""
        self.pieces.append(text)
        self.line += text.count("\n")

    def mark(self, element: Any) -> None:
        """Note that the element is about to be written."""
        place = element.getUserData(PLACE)
        if place is not None:
            self.starts.append((self.line, place))


def written(document: Any) -> LineNotes:
    """The text of a document as minidom prints it, two blanks per level."""
    lines = LineNotes()
    write_element = xml.dom.minidom.Element.writexml

    def write_marked(element: Any, *how: Any) -> None:
        lines.mark(element)
        write_element(element, *how)

    xml.dom.minidom.Element.writexml = write_marked  # type: ignore[method-assign, assignment]
    document.writexml(lines, "", "  ", "\n")
    return lines


# ---- speed --------------------------------------------------------------------------------------------------------------------

MANY = 200
BEHIND = 16
AHEAD = 64


def make_quick() -> None:
    """Make minidom's lists of nodes look near the last find first; the result is the same.

    minidom looks for a node among its siblings from the first one on, several times for each macro call, so that a robot
    with thousands of links would take a time that grows with their square. xacro goes through the siblings in order: the
    next node is beside the one before.
    """
    last: dict[int, int] = {}

    def index(nodes: list[Any], node: Any, *bounds: int) -> int:
        if bounds or len(nodes) < MANY:
            return list.index(nodes, node, *bounds)
        hint = last.get(id(nodes), 0)
        near = range(max(0, hint - BEHIND), min(len(nodes), hint + AHEAD))
        found = next((place for place in near if nodes[place] is node), None)
        last[id(nodes)] = list.index(nodes, node) if found is None else found
        return last[id(nodes)]

    def remove(nodes: list[Any], node: Any) -> None:
        del nodes[index(nodes, node)]

    NodeList.index = index  # type: ignore[method-assign, assignment]
    NodeList.remove = remove  # type: ignore[method-assign]
