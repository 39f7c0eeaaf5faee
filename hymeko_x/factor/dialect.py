"""What factoring has to know of the text that it is done for."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from msgspec import Struct

if TYPE_CHECKING:
    from collections.abc import Callable

_PIECE = re.compile(r"(?<!\S)[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?(?!\S)|\s+|[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+|[^A-Za-z0-9\s]")


def words(text: str) -> tuple[str, ...]:
    """A text cut into numbers, words, digits behind words, and single separators: ``LF_hip2`` -> LF _ hip 2."""
    return tuple(_PIECE.findall(text))


def _leaf_name(tag: str, leaf: str) -> str:
    """What a parameter is called after the leaf whose text it is."""
    return tag if leaf in ("name", "value", "") else leaf


class Dialect(Struct, frozen=True):
    """What things cost in a backend's text, in characters without white space, and how things are called there.

    ``element`` is what stands around tag and leaves of a form (``</>``: 3), ``block`` what children add to that, the tag
    again where ``closes_by_tag``; ``leaf`` what stands around a leaf's name and text (``=""``: 3). ``macro``, ``parameter``,
    ``default``, ``call``, ``argument``, ``hole`` and ``value`` likewise: what stands around the names and texts of a definition, a
    parameter in it, a default, a call, an argument, the name in a hole, and the definition of a named value.

    ``least`` characters must a macro save to be worth its reader's while. ``cut`` cuts a text into the pieces that a hole
    may take; return ``(text,)`` where only the whole text can be one. ``leaf_name`` proposes a parameter's name from
    tag and leaf. ``taken`` are names that nothing may have. ``name`` is the leaf that names a form. ``can_be_default``
    says whether a text can be a default, ``signs`` whether the dialect can write a number with the sign of a parameter,
    ``values`` whether it has named values, and ``can_be_value`` which texts can be one.
    """

    element: int = 3
    block: int = 2
    closes_by_tag: bool = True
    leaf: int = 3
    macro: int = 45
    parameter: int = 0
    default: int = 2
    call: int = 9
    argument: int = 3
    hole: int = 3
    value: int = 33
    least: int = 40
    cut: Callable[[str], tuple[str, ...]] = words
    leaf_name: Callable[[str, str], str] = _leaf_name
    taken: frozenset[str] = frozenset()
    name: str = "name"
    can_be_default: Callable[[str], bool] = bool
    signs: bool = True
    values: bool = False
    can_be_value: Callable[[str], bool] = bool
