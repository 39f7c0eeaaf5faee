"""The fields of parts by path: getting, putting, and digests of values."""

from __future__ import annotations

from enum import Enum
from functools import lru_cache
from hashlib import blake2b
from typing import TYPE_CHECKING, Any

from msgspec import NODEFAULT, Struct
from msgspec.structs import replace

from hymeko_x.compare.leaves import TURN, turn_of
from hymeko_x.ir.fields import NUMBERS, attributes_of, layout_of
from hymeko_x.ir.values import Pose, are_numbers, shortest_texts

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.compare.leaves import Path


def get(part: object, path: Path) -> object:
    """The value at a path.

    Raises: LookupError when the part has no such place.
    """
    for step in path:
        if isinstance(part, Pose) and step == TURN:
            return turn_of(part)
        try:
            part = part[step] if isinstance(step, int) else getattr(part, step)  # type: ignore[index]
        except (AttributeError, TypeError) as error:
            raise LookupError(step) from error
    return part


def put(part: Any, path: Path, value: object) -> Any:
    """The part with another value at a path.

    Raises: LookupError when the part has no such place.
    """
    if not path:
        return value
    step, rest = path[0], path[1:]
    if isinstance(step, int):
        return (*part[:step], put(get(part, (step,)), rest, value), *part[step + 1 :])
    if isinstance(part, Pose) and step == TURN:
        turn: Any = value
        return replace(part, quat=turn[0], written=turn[1])
    return replace(part, **{step: put(get(part, (step,)), rest, value)})


def default_at(part: object, path: Path) -> object:
    """The default of the field at a path; NODEFAULT where it has none."""
    *above, last = path
    owner = get(part, tuple(above))
    if isinstance(owner, Pose) or not isinstance(owner, Struct):
        return NODEFAULT
    return next((item.default for item in attributes_of(owner) if item.name == last), NODEFAULT)


_LONG = 64
"""Tuples with more items are points and faces of meshes: plain numbers, and many."""


# ---- digests -----------------------------------------------------------------------------------------------------------


def guard_of(value: object, default: object = NODEFAULT) -> str:
    """The digest of a value; empty for the default, which is what a format says that has no word for a field."""
    return "" if default is not NODEFAULT and value == default else digest(value)


_DIGITS = "0123456789abcdefghijklmnopqrstuvwxyz"
_LETTERS = _DIGITS[10:]
_PAIRS = tuple(second + first for first in _DIGITS for second in _DIGITS)
"""The texts of the numbers below 36 * 36, lowest digit first."""
_HASH = blake2b(digest_size=5)
"""To be copied, which is quicker than making one."""


def digest(*values: object) -> str:
    """Six letters and digits, the first a letter, that tell one value from another. Notations do not count."""
    return digest_of_texts(map(canonical, values))


def digest_of_texts(texts: Iterable[str]) -> str:
    """The digest of values whose canonical texts these are."""
    hashed = _HASH.copy()
    hashed.update("\0".join(texts).encode("utf-8", "surrogatepass"))
    number, letter = divmod(int.from_bytes(hashed.digest()), 26)
    number, first = divmod(number, 1296)
    third, second = divmod(number, 1296)
    return f"{_LETTERS[letter]}{_PAIRS[first]}{_PAIRS[second]}{_PAIRS[third % 1296]}"


def canonical(value: object) -> str:
    """A text that is equal exactly for equal values; notations do not count, nor does the sign of zero."""
    kind = type(value)
    if kind is float:
        return repr(value) if value else "0.0"
    if isinstance(value, tuple):
        if len(value) > _LONG and isinstance(value[0], NUMBERS):
            return _array(value)
        return f"({_numbers(value) if are_numbers(value) else _joined(value)})"
    if kind is Pose:
        return f"Pose(({_numbers(value.xyz)}),({_numbers(value.quat)}))"  # type: ignore[attr-defined]
    layout = layout_of(kind)
    if layout is not None:
        return f"{kind.__name__}({_joined(layout.compared(value))})"
    if kind is str:
        return repr(value)
    if isinstance(value, Enum):
        return str(value._value_)
    if isinstance(value, bool) or value is None:
        return str(value)
    if isinstance(value, float | int):
        return repr(float(value) + 0.0)
    return repr(value)


def canonical_without_name(part: object) -> str:
    """The same for a part that goes by no name."""
    layout = layout_of(type(part))
    assert layout is not None
    values = [None if item.name == "name" else value for item, value in zip(layout.counting, layout.compared(part), strict=True)]
    return f"{type(part).__name__}({_joined(values)})"


@lru_cache(1024)
def _numbers(values: tuple[float, ...]) -> str:
    """The same for numbers and nothing else, of which axes and places without a distance or a turn come again and again."""
    text = shortest_texts(values)
    return f"{text},".replace("-0.0,", "0.0,")[:-1] if "-0.0" in text else text


def _joined(values: Iterable[object]) -> str:
    """Most are numbers, of which most are zero, or nothing."""
    return ",".join(
        [(repr(value) if value else "0.0") if type(value) is float else "None" if value is None else canonical(value) for value in values]
    )


def _array(numbers: tuple[float, ...]) -> str:
    """Many numbers at once; adding zero makes its two signs one."""
    import numpy as np

    return blake2b((np.fromiter(numbers, np.float64, len(numbers)) + 0.0).tobytes(), digest_size=16).hexdigest()
