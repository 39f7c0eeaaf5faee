"""The outline of a HyMeKo text, without those that it imports."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.language.outline import STYLE, block_of
from hymeko_x.language.parser import parse
from hymeko_x.language.templates import decode
from hymeko_x.outline import Outline, TextFile

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.source import Source


def outline(source: Source, report: Report) -> Outline:
    """Where everything stands in a HyMeKo text. Raises: Refusal (HX060) when it is none."""
    text = decode(source.data, source.name)
    parse(text, source.name)
    return Outline(block_of(text, source.name), {source.name: TextFile(source.name, text.encode())}, source.name, STYLE)
