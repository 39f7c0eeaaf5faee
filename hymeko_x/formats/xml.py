"""Reading XML so that nothing gets lost: nodes that remember what was asked for, and what is left over at the end.

Shared by the frontends of all XML formats. A frontend takes attributes, children and text out of a :class:`Node`; what
it never took becomes an :class:`Extra` by :class:`Leftovers`, so that no list of known tags decides what survives.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from lxml import etree

from hymeko_x import codes
from hymeko_x.diagnostics import Origin
from hymeko_x.ir.mechanism import ROOT, Extra, Id

if TYPE_CHECKING:
    from collections.abc import Container, Iterator

    from hymeko_x.diagnostics import Report

COMMENT = "comment"
"""The format of an extra that is a comment."""
PRECEDING = "preceding"
FOLLOWING = "following"
"""The paths of what stands before and after the root element."""

_XML_NAMESPACE = "http://www.w3.org/XML/1998/namespace"
_words_in = etree.XPath("//text()[normalize-space()]")


class Node:
    """An XML element whose attributes, children and text are taken out one by one.

    ``owner`` is the element of the mechanism that the node became; a node without one belongs to its parent's.
    """

    __slots__ = ("_family", "_kids", "_parent", "_place", "_words_taken", "attributes", "element", "file", "owner", "tag")

    def __init__(self, element: Any, file: str, parent: Node | None = None, place: int = 0, family: list[Node] | None = None) -> None:
        self.element = element
        self.file = file
        self.tag: str = element.tag
        self.attributes: dict[str, str] = dict(element.items())
        self.owner: Id | None = None
        self._parent = parent
        self._place = place
        self._kids = _kids_of(element) if len(element) else {}
        self._words_taken = False
        if family is None:
            self._family = [self]
        else:
            self._family = family
            family.append(self)

    @property
    def origin(self) -> Origin:
        """Where the element starts."""
        return Origin(self.file, self.element.sourceline)

    @property
    def subject(self) -> str:
        """What the node belongs to, in the words of its file: ``joint 'elbow'``; the root element if to nothing else."""
        node = self._owning()
        return f"<{node.tag}>" if node.owner is None else f"{node.tag} '{node.owner.name}'"

    @property
    def about(self) -> str:
        """The element of the mechanism that the node belongs to, in words; empty for the mechanism itself."""
        owner = self._owning().owner
        return "" if owner is None else str(owner)

    def _owning(self) -> Node:
        node = self
        while node.owner is None and node._parent is not None:
            node = node._parent
        return node

    # ---- taking ----------------------------------------------------------------------------------------------------------

    def take(self, attribute: str) -> str | None:
        """The value of an attribute, or None when there is none."""
        return self.attributes.pop(attribute, None)

    def child(self, tag: str) -> Node | None:
        """The first child of this name that was not taken yet, or None."""
        return self._enter(tag) if tag in self._kids else None

    def child_among(self, tags: Container[str]) -> Node | None:
        """The first child that was not taken yet and has one of these names, or None."""
        found = [tag for tag in self._kids if tag in tags]
        if len(found) > 1:
            found = [element.tag for element in self.elements() if element.tag in tags]
        return self._enter(found[0]) if found else None

    def children(self, tag: str) -> Iterator[Node]:
        """All children of this name that were not taken yet, one after the other."""
        for place, element in self._kids.pop(tag, ()):
            yield self._node(place, element)

    def take_whole(self, tag: str) -> None:
        """Take the first child of this name with all that is in it, without reading it."""
        if tag in self._kids:
            self._pop(tag)

    def words(self) -> str:
        """The text of the element, stripped; none, and nothing taken, where elements stand between the words."""
        if any(isinstance(tag, str) for tag in self._kids):
            return ""
        self._words_taken = True
        return "".join([self.element.text or "", *(comment.tail or "" for comment in self.element)]).strip()

    def put_back(self, child: Node) -> None:
        """Undo the taking of a child, with all that was taken from it: it becomes an extra as a whole."""
        self._kids.setdefault(child.tag, []).append((child._place, child.element))
        self._family[:] = [node for node in self._family if not node._is_within(child)]

    def _enter(self, tag: str) -> Node:
        return self._node(*self._pop(tag))

    def _pop(self, tag: str) -> tuple[int, Any]:
        waiting = self._kids[tag]
        if len(waiting) == 1:
            del self._kids[tag]
        return waiting.pop(0)

    def _node(self, place: int, element: Any) -> Node:
        return Node(element, self.file, self, place, None if self._parent is None else self._family)

    def _is_within(self, other: Node) -> bool:
        node: Node | None = self
        while node is not None and node is not other:
            node = node._parent
        return node is other

    # ---- looking without taking ------------------------------------------------------------------------------------------

    def has(self, tag: str) -> bool:
        """Whether a child of this name is left."""
        return tag in self._kids

    def has_among(self, tags: Container[str]) -> bool:
        """Whether a child with one of these names is left."""
        return any(tag in tags for tag in self._kids)

    def took(self, tag: str) -> bool:
        """Whether a child of this name was taken."""
        count = sum(1 for element in self.element if element.tag == tag)
        return count > len(self._kids.get(tag, ()))

    def look(self, tag: str) -> str | None:
        """The first child of this name that is left, verbatim."""
        return verbatim(self._kids[tag][0][1]) if tag in self._kids else None

    def elements(self) -> list[Any]:
        """The child elements that are left, in the order of the file."""
        left = [item for tag, items in self._kids.items() if isinstance(tag, str) for item in items]
        return [element for _, element in sorted(left, key=_place_of)]

    # ---- what is left ----------------------------------------------------------------------------------------------------

    def _left(self, format_name: str, path: str, texts: Texts, *, comments: bool) -> Iterator[Extra]:
        """The extras of this node itself: attributes, then loose text and children in their order."""
        for step, value in self._left_attributes():
            yield Extra(format_name, _below(path, step), value)
        if not self._words_taken and self.element in texts:
            index, text = texts[self.element]
            yield Extra(format_name, _below(path, "text()"), text, index)
        yield from (_child_extra(format_name, path, element, index) for index, element in self._left_children(comments=comments))

    def _left_children(self, *, comments: bool) -> Iterator[tuple[int, Any]]:
        """What was not taken, with its place among the child elements (and comments)."""
        left = {place for items in self._kids.values() for place, _ in items}
        index = 0
        for place, element in enumerate(self.element if left else ()):
            counts = comments or isinstance(element.tag, str)
            if counts and place in left:
                yield index, element
            index += counts

    def _left_attributes(self) -> Iterator[tuple[str, str]]:
        for name, value in sorted(self.attributes.items()):
            if not name.startswith("{"):
                yield f"@{name}", value
                continue
            uri, _, local = name[1:].partition("}")
            prefix = _prefix_of(uri, self.element)
            if uri != _XML_NAMESPACE and self.element.getroottree().getroot().nsmap.get(prefix) != uri:
                yield f"@xmlns:{prefix}", uri
            yield f"@{prefix}:{local}", value

    def _place_below_owner(self) -> tuple[Id, str]:
        """Whose the node is, and the path from that element to it; repeated steps are numbered: ``joint[2]``."""
        node = self
        path = ""
        while node.owner is None and node._parent is not None:
            path = _below(node._step(node._parent), path) if path else node._step(node._parent)
            node = node._parent
        return node.owner or ROOT, path

    def _step(self, parent: Node) -> str:
        left = {place for place, _ in parent._kids.get(self.tag, ())}
        number = 1
        for place, element in enumerate(parent.element):
            if place == self._place:
                break
            number += element.tag == self.tag and place not in left
        return self.tag if number == 1 else f"{self.tag}[{number}]"


def _kids_of(element: Any) -> dict[Any, list[tuple[int, Any]]]:
    """The children by name, with their places; comments by what lxml has for their name."""
    kids: dict[Any, list[tuple[int, Any]]] = {}
    for place, child in enumerate(element):
        tag = child.tag
        if tag in kids:
            kids[tag].append((place, child))
        else:
            kids[tag] = [(place, child)]
    return kids


def _place_of(item: tuple[int, Any]) -> int:
    return item[0]


Texts = dict[Any, tuple[int, str]]


class Leftovers:
    """Collects what nobody took out of a file. Closing an element early frees its nodes; nothing of it counts twice."""

    def __init__(self, root: Node, format_name: str) -> None:
        self._root = root
        self._format = format_name
        self._texts = _loose_texts(root.element)
        self._found: dict[Id, list[Extra]] = {}
        self._owners: dict[int, Id] = {}

    def close(self, node: Node) -> list[Node]:
        """Collect what is left in a child of the root. Returns its nodes in which child elements were left."""
        if node.owner is not None:
            self._owners[node._place] = node.owner
        texts = self._texts
        left = [member for member in node._family if member.attributes or member._kids or (texts and member.element in texts)]
        for member in left:
            owner, path = member._place_below_owner()
            extras = list(member._left(self._format, path, texts, comments=False))
            if extras:
                self._found.setdefault(owner, []).extend(extras)
        node._family = []
        return [member for member in left if member._kids]

    def finish(self) -> dict[Id, tuple[Extra, ...]]:
        """Everything that was left, by element. The root's comments and namespaces (``@xmlns:drake``) are among it."""
        spaces = self._root.element.nsmap.items()
        own = [Extra(self._format, "@xmlns" + (f":{prefix}" if prefix else ""), uri) for prefix, uri in spaces]
        own += self._root._left(self._format, "", self._texts, comments=True)
        if own:
            self._found.setdefault(ROOT, []).extend(own)
        return {owner: tuple(extras) for owner, extras in self._found.items()}

    @property
    def layout(self) -> tuple[Id, ...]:
        """The elements that children of the root became, in the order of the file."""
        return tuple(self._owners[place] for place in sorted(self._owners))


def _loose_texts(root: Any) -> Texts:
    """The non-blank text of each element in one piece, with the place of its beginning among the element's children."""
    pieces: dict[Any, list[str]] = {}
    first: dict[Any, Any] = {}
    for text in _words_in(root):
        near = text.getparent()
        holder = near.getparent() if text.is_tail else near
        if holder is None:
            continue
        pieces.setdefault(holder, []).append(text.strip())
        first.setdefault(holder, near)
    return {holder: (_index_behind(first[holder], holder, root), "\n".join(said)) for holder, said in pieces.items()}


def _index_behind(near: Any, holder: Any, root: Any) -> int:
    """How many children stand up to this one, among which the comments count at top level only."""
    if near is holder:
        return 0
    before = [near, *near.itersiblings(preceding=True)]
    return sum(1 for element in before if holder is root or isinstance(element.tag, str))


def _below(path: str, step: str) -> str:
    return f"{path}/{step}" if path else step


def _prefix_of(uri: str, element: Any) -> str:
    if uri == _XML_NAMESPACE:
        return "xml"
    return next((prefix for prefix, known in element.nsmap.items() if known == uri and prefix), "ns")


def _child_extra(format_name: str, path: str, element: Any, index: int) -> Extra:
    """A child that nobody took; a comment is the same in every format, so it is kept without its signs."""
    if element.tag is etree.Comment:
        return Extra(COMMENT, path, (element.text or "").strip(), index)
    return Extra(format_name, path, verbatim(element), index)


def outer_extra(format_name: str, path: str, markup: str, index: int) -> Extra:
    """What stands outside the root: a comment, or a processing instruction as it is."""
    if markup.startswith("<!--"):
        return Extra(COMMENT, path, markup[4:-3].strip(), index)
    return Extra(format_name, path, markup, index)


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


@lru_cache(4096)
def read_numbers(text: str) -> tuple[float, ...] | None:
    """The decimal numbers of a text, separated by blanks, or None if one of them is not a finite decimal number."""
    try:
        numbers = tuple(map(float, text.split()))
    except ValueError:
        return None
    if not math.isfinite(sum(numbers)) or "_" in text or not text.isascii():
        return numbers if all(map(_is_plain, text.split())) else None
    return numbers


def _is_plain(text: str) -> bool:
    """Whether a text that is a number to Python is a finite decimal number to everybody."""
    return math.isfinite(float(text)) and "_" not in text and text.isascii()


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
        f"{node.subject}: <{node.tag} {attribute}> is '{shortened(text)}', expected {expected}; {instead}, and the text is kept as written",
        node.origin,
        element=node.about,
        hint="expand the file with xacro first" if left_over else "",
    )


def shortened(text: str, limit: int = 60) -> str:
    """A text for a message: at most ``limit`` characters."""
    return text if len(text) <= limit else text[: limit - 3] + "..."
