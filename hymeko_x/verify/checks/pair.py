"""Two matched robots at the same configurations: what every check takes."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct, field

from hymeko_x.verify.dh import zero_poses
from hymeko_x.verify.kinematics import bounds, draw, follow, prepare
from hymeko_x.verify.meshes import Meshes
from hymeko_x.verify.spatial import quat_from_rotation
from hymeko_x.verify.verdict import Check

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from hymeko_x.verify.matching import Match, Turned
    from hymeko_x.verify.model import Array, Feature, KinematicModel

POSITION, ROTATION = 1e-9, 1e-9
MASS_MATRIX = 1e-8


class Pair(Struct, frozen=True, eq=False, dict=True):
    """Two robots, their match, the same configurations (n, width) in the coordinates of each, and notes for the verdict.

    ``meshes`` reads the mesh files that are compared, each once; ``mesh_distances`` is what was found of meshes already.

    ``shifts`` holds for each pair of dofs by how much the second's coordinate is larger for the same pose.
    """

    a: KinematicModel
    b: KinematicModel
    match: Match
    q_a: Array
    q_b: Array
    shifts: tuple[float, ...]
    meshes: Meshes = field(default_factory=Meshes)
    notes: list[str] = field(default_factory=list)
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

    @property
    def precision(self) -> float:
        """The relative accuracy of the less accurate side."""
        return max(self.a.precision, self.b.precision)

    def allowed(self, least: float, scale: float = 1.0) -> float:
        """``least``, or what the accuracy of the numbers makes of a value of this scale."""
        return max(least, 8.0 * self.precision * scale)

    def both_say(self, feature: Feature) -> bool:
        """Whether both readers can tell."""
        return feature in self.a.says and feature in self.b.says

    def row_label(self, row: int) -> str:
        """What a configuration is, for the reader of a verdict."""
        return ("in the zero pose", "at all lower limits", "at all upper limits")[row] if row < 3 else f"at sample {row - 2}"


def pair_up(a: KinematicModel, b: KinematicModel, matched: Match, samples: int, seed: int, *, meshes: Meshes | None = None) -> Pair:
    """Configurations drawn in the first robot's limits and said in the coordinates of both."""
    rng = np.random.default_rng(seed)
    q_a = draw(a, samples, rng)
    shifts = _shifts(a, b, matched)
    q_b = _at_rest(b, len(q_a))
    for (d, e), shift in zip(matched.dofs, shifts, strict=True):
        width = a.dofs[d].kind.width
        q_b[:, b.columns[e] : b.columns[e] + width] = q_a[:, a.columns[d] : a.columns[d] + width] + shift
    follow(b, q_b)
    _turn_alike(a, b, matched.turned, q_a, q_b, rng)
    return Pair(a, b, matched, q_a, q_b, shifts, Meshes() if meshes is None else meshes, list(matched.notes))


def worst(quantity: str, unit: str, differences: Array, allowed: Array | float, label: Callable[[int], str]) -> Check:
    """The check of many differences: the one that exceeds what is allowed for it the most; not-a-number counts as infinite."""
    if differences.size == 0:
        return Check(quantity, unit, 0.0, "", float(np.max(allowed, initial=0.0)))
    flat = np.where(np.isnan(differences), np.inf, differences).ravel()
    limits = np.broadcast_to(allowed, differences.shape).ravel()
    index = int(np.argmax(flat / np.maximum(limits, 1e-300)))
    return Check(quantity, unit, float(flat[index]), label(index) if flat[index] > 0 else "", float(limits[index]))


def counted(quantity: str, findings: Sequence[str], most: int = 5) -> Check:
    """The check of things that must have a counterpart: how many have none, and which."""
    rest = f"; and {len(findings) - most} more" if len(findings) > most else ""
    return Check(quantity, "", float(len(findings)), "; ".join(findings[:most]) + rest, 0.0)


# ---- coordinates -----------------------------------------------------------------------------------------------------


def _at_rest(model: KinematicModel, count: int) -> Array:
    q = np.zeros((count, model.width))
    for dof, column in zip(model.dofs, model.columns, strict=True):
        if dof.kind.scalar:
            q[:, column] = dof.ref
        else:
            q[:, column + dof.kind.width - 4] = 1.0
    return q


def _shifts(a: KinematicModel, b: KinematicModel, matched: Match) -> tuple[float, ...]:
    """By how much coordinates differ for one pose, where one robot counts from another reference than the other.

    A format without references either turns the zero pose (coordinates stay, shift 0) or shifts the coordinates: it did
    the latter where both robots have the same pose below the joint when each is at its reference.
    """
    place = dict(matched.bodies)
    shifts = []
    for d, e in matched.dofs:
        away = b.dofs[e].ref - a.dofs[d].ref
        body = a.body_of_dof[d]
        same_body = place.get(body) == b.body_of_dof[e]
        shifted = away != 0.0 and same_body and _same_placement(a, b, body, b.body_of_dof[e])
        shifts.append(away if shifted else 0.0)
    return tuple(shifts)


def _same_placement(a: KinematicModel, b: KinematicModel, i: int, j: int) -> bool:
    return bool(np.abs(a.bodies[i].joint.placement - b.bodies[j].joint.placement).max() < 1e-6)


def _turn_alike(a: KinematicModel, b: KinematicModel, turned: Sequence[Turned], q_a: Array, q_b: Array, rng: np.random.Generator) -> None:
    """Gives each ball of one robot the orientation that the hinges of the other have, in place."""
    if not turned:
        return
    sides = [_Side(b, q_b, item.dofs_b, item.top_b, item.body_b) for item in turned]
    others = [_Side(a, q_a, item.dofs_a, item.top_a, item.body_a) for item in turned]
    balls = [side if len(side.dofs) == 1 else other for side, other in zip(sides, others, strict=True)]
    hinges = [other if len(side.dofs) == 1 else side for side, other in zip(sides, others, strict=True)]
    for ball, three in zip(balls, hinges, strict=True):
        ball.q[:, ball.column : ball.column + 4] = (1.0, 0.0, 0.0, 0.0)
        if ball.model is a:
            three.draw(rng)
    poses = {id(model): prepare(model).poses(q) for model, q in ((a, q_a), (b, q_b))}
    for ball, three in zip(balls, hinges, strict=True):
        at_rest, wanted = (side.turn(poses[id(side.model)]) for side in (ball, three))
        ball.q[:, ball.column : ball.column + 4] = quat_from_rotation(np.swapaxes(at_rest, 1, 2) @ wanted)


class _Side(Struct, frozen=True, eq=False):
    """One robot's dofs of a joint that turns every way: from the body ``top`` to the body ``below``."""

    model: KinematicModel
    q: Array
    dofs: tuple[int, ...]
    top: int
    below: int

    @property
    def column(self) -> int:
        return self.model.columns[self.dofs[0]]

    def draw(self, rng: np.random.Generator) -> None:
        """Random angles within the limits in all but the first three rows."""
        for dof in self.dofs:
            lower, upper = bounds(self.model.dofs[dof])
            self.q[3:, self.model.columns[dof]] = rng.uniform(lower, upper, len(self.q) - 3)

    def turn(self, poses: Array) -> Array:
        """The rotation of the body below, seen from the one on top, (n, 3, 3)."""
        turn: Array = np.swapaxes(poses[:, self.top, :3, :3], 1, 2) @ poses[:, self.below, :3, :3]
        return turn
