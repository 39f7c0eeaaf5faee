"""Limits of the operating system on the process of one file, and what that process has used."""

from __future__ import annotations

import os
import threading
from contextlib import suppress
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hymeko_x.corpus.plan import Limits

_CPU_FACTOR = 4
"""Processor seconds per wall-clock second of the limit: the last resort when nobody watches the clock any more."""

_MEGABYTE = 1e6


def set_limits(limits: Limits) -> None:
    """Bound the memory of this process and its processor time, leave no core dump, and end it when its parent is gone."""
    _end_with_parent()
    try:
        import resource
    except ImportError:
        return
    cpu = int(limits.seconds * _CPU_FACTOR) + 1
    _bound(resource.RLIMIT_DATA, limits.bytes)
    _bound(resource.RLIMIT_CPU, cpu)
    _bound(resource.RLIMIT_CORE, 0)


def _bound(kind: int, wanted: int) -> None:
    """Lower a soft limit, never above the hard one."""
    import resource

    hard = resource.getrlimit(kind)[1]
    resource.setrlimit(kind, (wanted if hard == resource.RLIM_INFINITY else min(wanted, hard), hard))


def _end_with_parent() -> None:
    """A thread that ends the process when the one that started it has died, so that a killed run leaves nothing behind."""
    import multiprocessing

    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_wait_and_end, args=(parent.sentinel,), daemon=True).start()


def _wait_and_end(sentinel: int) -> None:
    from multiprocessing.connection import wait

    wait([sentinel])
    os._exit(1)


def forget_peak() -> None:
    """Count peak memory from now on, where the system lets us (Linux); else it is the peak since the process began."""
    with suppress(OSError), open("/proc/self/clear_refs", "w", encoding="ascii") as file:
        file.write("5")


def peak_megabytes() -> float:
    """The most memory that this process has had, in MB (10^6 bytes); 0 where the system does not say."""
    with suppress(OSError), open("/proc/self/status", encoding="ascii", errors="replace") as file:
        for line in file:
            if line.startswith("VmHWM:"):
                return round(int(line.split()[1]) * 1024 / _MEGABYTE, 1)
    try:
        import resource
    except ImportError:
        return 0.0
    return round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / _MEGABYTE, 1)
