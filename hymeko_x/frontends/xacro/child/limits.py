"""Limits of an expansion, and how the operating system imposes them on the child process."""

from __future__ import annotations

import signal
from typing import NamedTuple, NoReturn

from hymeko_x.frontends.xacro.child.channel import Trouble


class ExpansionLimits(NamedTuple):
    """Time and memory of an expansion: a hundred times what a real robot needs, and some 25,000 links of macros."""

    cpu_seconds: int = 20
    wall_seconds: float = 60.0
    memory_bytes: int = 2**30


GRACE_BYTES = 64 * 1024 * 1024
GRACE_SECONDS = 2
"""Added to the limits, so that the child can report that one was reached."""


def set_limits(cpu_seconds: int, memory_bytes: int) -> None:
    """No further file, process or core dump; bounded time and memory. Where the system has no such limits, the parent's clock remains."""
    try:
        import resource
    except ImportError:
        return
    signal.signal(signal.SIGXCPU, _too_long)
    _bound(resource.RLIMIT_CPU, cpu_seconds, cpu_seconds + GRACE_SECONDS)
    _bound(resource.RLIMIT_AS, memory_bytes, memory_bytes + GRACE_BYTES)
    _bound(resource.RLIMIT_FSIZE, 0, 0)
    _bound(resource.RLIMIT_CORE, 0, 0)
    _bound(resource.RLIMIT_NPROC, 0, 0)
    _bound(resource.RLIMIT_NOFILE, 3, 3)


def _bound(kind: int, soft: int, hard: int) -> None:
    """Set a limit, never above one that is already there."""
    import resource

    present = resource.getrlimit(kind)[1]
    ceiling = hard if present == resource.RLIM_INFINITY else min(hard, present)
    resource.setrlimit(kind, (min(soft, ceiling), ceiling))


def lift_memory_limit() -> None:
    """Make room for the report of a failure."""
    try:
        import resource
    except ImportError:
        return
    ceiling = resource.getrlimit(resource.RLIMIT_AS)[1]
    resource.setrlimit(resource.RLIMIT_AS, (ceiling, ceiling))


def _too_long(*_: object) -> NoReturn:
    raise Trouble("limit", what="time")
