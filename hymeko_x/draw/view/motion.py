"""How the viewer moves robots: a configuration, sliders for the dofs that lead, couplings and loops obeyed."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hymeko_x.draw.view.closure import LoopCloser
from hymeko_x.verify.checks.pair import carried_over, shifts_between
from hymeko_x.verify.kinematics import bounds, draw, follow, prepare
from hymeko_x.verify.matching import match
from hymeko_x.verify.model import Kind

if TYPE_CHECKING:
    from hymeko_x.verify.model import Array, KinematicModel


class Slider(NamedTuple):
    """One dof that a user moves: its number in the model, its name, and its ends and its start in rad or m."""

    dof: int
    label: str
    lower: float
    upper: float
    start: float
    unit: str


class PosedRobot:
    """A robot in a configuration, at first the one in which its file places the bodies."""

    def __init__(self, model: KinematicModel) -> None:
        self.model = model
        self._kinematics = prepare(model)
        self._closure = LoopCloser(model, self._kinematics)
        self.rest: Array = draw(model, 0, np.random.default_rng(0))[0]
        self.q: Array = self.rest.copy()

    @property
    def sliders(self) -> tuple[Slider, ...]:
        """The dofs that one number moves and that follow no other."""
        followers = {coupling.follower for coupling in self.model.couplings}
        return tuple(self._slider(d) for d, dof in enumerate(self.model.dofs) if dof.kind.scalar and d not in followers)

    def _slider(self, d: int) -> Slider:
        dof = self.model.dofs[d]
        lower, upper = bounds(dof)
        start = float(np.clip(self.rest[self.model.columns[d]], lower, upper))
        return Slider(d, self.model.dof_label(d), lower, upper, start, "m" if dof.kind is Kind.SLIDE else "rad")

    def move(self, dof: int, value: float) -> bool:
        """Move one dof; followers and loops go along. False, and nothing moves, where that would open a loop."""
        q = self.q[None].copy()
        q[:, self.model.columns[dof]] = value
        follow(self.model, q)
        closed = self._closure.closed(q[0], (dof,))
        if closed is None:
            return False
        self.q = closed
        return True

    def poses(self) -> Array:
        """The pose of every body in the world, (bodies, 4, 4)."""
        return np.asarray(self._kinematics.poses(self.q[None])[0])


class Partner:
    """A second robot that goes where the first one goes."""

    def __init__(self, first: PosedRobot, model: KinematicModel) -> None:
        self.motion = PosedRobot(model)
        self._first = first
        self.match = match(first.model, model)
        self._shifts = shifts_between(first.model, model, self.match)

    def follow(self) -> None:
        """Take the configuration of the first robot over."""
        self.motion.q = carried_over(self._first.model, self.motion.model, self.match, self._shifts, self._first.q[None])[0]
