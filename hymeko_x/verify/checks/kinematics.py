"""Forward kinematics: where every body is, and how it is turned, at every configuration.

Compared: positions in m and rotation angles in rad, of all matched bodies in the world. Allowed: 1e-9, of a metre or of the robot's
reach; in single precision the rounding of a chain as deep as the tree.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from hymeko_x.verify.checks.pair import both_shown
from hymeko_x.verify.spatial import angle_between
from hymeko_x.verify.verdict import Check, Finding

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.verify.checks.pair import Pair
    from hymeko_x.verify.model import Array, Index

POSITION = 1e-9
"""In m, and of a larger reach than 1 m the part of it."""

ROTATION = 1e-9
"""In rad."""

_SHORT = 1e-3
"""In m: single precision is not expected to be finer than that of such a length."""


class Allowance(Struct, frozen=True, eq=False):
    """How far positions (m) and rotations (rad) may differ."""

    metres: float
    radians: float


def allowance(pair: Pair, reach: float, anchors: float = 0.0) -> Allowance:
    """For bodies up to ``reach`` m away, and anchors on them: rounding errors add up along the tree like a random walk."""
    steps = float(np.sqrt(max(1, len(pair.forward_a.levels))))
    return Allowance(
        pair.allowed(POSITION * max(1.0, reach), steps * max(_SHORT, reach, anchors)),
        pair.allowed(ROTATION, steps),
    )


def batches(pair: Pair) -> Iterator[tuple[slice, Array, Array]]:
    """The world poses (n, bodies, 4, 4) of both robots at all configurations, in slices that fit into little memory."""
    for rows, poses_a in pair.forward_a.batches(pair.q_a):
        yield rows, poses_a, pair.forward_b.poses(pair.q_b[rows])


def check_kinematics(pair: Pair) -> Iterator[Check]:
    """Position and rotation of every body; of the world there is nothing to compare."""
    if len(pair.match.bodies) < 2:
        return
    ours, theirs = (np.array(indices, dtype=np.intp) for indices in zip(*pair.match.bodies[1:], strict=True))
    distances, angles = Peaks(len(ours)), Peaks(len(ours))
    reach = 0.0
    for rows, poses_a, poses_b in batches(pair):
        reach = max(reach, float(np.abs(poses_a[..., :3, 3]).max()))
        a, b = poses_a[:, ours], poses_b[:, theirs]
        distances.add(slice(None), np.linalg.norm(a[..., :3, 3] - b[..., :3, 3], axis=-1), rows.start)
        angles.add(slice(None), angle_between(a[..., :3, :3], b[..., :3, :3]), rows.start)
    allowed = allowance(pair, reach)
    position = _body_check(pair, "forward kinematics, position", "m", distances, allowed.metres)
    rotation = _body_check(pair, "forward kinematics, rotation", "rad", angles, allowed.radians)
    if position.passed and rotation.passed:
        yield from (position, rotation)
        return
    moved, turned = _where_it_arises(pair, allowed)
    yield replace(_with_places(pair, position, distances), findings=() if position.passed else moved)
    yield replace(rotation, findings=() if rotation.passed else turned)


def _where_it_arises(pair: Pair, allowed: Allowance) -> tuple[tuple[Finding, ...], tuple[Finding, ...]]:
    """The bodies whose position, and those whose rotation, in the frame of the nearest ancestor with a counterpart differs."""
    partner = dict(pair.match.bodies)
    bodies = pair.match.bodies[1:]
    above = []
    for i, _ in bodies:
        parent = pair.a.bodies[i].parent
        while parent not in partner:
            parent = pair.a.bodies[parent].parent
        above.append((parent, partner[parent]))
    (ours, theirs), (over_a, over_b) = (np.array(pairs, dtype=np.intp).T for pairs in (bodies, above))
    distances, angles = Peaks(len(bodies)), Peaks(len(bodies))
    for rows, poses_a, poses_b in batches(pair):
        a, b = (_inside(poses[:, over], poses[:, own]) for poses, over, own in ((poses_a, over_a, ours), (poses_b, over_b, theirs)))
        distances.add(slice(None), np.linalg.norm(a[..., :3, 3] - b[..., :3, 3], axis=-1), rows.start)
        angles.add(slice(None), angle_between(a[..., :3, :3], b[..., :3, :3]), rows.start)
    return _findings(pair, distances, allowed.metres), _findings(pair, angles, allowed.radians)


def _inside(above: Array, poses: Array) -> Array:
    """Poses (n, bodies, 4, 4) in the frames of others."""
    back = np.swapaxes(above[..., :3, :3], -1, -2)
    inside = poses.copy()
    inside[..., :3, :3] = back @ poses[..., :3, :3]
    inside[..., :3, 3] = np.einsum("...ij,...j->...i", back, poses[..., :3, 3] - above[..., :3, 3])
    return inside


def _findings(pair: Pair, peaks: Peaks, allowed: float) -> tuple[Finding, ...]:
    beyond = np.flatnonzero(peaks.values > allowed)
    return tuple(Finding(pair.a.body_label(pair.match.bodies[1:][k][0]), float(peaks.values[k])) for k in beyond)


class Peaks:
    """The largest difference of each item so far, and the configuration where it was."""

    def __init__(self, count: int) -> None:
        self.values: Array = np.zeros(count)
        self.rows: Index = np.zeros(count, dtype=np.intp)

    def add(self, item: slice | int, differences: Array, first: int) -> None:
        """Differences (n,) of one item or (n, items) of all, at configurations from ``first`` on; NaN counts as infinite."""
        differences = np.where(np.isnan(differences), np.inf, differences)
        peaks, rows = differences.max(axis=0), differences.argmax(axis=0) + first
        higher = peaks > self.values[item]
        self.rows[item] = np.where(higher, rows, self.rows[item])
        self.values[item] = np.where(higher, peaks, self.values[item])


def _body_check(pair: Pair, quantity: str, unit: str, peaks: Peaks, allowed: float) -> Check:
    """The worst body; where that is too far, the first one down the tree that is, because that is where the difference begins."""
    bodies = pair.match.bodies[1:]
    last = int(peaks.values.argmax())
    beyond = np.flatnonzero(peaks.values > allowed)
    first = int(beyond[0]) if beyond.size else last
    at = f"{pair.a.body_label(bodies[first][0])} {pair.row_label(int(peaks.rows[first]))}" if peaks.values[last] > 0 else ""
    if first != last:
        at += f", worst at {pair.a.body_label(bodies[last][0])}"
    return Check(quantity, unit, float(peaks.values[last]), at, allowed)


def _with_places(pair: Pair, check: Check, peaks: Peaks) -> Check:
    """A check that failed with where both robots have the first body that is off, in m."""
    if check.passed:
        return check
    first = int(np.flatnonzero(peaks.values > check.allowed)[0])
    row = slice(int(peaks.rows[first]), int(peaks.rows[first]) + 1)
    i, j = pair.match.bodies[1:][first]
    places = pair.forward_a.poses(pair.q_a[row])[0, i, :3, 3], pair.forward_b.poses(pair.q_b[row])[0, j, :3, 3]
    return replace(check, values=both_shown(*places))
