"""From two models to one verdict."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hymeko_x.verify.checks.actuators import check_parts
from hymeko_x.verify.checks.chains import check_chains
from hymeko_x.verify.checks.dofs import check_dofs
from hymeko_x.verify.checks.dynamics import check_dynamics, disagreement
from hymeko_x.verify.checks.inertia import check_inertia
from hymeko_x.verify.checks.motion import check_motion
from hymeko_x.verify.checks.pair import Pair, counted, pair_up
from hymeko_x.verify.checks.shapes import check_shapes
from hymeko_x.verify.checks.tendons import check_tendons
from hymeko_x.verify.matching import BASE, BODIES, JOINTS, match
from hymeko_x.verify.meshes import Meshes
from hymeko_x.verify.verdict import Check, Verdict

if TYPE_CHECKING:
    from hymeko_x.verify.model import KinematicModel

_OPINION = 2  # configurations at which Pinocchio is asked about the batched kinematics


def compare(
    a: KinematicModel, b: KinematicModel, *, samples: int = 100, seed: int = 0, structure: bool = False, meshes: bool | Meshes = True
) -> Verdict:
    """Whether two models are the same robot, at ``samples`` configurations drawn with ``seed`` in the first one's limits."""
    engines = a.engine, b.engine
    for model in (a, b):
        reason = _unusable(model)
        if reason:
            return Verdict(engines, reason=reason)
    shelf = Meshes(read=meshes) if isinstance(meshes, bool) else meshes
    pair = pair_up(a, b, match(a, b, structure=structure), samples, seed, meshes=shelf)
    for model, q in ((a, pair.q_a), (b, pair.q_b)):
        apart = disagreement(model, q[-_OPINION:])
        if apart:
            return Verdict(engines, reason=f"Pinocchio and the batched kinematics disagree about the {model.format} side: {apart}")
    checks = tuple(_checks(pair))
    notes = (*_trust(a, b), *pair.notes, *(f"{model.format}: {note}" for model in (a, b) for note in model.notes))
    return Verdict(engines, checks, tuple(dict.fromkeys(notes)))


def _checks(pair: Pair) -> list[Check]:
    findings = {quantity: [f.words for f in pair.match.findings if f.quantity == quantity] for quantity in (BODIES, JOINTS, BASE)}
    return [
        *(counted(quantity, words) for quantity, words in findings.items()),
        *check_motion(pair),
        *check_chains(pair),
        *check_dofs(pair),
        *check_inertia(pair),
        *check_dynamics(pair),
        *check_shapes(pair),
        *check_parts(pair),
        *check_tendons(pair),
    ]


def _trust(a: KinematicModel, b: KinematicModel) -> list[str]:
    return [
        f"trust: the {model.format} side was read by hymeko-x itself, not by an independent engine" for model in (a, b) if not model.trusted
    ]


def _unusable(model: KinematicModel) -> str:
    """Why nothing can be computed with a model; "" when it can."""
    for index, body in enumerate(model.bodies):
        numbers = np.concatenate([body.joint.placement.ravel(), body.com, body.tensor.ravel(), [body.mass]])
        if not np.isfinite(numbers).all():
            return f"{model.body_label(index)} has numbers that are not finite in {model.format}"
    for index, dof in enumerate(model.dofs):
        if dof.kind.scalar and not abs(float(np.linalg.norm(dof.axis)) - 1.0) < 1e-6:
            return f"{model.dof_label(index)} has no axis in {model.format}"
    return ""
