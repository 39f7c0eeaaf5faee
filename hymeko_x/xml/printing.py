"""Printing XML: small tags that a backend fills, foreign text put back where it stood, and the text of it all.

Shared by the backends of all XML formats.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import Refusal, refuse
from hymeko_x.xml.tree import COMMENT, FOLLOWING, PRECEDING

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from hymeko_x.ir.mechanism import Extra, Id

_INDENT = "  "
_NAME = r"[^\W\d][\w.-]*(?::[^\W\d][\w.-]*)?"
_STEP = re.compile(rf"{_NAME}(?:\[[1-9]\d*\])?|@{_NAME}|text\(\)")
_SPACE = re.compile(r"xmlns(?::[^\W\d][\w.-]*)?")
_UNSAYABLE = re.compile(r"[\x00-\x08\x0b-\x1f\ud800-\udfff\ufffe\uffff]")
_SPECIAL = re.compile(r'[&<>"\x00-\x1f\ud800-\udfff\ufffe\uffff]')
_SPECIAL_BUT_QUOTE = re.compile(r"[&<>\x00-\x1f\ud800-\udfff\ufffe\uffff]")
_ESCAPES = (("&", "&amp;"), ("<", "&lt;"), (">", "&gt;"), ('"', "&quot;"), ("\n", "&#10;"), ("\r", "&#13;"), ("\t", "&#9;"))
_IMPOSSIBLE = re.compile(r"[\x00-\x1f\ud800-\udfff\ufffe\uffff]")


class Tag:
    """An XML element to be: name, attributes in order, and children that are tags or ready text; whose it is, if known."""

    __slots__ = ("attributes", "children", "name", "owner")

    def __init__(self, name: str, attributes: dict[str, str], children: Iterable[Tag | str] = ()) -> None:
        self.name = name
        self.attributes = attributes
        self.children = [*children]
        self.owner: Id | None = None

    def add(self, name: str, /, **attributes: str) -> Tag:
        """A new child with these attributes."""
        child = Tag(name, attributes)
        self.children.append(child)
        return child

    def child(self, step: str) -> Tag:
        """The child that a path's step (``joint``, ``joint[2]``) leads to; made when it is not there."""
        name, _, number = step.partition("[")
        wanted = int(number.rstrip("]")) if number else 1
        found = [child for child in self.children if isinstance(child, Tag) and child.name == name]
        return found[wanted - 1] if wanted <= len(found) else self.add(name)


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
    """The text of an extra that is an element, a comment or an instruction, without what ``declared`` says already.

    Raises: Refusal with HX062 when it is not well-formed.
    """
    if extra.format == COMMENT:
        return comment_markup(extra.text)
    from lxml import etree

    if extra.path in (PRECEDING, FOLLOWING) and not extra.text.startswith("<?"):
        raise _not_xml(extra, "outside the root there are only comments and instructions")
    spaces = attributes_text({name: uri for name, uri in declared.items() if _SPACE.fullmatch(name)})
    parser = etree.XMLParser(resolve_entities=False, no_network=True, huge_tree=True)
    try:
        found = list(etree.fromstring(f"<x{spaces}>{extra.text}</x>".encode(), parser))
    except (etree.XMLSyntaxError, UnicodeEncodeError) as error:
        raise _not_xml(extra, str(error)) from error
    if len(found) != 1 or not extra.text.startswith("<") or (found[0].tail or "").strip():
        raise _not_xml(extra, "it is not one element")
    return without_declared(extra.text, declared)


def comment_markup(text: str) -> str:
    """A comment of whatever format as an XML comment, in which ``--`` is not allowed."""
    while "--" in text:
        text = text.replace("--", "- -")
    return f"<!-- {_UNSAYABLE.sub(chr(0xFFFD), text)} -->"


def _not_xml(extra: Extra, why: str) -> Refusal:
    text = extra.text if len(extra.text) < 60 else extra.text[:60] + "..."
    return refuse(codes.BAD_VALUE, f"the {extra.format} extra '{text}' cannot be written into XML: {why}")


def _place_for(extra: Extra, tag: Tag) -> int:
    """Where a foreign element goes: to its place, but never before a child of its own name, which is the one that counts."""
    name = re.match(r"<([^\s/>]+)", extra.text)
    same = [place for place, child in enumerate(tag.children) if name and isinstance(child, Tag) and child.name == name[1]]
    return max(extra.index, same[-1] + 1) if same else extra.index


def without_declared(text: str, declared: Mapping[str, str]) -> str:
    """An element's text without the namespace declarations (attribute -> uri) right behind its name that stand further up already."""
    name = re.match(r"<[^\s/>]+", text)
    if name is None:
        return text
    rest = text[name.end() :]
    known = [f' {attribute}="{escaped(uri)}"' for attribute, uri in declared.items()]
    while (said := next((words for words in known if rest.startswith(words)), None)) is not None:
        rest = rest.removeprefix(said)
    return name[0] + rest


def render(tag: Tag, depth: int = 0) -> list[str]:
    """The lines of a tag, two blanks per level. Foreign text keeps its own inner indentation."""
    lines: list[str] = []
    _render(tag, _INDENT * depth, lines)
    return lines


def ready(tag: Tag, depth: int) -> str:
    """A tag as ready text for another tag at this depth: its lines, of which the first one is not indented."""
    return "\n".join(render(tag, depth))[len(_INDENT) * depth :]


def _render(tag: Tag, indent: str, lines: list[str]) -> None:
    name, children = tag.name, tag.children
    start = f"{indent}<{name}{attributes_text(tag.attributes)}"
    if not children:
        lines.append(start + "/>")
        return
    first = children[0]
    if len(children) == 1 and isinstance(first, str) and not first.startswith("<"):
        lines.append(f"{start}>{first}</{name}>")
        return
    lines.append(start + ">")
    inner = indent + _INDENT
    for child in children:
        if isinstance(child, str):
            lines.append(inner + child)
        elif child.children:
            _render(child, inner, lines)
        else:
            lines.append(f"{inner}<{child.name}{attributes_text(child.attributes)}/>")
    lines.append(f"{indent}</{name}>")


def attributes_text(attributes: dict[str, str]) -> str:
    """Attributes as they stand in a start tag, each with a blank before it."""
    text = "".join([f' {name}="{value}"' for name, value in attributes.items()])
    if _SPECIAL_BUT_QUOTE.search(text) is None and text.count('"') == 2 * len(attributes):
        return text
    return "".join([f' {name}="{escaped(value)}"' for name, value in attributes.items()])


def is_name(text: str) -> bool:
    """Whether a text can be the name of an element."""
    return re.fullmatch(_NAME, text) is not None


def escaped(text: str) -> str:
    """A text for an attribute or an element; every character that XML can hold reads back as it was, others are U+FFFD."""
    if _SPECIAL.search(text) is None:
        return text
    for character, entity in _ESCAPES:
        text = text.replace(character, entity)
    return text if text.isprintable() else _IMPOSSIBLE.sub("\ufffd", text)
