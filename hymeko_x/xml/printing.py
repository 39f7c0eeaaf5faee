"""The one printer of XML: tags that a backend fills, extras put back where they were, and the text of both."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING
from xml.parsers import expat

from hymeko_x import codes
from hymeko_x.diagnostics import Refusal, refuse
from hymeko_x.xml.layout import at_depth, laid_out
from hymeko_x.xml.namespaces import without_declared
from hymeko_x.xml.parse import parse_text
from hymeko_x.xml.text import NAME, attributes_text, comment_markup, escaped
from hymeko_x.xml.tree import COMMENT_NODE
from hymeko_x.xml.unread import COMMENT, FOLLOWING, PRECEDING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from hymeko_x.ir.mechanism import Extra, Id
    from hymeko_x.xml.tree import XmlNode

_WIDEST_INDENT = 80
"""Elements in more than 40 others are not indented further, so that the text stays linear in their number."""
_STEP = re.compile(rf"{NAME}(?:\[[1-9]\d*\])?|@{NAME}|text\(\)")
_PLAIN = re.compile(r"<([A-Za-z_][\w.-]*+)(?:/>|>[\w .,+\-/()\n]*+</\1>)", re.ASCII)
"""An element with a plain text and nothing else, which needs no parser."""
_NAMESPACE = re.compile(r"xmlns(?::[^\W\d][\w.-]*)?")


class Tag:
    """An XML element to be printed: name, attributes in order, and children that are tags or ready text.

    ``owner`` is the element of the mechanism that it is written for, if known; ``has_end`` asks for an end tag even without children.
    """

    __slots__ = ("attributes", "children", "has_end", "name", "owner")

    def __init__(self, name: str, attributes: dict[str, str], children: Iterable[Tag | str] = ()) -> None:
        self.name = name
        self.attributes = attributes
        self.children = [*children]
        self.owner: Id | None = None
        self.has_end = False

    def add(self, name: str, /, **attributes: str) -> Tag:
        """A new child with these attributes."""
        child = Tag(name, attributes)
        self.children.append(child)
        return child

    def child(self, step: str) -> Tag:
        """The child that a path's step (``joint``, ``joint[2]``) leads to; made when it is not there."""
        name, _, number = step.partition("[")
        wanted = int(number.rstrip("]")) if number else 1
        for child in self.children:
            if isinstance(child, Tag) and child.name == name:
                wanted -= 1
                if not wanted:
                    return child
        return self.add(name)


def put_back(tag: Tag, extras: Iterable[Extra], declared: Mapping[str, str]) -> None:
    """Write extras into a tag: attributes win over what is there, text and elements go to their place.

    ``declared`` are the namespace declarations of the root, which extras then need not repeat.

    Raises: Refusal with HX062 for an extra that is not well-formed.
    """
    for extra in sorted(extras, key=lambda e: (e.index, not e.path.endswith("text()"))):
        *steps, last = extra.path.split("/") if extra.path else [""]
        if not all(map(_STEP.fullmatch, [*steps, last] if extra.path else [])):
            raise _not_xml(extra, f"'{extra.path}' is not a path")
        target = tag
        for step in steps:
            target = target.child(step)
        if last.startswith("@"):
            target.attributes[last[1:]] = extra.text
        elif last == "text()":
            target.children.insert(extra.index, escaped(extra.text))
        else:
            target = target.child(last) if last else target
            target.children.insert(_place_for(extra, target), foreign_text(extra, declared))


def foreign_text(extra: Extra, declared: Mapping[str, str]) -> str:
    """The text of an extra that is an element, a comment or an instruction, without the namespaces that are ``declared`` already.

    Raises: Refusal with HX062 when it is not well-formed.
    """
    if extra.format == COMMENT:
        return comment_markup(extra.text)
    if extra.path in (PRECEDING, FOLLOWING) and not extra.text.startswith("<?"):
        raise _not_xml(extra, "outside the root there are only comments and instructions")
    if _PLAIN.fullmatch(extra.text) is not None:
        return extra.text
    spaces = attributes_text({name: uri for name, uri in declared.items() if _NAMESPACE.fullmatch(name)})
    try:
        around = parse_text(f"<x{spaces}>{extra.text}</x>", namespaces=True)
    except (expat.ExpatError, UnicodeEncodeError, Refusal) as error:
        raise _not_xml(extra, str(error)) from error
    if len(around.children) != 1 or not extra.text.startswith("<") or around.text is not None:
        raise _not_xml(extra, "it is not one element")
    return without_declared(extra.text, declared)


def _not_xml(extra: Extra, why: str) -> Refusal:
    text = extra.text if len(extra.text) < 60 else extra.text[:60] + "..."
    return refuse(codes.BAD_VALUE, f"the {extra.format} extra '{text}' cannot be written into XML: {why}")


def _place_for(extra: Extra, tag: Tag) -> int:
    """The index of a foreign element: its own, but never before a child of its name, of which readers take the first."""
    name = re.match(r"<([^\s/>]+)", extra.text)
    same = [place for place, child in enumerate(tag.children) if name and isinstance(child, Tag) and child.name == name[1]]
    return max(extra.index, same[-1] + 1) if same else extra.index


def render(tag: Tag, depth: int = 0) -> list[str]:
    """The lines of a tag, two blanks per level. Foreign text that is not tidy keeps its inner lines; an empty text is an empty line."""
    lines: list[str] = []
    around: list[tuple[Iterator[Tag | str], str, str]] = []
    row: Iterator[Tag | str] = iter((tag,))
    indent = " " * min(2 * depth, _WIDEST_INDENT)
    while True:
        for child in row:
            if isinstance(child, str):
                text = at_depth(child, len(indent) // 2) if "\n" in child else child
                lines.append(indent + text if text else "")
                continue
            name, children = child.name, child.children
            start = f"{indent}<{name}{attributes_text(child.attributes)}"
            if not children and not child.has_end:
                lines.append(start + "/>")
            elif len(children) == 1 and isinstance(children[0], str) and not children[0].startswith("<"):
                lines.append(f"{start}>{children[0]}</{name}>")
            else:
                lines.append(start + ">")
                around.append((row, indent, name))
                row = iter(children)
                indent = indent if len(indent) == _WIDEST_INDENT else indent + "  "
                break
        else:
            if not around:
                return lines
            row, indent, name = around.pop()
            lines.append(f"{indent}</{name}>")


def ready(tag: Tag, depth: int) -> str:
    """A tag as ready text for another tag at this depth: its lines, of which the first one is not indented."""
    return "\n".join(render(tag, depth))[2 * depth :]


def in_lines(markup: str) -> str:
    """The text of an element as readers keep one of several lines that stands in another one: one element a line."""
    return laid_out(markup, 2, spread=True)


def markup(node: XmlNode) -> str:
    """A node with everything in it as one line of XML; of a comment its text in comment signs."""
    pieces: list[str] = []
    stack: list[XmlNode | str] = [node]
    while stack:
        item = stack.pop()
        if isinstance(item, str):
            pieces.append(item)
        elif item.tag == COMMENT_NODE:
            pieces.append(f"<!--{item.text}-->")
        else:
            start = item.tag + attributes_text(item.attributes)
            if item.children or item.text:
                pieces.append(f"<{start}>{escaped((item.text or '').strip())}")
                stack.append(f"</{item.tag}>")
                stack.extend(reversed(item.children))
            else:
                pieces.append(f"<{start}/>")
    return "".join(pieces)
