"""XML elements that remember what was asked for, so that what nobody asked for can be kept.

A frontend takes attributes, children and text out of a :class:`Node`; what it never took becomes an :class:`Extra` by
:class:`Leftovers`. No list of known tags decides what survives.
"""

from __future__ import annotations

import math
import re
from functools import lru_cache
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import Origin
from hymeko_x.ir.mechanism import ROOT, Extra
from hymeko_x.xml.text import escaped

if TYPE_CHECKING:
    from collections.abc import Container, Iterator

    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Id

COMMENT = "comment"
"""The format of an extra that is a comment."""
COMMENT_NODE = "#comment"
INSTRUCTION_NODE = "#instruction"
"""The tags of the nodes of comments and processing instructions, which no element can have."""
PRECEDING = "preceding"
FOLLOWING = "following"
"""The paths of what stands before and after the root element."""


KNOWN_PREFIXES = {
    "xacro": "http://www.ros.org/wiki/xacro",
    "drake": "http://drake.mit.edu",
    "gz": "http://gazebosim.org/schema",
}
"""What an undeclared prefix stands for; others become ``urn:prefix``."""


class Node:
    """An XML element whose attributes, children and text are taken out one by one.

    ``owner`` is the element of the mechanism that the node became; a node without one belongs to its parent's.
    ``start`` and ``end`` are where the element starts, and where its end tag does, in the bytes of the file.
    """

    __slots__ = ("attributes", "end", "file", "kids", "line", "owner", "parent", "start", "tag", "taken", "text", "text_index")

    end: int
    text_index: int

    def __init__(self, tag: str, attributes: dict[str, str], parent: Node | None, file: str, line: int, start: int) -> None:
        self.tag = tag
        self.attributes = attributes
        self.parent = parent
        self.file = file
        self.line = line
        self.start = start
        self.kids: list[Node] | tuple[()] = ()
        self.taken = False
        self.owner: Id | None = None
        self.text: str | None = None

    @property
    def origin(self) -> Origin:
        """Where the element starts."""
        return Origin(self.file, self.line)

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

    @property
    def is_element(self) -> bool:
        """False for a comment or a processing instruction."""
        return self.tag[0] != "#"

    def _owning(self) -> Node:
        node = self
        while node.owner is None and node.parent is not None:
            node = node.parent
        return node

    def adopt(self, kid: Node) -> None:
        """Put a node behind the children; most elements never have one, and do without a list."""
        if self.kids:
            self.kids.append(kid)
        else:
            self.kids = [kid]

    # ---- taking ----------------------------------------------------------------------------------------------------------

    def take(self, attribute: str) -> str | None:
        """The value of an attribute, or None when there is none."""
        return self.attributes.pop(attribute, None)

    def child(self, tag: str) -> Node | None:
        """The first child of this name that was not taken yet, or None."""
        for kid in self.kids:
            if kid.tag == tag and not kid.taken:
                kid.taken = True
                return kid
        return None

    def child_among(self, tags: Container[str]) -> Node | None:
        """The first child that was not taken yet and has one of these names, or None."""
        for kid in self.kids:
            if kid.tag in tags and not kid.taken:
                kid.taken = True
                return kid
        return None

    def children(self, tag: str) -> Iterator[Node]:
        """All children of this name that were not taken yet, one after the other."""
        for kid in self.kids:
            if kid.tag == tag and not kid.taken:
                kid.taken = True
                yield kid

    def take_whole(self, tag: str) -> None:
        """Take the first child of this name with all that is in it, without reading it."""
        child = self.child(tag)
        if child is not None:
            child.attributes, child.kids, child.text = {}, (), None

    def words(self) -> str:
        """The text of the element, stripped; none, and nothing taken, where elements stand between the words."""
        if self.kids:
            return ""
        text = (self.text or "").strip()
        self.text = None
        return text

    def put_back(self, child: Node) -> None:
        """Undo the taking of a child: it becomes an extra as a whole, in the words of the file."""
        child.taken = False

    def let_go(self) -> None:
        """Take the element apart: nodes that know each other would wait for the collector of cycles, and a large robot has millions."""
        stack = [self]
        while stack:
            member = stack.pop()
            stack.extend([kid for kid in member.kids if kid.kids])
            member.kids = ()

    # ---- looking without taking ------------------------------------------------------------------------------------------

    def has(self, tag: str) -> bool:
        """Whether a child of this name is left."""
        return any(kid.tag == tag and not kid.taken for kid in self.kids)

    def has_among(self, tags: Container[str]) -> bool:
        """Whether a child with one of these names is left."""
        return any(kid.tag in tags and not kid.taken for kid in self.kids)

    def took(self, tag: str) -> bool:
        """Whether a child of this name was taken."""
        return any(kid.tag == tag and kid.taken for kid in self.kids)

    def left(self) -> list[Node]:
        """The child elements that are left."""
        return [kid for kid in self.kids if not kid.taken and kid.is_element]


# ---- what is left ------------------------------------------------------------------------------------------------------------


class Leftovers:
    """Collects what nobody took out of a file, whose bytes are ``data`` in UTF-8, element by element."""

    def __init__(self, root: Node, data: bytes, format_name: str, report: Report) -> None:
        self._root = root
        self._report = report
        self._data = data
        self._format = format_name
        self._found: dict[Id, list[Extra]] = {}
        self._owners: dict[int, Id] = {}

    def verbatim(self, node: Node) -> str:
        """The element as the file has it, with the namespace declarations that it needs from further up."""
        self._declare_prefixes(node)
        end = node.end
        closed_itself = not node.kids and node.text is None and self._data[end - 2 : end] == b"/>"
        if not closed_itself:
            end = self._data.index(b">", end) + 1
        text = self._data[node.start : end].decode().replace("\r\n", "\n").replace("\r", "\n")
        return _with_declarations(text, node)

    def _declare_prefixes(self, node: Node) -> None:
        """Declare at the root the prefixes in an element that are declared nowhere."""
        stack = [node]
        while stack:
            member = stack.pop()
            self._declare_prefix(member, member.tag)
            for name in member.attributes:
                self._declare_prefix(member, name)
            stack.extend(reversed(member.kids))

    def _declare_prefix(self, node: Node, name: str) -> None:
        prefix, colon, _ = name.partition(":")
        if not colon or prefix in ("xml", "xmlns"):
            return
        above: Node | None = node
        while above is not None and f"xmlns:{prefix}" not in above.attributes:
            above = above.parent
        if above is None:
            self._root.attributes[f"xmlns:{prefix}"] = KNOWN_PREFIXES.get(prefix, f"urn:{prefix}")
            said = f"undeclared prefix '{prefix}'; read as if the root declared it"
            self._report.warn(codes.REPAIRED_XML, said, node.origin)

    def close(self, node: Node) -> list[Node]:
        """Collect what is left in a child of the root. Returns its nodes in which child elements were left."""
        if node.owner is not None:
            self._owners[node.start] = node.owner
        with_left_kids = []
        stack = [node]
        while stack:
            member = stack.pop()
            if member.attributes or member.text is not None:
                self._keep(member)
            kept = False
            for kid in member.kids:
                if kid.taken:
                    stack.append(kid)
                elif not kept and kid.is_element:
                    kept = True
                    self._keep_kids(member)
                    with_left_kids.append(member)
        return with_left_kids

    def _keep(self, node: Node) -> None:
        owner, path = _place_below_owner(node)
        found = self._found.setdefault(owner, [])
        for name in list(node.attributes):
            self._declare_prefix(node, name)
        for name in sorted(node.attributes):
            found.append(Extra(self._format, _below(path, f"@{name}"), node.attributes[name]))
        if node.text is not None:
            found.append(Extra(self._format, _below(path, "text()"), node.text.strip(), node.text_index))

    def _keep_kids(self, node: Node) -> None:
        owner, path = _place_below_owner(node)
        found = self._found.setdefault(owner, [])
        elements = [kid for kid in node.kids if kid.is_element]
        found += [Extra(self._format, path, self.verbatim(kid), place) for place, kid in enumerate(elements) if not kid.taken]

    def finish(self) -> dict[Id, tuple[Extra, ...]]:
        """Everything that was left, by element. The root's comments, and its namespaces (``@xmlns:drake``), are among it.

        Nobody looks at the file's elements again.
        """
        own = self._found.setdefault(ROOT, [])
        for place, kid in enumerate(self._root.kids):
            if not kid.is_element:
                own.append(outer_extra(self._format, "", kid, place))
            elif not kid.taken:
                own.append(Extra(self._format, "", self.verbatim(kid), place))
        self._keep(self._root)  # last, since prefixes may have been declared at the root
        self._root.let_go()
        return {owner: tuple(sorted(extras, key=_by_place)) for owner, extras in self._found.items() if extras}

    @property
    def layout(self) -> tuple[Id, ...]:
        """The elements that children of the root became, in the order of the file."""
        return tuple(self._owners[place] for place in sorted(self._owners))


def _by_place(extra: Extra) -> tuple[bool, str, int]:
    """What stands deeper comes first, then the element's own content; each in the order of the file."""
    return extra.path == "", extra.path, extra.index


def outer_extra(format_name: str, path: str, node: Node, index: int) -> Extra:
    """A comment, which is the same in every format and is kept without its signs, or a processing instruction as it is."""
    text = node.text or ""
    if node.tag == COMMENT_NODE:
        return Extra(COMMENT, path, text.strip(), index)
    return Extra(format_name, path, f"<?{text}?>", index)


def _place_below_owner(node: Node) -> tuple[Id, str]:
    """Whose the node is, and the path from that element to it; repeated steps are numbered: ``joint[2]``."""
    path = ""
    while node.owner is None and node.parent is not None:
        path = _below(_step(node, node.parent), path) if path else _step(node, node.parent)
        node = node.parent
    return node.owner or ROOT, path


def _step(node: Node, parent: Node) -> str:
    number = 1
    for kid in parent.kids:
        if kid is node:
            break
        number += kid.tag == node.tag and kid.taken
    return node.tag if number == 1 else f"{node.tag}[{number}]"


def _below(path: str, step: str) -> str:
    return f"{path}/{step}" if path else step


def _with_declarations(text: str, node: Node) -> str:
    """The text of an element with the declarations of those prefixes that it uses and does not declare."""
    added: dict[str, str] = {}
    above = node.parent
    while above is not None:
        for name, uri in above.attributes.items():
            if name.startswith("xmlns:") and f"{name[6:]}:" in text and f"{name}=" not in text:
                added.setdefault(name, uri)
        above = above.parent
    if not added:
        return text
    name_end = re.match(r"<[^\s/>]+", text)
    assert name_end is not None
    declarations = "".join(f' {name}="{escaped(uri)}"' for name, uri in added.items())
    return text[: name_end.end()] + declarations + text[name_end.end() :]


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
