"""The line of a text that a message is about, with a caret below the place."""

from __future__ import annotations

import re
from dataclasses import replace

from hymeko_x.diagnostics import Refusal

_MAX_LINE = 160
_WORD = re.compile(r"@?\s*(?:`[^`]*`|[\w.]+)")


def with_excerpt(refusal: Refusal, text: str, name: str) -> Refusal:
    """The refusal with the line of the text that it is about, unless it shows one or is about another file."""
    said = refusal.diagnostic
    if said.excerpt or said.origin is None or said.origin.file != name or said.origin.line is None:
        return refusal
    line, column = said.origin.line, said.origin.column or 1
    word = _WORD.match(text.split("\n")[line - 1], column - 1)
    return Refusal(replace(said, excerpt=excerpt(text, line, column, len(word[0]) if word else 1)))


def excerpt(text: str, line: int, column: int, width: int) -> tuple[str, ...]:
    """The source line and a caret line below it; a long line is cut around the place."""
    source = text.split("\n")[line - 1].rstrip("\r").replace("\t", " ")
    start = max(0, column - 1 - _MAX_LINE // 2) if len(source) > _MAX_LINE else 0
    shown = source[start : start + _MAX_LINE]
    room = max(1, min(width, len(shown) - (column - 1 - start)))
    gutter = f"{line:>5}"
    return (f"{gutter} | {shown}", f"{' ' * len(gutter)} | {' ' * (column - 1 - start)}{'^' * room}")
