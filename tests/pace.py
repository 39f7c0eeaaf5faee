"""How long a piece of work takes, in seconds or beside another one, on machines whose pace changes while they run."""

from __future__ import annotations

import gc
import sys
import time
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

ROUNDS = 5


def seconds(work: Callable[[], object]) -> float:
    """Processor time, without a collector of cycles that would look through a process full of other tests."""
    gc.disable()
    try:
        start = time.process_time()
        work()
        return time.process_time() - start
    finally:
        gc.enable()


def skip_if_recorded(work: Callable[[], object] = lambda: None) -> None:
    """Skip the test, after one run of the work, where the lines that run are recorded, which takes more time than any bound allows."""
    coverage = sys.modules.get("coverage")
    if coverage is not None and coverage.Coverage.current() is not None:
        work()
        pytest.skip("the lines that run are recorded, so that no bound on time holds")


def assert_within(bound: float, work: Callable[[], object]) -> None:
    """The work takes at most so many seconds of processor time, in one round of several."""
    skip_if_recorded(work)
    taken: list[float] = []
    while not taken or taken[-1] > bound:
        assert len(taken) < ROUNDS, f"{', '.join(f'{time:.3f}' for time in taken)} s, not {bound:g} s at most"
        taken.append(seconds(work))


def assert_at_most(bound: float, work: Callable[[], object], yardstick: Callable[[], object], count: int = 1) -> None:
    """The work takes at most ``bound`` times as long as ``count`` runs of the yardstick, in one round of several.

    The two take turns, and with ``count`` runs about equally long, so that both meet the machine at the same pace. A machine that
    slows down within a round spoils that round; work of a higher order than the yardstick is over the bound in all of them.
    """
    skip_if_recorded(work)
    ratios: list[float] = []
    while not ratios or ratios[-1] > bound:
        assert len(ratios) < ROUNDS, f"{', '.join(f'{ratio:.2f}' for ratio in ratios)} times as long, not {bound:g} at most"
        few = sum(seconds(yardstick) for _ in range(count))
        ratios.append(seconds(work) / few)
