"""Mass matrix and gravity torque by Pinocchio at the samples, and Pinocchio's opinion of the batched kinematics."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from hymeko_x.verify.checks.inertia import repaired_bodies
from hymeko_x.verify.checks.pair import MASS_MATRIX, Pair, worst
from hymeko_x.verify.kinematics import prepare
from hymeko_x.verify.model import WORLD, Kind, KinematicModel
from hymeko_x.verify.pinocchio import PinModel, build

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.verify.model import Array
    from hymeko_x.verify.verdict import Check

_MOST_DOFS = 250  # of one tree: the time that Pinocchio takes to prepare grows with their cube
_MOST_ENTRIES = 1_000_000  # mass matrix entries over all samples of one tree
_SLACK = 1e-9


def disagreement(model: KinematicModel, q: Array) -> str:
    """Where Pinocchio's forward kinematics differ from the batched ones at the first configurations; "" when nowhere."""
    poses = prepare(model).poses(q)
    counts = Counter(_root_of_dofs(model))
    for root in model.children[WORLD]:
        if counts[root] > _MOST_DOFS:
            continue
        native = build(model, root)
        bodies = list(native.frames)
        apart = np.abs(native.poses(q) - poses[:, bodies]).max(axis=(0, 2, 3))
        if apart.max() > _SLACK * (1 + np.abs(poses).max()):
            return f"{model.body_label(bodies[int(apart.argmax())])} is {apart.max():.3g} apart"
    return ""


def check_dynamics(pair: Pair) -> Iterator[Check]:
    """The joint-space mass matrix (relative to its diagonal) and the torque that holds the robot against gravity."""
    partner = dict(pair.match.dofs)
    repaired = repaired_bodies(pair)
    weightless = frozenset(i for i, _ in repaired), frozenset(j for _, j in repaired)
    places: list[tuple[list[int], int, int]] = []
    matrix: list[float] = []
    torque: list[float] = []
    scale: list[float] = []
    for native_a, native_b in _trees(pair, weightless):
        dofs = [d for d in native_a.joints if d in partner]
        if not dofs:
            continue
        columns_a, columns_b = native_a.columns(dofs), native_b.columns([partner[d] for d in dofs])
        rows = _rows(len(pair.q_a), len(columns_a))
        ours, theirs = native_a.dynamics(pair.q_a[rows], columns_a), native_b.dynamics(pair.q_b[rows], columns_b)
        for row, (x, y) in enumerate(zip(ours, theirs, strict=True)):
            apart, gravity, size, at = _compare(x, y)
            matrix.append(apart)
            torque.append(gravity)
            scale.append(size)
            places.append((dofs, at, row))

    def label(k: int) -> str:
        dofs, at, row = places[k]
        return f"{_dof_of_column(pair.a, dofs, at)} {pair.row_label(row)}"

    if places:
        yield worst("mass matrix", "relative", np.array(matrix), pair.allowed(MASS_MATRIX, 8.0), label)
        allowed = np.maximum(pair.allowed(1e-9, 8.0) * np.array(scale), max(1e-9, pair.precision * _largest_torque(pair.a)))
        yield worst("gravity torque", "N m or N", np.array(torque), allowed, label)


def _largest_torque(model: KinematicModel) -> float:
    """What gravity could do at most, in N m: numbers of single precision leave a part of it where a balanced robot feels nothing."""
    reach = np.zeros(len(model.bodies))
    for i, body in enumerate(model.bodies[1:], start=1):
        reach[i] = 0.0 if body.parent == WORLD else reach[body.parent] + np.linalg.norm(body.joint.placement[:3, 3])
    anchors = [max((float(np.linalg.norm(dof.anchor)) for dof in body.joint.dofs), default=0.0) for body in model.bodies]
    levers = reach + np.array([float(np.linalg.norm(body.com)) for body in model.bodies]) + anchors
    return 9.81 * float(levers @ np.array([abs(body.mass) for body in model.bodies]))


def _trees(pair: Pair, weightless: tuple[frozenset[int], frozenset[int]]) -> Iterator[tuple[PinModel, PinModel]]:
    """The trees of both robots that have the same coordinates; a note for the others."""
    roots_a, roots_b = _root_of_dofs(pair.a), _root_of_dofs(pair.b)
    turned = {d for item in pair.match.turned for d in item.dofs_a}
    partner = dict(pair.match.dofs)
    for root in pair.a.children[WORLD]:
        dofs = [d for d in range(len(pair.a.dofs)) if roots_a[d] == root and pair.a.body_of_dof[d] not in pair.match.floor_a]
        if not dofs:
            continue
        if turned.intersection(dofs):
            pair.notes.append(
                f"mass matrix: the tree of {pair.a.body_label(root)} has other coordinates (a ball is three hinges in one of the two)"
            )
            continue
        roots = {roots_b[partner[d]] for d in dofs if d in partner}
        if len(roots) != 1 or any(d not in partner or _differ(pair, d, partner[d]) for d in dofs):
            pair.notes.append(f"mass matrix: the trees of {pair.a.body_label(root)} have other coordinates")
            continue
        if len(dofs) > _MOST_DOFS:
            where = f"{len(dofs)} coordinates below {pair.a.body_label(root)}"
            pair.notes.append(f"mass matrix: {where} are too many for Pinocchio; inertia and kinematics imply it")
            continue
        yield (
            build(pair.a, root, floor=frozenset(pair.match.floor_a), weightless=weightless[0]),
            build(pair.b, roots.pop(), floor=frozenset(pair.match.floor_b), weightless=weightless[1]),
        )


def _differ(pair: Pair, d: int, e: int) -> bool:
    return pair.a.dofs[d].kind is not pair.b.dofs[e].kind


def _root_of_dofs(model: KinematicModel) -> list[int]:
    root = list(range(len(model.bodies)))
    for i, body in enumerate(model.bodies[1:], start=1):
        root[i] = i if body.parent == WORLD else root[body.parent]
    return [root[i] for i in model.body_of_dof]


def _rows(count: int, width: int) -> slice:
    """All configurations, or the first ones where the mass matrices would be too many numbers."""
    return slice(0, min(count, max(4, _MOST_ENTRIES // max(1, width * width))))


def _compare(ours: tuple[Array, Array], theirs: tuple[Array, Array]) -> tuple[float, float, float, int]:
    """Worst relative difference of two mass matrices, worst torque difference, largest torque, and the column of the worst."""
    (mass_a, gravity_a), (mass_b, gravity_b) = ours, theirs
    diagonal = np.maximum(np.diag(mass_a), 1e-6 * float(np.diag(mass_a).max(initial=0.0)) + 1e-9)
    apart = np.abs(mass_a - mass_b) / np.sqrt(np.outer(diagonal, diagonal))
    torque = np.abs(gravity_a - gravity_b)
    at = int(apart.max(axis=1).argmax())
    return float(apart.max()), float(torque.max()), float(np.abs(gravity_a).max()), at


def _dof_of_column(model: KinematicModel, dofs: list[int], column: int) -> str:
    widths = np.cumsum([{Kind.BALL: 3, Kind.FREE: 6}.get(model.dofs[d].kind, 1) for d in dofs])
    return model.dof_label(dofs[int(np.searchsorted(widths, column, side="right"))])
