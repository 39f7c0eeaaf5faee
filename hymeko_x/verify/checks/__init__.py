"""The checks that make up a verdict, in its order.

To add a check: write a file here whose docstring names what is compared, its unit and its allowance, with a function that takes a
:class:`Pair` and yields a :class:`Check` for each quantity of which something was compared, and add the function to :data:`CHECKS`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hymeko_x.verify.checks.actuators import check_actuators
from hymeko_x.verify.checks.chains import check_chains
from hymeko_x.verify.checks.dofs import check_dofs
from hymeko_x.verify.checks.dynamics import check_dynamics, disagreement
from hymeko_x.verify.checks.inertia import check_inertia
from hymeko_x.verify.checks.kinematics import check_kinematics
from hymeko_x.verify.checks.loops import check_loops
from hymeko_x.verify.checks.pair import MOST_SHOWN, Pair, counted, pair_up
from hymeko_x.verify.checks.shapes import check_shapes
from hymeko_x.verify.checks.tendons import check_tendons
from hymeko_x.verify.matching import BASE, BODIES, JOINTS, match
from hymeko_x.verify.matching.held import with_bases_held
from hymeko_x.verify.meshes import Meshes
from hymeko_x.verify.verdict import Check, Gap, Verdict

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from hymeko_x.verify.model import KinematicModel


def check_matching(pair: Pair) -> Iterator[Check]:
    """Bodies, joints and bases without a counterpart, or joined differently. Allowed: none."""
    if max(len(pair.a.bodies), len(pair.b.bodies)) < 2:
        return
    for quantity in (BODIES, JOINTS, BASE):
        yield counted(quantity, [finding.words for finding in pair.match.findings if finding.quantity == quantity])


CHECKS: tuple[Callable[[Pair], Iterator[Check]], ...] = (
    check_matching,
    check_kinematics,
    check_loops,
    check_chains,
    check_dofs,
    check_inertia,
    check_dynamics,
    check_shapes,
    check_actuators,
    check_tendons,
)

QUANTITIES = (
    BODIES,
    JOINTS,
    BASE,
    "forward kinematics, position",
    "forward kinematics, rotation",
    "loops",
    "loop closure, position",
    "loop closure, rotation",
    "DH parameters, lengths",
    "DH parameters, angles",
    "position limits",
    "velocity limits",
    "effort limits",
    "damping",
    "friction",
    "armature",
    "stiffness",
    "spring reference",
    "nonlinear damping and stiffness",
    "coordinate references",
    "couplings",
    "coupled coordinates",
    "mass",
    "centre of mass",
    "inertia tensor",
    "mass matrix",
    "gravity torque",
    "collision shapes",
    "collision shapes, size and pose",
    "collision meshes",
    "visual shapes",
    "visual shapes, size and pose",
    "visual meshes",
    "actuators",
    "actuators, numbers",
    "sensors",
    "couplings of tendons",
    "tendons",
)
"""What the checks compare, in their order; those of which a pair of robots has nothing have no row in its verdict."""

_CONFIRMED = 2
"""The number of configurations, the last ones, at which Pinocchio confirms the batched kinematics of each robot."""


_UNIT_LENGTH = 1e-6
"""The length of an axis may differ from 1 by this: single precision."""


def compare(
    a: KinematicModel, b: KinematicModel, *, samples: int = 100, seed: int = 0, structure: bool = False, meshes: bool | Meshes = True
) -> Verdict:
    """Whether two models are the same robot, at ``samples`` configurations drawn with ``seed`` in the first one's limits."""
    engines = a.engine, b.engine
    for model in (a, b):
        reason = _unusable(model)
        if reason:
            return Verdict(engines, reason=reason)
    a, b = with_bases_held(a, b), with_bases_held(b, a)
    reader = Meshes(read=meshes) if isinstance(meshes, bool) else meshes
    pair = pair_up(a, b, match(a, b, structure=structure), samples, seed, meshes=reader)
    for model, q in ((a, pair.q_a), (b, pair.q_b)):
        difference = disagreement(model, q[-_CONFIRMED:])
        if difference:
            return Verdict(engines, reason=f"Pinocchio and the batched kinematics disagree about the {model.format} side: {difference}")
    checks = tuple(found for check in CHECKS for found in check(pair))
    if not checks:
        return Verdict(engines, reason="there is nothing to compare: neither robot has bodies or shapes")
    done = {check.quantity for check in checks}
    nothing = tuple(quantity for quantity in QUANTITIES if quantity not in done)
    trust = [
        f"trust: the {m.format} side was read by hymeko-x itself, not by an independent engine" for m in (a, b) if not m.is_independent
    ]
    notes = (*trust, *pair.notes, *(f"{model.format}: {note}" for model in (a, b) for note in model.notes))
    return Verdict(engines, checks, tuple(dict.fromkeys(notes)), gaps=merged(pair.gaps), nothing=nothing)


def merged(gaps: Iterable[Gap]) -> tuple[Gap, ...]:
    """Gaps of one format and quantity as one."""
    found: dict[tuple[str, str], Gap] = {}
    for gap in gaps:
        before = found.get((gap.format, gap.quantity))
        if before is not None:
            gap = Gap(gap.format, gap.quantity, before.count + gap.count, (*before.names, *gap.names)[:MOST_SHOWN])
        found[gap.format, gap.quantity] = gap
    return tuple(found.values())


def _unusable(model: KinematicModel) -> str:
    """Why nothing can be computed with a model; "" when it can."""
    for index, body in enumerate(model.bodies):
        numbers = np.concatenate([body.joint.placement.ravel(), body.com, body.tensor.ravel(), [body.mass]])
        if not np.isfinite(numbers).all():
            return f"{model.body_label(index)} has numbers that are not finite in {model.format}"
    for index, dof in enumerate(model.dofs):
        if dof.kind.scalar and not abs(float(np.linalg.norm(dof.axis)) - 1.0) < _UNIT_LENGTH:
            return f"{model.dof_label(index)} has no axis in {model.format}"
    return ""
