"""The tags of the URDF backend as forms, the comments between them, and the costs of xacro's text for factoring them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING
from xml.parsers import expat

from hymeko_x.backends.xacro.spelling import CONSTANTS
from hymeko_x.factor.forms import Dialect, FormElement
from hymeko_x.formats.xacro import PREFIX, TAKEN, survives
from hymeko_x.xml.text import unescaped

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.xml.printing import Tag

TEXT = "#text"
INSTRUCTION = "#instruction"
"""Tags of texts and processing instructions. The text of an element without children is its leaf without a name.

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
        self.kids: list[FormElement] = []
        self.hint = hint

    def closed(self) -> FormElement:
        kids = self.kids
        if len(kids) == 1 and kids[0].tag == TEXT:
            return FormElement(self.tag, (*self.leaves, ("", kids[0].leaves[0][1])), (), self.hint)
        return FormElement(self.tag, self.leaves, tuple(kids), self.hint)


def top_level(elements: Iterable[Tag | str], mechanism: Mechanism) -> tuple[list[FormElement], Remarks]:
    """The content of the root element: forms, and the comments before each of them."""
    forms: list[FormElement] = []
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


def _form(tag: Tag, hint: str) -> FormElement:
    """A tag with everything in it. URDF's own tags are a few levels deep; foreign text is parsed without recursion."""
    made = _Open(tag.name, tuple([(name, _as_xacro_prints(name, text)) for name, text in tag.attributes.items()]), hint)
    for child in tag.children:
        made.kids += _parsed(child) if isinstance(child, str) else [_form(child, "")]
    return made.closed()


_WORDS = frozenset(("name", "link", "joint", "filename"))
_SMALL = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?e-)([1-9])(?!\S)")


def _as_xacro_prints(name: str, text: str) -> str:
    """A text with its small numbers as Python prints them (``2e-06``): parameters with other texts would have to be quoted."""
    return text if name in _WORDS or "e-" not in text else _SMALL.sub(r"\g<1>0\2", text)


def _parsed(text: str) -> list[FormElement]:
    """Ready text as forms: an element with what is in it, words, or nothing for a comment."""
    if not text.startswith("<"):
        return _words(unescaped(text))
    return _Reader(text).root.kids


def _words(text: str) -> list[FormElement]:
    return [FormElement(TEXT, (("", text.strip()),))] if text.strip() else []


class _Reader:
    """Reads one element; names keep their prefixes, as the root declares those."""

    def __init__(self, text: str) -> None:
        self.root = _Open("", ())
        self._stack = [self.root]
        self._texts: list[str] = []
        parser = expat.ParserCreate()
        parser.ordered_attributes = True
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        parser.CharacterDataHandler = self._texts.append
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
        self._stack[-1].kids.append(FormElement(INSTRUCTION, (("", f"{target} {words}"),)))

    def _comment(self, words: str) -> None:
        self._flush()
        self._stack[-1].kids.append(FormElement(f"<!--{words}-->"))

    def _flush(self) -> None:
        self._stack[-1].kids += _words("".join(self._texts))
        self._texts.clear()


# ---- costs --------------------------------------------------------------------------------------------------------------------


def can_be_default(text: str) -> bool:
    """Whether a text can stand as the default of a parameter."""
    return not set(text) & set("'\"$\n\r\t")


def can_be_value(text: str) -> bool:
    """Whether a text can be that of a property, which xacro evaluates again wherever it is used; ``${pi/2}`` is its own name."""
    return survives(text) and not set(text) & set("'\"$\n\r\t") and text.removeprefix("-") not in CONSTANTS


_LEAVES = {"xyz": "xyz", "rpy": "rpy", "value": "", "name": "", "link": "", "rgba": "rgba", "filename": "mesh"}


def _leaf_name(tag: str, leaf: str) -> str:
    return tag if (tag, leaf) == ("axis", "xyz") else _LEAVES.get(leaf, leaf) or tag


FRAGMENTS = frozenset(("origin", "geometry", "mesh", "box", "cylinder", "sphere", "capsule", "material", "color", "texture"))
FRAGMENTS |= {"mass", "inertia", "parent", "child", "axis", "limit", "dynamics"}
"""Elements of which a macro is none that a person would make: it would be a part of a visual, an inertial or a joint."""

DIALECT = Dialect(
    element=len("</>"),
    block=len("<></>") - len("</>"),
    closes_by_tag=True,
    leaf=len('=""'),
    macro=len('<xacro:macroname=""params=""></xacro:macro>'),
    parameter=0,
    default=len(":="),
    call=len("<xacro:/>"),
    argument=len('=""'),
    hole=len("${}"),
    value=len('<xacro:propertyname=""value=""/>'),
    leaf_name=_leaf_name,
    taken=TAKEN,
    can_be_default=can_be_default,
    values=True,
    can_be_value=can_be_value,
    without_default=frozenset(("name", "prefix", "suffix", "part", "parent", "child")),
    fragments=FRAGMENTS,
    components={"xyz": ("x", "y", "z"), "rpy": ("roll", "pitch", "yaw")},
)
