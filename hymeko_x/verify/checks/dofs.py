"""The numbers of each coordinate: limits, mechanics, references, and who follows whom."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hymeko_x.verify.checks.pair import Pair, counted, worst
from hymeko_x.verify.model import INF, Array, Dof, Feature, Kind

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from hymeko_x.verify.verdict import Check

FAR = 1e9
"""A bound beyond this is none: engines without one-sided limits write such numbers."""

LIMIT = 2e-9
"""In rad or m: a locked coordinate is given 1e-9 of play where an engine knows no interval of width zero."""

_MECHANICS = {
    Feature.DAMPING: ("damping", "N m s/rad", lambda dof: dof.damping),
    Feature.FRICTION: ("friction", "N m", lambda dof: dof.friction),
    Feature.ARMATURE: ("armature", "kg m^2", lambda dof: dof.armature),
}


def check_dofs(pair: Pair) -> Iterator[Check]:
    """Every check of single coordinates."""
    yield from _check_limits(pair)
    for feature, (name, unit, value) in _MECHANICS.items():
        yield from _check_numbers(pair, feature, name, unit, value)
    yield from _check_springs(pair)
    yield from _check_references(pair)
    yield from _check_couplings(pair)


# ---- limits ----------------------------------------------------------------------------------------------------------


def _check_limits(pair: Pair) -> Iterator[Check]:
    scalar = [k for k, (d, _) in enumerate(pair.match.dofs) if pair.a.dofs[d].kind is not Kind.FREE]
    lower = _differences(pair, scalar, lambda dof, shift: _bound(dof.lower, shift))
    upper = _differences(pair, scalar, lambda dof, shift: _bound(dof.upper, shift))
    sizes = np.array([_size(pair.a.dofs[pair.match.dofs[k][0]]) for k in scalar])
    empty = _contradictory(pair, scalar)
    yield worst(
        "position limits", "rad or m", np.where(empty, 0.0, np.maximum(lower, upper)), _allowed(pair, LIMIT, sizes), _label(pair, scalar)
    )
    yield from _check_bounds(pair, scalar, Feature.VELOCITY_LIMITS, "velocity limits", "rad/s or m/s", _velocity)
    yield from _check_bounds(pair, scalar, Feature.EFFORT_LIMITS, "effort limits", "N m or N", _effort)


def _bound(value: float, shift: float) -> float:
    return value - shift if abs(value) < FAR else float(np.copysign(INF, value))


def _size(dof: Dof) -> float:
    finite = [abs(x) for x in (dof.lower, dof.upper) if abs(x) < FAR]
    return max(finite, default=0.0)


def _velocity(dof: Dof) -> tuple[float, float]:
    return -_or_none(dof.velocity), _or_none(dof.velocity)


def _effort(dof: Dof) -> tuple[float, float]:
    """A file that says 0 or a negative number does not mean that the motor is dead; engines read 0 as no limit."""
    low, high = dof.effort
    if low == -high:
        return -_or_none(abs(high)), _or_none(abs(high))
    return low, high


def _or_none(value: float) -> float:
    return INF if value == 0.0 or value >= FAR else value


def _check_bounds(
    pair: Pair, scalar: list[int], feature: Feature, name: str, unit: str, bounds: Callable[[Dof], tuple[float, float]]
) -> Iterator[Check]:
    _note_unsaid(pair, feature, lambda dof: bounds(dof) != (-INF, INF))
    if not pair.both_say(feature):
        return
    scalar = [k for k in scalar if _both_say(pair, feature, *pair.match.dofs[k])]
    low = _differences(pair, scalar, lambda dof, _: bounds(dof)[0])
    high = _differences(pair, scalar, lambda dof, _: bounds(dof)[1])
    sizes = np.array([max((abs(x) for x in bounds(pair.a.dofs[pair.match.dofs[k][0]]) if abs(x) < INF), default=0.0) for k in scalar])
    yield worst(name, unit, np.maximum(low, high), _allowed(pair, 1e-9, sizes), _label(pair, scalar))


def _contradictory(pair: Pair, scalar: list[int]) -> Array:
    """Where one robot has limits that engines disagree about and the other has none.

    A lower limit above the upper one; and [0, 0], with which urdfdom locks the joint while MuJoCo's reader of URDF takes none.
    """
    empty = np.zeros(len(scalar), dtype=bool)
    for place, k in enumerate(scalar):
        d, e = pair.match.dofs[k]
        ours, theirs = pair.a.dofs[d], pair.b.dofs[e]
        open_one, other = (theirs, ours) if _is_unlimited(theirs) else (ours, theirs)
        empty[place] = _is_unlimited(open_one) and (other.lower > other.upper or other.lower == other.upper == 0.0)
        if empty[place]:
            pair.notes.append(f"position limits: [{other.lower:.6g}, {other.upper:.6g}] of {pair.a.dof_label(d)} is none for some engines")
    return empty


def _is_unlimited(dof: Dof) -> bool:
    return dof.lower <= -FAR and dof.upper >= FAR


# ---- mechanics -------------------------------------------------------------------------------------------------------


def _check_numbers(pair: Pair, feature: Feature, name: str, unit: str, value: Callable[[Dof], float]) -> Iterator[Check]:
    _note_unsaid(pair, feature, lambda dof: value(dof) != 0.0)
    if not pair.both_say(feature):
        return
    known = [(d, e) for d, e in (*pair.match.dofs, *_turned(pair)) if _both_say(pair, feature, d, e)]
    sizes = np.array([abs(value(pair.a.dofs[d])) for d, _ in known])
    apart = np.array([abs(value(pair.b.dofs[e]) - value(pair.a.dofs[d])) for d, e in known])
    yield worst(name, unit, apart, _allowed(pair, 1e-12, sizes), lambda place: pair.a.dof_label(known[place][0]))


def _turned(pair: Pair) -> Iterator[tuple[int, int]]:
    """A ball and each of the hinges that stand for it: what acts on the ball acts on each of them."""
    for turned in pair.match.turned:
        yield from ((d, e) for d in turned.dofs_a for e in turned.dofs_b)


def _check_springs(pair: Pair) -> Iterator[Check]:
    _note_unsaid(pair, Feature.SPRINGS, lambda dof: dof.stiffness != 0.0 or bool(dof.nonlinear))
    if not pair.both_say(Feature.SPRINGS):
        return
    known = list(range(len(pair.match.dofs)))
    label = _label(pair, known)
    stiffness = np.array([abs(pair.a.dofs[d].stiffness) for d, _ in pair.match.dofs])
    yield worst("stiffness", "N m/rad", _differences(pair, known, lambda dof, _: dof.stiffness), _allowed(pair, 1e-12, stiffness), label)
    yield worst(
        "spring reference",
        "rad or m",
        _differences(pair, known, lambda dof, shift: dof.spring_ref - shift * bool(dof.stiffness)),
        _allowed(pair, LIMIT, 0.0 * stiffness + 1.0),
        label,
    )
    curved = [
        f"{pair.a.dof_label(d)} has other curves"
        for d, e in pair.match.dofs
        if not _alike(pair.a.dofs[d].nonlinear, pair.b.dofs[e].nonlinear)
    ]
    if any(pair.a.dofs[d].nonlinear or pair.b.dofs[e].nonlinear for d, e in pair.match.dofs):
        yield counted("nonlinear damping and stiffness", curved)


def _alike(a: tuple[float, ...], b: tuple[float, ...]) -> bool:
    width = max(len(a), len(b))
    return bool(np.allclose(np.resize([*a, *[0.0] * (width - len(a))], width), [*b, *[0.0] * (width - len(b))], rtol=1e-9, atol=0.0))


def _check_references(pair: Pair) -> Iterator[Check]:
    """A shifted coordinate is a difference where both formats can say what it counts from."""
    shifts = np.abs(np.array(pair.shifts))
    if pair.both_say(Feature.REFS):
        if shifts.any():
            yield worst("coordinate references", "rad or m", shifts, LIMIT, lambda k: pair.a.dof_label(pair.match.dofs[k][0]))
        return
    moved = [f"{pair.a.dof_label(pair.match.dofs[k][0])} by {pair.shifts[k]:.6g}" for k in np.flatnonzero(shifts)]
    if moved:
        pair.notes.append(f"coordinates count from another zero: {', '.join(moved[:5])}{' and more' if len(moved) > 5 else ''}")


# ---- couplings -------------------------------------------------------------------------------------------------------


def _check_couplings(pair: Pair) -> Iterator[Check]:
    """The same dofs follow, and are at the same place at every configuration."""
    ours, theirs = set(_sayable_followers(pair)), {coupling.follower for coupling in pair.b.couplings}
    if not ours and not theirs:
        return
    partner = dict(pair.match.dofs)
    paired = set(partner.values())
    missing = [f"{pair.a.dof_label(d)} follows nothing in the other" for d in sorted(ours) if d not in partner or partner[d] not in theirs]
    led = {partner[d] for d in ours if d in partner}
    new = [f"{pair.b.dof_label(e)} follows only in the other" for e in sorted(theirs & paired - led)]
    yield counted("couplings", missing + new)
    both = [k for k, (d, e) in enumerate(pair.match.dofs) if d in ours and e in theirs]
    apart = np.array([_follower_distance(pair, k) for k in both])
    size = np.array([float(np.abs(pair.q_a[:, pair.a.columns[pair.match.dofs[k][0]]]).max()) for k in both])
    yield worst("coupled coordinates", "rad or m", apart, _allowed(pair, 1e-9, size), _label(pair, both))


def _sayable_followers(pair: Pair) -> Iterator[int]:
    """The first robot's dofs that follow in a way that the second's format can say; a note for the others."""
    curved = [] if Feature.CURVES in pair.b.says else [coupling for coupling in pair.a.couplings if not coupling.straight]
    yield from (coupling.follower for coupling in pair.a.couplings if coupling not in curved)
    if curved:
        said = ", ".join(pair.a.dof_label(coupling.follower) for coupling in curved[:3])
        pair.notes.append(f"{Feature.CURVES.value}: {pair.b.format} has none; {len(curved)} in {pair.a.format}: {said}")


def _follower_distance(pair: Pair, k: int) -> float:
    d, e = pair.match.dofs[k]
    return float(np.abs(pair.q_b[:, pair.b.columns[e]] - pair.shifts[k] - pair.q_a[:, pair.a.columns[d]]).max())


# ---- shared ----------------------------------------------------------------------------------------------------------


def _differences(pair: Pair, which: list[int], value: Callable[[Dof, float], float]) -> Array:
    """|value of b - value of a| of these dof pairs; two equal infinities do not differ."""
    out = np.zeros(len(which))
    for place, k in enumerate(which):
        d, e = pair.match.dofs[k]
        x, y = value(pair.a.dofs[d], 0.0), value(pair.b.dofs[e], pair.shifts[k])
        out[place] = 0.0 if x == y else abs(y - x)
    return out


def _allowed(pair: Pair, least: float, sizes: Array) -> Array:
    allowed: Array = np.maximum(least, np.maximum(1e-9, 8.0 * pair.precision) * sizes)
    return allowed


def _label(pair: Pair, which: list[int]) -> Callable[[int], str]:
    return lambda place: pair.a.dof_label(pair.match.dofs[which[place]][0])


def _note_unsaid(pair: Pair, feature: Feature, said: Callable[[Dof], bool]) -> None:
    """A note where one side says something that the other's format or reader cannot."""
    for model, other in ((pair.a, pair.b), (pair.b, pair.a)):
        unsaid = [dof for dof in model.dofs if said(dof) and not other.can_say(feature, dof.kind)]
        if not unsaid:
            continue
        kinds = sorted({dof.kind.value for dof in unsaid})
        where = "" if feature not in other.says else f" for {' and '.join(kinds)} joints"
        pair.notes.append(f"{feature.value}: {other.format} has none{where}; {len(unsaid)} in {model.format}")


def _both_say(pair: Pair, feature: Feature, d: int, e: int) -> bool:
    return pair.a.can_say(feature, pair.a.dofs[d].kind) and pair.b.can_say(feature, pair.b.dofs[e].kind)
