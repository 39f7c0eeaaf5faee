"""What other formats said of an element, as blocks of the language: the words that their reader and their writer share."""

from __future__ import annotations

import re

from hymeko_x import formats
from hymeko_x.language.markup import Spacing

PLACE = "place"
"""``place 3``: the number that the next child has among the children of its parent; those behind it count on."""
INDENT = "indent"
"""``indent [4 2]``: blanks before the closing tag of the children that follow, and more for every level; also as texts."""
ONE_LINE = "none"
"""``indent=none``: no white space between the tags."""

SECTION = re.compile(r"(?!preceding\b|following\b)\w+")
SECTION_COMMENT = re.compile(rf"\[({SECTION.pattern})\] (.+)", re.DOTALL)
"""A comment between the elements that stood in a section of its format: ``// [asset] meshes``."""

_NESTED = Spacing("    ", "  ")
_OUTER = Spacing("  ", "  ")


def usual_spacing(format: str, *, at_root: bool) -> Spacing | None:
    """The white space between the tags of a format's children that needs no word: of the whole, or of an element."""
    if any(row.name == format and row.has_compact_extras for row in formats.FORMATS):
        return None
    return _OUTER if at_root else _NESTED
