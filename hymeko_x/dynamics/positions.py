"""Small steps of configurations, and the steps that close loops."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hymeko_x.dynamics.spatial import of_quaternion, turned
from hymeko_x.ir.parts import DofKind

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

    from hymeko_x.dynamics.numbers import Number
    from hymeko_x.dynamics.tree import Link

_DONE = 1e-15
_STEPS = 100
_LONGEST = 0.5
"""Of one step, in m or rad."""


def moved(links: Sequence[Link], z: Sequence[Number], step: Sequence[Number]) -> list[Number]:
    """Positions after a small step along the velocities; exact to first order."""
    found: list[Number] = []
    at = column = 0
    for link in links:
        own, along = list(z[at : at + link.coordinates]), list(step[column : column + link.velocities])
        at, column = at + link.coordinates, column + link.velocities
        if link.coordinates == 1:
            found.append(own[0] + along[0])
            continue
        if link.dof.kind is DofKind.FREE:
            found += [a + b for a, b in zip(own[:3], turned(of_quaternion(own[3:]), along[:3]), strict=True)]
        w, x, y, z_ = own[-4:]
        a, b, c = (value / 2 for value in along[-3:])
        found += [w - x * a - y * b - z_ * c, x + w * a + y * c - z_ * b, y + w * b + z_ * a - x * c, z_ + w * c + x * b - y * a]
    return found


def nearest(
    links: Sequence[Link], closed: Callable[[Sequence[float]], tuple[Any, Any]], z: Sequence[float], kept: Collection[str] = ()
) -> list[float]:
    """The positions to which Gauss and Newton's steps of least length lead from z, towards closed loops. ``closed`` gives phi and J."""
    import numpy as np

    at = list(z)
    free = np.array([link.name not in kept for link in links for _ in range(link.velocities)])
    for _ in range(_STEPS):
        phi, slope = closed(at)
        step = np.zeros(len(free))
        step[free] = np.linalg.lstsq(slope[:, free], -phi, rcond=1e-8)[0]
        if min(np.abs(step).max(), np.abs(phi).max()) <= _DONE:
            break
        step *= min(1.0, _LONGEST / float(np.abs(step).max()))
        at = normal(links, moved(links, at, step.tolist()))
    return at


def normal(links: Sequence[Link], z: Sequence[float]) -> list[float]:
    """Positions with quaternions of unit length."""
    found: list[float] = []
    at = 0
    for link in links:
        own = [float(value) for value in z[at : at + link.coordinates]]
        at += link.coordinates
        if link.coordinates > 1:
            size = sum(value * value for value in own[-4:]) ** 0.5
            own[-4:] = [value / size for value in own[-4:]] if size else [1.0, 0.0, 0.0, 0.0]
        found += own
    return found
