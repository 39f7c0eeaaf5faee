"""The values of a loss as numbers, and by how much they differ."""

from __future__ import annotations

import math
import re
from ast import literal_eval
from typing import TYPE_CHECKING

from hymeko_x.compare.extras import format_of
from hymeko_x.ir.values import rotation_angle

if TYPE_CHECKING:
    from hymeko_x.compare.ledger import Loss

Value = str | bool | float | list[float] | None

_WORDS: dict[str, Value] = {"none": None, "True": True, "False": False}
_NUMBER = re.compile(r"-?(?:\d+\.?\d*(?:e[-+]?\d+)?|inf)|nan", re.IGNORECASE)


def values_of(loss: Loss) -> tuple[Value, Value]:
    """Before and after: a number, a list of numbers, a text; None where there is nothing."""
    if is_extra(loss):
        return loss.before, loss.after
    return _value(loss.before), _value(loss.after)


def _value(text: str | None) -> Value:
    """A value of how a difference shows it."""
    if text is None or text in _WORDS:
        return _WORDS.get(text or "none")
    if _NUMBER.fullmatch(text):
        return float(text)
    if text.startswith("[") and text.endswith("]"):
        words = text[1:-1].split()
        return [float(word) for word in words] if all(map(_NUMBER.fullmatch, words)) else text
    return str(literal_eval(text)) if _is_quoted(text) else text


def _is_quoted(text: str) -> bool:
    """Whether it is a text in quotes, as ``repr`` writes them."""
    return len(text) > 1 and text[0] == text[-1] and text[0] in "'\"" and text.count(text[0]) == 2 + text.count(f"\\{text[0]}")


def error_of(loss: Loss) -> float | None:
    """By how much a number is off, in the loss's unit: the largest part of a vector, the angle of a rotation; None for no numbers."""
    before, after = values_of(loss)
    if isinstance(before, float) and isinstance(after, float):
        return abs(after - before)
    if not isinstance(before, list) or not isinstance(after, list) or len(before) != len(after) or not before:
        return None
    if loss.field.endswith(".rotation") and len(before) == 4:
        return rotation_angle((before[0], before[1], before[2], before[3]), (after[0], after[1], after[2], after[3]))
    return max(abs(y - x) for x, y in zip(before, after, strict=True))


def size_of(loss: Loss) -> float | None:
    """The size of the number that was there: the largest part of a vector; None where it is no number."""
    before = values_of(loss)[0]
    numbers = [before] if isinstance(before, float) else before if isinstance(before, list) else []
    found = [abs(number) for number in numbers if math.isfinite(number)]
    return max(found, default=None)


def is_extra(loss: Loss) -> bool:
    """Whether it is an extra, whose field begins with the name of its format."""
    return loss.field.startswith("comment ") or format_of(loss.field) is not None
