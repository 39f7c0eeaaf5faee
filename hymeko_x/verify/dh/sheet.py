"""The table that a data sheet prints: signs and constants chosen so that theta has no offset wherever that is possible.

Between two axes the common normal may point either way: Rz(pi) L Rz(pi) is L with a, alpha and beta negated, so that turning
the normal round adds pi to the theta before it and to the theta behind it. Where an axis goes on in itself, the normal may point
anywhere. What is left of the first theta belongs to the base.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.verify.dh.lines import DhLink

if TYPE_CHECKING:
    from collections.abc import Sequence

_ZERO = 1e-9
"""Below this, in rad and m, a number is rounding."""

_SAME = 1e-11
"""Below this two axes are one, and what is moved along it makes no difference."""

Chain = tuple[list[DhLink], tuple[float, float]]
"""J_0 L_0 ... J_n L_n as links, and theta and d of J_n+1."""


def settled(links: Sequence[DhLink], last: tuple[float, float], *, sliding_end: bool = False) -> Chain:
    """The same chain with the fewest offsets of theta, then the plainest base and tip, then the first alpha that is not zero positive.

    J_1 has no theta: it is in ``theta`` of L_0 where axis 1 is the base's z axis, and otherwise the base has it, see :func:`turn_of_base`.
    Where the tip's z axis is the last axis, the tip's height is d of the last row, unless that slides.
    """
    choices = [_with_first_normal(links, last, is_turned=turned) for turned in (False, True)]
    found, (theta, d) = min(choices, key=_cost)
    end = found[-1]
    if _is_straight(end) and not sliding_end:
        found[-1] = replace(end, d=end.d + (d if abs(end.alpha) < 1 else -d))
        d = 0.0
    return found, (theta, d)


def turn_of_base(chain: Chain) -> float:
    """What is left of the offset of the first theta, which the base takes."""
    return chain[0][1].theta


def _with_first_normal(links: Sequence[DhLink], last: tuple[float, float], *, is_turned: bool) -> Chain:
    """The chain whose first normal points as found or the other way, and each later one so that its theta is at most a right angle."""
    found = list(links)
    thetas = [*(link.theta for link in links), last[0]]
    first = next((i for i, link in enumerate(found) if i and not _is_straight(link)), len(found))
    for i in range(first, len(found)):
        if _is_straight(found[i]):
            thetas[i], thetas[i + 1] = 0.0, _summed(thetas[i + 1], thetas[i], found[i])
        elif is_turned if i == first else _is_better_turned(thetas[i], found[i]):
            found[i] = replace(found[i], a=-found[i].a, alpha=-found[i].alpha, beta=-found[i].beta)
            thetas[i : i + 2] = [thetas[i] + math.pi, thetas[i + 1] + math.pi]
        thetas[i] = _wrapped(thetas[i])
    for i in range(first - 1, -1, -1):
        if _is_straight(found[i]) and i + 1 < len(found):
            thetas[i], thetas[i + 1] = _summed(thetas[i], thetas[i + 1], found[i]), 0.0
    settled = [replace(link, theta=_wrapped(theta)) for link, theta in zip(found, thetas, strict=False)]
    return settled, (_wrapped(thetas[-1]), last[1])


def _summed(theta: float, other: float, link: DhLink) -> float:
    """Two offsets with a link along one axis between them as one; the axis may turn round there."""
    return theta + (other if abs(link.alpha) < 1 else -other)


def _is_better_turned(theta: float, link: DhLink) -> bool:
    """Whether theta would be nearer to zero; at a right angle, whether a (or else alpha) would be positive."""
    away = abs(_wrapped(theta)) - math.pi / 2
    if abs(away) > _ZERO:
        return away > 0
    return link.a < -_ZERO or (abs(link.a) <= _ZERO and link.alpha < 0)


def _is_straight(link: DhLink) -> bool:
    """Whether the next axis lies in the same line."""
    return abs(link.a) < _SAME and abs(math.sin(link.alpha)) < _SAME and abs(link.beta) < _SAME


def _cost(chain: Chain) -> tuple[int, int, bool]:
    links, (theta, _) = chain
    first = links[0]
    offsets = sum(abs(link.theta) > _ZERO for link in links[2:])
    is_moved = any(abs(value) > _ZERO for value in (first.theta, first.d, first.a, first.alpha, links[1].theta))
    alpha = next((link.alpha for link in links if abs(math.sin(link.alpha)) > _ZERO), 0.0)
    return offsets, is_moved + (abs(theta) > _ZERO), alpha < 0


def _wrapped(angle: float) -> float:
    """The angle in (-pi, pi], without a negative zero; pi within rounding is pi."""
    turned = angle if -math.pi < angle <= math.pi else math.remainder(angle, math.tau)
    return turned + math.tau if turned <= -math.pi + _ZERO else turned + 0.0
