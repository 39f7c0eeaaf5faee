"""Numbers that are computed, as a person would write them: the shortest decimal of the same quantity to rounding.

Numbers that an author wrote are not touched: what is computed from them - a rotation from angles, a tensor in other axes, the pose
of what was joined - has noise in its last digits, which means nothing and is hard to read.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

PRECISION = 1e-15
"""How far a computed number may be moved, relative to the largest of those that make one quantity."""

_QUAT_DECIMALS = 15  # moves a component by half of PRECISION at most, so that the norm stays 1 to rounding
_HALF_ROOT = math.sqrt(0.5)


def shortest(value: float) -> float:
    """The number of the fewest decimals that differs by at most 1e-15 of itself."""
    return shortest_of((value,))[0]


def shortest_of(values: Iterable[float], least: float = 0.0) -> tuple[float, ...]:
    """The components of one quantity, each the shortest decimal relative to the largest of them, or to ``least`` if that is larger."""
    found = tuple(values)
    scale = max([*map(abs, found), least])
    if not 1e-290 < scale < 1e290:  # rounding needs room; also infinity and what is not a number
        return found
    room = PRECISION * scale
    decimals = math.ceil(-math.log10(2.0 * room))
    return tuple([_rounded(value, room, decimals) for value in found])


def _rounded(value: float, room: float, decimals: int) -> float:
    """The shorter one of two roundings that differ by at most ``room``."""
    if abs(value) <= room:
        return 0.0
    shorter = round(value, decimals - 1)
    return shorter if abs(shorter - value) <= room else round(value, decimals)


def clean_vector(vector: tuple[float, float, float]) -> tuple[float, float, float]:
    """A computed place in m or direction without noise: the components relative to the largest of them, to 1 at least."""
    x, y, z = shortest_of(vector, 1.0)
    return x, y, z


def clean_angles(angles: Iterable[float]) -> tuple[float, ...]:
    """Computed angles of a rotation in rad without noise: quarter and half turns are the doubles nearest to them, as programs write them.

    Half a turn is the same in both directions, and is positive.
    """
    return tuple([_angle(value) for value in shortest_of(angles, 1.0)])


def _angle(value: float) -> float:
    if abs(abs(value) - math.pi) < PRECISION * math.pi:
        return math.pi
    if abs(abs(value) - math.pi / 2.0) < PRECISION:
        return math.copysign(math.pi / 2.0, value)
    return value + 0.0


def clean_quat(quat: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    """A computed unit quaternion without noise: sqrt(1/2) is the double nearest to it, every other component has 15 decimals."""
    w, x, y, z = quat
    norm = math.hypot(w, x, y, z)
    return (_component(w / norm), _component(x / norm), _component(y / norm), _component(z / norm))


def _component(value: float) -> float:
    if abs(value) <= PRECISION:
        return 0.0
    if abs(abs(value) - _HALF_ROOT) < PRECISION:
        return math.copysign(_HALF_ROOT, value)
    return round(value, _QUAT_DECIMALS)
