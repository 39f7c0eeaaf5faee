"""Actuators and couplings of tendons: what they act on, word by word, and their numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hymeko_x.verify.checks.pair import Pair, counted, worst
from hymeko_x.verify.model import Feature, KinematicModel, Part

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from hymeko_x.verify.verdict import Check


def check_parts(pair: Pair) -> Iterator[Check]:
    """Every actuator and coupling of tendons of the first robot in the second, and no new ones."""
    yield from _check(pair, Feature.ACTUATORS, pair.a.actuators, pair.b.actuators)
    yield from _check(pair, Feature.TIED_TENDONS, pair.a.tied_tendons, pair.b.tied_tendons)


def _check(pair: Pair, feature: Feature, ours: Sequence[Part], theirs: Sequence[Part]) -> Iterator[Check]:
    if not ours and not theirs:
        return
    if not pair.both_say(feature):
        _note(pair, feature)
        return
    pairs, findings = _pair_parts(ours, theirs)
    findings += [f"{_label(x)} is '{' '.join(x.words)}', and '{' '.join(y.words)}' in the other" for x, y in pairs if x.words != y.words]
    comparable = [(x, y) for x, y in pairs if x.words == y.words and len(x.numbers) == len(y.numbers)]
    apart = np.array([float(np.abs(np.subtract(x.numbers, y.numbers)).max(initial=0.0)) for x, y in comparable])
    sizes = np.array([float(np.abs(x.numbers).max(initial=0.0)) for x, _ in comparable])
    yield counted(feature.value, findings)
    yield worst(f"{feature.value}, numbers", "SI", apart, np.maximum(1e-12, pair.allowed(1e-9) * sizes), lambda k: _label(comparable[k][0]))


def _note(pair: Pair, feature: Feature) -> None:
    for model, other in ((pair.a, pair.b), (pair.b, pair.a)):
        count = len(_parts(model, feature))
        if count and feature not in other.says:
            pair.notes.append(f"{feature.value}: {other.format} has none; {count} in {model.format}")


def _parts(model: KinematicModel, feature: Feature) -> Sequence[Part]:
    return model.actuators if feature is Feature.ACTUATORS else model.tied_tendons


def _pair_parts(ours: Sequence[Part], theirs: Sequence[Part]) -> tuple[list[tuple[Part, Part]], list[str]]:
    """By name; unnamed ones in order, because that is how a controller addresses them."""
    named = {part.name: part for part in theirs if part.name is not None}
    unnamed = [part for part in theirs if part.name is None]
    pairs: list[tuple[Part, Part]] = []
    findings: list[str] = []
    for part in ours:
        other = named.pop(part.name, None) if part.name is not None else (unnamed.pop(0) if unnamed else None)
        if other is None:
            findings.append(f"{_label(part)} is missing")
        else:
            pairs.append((part, other))
    findings += [f"{_label(part)} is new" for part in (*named.values(), *unnamed)]
    return pairs, findings


def _label(part: Part) -> str:
    return f"'{part.name}'" if part.name else f"an unnamed one on '{part.words[1] if len(part.words) > 1 else ''}'"
