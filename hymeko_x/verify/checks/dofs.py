"""The numbers of each coordinate: limits, mechanics, springs, references, and couplings.

Compared: position limits and references in rad or m; velocity and effort limits, damping, friction, armature and stiffness in SI units;
the coordinates of followers at every configuration. Allowed: 1e-9 of the value, 2e-9 rad or m for positions.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hymeko_x.verify.checks.pair import RELATIVE, Differences, Pair, counted, same_numbers
from hymeko_x.verify.features import Feature
from hymeko_x.verify.model import INF, Dof, Kind

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from hymeko_x.verify.verdict import Check

FAR = 1e9
"""A bound beyond this is none: engines without one-sided limits write such numbers."""

LIMIT = 2e-9
"""In rad or m: a locked coordinate is given 1e-9 of play where an engine knows no interval of width zero."""

TINY = 1e-12
"""In SI units: mechanics below it are zero."""

_MECHANICS: dict[Feature, tuple[str, str, Callable[[Dof], float]]] = {
    Feature.FRICTION: ("friction", "N m", lambda dof: dof.friction),
    Feature.ARMATURE: ("armature", "kg m^2", lambda dof: dof.armature),
}


def check_dofs(pair: Pair) -> Iterator[Check]:
    """Every check of single coordinates."""
    yield from _check_limits(pair)
    yield from _check_bounds(pair, Feature.VELOCITY_LIMITS, "velocity limits", "rad/s or m/s", _velocity)
    yield from _check_bounds(pair, Feature.EFFORT_LIMITS, "effort limits", "N m or N", _driven_effort(pair))
    yield from _check_mechanics(pair, Feature.DAMPING, "damping", "N m s/rad", _damping(pair))
    for feature, (name, unit, value) in _MECHANICS.items():
        yield from _check_mechanics(pair, feature, name, unit, value)
    yield from _check_springs(pair)
    yield from _check_references(pair)
    yield from _check_couplings(pair)


# ---- limits ----------------------------------------------------------------------------------------------------------


def _check_limits(pair: Pair) -> Iterator[Check]:
    _add_unrepresented(pair, Feature.POSITION_LIMITS, lambda dof: dof.kind is not Kind.FREE and not _is_unlimited(dof))
    found = Differences("position limits", "rad or m")
    for (d, e), shift in zip(pair.match.dofs, pair.shifts, strict=True):
        ours, theirs = pair.a.dofs[d], pair.b.dofs[e]
        if ours.kind is Kind.FREE or not _both_represent(pair, Feature.POSITION_LIMITS, d, e):
            continue
        lower = _distance(_bound(ours.lower), _bound(theirs.lower, shift))
        upper = _distance(_bound(ours.upper), _bound(theirs.upper, shift))
        difference = 0.0 if _is_contradictory(pair, d, e) else max(lower, upper)
        if _is_unlimited(ours) and _is_unlimited(theirs):
            continue
        allowed = pair.relative(LIMIT, *(x for x in (ours.lower, ours.upper) if abs(x) < FAR))
        found.add(difference, allowed, pair.a.dof_label(d), (ours.lower, ours.upper), (theirs.lower - shift, theirs.upper - shift))
    yield from found.checks()


def _bound(value: float, shift: float = 0.0) -> float:
    return value - shift if abs(value) < FAR else float(np.copysign(INF, value))


def _velocity(dof: Dof) -> tuple[float, float]:
    return -_or_none(dof.velocity), _or_none(dof.velocity)


def _effort(dof: Dof) -> tuple[float, float]:
    """0 or a negative number in a file does not mean that the motor is dead; engines read 0 as no limit."""
    low, high = dof.effort
    if low == -high:
        return -_or_none(abs(high)), _or_none(abs(high))
    return low, high


def _driven_effort(pair: Pair) -> Callable[[Dof], tuple[float, float]]:
    """The effort limits; where a format has no actuators, a joint without one has what they can exert in the other."""
    if pair.both_represent(Feature.ACTUATORS):
        return _effort
    return lambda dof: (-dof.driven, dof.driven) if _effort(dof) == (-INF, INF) else _effort(dof)


def _or_none(value: float) -> float:
    return INF if value == 0.0 or value >= FAR else value


def _check_bounds(pair: Pair, feature: Feature, name: str, unit: str, bounds: Callable[[Dof], tuple[float, float]]) -> Iterator[Check]:
    _add_unrepresented(pair, feature, lambda dof: bounds(dof) != (-INF, INF))
    found = Differences(name, unit)
    for d, e in pair.match.dofs:
        if pair.a.dofs[d].kind is not Kind.FREE and _both_represent(pair, feature, d, e):
            ours, theirs = bounds(pair.a.dofs[d]), bounds(pair.b.dofs[e])
            difference = max(map(_distance, ours, theirs))
            if ours != (-INF, INF) or theirs != (-INF, INF):
                allowed = pair.relative(RELATIVE, *(x for x in ours if abs(x) < INF))
                found.add(difference, allowed, pair.a.dof_label(d), ours, theirs)
    yield from found.checks()


def _is_contradictory(pair: Pair, d: int, e: int) -> bool:
    """Whether one robot has limits that engines disagree about and the other has none; a note names them.

    A lower limit above the upper one; and [0, 0], with which urdfdom locks the joint while MuJoCo's reader of URDF takes no limits.
    """
    ours, theirs = pair.a.dofs[d], pair.b.dofs[e]
    unlimited, other = (theirs, ours) if _is_unlimited(theirs) else (ours, theirs)
    if not _is_unlimited(unlimited) or not (other.lower > other.upper or other.lower == other.upper == 0.0):
        return False
    pair.notes.append(f"position limits: [{other.lower:.6g}, {other.upper:.6g}] of {pair.a.dof_label(d)} is none for some engines")
    return True


def _is_unlimited(dof: Dof) -> bool:
    return dof.lower <= -FAR and dof.upper >= FAR


# ---- mechanics -------------------------------------------------------------------------------------------------------


def _check_mechanics(pair: Pair, feature: Feature, name: str, unit: str, value: Callable[[Dof], float]) -> Iterator[Check]:
    """One number of every dof. Of a ball that is three hinges in the other robot, it is that of each of them."""
    _add_unrepresented(pair, feature, lambda dof: value(dof) != 0.0)
    found = Differences(name, unit)
    hinges = ((d, e) for item in pair.match.balls for d in item.dofs_a for e in item.dofs_b)
    for d, e in (*pair.match.dofs, *hinges):
        if _both_represent(pair, feature, d, e):
            ours, theirs = value(pair.a.dofs[d]), value(pair.b.dofs[e])
            if ours or theirs:
                found.add(abs(theirs - ours), pair.relative(TINY, ours), pair.a.dof_label(d), ours, theirs)
    yield from found.checks()


def _damping(pair: Pair) -> Callable[[Dof], float]:
    """The damping of a dof; where a format has only positive damping, 0 in place of a negative one, which is a gap."""
    if pair.both_represent(Feature.NEGATIVE_DAMPING):
        return lambda dof: dof.damping
    if pair.both_represent(Feature.DAMPING):
        _add_unrepresented(pair, Feature.NEGATIVE_DAMPING, lambda dof: dof.damping < 0.0)
    return lambda dof: max(dof.damping, 0.0)


def _check_springs(pair: Pair) -> Iterator[Check]:
    _add_unrepresented(pair, Feature.SPRINGS, lambda dof: dof.stiffness != 0.0 or bool(dof.nonlinear))
    if not pair.both_represent(Feature.SPRINGS):
        return
    stiffness, reference = Differences("stiffness", "N m/rad"), Differences("spring reference", "rad or m")
    curved: list[str] = []
    dofs = [(d, pair.a.dofs[d], pair.b.dofs[e], shift) for (d, e), shift in zip(pair.match.dofs, pair.shifts, strict=True)]
    for d, ours, theirs, shift in dofs:
        label = pair.a.dof_label(d)
        if ours.stiffness or theirs.stiffness:
            allowed = pair.relative(TINY, ours.stiffness)
            stiffness.add(_distance(ours.stiffness, theirs.stiffness), allowed, label, ours.stiffness, theirs.stiffness)
        rest = theirs.spring_ref - shift * bool(theirs.stiffness)
        if ours.stiffness or theirs.stiffness or ours.spring_ref or rest:
            reference.add(_distance(ours.spring_ref, rest), pair.relative(LIMIT, 1.0), label, ours.spring_ref, rest)
        if not same_numbers(ours.nonlinear, theirs.nonlinear):
            curved.append(f"{label} has other curves")
    yield from (*stiffness.checks(), *reference.checks())
    if any(ours.nonlinear or theirs.nonlinear for _, ours, theirs, _ in dofs):
        yield counted("nonlinear damping and stiffness", curved)


def _check_references(pair: Pair) -> Iterator[Check]:
    """A shifted coordinate is a difference where both formats represent its reference, else a gap of the one that does not."""
    shifted = [(pair.a.dof_label(d), shift) for (d, _), shift in zip(pair.match.dofs, pair.shifts, strict=True) if shift]
    if pair.both_represent(Feature.REFS):
        found = Differences("coordinate references", "rad or m")
        for label, shift in shifted:
            found.add(abs(shift), LIMIT, label)
        yield from found.checks()
    else:
        side = pair.a if Feature.REFS not in pair.a.features else pair.b
        pair.add_gap(side, Feature.REFS, [f"{label} is shifted by {shift:.6g}" for label, shift in shifted])


# ---- couplings -------------------------------------------------------------------------------------------------------


def _check_couplings(pair: Pair) -> Iterator[Check]:
    """The same dofs follow, and their coordinates are equal at every configuration."""
    ours, theirs = set(_representable_followers(pair)), {coupling.follower for coupling in pair.b.couplings}
    if not ours and not theirs:
        return
    partner = dict(pair.match.dofs)
    missing = [f"{pair.a.dof_label(d)} follows nothing in the other" for d in sorted(ours) if partner.get(d) not in theirs]
    new = theirs & set(partner.values()) - {partner[d] for d in ours if d in partner}
    yield counted("couplings", missing + [f"{pair.b.dof_label(e)} follows only in the other" for e in sorted(new)])
    found = Differences("coupled coordinates", "rad or m")
    for (d, e), shift in zip(pair.match.dofs, pair.shifts, strict=True):
        if d in ours and e in theirs:
            q_a, q_b = pair.q_a[:, pair.a.columns[d]], pair.q_b[:, pair.b.columns[e]]
            allowed = pair.relative(RELATIVE, float(np.abs(q_a).max()))
            found.add(float(np.abs(q_b - shift - q_a).max()), allowed, pair.a.dof_label(d))
    yield from found.checks()


def _representable_followers(pair: Pair) -> Iterator[int]:
    """The first robot's dofs that follow in a way that the second's format represents; a gap for the others."""
    curved = [] if Feature.CURVES in pair.b.features else [coupling for coupling in pair.a.couplings if not coupling.straight]
    yield from (coupling.follower for coupling in pair.a.couplings if coupling not in curved)
    pair.add_gap(pair.b, Feature.CURVES, [pair.a.dof_label(coupling.follower) for coupling in curved])


# ---- shared ----------------------------------------------------------------------------------------------------------


def _distance(ours: float, theirs: float) -> float:
    """Of two numbers; two equal infinities do not differ."""
    return 0.0 if ours == theirs else abs(theirs - ours)


def _add_unrepresented(pair: Pair, feature: Feature, has_it: Callable[[Dof], bool]) -> None:
    """A gap where dofs of one side have a number that the other's format or reader does not represent."""
    for model, other in ((pair.a, pair.b), (pair.b, pair.a)):
        found = [d for d, dof in enumerate(model.dofs) if has_it(dof) and not other.represents(feature, dof.kind)]
        kinds = sorted({model.dofs[d].kind.value for d in found})
        where = "" if feature not in other.features else f" of {' and '.join(kinds)} joints"
        pair.add_gap(other, feature, [model.dof_label(d) for d in found], f"{feature.value}{where}")


def _both_represent(pair: Pair, feature: Feature, d: int, e: int) -> bool:
    return pair.a.represents(feature, pair.a.dofs[d].kind) and pair.b.represents(feature, pair.b.dofs[e].kind)
