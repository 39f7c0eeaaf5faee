"""What an extra is apart from its layout."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Extra


def essence_of(extra: Extra) -> Extra:
    """An extra that is an XML element without its comments, the blanks between its elements and the order of its attributes."""
    if not extra.text.startswith("<"):
        return extra
    from xml.etree.ElementTree import ParseError, canonicalize  # with the standard library's network code

    try:
        return replace(extra, text=canonicalize(extra.text, strip_text=True))
    except ParseError:
        return extra
