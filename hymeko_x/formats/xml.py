"""Reading XML so that nothing gets lost: nodes that remember what was asked for, and what is left over at the end.

Shared by the frontends of all XML formats. A frontend takes attributes, children and text out of a :class:`Node`; what
it never took becomes an :class:`Extra` by :func:`leftovers`, so that no list of known tags decides what survives.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from lxml import etree

from hymeko_x import codes
from hymeko_x.diagnostics import Origin
from hymeko_x.ir.mechanism import ROOT, Extra, Id

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Iterator

    from hymeko_x.diagnostics import Report

PRECEDING = "preceding"
FOLLOWING = "following"
"""The paths of what stands before and after the root element."""

_XML_NAMESPACE = "http://www.w3.org/XML/1998/namespace"
_words_in = etree.XPath("//text()[normalize-space()]")


class Node:
    """An XML element whose attributes, children and text are taken out one by one.

    ``owner`` is the element of the mechanism that the node became; a node without one belongs to its parent's.
    """

    __slots__ = ("_entered", "_place", "_rest", "_within", "_words_taken", "attributes", "element", "file", "owner", "tag")

    def __init__(self, element: Any, file: str, place: int = 0, within: Id | None = None) -> None:
        self.element = element
        self.file = file
        self.tag: str = element.tag
        self.attributes: dict[str, str] = dict(element.attrib)
        self.owner: Id | None = None
        self._place = place
        self._within = within
        self._rest: list[Any] = list(element)
        self._entered: dict[int, Node] = {}
        self._words_taken = False

    @property
    def origin(self) -> Origin:
        """Where the element starts."""
        return Origin(self.file, self.element.sourceline)

    @property
    def subject(self) -> str:
        """The element of the mechanism that the node belongs to, in words: ``joint 'elbow'``; empty for the root's own."""
        subject = self.owner or self._within
        return "" if subject is None else str(subject)

    # ---- taking ----------------------------------------------------------------------------------------------------------

    def take(self, attribute: str) -> str | None:
        """The value of an attribute, or None when there is none."""
        return self.attributes.pop(attribute, None)

    def child(self, tag: str) -> Node | None:
        """The first child of this name that was not taken yet, or None."""
        for place, element in enumerate(self._rest):
            if element is not None and element.tag == tag:
                return self._enter(place, element)
        return None

    def child_among(self, tags: Container[str]) -> Node | None:
        """The first child that was not taken yet and has one of these names, or None."""
        for place, element in enumerate(self._rest):
            if element is not None and element.tag in tags:
                return self._enter(place, element)
        return None

    def children(self, tag: str) -> list[Node]:
        """All children of this name that were not taken yet."""
        found = [(place, element) for place, element in enumerate(self._rest) if element is not None and element.tag == tag]
        return [self._enter(place, element) for place, element in found]

    def has(self, tag: str) -> bool:
        """Whether a child of this name is left; takes nothing."""
        return any(element is not None and element.tag == tag for element in self._rest)

    def look(self, tag: str) -> str | None:
        """The first child of this name that is left, verbatim; takes nothing."""
        return next((verbatim(element) for element in self._rest if element is not None and element.tag == tag), None)

    def take_whole(self, tag: str) -> None:
        """Take the first child of this name with all that is in it, without reading it."""
        for place, element in enumerate(self._rest):
            if element is not None and element.tag == tag:
                self._rest[place] = None
                return

    def elements(self) -> Iterator[Any]:
        """The child elements that are left, to look at; takes nothing."""
        return (element for element in self._rest if element is not None and isinstance(element.tag, str))

    def entered(self) -> list[Node]:
        """The children that were taken, in the order of the file."""
        return [self._entered[place] for place in sorted(self._entered)]

    def words(self) -> str:
        """The text of an element without children, stripped."""
        self._words_taken = True
        return (self.element.text or "").strip()

    def put_back(self, child: Node) -> None:
        """Undo the taking of a child, with all that was taken from it: it becomes an extra as a whole."""
        self._rest[child._place] = child.element
        del self._entered[child._place]

    def _enter(self, place: int, element: Any) -> Node:
        self._rest[place] = None
        node = Node(element, self.file, place, self.owner or self._within)
        self._entered[place] = node
        return node

    # ---- what is left ----------------------------------------------------------------------------------------------------

    def _left(self, path: str, texts: dict[Any, list[tuple[int, str]]], *, comments: bool) -> Iterator[Extra]:
        """The extras of this node itself: attributes, then children and loose text in their order."""
        yield from self._left_attributes(path)
        words = () if self._words_taken else texts.get(self.element, ())
        if words:
            yield from (Extra("", _below(path, "text()"), text, index) for index, text in words)
        if self._rest.count(None) == len(self._rest):
            return
        index = 0
        for element in self._rest:
            said = element is None or isinstance(element.tag, str) or comments
            if element is not None and said:
                yield Extra("", path, verbatim(element), index)
            index += said

    def _left_attributes(self, path: str) -> Iterator[Extra]:
        for name, value in sorted(self.attributes.items()):
            if not name.startswith("{"):
                yield Extra("", _below(path, f"@{name}"), value)
                continue
            uri, _, local = name[1:].partition("}")
            prefix = _prefix_of(uri, self.element)
            if uri != _XML_NAMESPACE and self.element.getroottree().getroot().nsmap.get(prefix) != uri:
                yield Extra("", _below(path, f"@xmlns:{prefix}"), uri)
            yield Extra("", _below(path, f"@{prefix}:{local}"), value)


def leftovers(root: Node, format_name: str) -> dict[Id, tuple[Extra, ...]]:
    """Everything below ``root`` that nobody took, as extras of the elements that it belongs to.

    The root's own comments are kept as well. Namespaces declared at the root are attributes of it (``@xmlns:drake``).
    """
    found: dict[Id, list[Extra]] = {}
    texts = _loose_texts(root.element)
    stack = [(root, root.owner or ROOT, "")]
    while stack:
        node, owner, path = stack.pop()
        left = list(node._left(path, texts, comments=node is root))
        if left:
            found.setdefault(owner, []).extend(Extra(format_name, e.path, e.text, e.index) for e in left)
        stack.extend(reversed(list(_nested(node, owner, path))))
    spaces = [Extra(format_name, "@xmlns" + (f":{prefix}" if prefix else ""), uri) for prefix, uri in root.element.nsmap.items()]
    if spaces:
        found[ROOT] = spaces + found.get(ROOT, [])
    return {owner: tuple(extras) for owner, extras in found.items()}


def _nested(node: Node, owner: Id, path: str) -> Iterator[tuple[Node, Id, str]]:
    """The entered children with owner and path; repeated ones are numbered: ``joint``, ``joint[2]``."""
    seen: dict[str, int] = {}
    for child in node.entered():
        if child.owner is not None:
            yield child, child.owner, ""
            continue
        number = seen[child.tag] = seen.get(child.tag, 0) + 1
        yield child, owner, _below(path, child.tag if number == 1 else f"{child.tag}[{number}]")


def _loose_texts(root: Any) -> dict[Any, list[tuple[int, str]]]:
    """The non-blank text of each element, with its place among the element's children."""
    found: dict[Any, list[tuple[int, str]]] = {}
    for text in _words_in(root):
        near = text.getparent()
        if text.is_tail:
            parent = near.getparent()
            if parent is not None:
                found.setdefault(parent, []).append((parent.index(near) + 1, text.strip()))
        else:
            found.setdefault(near, []).append((0, text.strip()))
    return found


def _below(path: str, step: str) -> str:
    return f"{path}/{step}" if path else step


def _prefix_of(uri: str, element: Any) -> str:
    if uri == _XML_NAMESPACE:
        return "xml"
    return next((prefix for prefix, known in element.nsmap.items() if known == uri and prefix), "ns")


def verbatim(element: Any) -> str:
    """The element as text of its own, with those namespace declarations that it needs and no others."""
    text: str = etree.tostring(element, encoding="unicode", with_tail=False)
    if not isinstance(element.tag, str):
        return text
    for prefix, uri in element.nsmap.items():
        declaration = f' xmlns:{prefix}="{uri}"' if prefix else f' xmlns="{uri}"'
        bare = text.replace(declaration, "", 1)
        if prefix and f"{prefix}:" not in bare:
            text = bare
    return text


# ---- numbers ---------------------------------------------------------------------------------------------------------------


def read_numbers(text: str) -> tuple[float, ...] | None:
    """The decimal numbers of a text, separated by blanks, or None if one of them is not a finite decimal number."""
    try:
        numbers = tuple(map(float, text.split()))
    except ValueError:
        return None
    if not all(map(math.isfinite, numbers)) or "_" in text or not text.isascii():
        return None
    return numbers


def take_numbers(node: Node, attribute: str, count: int, report: Report, *, instead: str) -> tuple[float, ...] | None:
    """The ``count`` numbers of an attribute; None when it is missing or bad.

    A bad one is reported and not taken, so that it becomes an extra and is written back as it was; ``instead`` says
    what the caller uses (``0 is used``).
    """
    text = node.attributes.get(attribute)
    if text is None:
        return None
    numbers = read_numbers(text)
    if numbers is not None and len(numbers) == count:
        del node.attributes[attribute]
        return numbers
    _report_bad(node, attribute, text, count, report, instead)
    return None


def take_number(node: Node, attribute: str, report: Report, *, instead: str) -> float | None:
    """The one number of an attribute; None when it is missing or bad. See :func:`take_numbers`."""
    numbers = take_numbers(node, attribute, 1, report, instead=instead)
    return None if numbers is None else numbers[0]


def _report_bad(node: Node, attribute: str, text: str, count: int, report: Report, instead: str) -> None:
    expected = "one finite number" if count == 1 else f"{count} finite numbers separated by blanks"
    left_over = "${" in text or "$(" in text
    report.error(
        codes.LEFTOVER_TEMPLATE if left_over else codes.BAD_NUMBER,
        f"{_of(node)}<{node.tag} {attribute}> is '{shortened(text)}', expected {expected}; {instead}, and the text is kept as written",
        node.origin,
        element=node.subject,
        hint="expand the file with xacro first" if left_over else "",
    )


def _of(node: Node) -> str:
    return f"{node.subject}: " if node.subject else ""


def shortened(text: str, limit: int = 60) -> str:
    """A text for a message: at most ``limit`` characters."""
    return text if len(text) <= limit else text[: limit - 3] + "..."


def by_path(extras: Iterable[Extra], format_name: str) -> list[Extra]:
    """The extras of one format in the order of their places."""
    return sorted((extra for extra in extras if extra.format == format_name), key=lambda extra: extra.index)
