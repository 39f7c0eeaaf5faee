"""Text in XML and out of it. The standard library's own module for this loads half of its network code."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping


def escape(text: str) -> str:
    """A text as the content of an element."""
    return text.replace("&", "&amp;").replace(">", "&gt;").replace("<", "&lt;")


def quoted(text: str, entities: Mapping[str, str]) -> str:
    """A text as the value of an attribute, in the quotes that it needs; ``entities`` are more characters to escape."""
    text = escape(text)
    for character, entity in entities.items():
        text = text.replace(character, entity)
    if '"' not in text:
        return f'"{text}"'
    return f"'{text}'" if "'" not in text else '"' + text.replace('"', "&quot;") + '"'


def unescape(text: str, entities: Mapping[str, str] | None = None) -> str:
    """The text that :func:`escape` was given; ``entities`` are more of them, with what they stand for."""
    text = text.replace("&lt;", "<").replace("&gt;", ">")
    for entity, character in (entities or {}).items():
        text = text.replace(entity, character)
    return text.replace("&amp;", "&")
