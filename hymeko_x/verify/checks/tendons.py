"""Tendons: through what their paths lead, where that is, and what they do with their length."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct, field

from hymeko_x.verify.checks.pair import Pair, counted, worst
from hymeko_x.verify.matching.bodies import plain
from hymeko_x.verify.model import JOINT, PULLEY, SIDE, Feature, KinematicModel, Step, Tendon

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from hymeko_x.verify.model import Spring
    from hymeko_x.verify.verdict import Check

_POINT, _NUMBER = 1e-9, 1e-9
_AXIS = 1e-7
_ARTICLES = {SIDE: "a site beside a shape", PULLEY: "a pulley"}
_MECHANICS = ("stiffness", "damping", "friction", "armature")


def check_tendons(pair: Pair) -> Iterator[Check]:
    """Every tendon of the first robot in the second, and no new ones."""
    if not pair.a.tendons and not pair.b.tendons:
        return
    if not pair.both_say(Feature.TENDONS):
        _note(pair)
        return
    pairs, findings = _pair_tendons(pair)
    bodies, dofs = dict(pair.match.bodies), dict(pair.match.dofs)
    compared = [(ours, theirs, _other_path(pair, ours, theirs, bodies, dofs)) for ours, theirs in pairs]
    yield counted(Feature.TENDONS.value, [*findings, *(words for _, _, words in compared if words)])
    alike = [(ours, theirs) for ours, theirs, words in compared if not words]
    for quantity, differences in _differences(pair, alike).items():
        yield differences.check(quantity)
    yield from _check_curves(pair, alike)


def _note(pair: Pair) -> None:
    for model, other in ((pair.a, pair.b), (pair.b, pair.a)):
        if model.tendons and Feature.TENDONS not in other.says:
            pair.notes.append(f"tendons: {other.format} has none; {len(model.tendons)} in {model.format}")


# ---- which is which --------------------------------------------------------------------------------------------------


def _pair_tendons(pair: Pair) -> tuple[list[tuple[Tendon, Tendon]], list[str]]:
    """By name, as USD spells it where one side is USD; one that has no name in one of the files by its place among the rest."""
    spelled = "usd" in (pair.a.format, pair.b.format)
    theirs = {_key(tendon, spelled=spelled): tendon for tendon in pair.b.tendons if tendon.name is not None}
    partners = [theirs.pop(_key(tendon, spelled=spelled), None) for tendon in pair.a.tendons]
    taken = {id(tendon) for tendon in partners if tendon is not None}
    rest = [tendon for tendon in pair.b.tendons if id(tendon) not in taken]
    nameless, named = (deque(tendon for tendon in rest if (tendon.name is None) is wanted) for wanted in (True, False))
    pairs: list[tuple[Tendon, Tendon]] = []
    findings: list[str] = []
    for tendon, partner in zip(pair.a.tendons, partners, strict=True):
        queue = nameless if nameless or tendon.name is not None else named
        other = partner or (queue.popleft() if queue else None)
        if other is None:
            findings.append(f"{_label(tendon)} is missing")
        else:
            pairs.append((tendon, other))
    return pairs, [*findings, *(f"{_label(tendon)} is new" for tendon in (*named, *nameless))]


def _key(tendon: Tendon, *, spelled: bool) -> str | None:
    return plain(tendon.name) if spelled and tendon.name is not None else tendon.name


def _label(tendon: Tendon) -> str:
    return f"tendon '{tendon.name}'" if tendon.name is not None else "a tendon without a name"


# ---- paths -----------------------------------------------------------------------------------------------------------


def _other_path(pair: Pair, ours: Tendon, theirs: Tendon, bodies: Mapping[int, int], dofs: Mapping[int, int]) -> str:
    """How two paths differ in what they lead through; "" when they do not. ``bodies`` and ``dofs`` say which is which."""
    if len(ours.path) != len(theirs.path):
        return f"{_label(ours)} has {len(ours.path)} steps, and {len(theirs.path)} in the other"
    for number, (step, other) in enumerate(zip(ours.path, theirs.path, strict=True), 1):
        if step.kind != other.kind or not _is_on_same(step, other, dofs if step.kind == JOINT else bodies):
            return f"step {number} of {_label(ours)} is {_words(pair.a, step)}, and {_words(pair.b, other)} in the other"
    return ""


def _is_on_same(step: Step, other: Step, known: Mapping[int, int]) -> bool:
    return step.kind == PULLEY or known.get(step.on) == other.on


def _words(model: KinematicModel, step: Step) -> str:
    if step.kind == JOINT:
        return model.dof_label(step.on)
    words = _ARTICLES.get(step.kind, f"a {step.kind}")
    return words if step.kind == PULLEY else f"{words} on {model.body_label(step.on)}"


# ---- numbers ---------------------------------------------------------------------------------------------------------


class _Differences(Struct):
    """Differences of one quantity, what is allowed for each, and where each is."""

    unit: str
    apart: list[float] = field(default_factory=list)
    allowed: list[float] = field(default_factory=list)
    at: list[str] = field(default_factory=list)

    def add(self, at: str, apart: float, allowed: float) -> None:
        self.apart.append(apart)
        self.allowed.append(allowed)
        self.at.append(at)

    def check(self, quantity: str) -> Check:
        return worst(quantity, self.unit, np.array(self.apart), np.array(self.allowed), lambda k: self.at[k])


def _differences(pair: Pair, alike: Sequence[tuple[Tendon, Tendon]]) -> dict[str, _Differences]:
    """Coefficients, places, mechanics and bounds of tendons that lead through the same."""
    units = {"coefficients": "SI", "path": "m", "axes": "rad"}
    units |= dict.fromkeys((*_MECHANICS, "limits", "force limits", "spring lengths"), "SI")
    found = {f"tendons, {word}": _Differences(unit) for word, unit in units.items()}
    for ours, theirs in alike:
        at = _label(ours)
        for number, (step, other) in enumerate(zip(ours.path, theirs.path, strict=True), 1):
            _compare_steps(pair, f"step {number} of {at}", step, other, found)
        for word, mine, other_number in zip(_MECHANICS, ours.mechanics, theirs.mechanics, strict=True):
            found[f"tendons, {word}"].add(at, abs(mine - other_number), _relative(pair, mine))
        for word, bounds, others in (("limits", ours.limits, theirs.limits), ("force limits", ours.force, theirs.force)):
            found[f"tendons, {word}"].add(at, _apart(bounds, others), _relative(pair, *(bounds or ())))
        found["tendons, spring lengths"].add(at, _springs_apart(ours.spring, theirs.spring), _relative(pair, *(ours.spring.between or ())))
    return {word: differences for word, differences in found.items() if differences.apart}


def _compare_steps(pair: Pair, at: str, step: Step, other: Step, found: Mapping[str, _Differences]) -> None:
    """A coefficient or divisor, or where a point is and how large what stands there."""
    apart = abs(step.number - other.number)
    if step.point is None or other.point is None:
        found["tendons, coefficients"].add(at, apart, _relative(pair, step.number))
        return
    scale = 1.0 + float(np.abs(step.point).max()) + step.number
    distance = float(np.linalg.norm(np.subtract(step.point, other.point)))
    found["tendons, path"].add(at, max(apart, distance), pair.allowed(_POINT, scale))
    if step.axis is not None and other.axis is not None:
        angle = float(np.linalg.norm(np.cross(step.axis, other.axis)))
        found["tendons, axes"].add(at, angle, pair.allowed(_AXIS))


def _relative(pair: Pair, *numbers: float) -> float:
    return max(1e-12, pair.allowed(_NUMBER) * max(map(abs, numbers), default=0.0))


def _apart(bounds: tuple[float, float] | None, others: tuple[float, float] | None) -> float:
    """How far two intervals are from being one; infinite where only one is there."""
    if bounds is None or others is None:
        return 0.0 if bounds is others else float("inf")
    return max(0.0 if a == b else abs(a - b) for a, b in zip(bounds, others, strict=True))


def _springs_apart(ours: Spring, theirs: Spring) -> float:
    return 0.0 if ours.at_rest and theirs.at_rest else _apart(ours.between, theirs.between)


def _check_curves(pair: Pair, alike: Sequence[tuple[Tendon, Tendon]]) -> Iterator[Check]:
    """The higher coefficients of stiffness and damping, where both sides know them."""
    known = [(ours, theirs) for ours, theirs in alike if ours.curves is not None and theirs.curves is not None]
    unknown = [ours for ours, theirs in alike if (ours.curves or theirs.curves) and (ours.curves is None or theirs.curves is None)]
    if unknown:
        pair.notes.append(f"nonlinear damping and stiffness of tendons: {len(unknown)} were not compared, first {_label(unknown[0])}")
    if any(ours.curves or theirs.curves for ours, theirs in known):
        bent = [f"{_label(ours)} has other curves" for ours, theirs in known if not _curved_alike(ours.curves or (), theirs.curves or ())]
        yield counted("nonlinear damping and stiffness of tendons", bent)


def _curved_alike(ours: Sequence[float], theirs: Sequence[float]) -> bool:
    """Whether the coefficients are the same; none at all are zeros."""
    width = max(len(ours), len(theirs))
    first, second = (np.array([*values, *[0.0] * (width - len(values))]) for values in (ours, theirs))
    return bool(np.allclose(first, second, rtol=_NUMBER, atol=0.0))
