"""Loops in the viewer: after one joint was moved, the other joints of its loops go where these are closed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hymeko_x.verify.checks.loops import ends, gap_between
from hymeko_x.verify.kinematics import follow

if TYPE_CHECKING:
    from collections.abc import Collection

    from hymeko_x.verify.kinematics import Kinematics
    from hymeko_x.verify.model import Array, KinematicModel, Loop

CLOSED = 1e-6
"""In m and as a sine: what is nearer is closed."""
_STEPS = 30
_DIFFERENCE = 1e-6
_DAMPING = 1e-9
_LONGEST = 0.3
"""No coordinate moves by more than this in one step, in rad or m."""


class LoopCloser:
    """The loops of a model, and the dofs between their bodies and the base that can close them."""

    def __init__(self, model: KinematicModel, kinematics: Kinematics) -> None:
        self._model = model
        self._kinematics = kinematics
        followers = {coupling.follower for coupling in model.couplings}
        above = {body for loop in model.loops for end in (loop.body_a, loop.body_b) for body in _ancestors(model, end)}
        self._dofs = [d for d, dof in enumerate(model.dofs) if dof.kind.scalar and d not in followers and model.body_of_dof[d] in above]

    def closed(self, q: Array, held: Collection[int] = ()) -> Array | None:
        """The configuration (width) near this one in which every loop is closed and the held dofs stay; None where none was found."""
        if not self._model.loops:
            return q
        free = [d for d in self._dofs if d not in held]
        columns = [self._model.columns[d] for d in free]
        q = q.copy()
        for _ in range(_STEPS):
            rows = np.repeat(q[None], len(columns) + 1, axis=0)
            rows[np.arange(1, len(columns) + 1), columns] += _DIFFERENCE
            follow(self._model, rows)
            found = self._residual(rows)
            if float(np.abs(found[0]).max()) < CLOSED:
                return np.asarray(rows[0])
            if not columns:
                return None
            slope = (found[1:] - found[0]).T / _DIFFERENCE
            step = -slope.T @ np.linalg.solve(slope @ slope.T + _DAMPING * np.eye(len(slope)), found[0])
            q[columns] += step * min(1.0, _LONGEST / max(float(np.abs(step).max()), 1e-12))
            self._stay_within(q, free)
        return None

    def _stay_within(self, q: Array, free: list[int]) -> None:
        """Move coordinates back to their limits; [0, 0] stands for none."""
        for d in free:
            dof = self._model.dofs[d]
            if not dof.lower == dof.upper == 0.0:
                column = self._model.columns[d]
                q[column] = min(max(q[column], dof.lower), dof.upper)

    def _residual(self, q: Array) -> Array:
        """By how much each loop is open in each configuration, (n, numbers)."""
        poses = self._kinematics.poses(q)
        return np.concatenate([_open(poses, loop) for loop in self._model.loops], axis=1)


def _open(poses: Array, loop: Loop) -> Array:
    """What must be zero where a loop is closed: the gap in m, and sines of the angles of motions that its kind forbids."""
    first, second = ends(poses, loop, swapped=False)
    gap = gap_between(first, second, loop.kind)
    if loop.kind == "connect":
        return gap
    if loop.kind in ("hinge", "cylinder"):
        return np.concatenate([gap, np.cross(first[:, :3, 2], second[:, :3, 2])], axis=1)
    turn = np.swapaxes(first[:, :3, :3], 1, 2) @ second[:, :3, :3]
    skew = np.stack([turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0], turn[:, 1, 0] - turn[:, 0, 1]], axis=1)
    return np.concatenate([gap, skew / 2.0], axis=1)


def _ancestors(model: KinematicModel, body: int) -> list[int]:
    """A body and all bodies between it and the world."""
    found = []
    while body > 0:
        found.append(body)
        body = model.bodies[body].parent
    return found
