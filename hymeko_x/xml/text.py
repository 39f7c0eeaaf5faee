"""Text in XML and out of it: the one escaper. The standard library's own module for this loads half of its network code."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING
from xml.parsers import expat

if TYPE_CHECKING:
    from collections.abc import Mapping

NAME = r"[^\W\d][\w.-]*(?::[^\W\d][\w.-]*)?"
"""The pattern of the name of an element or an attribute, with or without a prefix."""

_MARKUP = (("&", "&amp;"), ("<", "&lt;"), (">", "&gt;"))
_QUOTED = (('"', "&quot;"), ("\n", "&#10;"), ("\r", "&#13;"), ("\t", "&#9;"))
_SPECIAL = re.compile(r'[&<>"\x00-\x1f\ud800-\udfff\ufffe\uffff]')
_IMPOSSIBLE = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")
_IMPOSSIBLE_IN_COMMENT = re.compile(r"[\x00-\x08\x0b-\x1f\ud800-\udfff\ufffe\uffff]")
_HYPHENS = re.compile("--+")


def escaped(text: str) -> str:
    """A text for an attribute or an element; every character that XML can represent reads back as it was, others are U+FFFD."""
    if _SPECIAL.search(text) is None:
        return text
    for character, entity in (*_MARKUP, *_QUOTED):
        text = text.replace(character, entity)
    return _IMPOSSIBLE.sub("\ufffd", text)


def escaped_lines(text: str) -> str:
    """A long text for an element: only markup is escaped, so that its lines and quotes remain readable."""
    for character, entity in _MARKUP:
        text = text.replace(character, entity)
    return text


def unescaped(text: str) -> str:
    """The text that :func:`escaped` or :func:`escaped_lines` was given."""
    if "&" not in text:
        return text
    for character, entity in reversed((*_MARKUP, *_QUOTED)):
        text = text.replace(entity, character)
    return text


def attributes_text(attributes: Mapping[str, str | None]) -> str:
    """Attributes as they stand in a start tag, each with a blank before it; None is not written."""
    if not attributes:
        return ""
    parts = [f' {name}="{value}"' for name, value in attributes.items() if value is not None]
    text = "".join(parts)
    if text.isprintable() and not ("&" in text or "<" in text or ">" in text) and text.count('"') == 2 * len(parts):
        return text
    return "".join([f' {name}="{escaped(value)}"' for name, value in attributes.items() if value is not None])


def comment_markup(text: str) -> str:
    """A comment of whatever format as an XML comment."""
    return f"<!-- {_IMPOSSIBLE_IN_COMMENT.sub(chr(0xFFFD), without_hyphens_in_a_row(text))} -->"


def without_hyphens_in_a_row(text: str) -> str:
    """The text of a comment without ``--``, which XML does not allow: two get a blank between them, a line of them is one of ``=``."""
    return text if "--" not in text else _HYPHENS.sub(lambda found: "- -" if found[0] == "--" else "=" * len(found[0]), text)


def is_name(text: str) -> bool:
    """Whether a text can be the name of an element, also for expat, which knows fewer letters than Python."""
    if re.fullmatch(NAME, text) is None:
        return False
    try:
        expat.ParserCreate().Parse(f"<{text}/>", True)
    except expat.ExpatError:
        return False
    return True


_LONGEST_PART = 5_000_000
"""Some readers of XML stop at ten million characters in one text."""


def parts_of_text(text: str) -> list[str]:
    """A long text in pieces that every reader accepts."""
    return [text[start : start + _LONGEST_PART] for start in range(0, len(text), _LONGEST_PART)]
