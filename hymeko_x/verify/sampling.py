"""Configurations to compare at: the zero pose, the limits, and seeded random ones, with followers where they belong."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hymeko_x.verify.model import Array, Dof, Kind, KinematicModel
from hymeko_x.verify.spatial import random_quats

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hymeko_x.verify.model import Coupling

_REACH = {Kind.HINGE: 2 * np.pi, Kind.SCREW: 2 * np.pi, Kind.SLIDE: 10.0}
_UNLIMITED = {Kind.HINGE: np.pi, Kind.SCREW: np.pi, Kind.SLIDE: 1.0}


def draw(model: KinematicModel, count: int, rng: np.random.Generator) -> Array:
    """Configurations (count + 3, width): the authored pose, all lower limits, all upper limits, then random ones inside.

    Limits beyond two turns or 10 m are cut there; without limits a hinge takes one turn and a slide 2 m. Balls and free
    joints are at rest in the first three rows. Followers are computed from their leaders in every row.
    """
    q = np.zeros((count + 3, model.width))
    for dof, column in zip(model.dofs, model.columns, strict=True):
        _fill(q, dof, column, rng)
    follow(model, q)
    return q


def _fill(q: Array, dof: Dof, column: int, rng: np.random.Generator) -> None:
    count = len(q) - 3
    if dof.kind is Kind.BALL:
        q[:3, column] = 1.0
        q[3:, column : column + 4] = random_quats(rng, count)
    elif dof.kind is Kind.FREE:
        q[:3, column + 3] = 1.0
        q[3:, column : column + 3] = rng.uniform(-1, 1, (count, 3))
        q[3:, column + 3 : column + 7] = random_quats(rng, count)
    else:
        lower, upper = bounds(dof)
        q[:3, column] = dof.ref, lower, upper
        q[3:, column] = rng.uniform(lower, upper, count)


def bounds(dof: Dof) -> tuple[float, float]:
    """The finite range that a scalar dof is sampled in. [0, 0] is how exporters write "no limits", so it moves freely."""
    reach, free = _REACH[dof.kind], _UNLIMITED[dof.kind]
    if dof.lower == dof.upper == 0.0:
        return -free, free
    lower = max(dof.lower, dof.ref - reach) if np.isfinite(dof.lower) else dof.ref - free
    upper = min(dof.upper, dof.ref + reach) if np.isfinite(dof.upper) else dof.ref + free
    return (lower, upper) if lower <= upper else (dof.ref, dof.ref)


def follow(model: KinematicModel, q: Array) -> None:
    """Sets the followers' columns in place, leaders before their followers; a circle of followers is cut at its first."""
    for coupling in ordered(model):
        value = np.full(len(q), coupling.constant)
        for leader, coefficients in coupling.leaders:
            x = q[:, model.columns[leader]]
            value += x * np.polynomial.polynomial.polyval(x, np.asarray(coefficients)) if coefficients else 0.0
        q[:, model.columns[coupling.follower]] = value


def ordered(model: KinematicModel) -> Sequence[Coupling]:
    """The couplings, every leader's own coupling before the couplings that it leads."""
    by_follower = {coupling.follower: coupling for coupling in model.couplings}
    order: list[Coupling] = []
    state: dict[int, int] = {}
    for start in by_follower:
        stack = [start]
        while stack:
            dof = stack[-1]
            coupling = by_follower.get(dof)
            waiting = (
                []
                if coupling is None or state.get(dof)
                else [lead for lead, _ in coupling.leaders if lead in by_follower and lead not in state]
            )
            state.setdefault(dof, 1)
            if waiting:
                stack.extend(waiting)
                continue
            stack.pop()
            if coupling is not None and state[dof] == 1:
                state[dof] = 2
                order.append(coupling)
    return order
