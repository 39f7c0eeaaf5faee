"""Python's collector of cyclic garbage, and when it rests."""

from __future__ import annotations

import gc
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def uncollected() -> Iterator[None]:
    """Without the collector of cycles, if it is on; also a decorator.

    Reading and writing make many small values, of which nearly all stay to the end and none is in a cycle: looking for cycles
    among them again and again is what makes a large robot take longer per link than a small one.
    """
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()
