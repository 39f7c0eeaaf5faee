"""Dynamics by Pinocchio at the samples, and whether Pinocchio's kinematics agree with the batched ones.

Compared: the joint-space mass matrix relative to its diagonal, and the torque that holds the robot against gravity in N m or N.
Allowed: 1e-8; 1e-9 of the largest torque.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from hymeko_x.verify.checks.inertia import repaired_bodies
from hymeko_x.verify.checks.pair import RELATIVE, Differences, Pair
from hymeko_x.verify.kinematics import prepare
from hymeko_x.verify.model import WORLD, KinematicModel
from hymeko_x.verify.pinocchio import GRAVITY, VELOCITIES, PinocchioModel, build

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.verify.model import Array
    from hymeko_x.verify.verdict import Check

_MOST_DOFS = 250  # of one tree: the time that Pinocchio takes to prepare grows with their cube
_MOST_ENTRIES = 1_000_000  # mass matrix entries over all samples of one tree: a second of work
_LEAST_SAMPLES = 4  # whatever the size
_MASS_MATRIX = 1e-8  # relative to the diagonal: ten times the allowance of each tensor that is summed up
_AGREEMENT = 1e-9  # m and as a matrix entry; both sides compute in doubles
_SUMMED = 8.0  # scale of the rounding errors: each entry is a sum over bodies


def disagreement(model: KinematicModel, q: Array) -> str:
    """Where Pinocchio's forward kinematics differ from the batched ones at the first configurations; "" when nowhere."""
    poses = prepare(model).poses(q)
    counts = Counter(_root_of_dofs(model))
    for root in model.children[WORLD]:
        if counts[root] > _MOST_DOFS:
            continue
        native = build(model, root)
        bodies = list(native.frames)
        difference = np.abs(native.poses(q) - poses[:, bodies]).max(axis=(0, 2, 3))
        if difference.max() > _AGREEMENT * (1 + np.abs(poses).max()):
            return f"{model.body_label(bodies[int(difference.argmax())])} is {difference.max():.3g} apart"
    return ""


def check_dynamics(pair: Pair) -> Iterator[Check]:
    """Mass matrix and gravity torque of every tree that has the same coordinates in both robots."""
    partner = dict(pair.match.dofs)
    repaired = repaired_bodies(pair)
    massless = frozenset(i for i, _ in repaired), frozenset(j for _, j in repaired)
    matrix, torque = Differences("mass matrix", "relative"), Differences("gravity torque", "N m or N")
    least = max(RELATIVE, pair.precision * _largest_torque(pair.a))
    for native_a, native_b in _trees(pair, massless):
        dofs = [d for d in native_a.joints if d in partner]
        columns_a, columns_b = native_a.columns(dofs), native_b.columns([partner[d] for d in dofs])
        rows = _rows(len(pair.q_a), len(columns_a))
        ours, theirs = native_a.dynamics(pair.q_a[rows], columns_a), native_b.dynamics(pair.q_b[rows], columns_b)
        for row, ((mass_a, gravity_a), (mass_b, gravity_b)) in enumerate(zip(ours, theirs, strict=True)):
            difference = _relative_difference(mass_a, mass_b)
            at = f"{_dof_of_column(pair.a, dofs, int(difference.argmax()))} {pair.row_label(row)}"
            matrix.add(float(difference.max()), pair.allowed(_MASS_MATRIX, _SUMMED), at)
            allowed = max(least, pair.allowed(RELATIVE, _SUMMED) * float(np.abs(gravity_a).max()))
            column = int(np.abs(gravity_a - gravity_b).argmax())
            at = f"{_dof_of_column(pair.a, dofs, column)} {pair.row_label(row)}"
            torque.add(abs(gravity_a[column] - gravity_b[column]), allowed, at, gravity_a[column], gravity_b[column])
    yield from (*matrix.checks(), *torque.checks())


def _largest_torque(model: KinematicModel) -> float:
    """An upper bound of the gravity torque in N m: single precision leaves a part of it where a balanced robot has none."""
    reach = np.zeros(len(model.bodies))
    for i, body in enumerate(model.bodies[1:], start=1):
        reach[i] = 0.0 if body.parent == WORLD else reach[body.parent] + np.linalg.norm(body.joint.placement[:3, 3])
    anchors = [max((float(np.linalg.norm(dof.anchor)) for dof in body.joint.dofs), default=0.0) for body in model.bodies]
    levers = reach + np.array([float(np.linalg.norm(body.com)) for body in model.bodies]) + anchors
    return -GRAVITY[2] * float(levers @ np.array([abs(body.mass) for body in model.bodies]))


def _trees(pair: Pair, massless: tuple[frozenset[int], frozenset[int]]) -> Iterator[tuple[PinocchioModel, PinocchioModel]]:
    """The trees of both robots that have the same coordinates; a note for the others."""
    roots_a, roots_b = _root_of_dofs(pair.a), _root_of_dofs(pair.b)
    balls = {d for item in pair.match.balls for d in item.dofs_a}
    partner = dict(pair.match.dofs)
    for root in pair.a.children[WORLD]:
        dofs = [d for d in range(len(pair.a.dofs)) if roots_a[d] == root and pair.a.body_of_dof[d] not in pair.match.pinned_a]
        if not dofs:
            continue
        if balls.intersection(dofs):
            pair.notes.append(
                f"mass matrix: the tree of {pair.a.body_label(root)} has other coordinates (a ball is three hinges in one of the two)"
            )
            continue
        roots = {roots_b[partner[d]] for d in dofs if d in partner}
        if len(roots) != 1 or not partner.keys() >= set(dofs) or any(pair.a.dofs[d].kind is not pair.b.dofs[partner[d]].kind for d in dofs):
            pair.notes.append(f"mass matrix: the trees of {pair.a.body_label(root)} have other coordinates")
            continue
        if len(dofs) > _MOST_DOFS:
            where = f"{len(dofs)} coordinates below {pair.a.body_label(root)}"
            pair.notes.append(f"mass matrix: {where} are too many for Pinocchio; inertia and kinematics imply it")
            continue
        yield (
            build(pair.a, root, pinned=frozenset(pair.match.pinned_a), massless=massless[0]),
            build(pair.b, roots.pop(), pinned=frozenset(pair.match.pinned_b), massless=massless[1]),
        )


def _root_of_dofs(model: KinematicModel) -> list[int]:
    root = list(range(len(model.bodies)))
    for i, body in enumerate(model.bodies[1:], start=1):
        root[i] = i if body.parent == WORLD else root[body.parent]
    return [root[i] for i in model.body_of_dof]


def _rows(count: int, width: int) -> slice:
    """All configurations, or the first ones where the mass matrices would be too many numbers."""
    return slice(0, min(count, max(_LEAST_SAMPLES, _MOST_ENTRIES // max(1, width * width))))


def _relative_difference(ours: Array, theirs: Array) -> Array:
    """For each coordinate the worst difference of two mass matrices in its row, relative to the diagonal."""
    diagonal = np.maximum(np.diag(ours), 1e-6 * float(np.diag(ours).max(initial=0.0)) + 1e-9)  # a coordinate may move next to no mass
    relative: Array = (np.abs(ours - theirs) / np.sqrt(np.outer(diagonal, diagonal))).max(axis=1)
    return relative


def _dof_of_column(model: KinematicModel, dofs: list[int], column: int) -> str:
    widths = np.cumsum([VELOCITIES[model.dofs[d].kind] for d in dofs])
    return model.dof_label(dofs[int(np.searchsorted(widths, column, side="right"))])
