"""What an extra is apart from its layout, and which extras two elements do not share."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import formats

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterable, Sequence

    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Extra

    Identity = Callable[[Extra], Hashable]
    Known = Iterable[tuple[Hashable, Extra]]


def format_of(field: str) -> Format | None:
    """The format of the extra in a difference, whose field begins with its name (``usd content``); None where it is no extra of one."""
    name, blank, _ = field.partition(" ")
    return next((row for row in formats.FORMATS if row.name == name), None) if blank else None


def essence_of(extra: Extra) -> Extra:
    """An extra that is an XML element without its comments, the blanks between its elements and the order of its attributes."""
    if not extra.text.startswith("<"):
        return extra
    from xml.etree.ElementTree import ParseError, canonicalize  # with the standard library's network code

    try:
        return replace(extra, text=canonicalize(extra.text, strip_text=True))
    except ParseError:
        return extra


def as_written(extra: Extra) -> Hashable:
    """An extra with its text as it stands, wherever it stands among others."""
    return extra.format, extra.path, extra.text


def as_meant(extra: Extra) -> Hashable:
    """An extra with its essence, wherever it stands among others."""
    return as_written(essence_of(extra))


def unshared(mine: Sequence[Extra], theirs: Sequence[Extra], *identities: Identity) -> tuple[list[Extra], list[Extra]]:
    """The extras of each that the other does not have, as multisets, in their order. Linear.

    Two are the same by the first of ``identities``; what that leaves of both sides, by the next one.
    """
    a, b = list(mine), list(theirs)
    for identity in identities:
        if {_place(extra) for extra in a}.isdisjoint(map(_place, b)):
            break
        known, others = ([(identity(extra), extra) for extra in extras] for extras in (a, b))
        both = Counter(key for key, _ in known) & Counter(key for key, _ in others)
        a, b = _without(known, both.copy()), _without(others, both)
    return a, b


def _place(extra: Extra) -> Hashable:
    """What the extras of equal identity have in common: where a format has them."""
    return extra.format, extra.path


def _without(extras: Known, shared: Counter[Hashable]) -> list[Extra]:
    """The extras beyond the shared ones, which are counted down."""
    left = []
    for key, extra in extras:
        shared[key] -= 1
        if shared[key] < 0:
            left.append(extra)
    return left
