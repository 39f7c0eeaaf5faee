"""What a reader has left in a tree becomes extras: attributes, text and elements that no frontend took.

No list of known tags decides what survives.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.ir.mechanism import ROOT, Extra
from hymeko_x.xml.layout import laid_out
from hymeko_x.xml.namespaces import KNOWN_PREFIXES, PREFIX, with_declared
from hymeko_x.xml.tree import COMMENT_NODE, INSTRUCTION_NODE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.xml.tree import XmlDocument, XmlNode

COMMENT = "comment"
"""The format of an extra that is a comment: it is the same in every format, and kept without its signs."""
PRECEDING = "preceding"
FOLLOWING = "following"
"""The paths of what stands before and after the root element."""


def unread_extras(node: XmlNode, path: str, format_name: str, verbatim: Callable[[XmlNode], str]) -> Iterator[Extra]:
    """Everything in a node that is unread, as extras; ``path`` leads to the node, and ``verbatim`` gives the text of an element."""
    for name, value in node.attributes.items():
        yield Extra(format_name, _below(path, f"@{name}"), value)
    if node.text is not None:
        yield Extra(format_name, _below(path, "text()"), node.text.strip(), node.text_index)
    for index, child in enumerate(node.children):
        if not child.taken:
            yield extra_of(child, path, index, format_name, verbatim)


def extra_of(node: XmlNode, path: str, index: int, format_name: str, verbatim: Callable[[XmlNode], str] = str) -> Extra:
    """A comment, a processing instruction or an element as an extra."""
    if node.tag == COMMENT_NODE:
        return Extra(COMMENT, path, node.text or "", index)
    return Extra(format_name, path, f"<?{node.text}?>" if node.tag == INSTRUCTION_NODE else verbatim(node), index)


def extras_around(document: XmlDocument, format_name: str) -> list[Extra]:
    """The comments and instructions before and after the root element."""
    before = [extra_of(node, PRECEDING, place, format_name) for place, node in enumerate(document.preceding)]
    return before + [extra_of(node, FOLLOWING, place, format_name) for place, node in enumerate(document.following)]


class Unread:
    """Collects what is unread in a file, whose bytes are ``data`` in UTF-8, element by element; elements keep their text."""

    def __init__(self, root: XmlNode, data: bytes, format_name: str, report: Report) -> None:
        self._root = root
        self._report = report
        self._data = data
        self._format = format_name
        self._found: dict[Id, list[Extra]] = {}
        self._owners: dict[int, Id] = {}

    def close(self, node: XmlNode) -> list[XmlNode]:
        """Collect what is unread in a child of the root. Returns its nodes in which child elements are unread."""
        if node.owner is not None:
            self._owners[node.start] = node.owner
        with_unread_children = []
        stack = [node]
        while stack:
            member = stack.pop()
            is_whole = True
            for child in member.children:
                if not child.taken:
                    is_whole = False
                elif child.children or child.attributes or child.text is not None:  # nothing is unread in the others, which are the most
                    stack.append(child)
            if not is_whole:
                with_unread_children.append(member)
            if not is_whole or member.attributes or member.text is not None:
                self._keep(member)
        return with_unread_children

    def _keep(self, node: XmlNode) -> None:
        for name in list(node.attributes):
            self._declare_prefix(node, name)
        owner, path = _place_below_owner(node)
        self._found.setdefault(owner, []).extend(unread_extras(node, path, self._format, self.verbatim))

    def finish(self) -> dict[Id, tuple[Extra, ...]]:
        """Everything that is unread, by element. The root's comments, and its namespaces (``@xmlns:drake``), are among it.

        The tree is of no use afterwards.
        """
        for child in self._root.unread_children():
            self._declare_prefixes(child)
        self._keep(self._root)
        self._root.release()
        return {owner: tuple(sorted(extras, key=_by_place)) for owner, extras in self._found.items() if extras}

    @property
    def layout(self) -> tuple[Id, ...]:
        """The elements that children of the root became, in the order of the file."""
        return tuple(self._owners[place] for place in sorted(self._owners))

    # ---- text of elements ------------------------------------------------------------------------------------------------

    def verbatim(self, node: XmlNode) -> str:
        """The element as the file has it but for its layout, with the namespace declarations that it needs from further up."""
        self._declare_prefixes(node)
        end = node.end
        closed_itself = not node.children and node.text is None and self._data[end - 2 : end] == b"/>"
        if not closed_itself:
            end = self._data.index(b">", end) + 1
        is_outer = node.parent is None or _place_below_owner(node.parent) == (ROOT, "")
        text = self._data[node.start : end].decode().replace("\r\n", "\n").replace("\r", "\n")
        text = laid_out(text, 1 if is_outer else 2)
        return with_declared(text, _declared_above(node)) if ":" in text else text

    def _declare_prefixes(self, node: XmlNode) -> None:
        """Declare at the root the prefixes in an element that are declared nowhere."""
        if self._data.find(b":", node.start, node.end) < 0:
            return
        for member in node.walk():
            self._declare_prefix(member, member.tag)
            for name in member.attributes:
                self._declare_prefix(member, name)

    def _declare_prefix(self, node: XmlNode, name: str) -> None:
        prefix, colon, _ = name.partition(":")
        if not colon or prefix in ("xml", "xmlns"):
            return
        above: XmlNode | None = node
        while above is not None and f"xmlns:{prefix}" not in above.attributes:
            above = above.parent
        if above is None:
            self._root.attributes[f"xmlns:{prefix}"] = KNOWN_PREFIXES.get(prefix, f"urn:{prefix}")
            message = f"undeclared prefix '{prefix}'; read as if the root declared it"
            self._report.warn(codes.REPAIRED_XML, message, node.origin)


def _by_place(extra: Extra) -> tuple[bool, str, int]:
    """Deeper extras come first, then the element's own content; each in the order of the file."""
    return extra.path == "", extra.path, extra.index


def _place_below_owner(node: XmlNode) -> tuple[Id, str]:
    """Whose the node is, and the path from that element to it; repeated steps are numbered: ``joint[2]``."""
    path = ""
    while node.owner is None and node.parent is not None:
        path = _below(_step(node, node.parent), path) if path else _step(node, node.parent)
        node = node.parent
    return node.owner or ROOT, path


def _step(node: XmlNode, parent: XmlNode) -> str:
    number = 1
    for child in parent.children:
        if child is node:
            break
        number += child.tag == node.tag and child.taken
    return node.tag if number == 1 else f"{node.tag}[{number}]"


def _below(path: str, step: str) -> str:
    return f"{path}/{step}" if path else step


def _declared_above(node: XmlNode) -> dict[str, str]:
    """The namespaces (attribute -> uri) that the elements around a node declare, the innermost ones first."""
    found: dict[str, str] = {}
    above = node.parent
    while above is not None:
        for name, uri in above.attributes.items():
            if name.startswith(PREFIX):
                found.setdefault(name, uri)
        above = above.parent
    return found
