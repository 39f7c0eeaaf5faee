"""The tags of the URDF backend as forms, and the comments that stood between them."""

from __future__ import annotations

from typing import TYPE_CHECKING
from xml.parsers import expat

from hymeko_x.factor.forms import Element
from hymeko_x.formats.xacro import PREFIX
from hymeko_x.xml.text import unescaped

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.xml.printing import Tag

TEXT = "#text"
INSTRUCTION = "#instruction"
"""Tags of what is no element. The words of an element without children are its leaf without a name.

A comment is a tag of its own, because xacro fills no holes in it.
"""

Remarks = dict[int, list[str]]
"""Comments, as they are marked up, by the number of the form that they stand before."""


class _Open:
    """An element under construction."""

    __slots__ = ("hint", "kids", "leaves", "tag")

    def __init__(self, tag: str, leaves: tuple[tuple[str, str], ...], hint: str = "") -> None:
        self.tag = tag
        self.leaves = leaves
        self.kids: list[Element] = []
        self.hint = hint

    def closed(self) -> Element:
        kids = self.kids
        if len(kids) == 1 and kids[0].tag == TEXT:
            return Element(self.tag, (*self.leaves, ("", kids[0].leaves[0][1])), (), self.hint)
        return Element(self.tag, self.leaves, tuple(kids), self.hint)


def top_level(elements: Iterable[Tag | str], mechanism: Mechanism) -> tuple[list[Element], Remarks]:
    """What is to stand in the root element: forms, and the comments before each of them."""
    forms: list[Element] = []
    remarks: Remarks = {}
    for child in elements:
        if isinstance(child, str) and child.startswith("<!--"):
            remarks.setdefault(len(forms), []).append(child)
        elif isinstance(child, str):
            forms += _parsed(child)
        else:
            hints = mechanism.stereotypes.get(child.owner, ()) if child.owner else ()
            forms.append(_form(child, hints[0] if hints else ""))
    return forms, remarks


def _form(tag: Tag, hint: str) -> Element:
    """A tag with everything in it. URDF's own tags are a few levels deep; foreign text is parsed without recursion."""
    made = _Open(tag.name, tuple(tag.attributes.items()), hint)
    for child in tag.children:
        made.kids += _parsed(child) if isinstance(child, str) else [_form(child, "")]
    return made.closed()


def _parsed(text: str) -> list[Element]:
    """Ready text as forms: an element with what is in it, words, or nothing for a comment."""
    if not text.startswith("<"):
        return _words(unescaped(text))
    return _Reader(text).root.kids


def _words(text: str) -> list[Element]:
    return [Element(TEXT, (("", text.strip()),))] if text.strip() else []


class _Reader:
    """Reads one element; names keep their prefixes, as the root declares those."""

    def __init__(self, text: str) -> None:
        self.root = _Open("", ())
        self._stack = [self.root]
        self._said: list[str] = []
        parser = expat.ParserCreate()
        parser.ordered_attributes = True
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        parser.CharacterDataHandler = self._said.append
        parser.ProcessingInstructionHandler = self._instruction
        parser.CommentHandler = self._comment
        parser.Parse(text, True)

    def _start(self, tag: str, attributes: list[str]) -> None:
        self._flush()
        leaves = tuple(zip(attributes[::2], attributes[1::2], strict=True))
        self._stack.append(_Open(tag, tuple(leaf for leaf in leaves if not leaf[0].startswith(PREFIX))))

    def _end(self, tag: str) -> None:
        self._flush()
        done = self._stack.pop().closed()
        if not tag.startswith(PREFIX):  # xacro would take it for its own; the ledger lists it
            self._stack[-1].kids.append(done)

    def _instruction(self, target: str, words: str) -> None:
        self._flush()
        self._stack[-1].kids.append(Element(INSTRUCTION, (("", f"{target} {words}"),)))

    def _comment(self, words: str) -> None:
        self._flush()
        self._stack[-1].kids.append(Element(f"<!--{words}-->"))

    def _flush(self) -> None:
        self._stack[-1].kids += _words("".join(self._said))
        self._said.clear()
