"""Tendons: through which joints, sites and shapes their paths lead, where these are, and how a tendon acts on its length.

Compared: the steps of each path; places in m, axes in rad; coefficients, divisors, mechanics, limits and spring lengths in SI units.
Allowed: 1e-9 m, 1e-7 rad, 1e-9 of a number.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

import numpy as np

from hymeko_x.verify.checks.pair import Differences, Pair, counted, same_numbers
from hymeko_x.verify.features import Feature
from hymeko_x.verify.matching.bodies import speller
from hymeko_x.verify.model import JOINT, PULLEY, SIDE, KinematicModel, SpringRange, Step, Tendon

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from hymeko_x.verify.verdict import Check

_POINT = 1e-9
"""In m."""

_AXIS = 1e-7
"""In rad: formats with quaternions in single precision keep no more of a direction."""

_TINY = 1e-12
"""In SI units: numbers below it are zero."""

_WORDS = {SIDE: "a site beside a shape", PULLEY: "a pulley"}
_MECHANICS = ("stiffness", "damping", "friction", "armature")
_UNITS = {"coefficients": "SI", "path": "m", "axes": "rad"} | dict.fromkeys((*_MECHANICS, "limits", "force limits", "spring lengths"), "SI")


def check_tendons(pair: Pair) -> Iterator[Check]:
    """Every tendon of the first robot in the second, and no new ones."""
    if not pair.both_represent(Feature.TENDONS):
        pair.add_unrepresented(Feature.TENDONS, lambda model: [_name(tendon) for tendon in model.tendons])
        return
    if not pair.a.tendons and not pair.b.tendons:
        return
    pairs, findings = _pair_tendons(pair)
    bodies, dofs = dict(pair.match.bodies), dict(pair.match.dofs)
    paths = [(ours, theirs, _path_difference(pair, ours, theirs, bodies, dofs)) for ours, theirs in pairs]
    yield counted(Feature.TENDONS.value, [*findings, *(words for _, _, words in paths if words)])
    comparable = [(ours, theirs) for ours, theirs, words in paths if not words]
    found = {word: Differences(f"tendons, {word}", unit) for word, unit in _UNITS.items()}
    for ours, theirs in comparable:
        _compare(pair, ours, theirs, found)
    for differences in found.values():
        yield from differences.checks()
    yield from _check_curves(pair, comparable)


# ---- counterparts ----------------------------------------------------------------------------------------------------


def _pair_tendons(pair: Pair) -> tuple[list[tuple[Tendon, Tendon]], list[str]]:
    """By name; a tendon that has no name in one of the files by its place among the rest."""
    spell = speller(pair.a, pair.b)
    named = {spell(tendon.name): tendon for tendon in pair.b.tendons if tendon.name is not None}
    partners = [named.pop(spell(tendon.name), None) if tendon.name is not None else None for tendon in pair.a.tendons]
    taken = {id(tendon) for tendon in partners if tendon is not None}
    rest = [tendon for tendon in pair.b.tendons if id(tendon) not in taken]
    nameless, others = (deque(tendon for tendon in rest if (tendon.name is None) is wanted) for wanted in (True, False))
    pairs: list[tuple[Tendon, Tendon]] = []
    findings: list[str] = []
    for tendon, partner in zip(pair.a.tendons, partners, strict=True):
        queue = nameless if nameless or tendon.name is not None else others
        other = partner or (queue.popleft() if queue else None)
        if other is None:
            findings.append(f"{_label(tendon)} is missing")
        else:
            pairs.append((tendon, other))
    return pairs, [*findings, *(f"{_label(tendon)} is new" for tendon in (*others, *nameless))]


def _label(tendon: Tendon) -> str:
    return f"tendon {_name(tendon)}" if tendon.name is not None else "a tendon without a name"


def _name(tendon: Tendon) -> str:
    return f"'{tendon.name}'" if tendon.name is not None else "no name"


def _path_difference(pair: Pair, ours: Tendon, theirs: Tendon, bodies: Mapping[int, int], dofs: Mapping[int, int]) -> str:
    """The first step that leads elsewhere, by the matched bodies and dofs; "" when there is none."""
    if len(ours.path) != len(theirs.path):
        return f"{_label(ours)} has {len(ours.path)} steps, and {len(theirs.path)} in the other"
    for number, (step, other) in enumerate(zip(ours.path, theirs.path, strict=True), 1):
        matched = dofs if step.kind == JOINT else bodies
        if step.kind != other.kind or (step.kind != PULLEY and matched.get(step.on) != other.on):
            return f"step {number} of {_label(ours)} is {_words(pair.a, step)}, and {_words(pair.b, other)} in the other"
    return ""


def _words(model: KinematicModel, step: Step) -> str:
    if step.kind == JOINT:
        return model.dof_label(step.on)
    words = _WORDS.get(step.kind, f"a {step.kind}")
    return words if step.kind == PULLEY else f"{words} on {model.body_label(step.on)}"


# ---- numbers ---------------------------------------------------------------------------------------------------------


def _compare(pair: Pair, ours: Tendon, theirs: Tendon, found: Mapping[str, Differences]) -> None:
    """Coefficients, places, mechanics and bounds of two tendons that lead through the same."""
    at = _label(ours)
    for number, (step, other) in enumerate(zip(ours.path, theirs.path, strict=True), 1):
        _compare_steps(pair, f"step {number} of {at}", step, other, found)
    for word, value, other_value in zip(_MECHANICS, ours.mechanics, theirs.mechanics, strict=True):
        if value or other_value:
            found[word].add(abs(value - other_value), pair.relative(_TINY, value), at, value, other_value)
    for word, bounds, others in (("limits", ours.limits, theirs.limits), ("force limits", ours.force, theirs.force)):
        if bounds or others:
            found[word].add(_interval_distance(bounds, others), pair.relative(_TINY, *(bounds or ())), at, bounds or (), others or ())
    found["spring lengths"].add(_spring_distance(ours.spring, theirs.spring), pair.relative(_TINY, *(ours.spring.between or ())), at)


def _compare_steps(pair: Pair, at: str, step: Step, other: Step, found: Mapping[str, Differences]) -> None:
    """A coefficient or divisor; or the place and radius of a site or shape."""
    difference = abs(step.number - other.number)
    if step.point is None or other.point is None:
        found["coefficients"].add(difference, pair.relative(_TINY, step.number), at)
        return
    scale = 1.0 + float(np.abs(step.point).max()) + step.number
    distance = float(np.linalg.norm(np.subtract(step.point, other.point)))
    found["path"].add(max(difference, distance), pair.allowed(_POINT, scale), at)
    if step.axis is not None and other.axis is not None:
        found["axes"].add(float(np.linalg.norm(np.cross(step.axis, other.axis))), pair.allowed(_AXIS), at)


def _interval_distance(bounds: tuple[float, float] | None, others: tuple[float, float] | None) -> float:
    """The larger distance of the bounds of two intervals; infinite where there is only one interval."""
    if bounds is None or others is None:
        return 0.0 if bounds is others else float("inf")
    return max(0.0 if a == b else abs(a - b) for a, b in zip(bounds, others, strict=True))


def _spring_distance(ours: SpringRange, theirs: SpringRange) -> float:
    return 0.0 if ours.at_rest and theirs.at_rest else _interval_distance(ours.between, theirs.between)


def _check_curves(pair: Pair, pairs: Sequence[tuple[Tendon, Tendon]]) -> Iterator[Check]:
    """The higher coefficients of stiffness and damping, where both sides represent them."""
    known = [(ours, theirs) for ours, theirs in pairs if ours.curves is not None and theirs.curves is not None]
    unknown = [ours for ours, theirs in pairs if (ours.curves or theirs.curves) and (ours.curves is None or theirs.curves is None)]
    if unknown:
        pair.notes.append(f"nonlinear damping and stiffness of tendons: {len(unknown)} were not compared, first {_label(unknown[0])}")
    if any(ours.curves or theirs.curves for ours, theirs in known):
        bent = [f"{_label(ours)} has other curves" for ours, theirs in known if not same_numbers(ours.curves or (), theirs.curves or ())]
        yield counted("nonlinear damping and stiffness of tendons", bent)
