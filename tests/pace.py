"""How much longer one piece of work takes than another, on machines whose pace changes while they run."""

from __future__ import annotations

import gc
import time
from typing import TYPE_CHECKING

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


def assert_at_most(bound: float, work: Callable[[], object], yardstick: Callable[[], object], count: int = 1) -> None:
    """The work takes at most ``bound`` times as long as ``count`` runs of the yardstick, in one round of several.

    The two take turns, and with ``count`` runs about equally long, so that both meet the machine at the same pace. A machine that
    slows down within a round spoils that round; work of a higher order than the yardstick is over the bound in all of them.
    """
    ratios: list[float] = []
    while not ratios or ratios[-1] > bound:
        assert len(ratios) < ROUNDS, f"{', '.join(f'{ratio:.2f}' for ratio in ratios)} times as long, not {bound:g} at most"
        few = sum(seconds(yardstick) for _ in range(count))
        ratios.append(seconds(work) / few)
