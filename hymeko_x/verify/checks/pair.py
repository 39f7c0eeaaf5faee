"""Two matched robots at the same configurations, which every check takes, and the ways to report differences."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct, field

from hymeko_x.verify.dh import zero_poses
from hymeko_x.verify.kinematics import bounds, draw, follow, prepare
from hymeko_x.verify.meshes import Meshes
from hymeko_x.verify.spatial import quat_from_rotation
from hymeko_x.verify.verdict import Check, Finding, Gap

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from hymeko_x.verify.features import Feature
    from hymeko_x.verify.kinematics import Kinematics
    from hymeko_x.verify.matching import BallMatch, Match
    from hymeko_x.verify.model import Array, KinematicModel

RELATIVE = 1e-9
"""Of a value: text keeps 15 digits or more, engines compute in doubles, and the error grows by conversion of units and frames."""

ROUNDINGS = 8.0
"""So many roundings a value may have behind it on its way through a format: its allowance is that many times the precision."""

_SAME_PLACEMENT = 1e-6
"""In m and as a matrix entry: below it two joints place their child bodies equally, so that only the coordinate was shifted."""

MOST_NAMED = 5
"""So many findings a check names; it counts the rest."""

ROUNDING = 1e-11
"""Of the largest number beside it: computed numbers below have other digits on each processor. Authors write 1e-9 kg for no mass."""

MOST_SHOWN = 2
"""So many elements a gap names."""


class Pair(Struct, frozen=True, eq=False, dict=True):
    """Two robots, their match, the same configurations (n, width) in the coordinates of each, notes and gaps for the verdict.

    ``shifts`` holds for each pair of dofs by how much the second's coordinate is larger for the same pose. ``meshes`` reads the mesh
    files that are compared, each once; ``mesh_distances`` holds the results of mesh comparisons.
    """

    a: KinematicModel
    b: KinematicModel
    match: Match
    q_a: Array
    q_b: Array
    shifts: tuple[float, ...]
    meshes: Meshes = field(default_factory=Meshes)
    notes: list[str] = field(default_factory=list)
    gaps: list[Gap] = field(default_factory=list)
    mesh_distances: dict[object, tuple[float, str, str]] = field(default_factory=dict)

    @cached_property
    def zero_a(self) -> Array:
        """World poses of the first robot with all scalar coordinates at 0."""
        return zero_poses(self.a)

    @cached_property
    def rest_b(self) -> Array:
        """The coordinates of the second robot where all of the first's are 0."""
        coordinates = np.zeros(self.b.width)
        for (_, e), shift in zip(self.match.dofs, self.shifts, strict=True):
            coordinates[self.b.columns[e]] = shift
        return coordinates

    @cached_property
    def zero_b(self) -> Array:
        """World poses of the second robot in the same pose."""
        return zero_poses(self.b, self.rest_b)

    @cached_property
    def forward_a(self) -> Kinematics:
        """The forward kinematics of the first robot, with bases that do not count pinned to the world."""
        return prepare(self.a, pinned=frozenset(self.match.pinned_a))

    @cached_property
    def forward_b(self) -> Kinematics:
        """The same of the second robot."""
        return prepare(self.b, pinned=frozenset(self.match.pinned_b))

    @property
    def precision(self) -> float:
        """The relative accuracy of the less accurate side."""
        return max(self.a.precision, self.b.precision)

    def allowed(self, least: float, scale: float = 1.0) -> float:
        """``least``, or the error that the accuracy of the numbers leaves in a value of this scale."""
        return max(least, ROUNDINGS * self.precision * scale)

    def relative(self, least: float, *values: float) -> float:
        """``least``, or the relative allowance of the largest of these values."""
        return max(least, self.allowed(RELATIVE) * max(map(abs, values), default=0.0))

    def both_represent(self, feature: Feature) -> bool:
        """Whether both formats and their readers represent it."""
        return feature in self.a.features and feature in self.b.features

    def add_unrepresented(self, feature: Feature, names: Callable[[KinematicModel], Sequence[str]]) -> None:
        """A gap for each side that has something which the other's format or reader does not represent."""
        for model, other in ((self.a, self.b), (self.b, self.a)):
            if feature not in other.features:
                self.add_gap(other, feature, names(model))

    def add_gap(self, other: KinematicModel, feature: Feature | None, names: Sequence[str], quantity: str = "") -> None:
        """A gap of this side: it does not represent these elements of the other one. A note where only its reader does not."""
        quantity = quantity or (feature.value if feature else "")
        if names and (feature in other.unread or not other.is_independent):
            self.notes.append(f"{quantity}: {len(names)} were not compared, because the reader of {other.format} does not read them")
        elif names:
            self.gaps.append(Gap(other.format, quantity, len(names), tuple(names[:MOST_SHOWN])))

    def row_label(self, row: int) -> str:
        """The name of a configuration in a verdict."""
        return ("in the zero pose", "at all lower limits", "at all upper limits")[row] if row < 3 else f"at sample {row - 2}"


def pair_up(a: KinematicModel, b: KinematicModel, matched: Match, samples: int, seed: int, *, meshes: Meshes | None = None) -> Pair:
    """Configurations drawn in the first robot's limits, in the coordinates of both."""
    rng = np.random.default_rng(seed)
    q_a = draw(a, samples, rng)
    shifts = shifts_between(a, b, matched)
    q_b = carried_over(a, b, matched, shifts, q_a)
    _align_balls(a, b, matched.balls, q_a, q_b, rng)
    return Pair(a, b, matched, q_a, q_b, shifts, Meshes() if meshes is None else meshes, list(matched.notes))


class Differences:
    """The differences of one quantity in its unit, each with its allowance and its place."""

    def __init__(self, quantity: str, unit: str) -> None:
        self.quantity, self.unit = quantity, unit
        self._rows: list[tuple[float, float, str, object, object]] = []

    def add(self, difference: float, allowed: float, at: str, ours: object = None, theirs: object = None) -> None:
        """One more difference, of these values; not-a-number counts as infinite."""
        self._rows.append((np.inf if np.isnan(difference) else float(difference), float(allowed), at, ours, theirs))

    def checks(self) -> list[Check]:
        """The check of the difference that exceeds its allowance the most; none where nothing was compared."""
        if not self._rows:
            return []
        difference, allowed, at, ours, theirs = max(self._rows, key=lambda row: row[0] / max(row[1], 1e-300))
        values = None if ours is None or difference == 0 else both_shown(ours, theirs)
        findings = tuple(_finding(*row) for row in self._rows if not row[0] <= row[1])
        return [Check(self.quantity, self.unit, difference, at if difference > 0 else "", allowed, values, findings)]


def _finding(difference: float, _: float, at: str, ours: object, theirs: object) -> Finding:
    return Finding(at, difference, None if ours is None else both_shown(ours, theirs))


def both_shown(ours: object, theirs: object) -> tuple[str, str]:
    """Two values in a few digits; a number that is rounding beside the largest of them is 0."""
    a, b = np.asarray(ours, dtype=np.float64), np.asarray(theirs, dtype=np.float64)
    rounding = ROUNDING * max(np.abs(value[np.isfinite(value)]).max(initial=0.0) for value in (a, b))
    return _shown(np.where(np.abs(a) <= rounding, 0.0, a)), _shown(np.where(np.abs(b) <= rounding, 0.0, b))


def _shown(numbers: Array) -> str:
    """A number, an interval, a vector or a symmetric tensor."""
    if numbers.shape == (3, 3):
        numbers = numbers[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    text = " ".join(f"{number:.6g}" for number in numbers.ravel())
    return f"[{text}]" if numbers.ndim else text


def counted(quantity: str, findings: Sequence[str]) -> Check:
    """The check of elements that must have a counterpart: how many have none, and which."""
    rest = f"; and {len(findings) - MOST_NAMED} more" if len(findings) > MOST_NAMED else ""
    each = tuple(Finding(words, 1.0) for words in findings)
    return Check(quantity, "", float(len(findings)), "; ".join(findings[:MOST_NAMED]) + rest, 0.0, findings=each)


def same_numbers(ours: Sequence[float], theirs: Sequence[float]) -> bool:
    """Whether two lists of coefficients are equal; missing ones are zeros."""
    width = max(len(ours), len(theirs))
    first, second = ([*numbers, *[0.0] * (width - len(numbers))] for numbers in (ours, theirs))
    return bool(np.allclose(first, second, rtol=RELATIVE, atol=0.0))


# ---- coordinates -----------------------------------------------------------------------------------------------------


def _at_rest(model: KinematicModel, count: int) -> Array:
    q = np.zeros((count, model.width))
    for dof, column in zip(model.dofs, model.columns, strict=True):
        if dof.kind.scalar:
            q[:, column] = dof.ref
        else:
            q[:, column + dof.kind.width - 4] = 1.0
    return q


def carried_over(a: KinematicModel, b: KinematicModel, matched: Match, shifts: Sequence[float], q_a: Array) -> Array:
    """The first robot's configurations (n, width) in the coordinates of the second; what has no partner there is at rest."""
    q_b = _at_rest(b, len(q_a))
    for (d, e), shift in zip(matched.dofs, shifts, strict=True):
        width = a.dofs[d].kind.width
        q_b[:, b.columns[e] : b.columns[e] + width] = q_a[:, a.columns[d] : a.columns[d] + width] + shift
    follow(b, q_b)
    return q_b


def shifts_between(a: KinematicModel, b: KinematicModel, matched: Match) -> tuple[float, ...]:
    """By how much coordinates differ for one pose, where one robot counts from another reference than the other.

    A format without references either turns the zero pose (coordinates stay, shift 0) or shifts the coordinates: it did
    the latter where both robots have the same pose of the child body when each is at its reference.
    """
    partner = dict(matched.bodies)
    shifts = []
    for d, e in matched.dofs:
        shift = b.dofs[e].ref - a.dofs[d].ref
        i, j = a.body_of_dof[d], b.body_of_dof[e]
        is_shifted = shift != 0.0 and partner.get(i) == j and _same_placement(a, b, i, j)
        shifts.append(shift if is_shifted else 0.0)
    return tuple(shifts)


def _same_placement(a: KinematicModel, b: KinematicModel, i: int, j: int) -> bool:
    return bool(np.abs(a.bodies[i].joint.placement - b.bodies[j].joint.placement).max() < _SAME_PLACEMENT)


def _align_balls(
    a: KinematicModel, b: KinematicModel, matches: Sequence[BallMatch], q_a: Array, q_b: Array, rng: np.random.Generator
) -> None:
    """Gives each ball of one robot the orientation that the hinges of the other have, in place."""
    if not matches:
        return
    pairs = []
    for item in matches:
        first, second = _Side(a, q_a, item.dofs_a, item.top_a, item.body_a), _Side(b, q_b, item.dofs_b, item.top_b, item.body_b)
        pairs.append((second, first) if len(second.dofs) == 1 else (first, second))
    for ball, hinges in pairs:
        ball.set((1.0, 0.0, 0.0, 0.0))
        if ball.model is a:
            hinges.draw(rng)
    poses = {id(model): prepare(model).poses(q) for model, q in ((a, q_a), (b, q_b))}
    for ball, hinges in pairs:
        at_rest, wanted = (side.turn(poses[id(side.model)]) for side in (ball, hinges))
        ball.set(quat_from_rotation(np.swapaxes(at_rest, 1, 2) @ wanted))


class _Side(Struct, frozen=True, eq=False):
    """One robot's dofs of a joint that turns every way: from the body ``top`` to the body ``bottom``."""

    model: KinematicModel
    q: Array
    dofs: tuple[int, ...]
    top: int
    bottom: int

    def set(self, quats: Array | tuple[float, ...]) -> None:
        """The orientation of a ball in all configurations."""
        column = self.model.columns[self.dofs[0]]
        self.q[:, column : column + 4] = quats

    def draw(self, rng: np.random.Generator) -> None:
        """Random angles within the limits in all but the first three rows."""
        for dof in self.dofs:
            lower, upper = bounds(self.model.dofs[dof])
            self.q[3:, self.model.columns[dof]] = rng.uniform(lower, upper, len(self.q) - 3)

    def turn(self, poses: Array) -> Array:
        """The rotation of the bottom body in the frame of the top one, (n, 3, 3)."""
        turn: Array = np.swapaxes(poses[:, self.top, :3, :3], 1, 2) @ poses[:, self.bottom, :3, :3]
        return turn
