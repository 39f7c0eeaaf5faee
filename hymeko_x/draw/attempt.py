"""Drawing where it is possible, for pages that are worth something without pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from hymeko_x import codes
from hymeko_x.diagnostics import Refusal
from hymeko_x.extras import missing_library

if TYPE_CHECKING:
    from collections.abc import Callable

T = TypeVar("T")

_NOT_DRAWN = frozenset({codes.CANNOT_DRAW, codes.NOTHING_TO_DRAW, codes.ENGINE_REFUSED})
"""This machine cannot draw, or the robot cannot be drawn."""


def attempt(draw: Callable[[], T]) -> tuple[T | None, str]:
    """What was drawn; or nothing, and why: no library, no way to draw on this machine, or nothing to see."""
    try:
        return draw(), ""
    except ModuleNotFoundError as error:
        refusal = missing_library(error)
        if refusal is None:
            raise
    except Refusal as refused:
        if refused.diagnostic.code not in _NOT_DRAWN:
            raise
        refusal = refused
    found = refusal.diagnostic
    return None, f"{found.code.id}: {found.message}{f' ({found.hint})' if found.hint else ''}"
