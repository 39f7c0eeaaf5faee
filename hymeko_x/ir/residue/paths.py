"""The fields of parts by path: what differs, getting, putting, and digests of values."""

from __future__ import annotations

import math
from dataclasses import MISSING, fields, is_dataclass, replace
from enum import Enum
from functools import cache
from hashlib import blake2b
from typing import TYPE_CHECKING, Any, NamedTuple

from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.values import Pose

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.ir.residue import Path

TURN = "turn"
"""The last step to a pose's rotation: its quaternion together with the notation that it was written in."""


class Attribute(NamedTuple):
    """A field of a part."""

    name: str
    default: object
    compare: bool


def attributes_of(part: object) -> tuple[Attribute, ...]:
    """The fields of a part, with their defaults (MISSING for those that have none)."""
    kind: Any = type(part)
    return _attributes(kind)


@cache
def _attributes(kind: Any) -> tuple[Attribute, ...]:
    return tuple(Attribute(f.name, f.default, f.compare) for f in fields(kind))


def identical(a: object, b: object) -> bool:
    """Whether two values are the same to the last bit, notations and the sign of zero included."""
    if a is b:
        return True
    if isinstance(a, float | int) and isinstance(b, float | int):
        return (a == b and math.copysign(1.0, a) == math.copysign(1.0, b)) or (a != a and b != b)
    if isinstance(a, str) or type(a) is not type(b):
        return a == b
    if isinstance(a, tuple):
        assert isinstance(b, tuple)
        return len(a) == len(b) and all(identical(x, y) for x, y in zip(a, b, strict=True))
    if is_dataclass(a):
        return all(identical(getattr(a, f.name), getattr(b, f.name)) for f in attributes_of(a))
    return a == b


def differing(image: object, source: object, path: Path = (), default: object = MISSING) -> Iterator[tuple[Path, object, str]]:
    """The path, the source's value and the guard of every field in which two parts differ. Depth is that of the parts."""
    if identical(image, source):
        return
    if isinstance(image, Pose) and isinstance(source, Pose):
        if not identical(image.xyz, source.xyz):
            yield (*path, "xyz"), source.xyz, digest(image.xyz)
        if not identical(turn_of(image), turn_of(source)):
            yield (*path, TURN), turn_of(source), digest(image.quat)
    elif is_dataclass(image) and type(image) is type(source):
        for item in attributes_of(image):
            yield from differing(getattr(image, item.name), getattr(source, item.name), (*path, item.name), item.default)
    elif _are_alike(image, source):
        for place, (before, after) in enumerate(zip(image, source, strict=True)):  # type: ignore[call-overload]
            yield from differing(before, after, (*path, place))
    else:
        yield path, source, guard_of(image, default)


def _are_alike(a: object, b: object) -> bool:
    """Whether two tuples hold parts of the same types, so that they can be compared part by part."""
    if not isinstance(a, tuple) or not isinstance(b, tuple) or isinstance(a, Id) or len(a) != len(b):
        return False
    return all(is_dataclass(x) and type(x) is type(y) for x, y in zip(a, b, strict=True))


def turn_of(pose: Pose) -> tuple[object, object]:
    """The rotation with its notation."""
    return pose.quat, pose.written


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
    """The default of the field at a path; MISSING where it has none."""
    *above, last = path
    owner = get(part, tuple(above))
    if isinstance(owner, Pose) or not is_dataclass(owner):
        return MISSING
    return next((item.default for item in attributes_of(owner) if item.name == last), MISSING)


_LONG = 64
"""Tuples with more items are points and faces of meshes: plain numbers, and many."""


# ---- digests -----------------------------------------------------------------------------------------------------------


def guard_of(value: object, default: object = MISSING) -> str:
    """The digest of a value; empty for the default, which is what a format says that has no word for a field."""
    return "" if default is not MISSING and value == default else digest(value)


def digest(*values: object) -> str:
    """Six letters and digits, the first a letter, that tell one value from another. Notations do not count."""
    number = int.from_bytes(blake2b("\0".join(map(_canonical, values)).encode("utf-8", "surrogatepass"), digest_size=5).digest())
    return chr(97 + number % 26) + _base36(number // 26)


def _base36(number: int) -> str:
    digits = ""
    for _ in range(6):
        number, rest = divmod(number, 36)
        digits += "0123456789abcdefghijklmnopqrstuvwxyz"[rest]
    return digits


def _canonical(value: object) -> str:
    """A text that is equal exactly for equal values."""
    if isinstance(value, bool) or value is None:
        return str(value)
    if isinstance(value, float | int):
        return repr(float(value) + 0.0)
    if isinstance(value, Enum):
        return str(value.value)
    if isinstance(value, str):
        return repr(value)
    if isinstance(value, tuple):
        return _array(value) if len(value) > _LONG and isinstance(value[0], float | int) else f"({','.join(map(_canonical, value))})"
    inner = (_canonical(getattr(value, item.name)) for item in attributes_of(value) if item.compare)
    return f"{type(value).__name__}({','.join(inner)})"


def _array(numbers: tuple[float, ...]) -> str:
    """Many numbers at once; adding zero makes its two signs one."""
    import numpy as np

    return blake2b((np.fromiter(numbers, np.float64, len(numbers)) + 0.0).tobytes(), digest_size=16).hexdigest()
