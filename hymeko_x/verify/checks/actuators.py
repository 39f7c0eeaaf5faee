"""Actuators, sensors and couplings of tendons: what they act on or measure, their laws, and their numbers.

Compared: the words of each, and its numbers in SI units. Allowed: 1e-9 of the largest number.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

import numpy as np

from hymeko_x.verify.checks.pair import Differences, Pair, counted
from hymeko_x.verify.features import Feature

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from hymeko_x.verify.model import KinematicModel, Record
    from hymeko_x.verify.verdict import Check

_OF_IMU = ("accelerometer", "gyro")
"""MuJoCo's kinds of sensors that an IMU consists of."""
_TINY = 1e-12
"""In SI units: numbers below it are zero."""


def check_actuators(pair: Pair) -> Iterator[Check]:
    """Every actuator, sensor and coupling of tendons of the first robot in the second, and no new ones."""
    yield from _check(pair, Feature.ACTUATORS, lambda model: model.actuators)
    yield from _check(pair, Feature.SENSORS, lambda model: model.sensors)
    yield from _check(pair, Feature.TIED_TENDONS, lambda model: model.tied_tendons)


def _check(pair: Pair, feature: Feature, records: Callable[[KinematicModel], Sequence[Record]]) -> Iterator[Check]:
    if not pair.both_represent(feature):
        pair.add_unrepresented(feature, lambda model: [_label(record) for record in records(model)])
    elif records(pair.a) or records(pair.b):
        firsts, seconds = _of_kinds_of(pair.b, records(pair.a), records(pair.b), pair)
        seconds, firsts = _of_kinds_of(pair.a, seconds, firsts, pair)
        pairs, findings = _pair_records(firsts, seconds)
        found = Differences(f"{feature.value}, numbers", "SI")
        for x, y in pairs:
            if x.words and y.words and x.words != y.words:
                findings.append(f"{_label(x)} is '{' '.join(x.words)}', and '{' '.join(y.words)}' in the other")
            elif len(x.numbers) == len(y.numbers) and x.numbers:
                worst = int(np.abs(np.subtract(x.numbers, y.numbers)).argmax())
                ours, theirs = x.numbers[worst], y.numbers[worst]
                found.add(abs(ours - theirs), pair.relative(_TINY, *x.numbers), _label(x), ours, theirs)
        yield counted(feature.value, findings)
        yield from found.checks()


def _of_kinds_of(model: KinematicModel, others: Sequence[Record], own: Sequence[Record], pair: Pair) -> tuple[list[Record], list[Record]]:
    """The other robot's records of kinds that the model's format has, and the model's own; a gap names the rest.

    An IMU is represented by what measures its acceleration and its angular velocity, where the format has none.
    """
    foreign = [record for record in others if record.kind and model.sensor_kinds is not None and record.kind not in model.sensor_kinds]
    names = {record.name for record in own}
    imus = {record.name: {f"{record.name}_{part}" for part in _OF_IMU} for record in foreign if record.kind == "imu"}
    parts = {part for found in imus.values() if found <= names for part in found}
    lacking = [record for record in foreign if not (record.kind == "imu" and imus[record.name] <= names)]
    pair.add_gap(model, Feature.SENSORS, [_label(record) for record in lacking])
    return [record for record in others if record not in foreign], [record for record in own if record.name not in parts]


def _pair_records(ours: Sequence[Record], theirs: Sequence[Record]) -> tuple[list[tuple[Record, Record]], list[str]]:
    """By name; unnamed ones in order, because that is how a controller addresses them."""
    named = {record.name: record for record in theirs if record.name is not None}
    unnamed = deque(record for record in theirs if record.name is None)
    pairs: list[tuple[Record, Record]] = []
    findings: list[str] = []
    for record in ours:
        other = named.pop(record.name, None) if record.name is not None else (unnamed.popleft() if unnamed else None)
        if other is None:
            findings.append(f"{_label(record)} is missing")
        else:
            pairs.append((record, other))
    return pairs, [*findings, *(f"{_label(record)} is new" for record in (*named.values(), *unnamed))]


def _label(record: Record) -> str:
    return f"'{record.name}'" if record.name else f"an unnamed one on '{record.words[1] if len(record.words) > 1 else ''}'"
