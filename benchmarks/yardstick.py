"""Timing by ratio: machines differ and are noisy, so everything is measured against a yardstick in the same run."""

from __future__ import annotations

import gc
import statistics
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable


def best_of(work: Callable[[], object], yardstick: Callable[[], object], repeats: int = 9) -> tuple[float, float]:
    """The least processor time in s of both, run in turns so that a busy machine disturbs both alike."""
    ours, theirs = [], []
    for _ in range(repeats):
        ours.append(_time(work))
        theirs.append(_time(yardstick))
    return min(ours), min(theirs)


def in_turns(*works: Callable[[], object], rounds: int = 5) -> tuple[float, ...]:
    """The median processor time in s of each, run in turns; one round to warm up is not counted."""
    times: list[list[float]] = [[] for _ in works]
    for _ in range(rounds + 1):
        for own, work in zip(times, works, strict=True):
            own.append(_time(work))
    return tuple(statistics.median(own[1:]) for own in times)


def least_in_turns(*works: Callable[[], object], rounds: int = 3) -> tuple[float, ...]:
    """The least processor time in s of each, run in turns; one round to warm up is not counted."""
    times = [[_time(work) for work in works] for _ in range(rounds + 1)][1:]
    return tuple(map(min, zip(*times, strict=True)))


def _time(work: Callable[[], object]) -> float:
    gc.collect()
    start = time.process_time()
    work()
    return time.process_time() - start


def verdict(name: str, ratio: float, bound: float, *, at_least: bool) -> bool:
    """Print a line with the ratio and whether it keeps its bound."""
    kept = ratio >= bound if at_least else ratio <= bound
    sign = "at least" if at_least else "at most"
    print(f"{name}: ratio {ratio:.2f}, {sign} {bound:g} wanted: {'kept' if kept else 'MISSED'}")
    return kept
