"""A bound on the memory that an engine takes: with a few letters a file can ask for more than the machine has."""

from __future__ import annotations

from pathlib import Path
from threading import Lock

MOST_BYTES = 2**32
"""What engines may take beyond what the process has already; far more than a real robot needs."""


class BoundedMemory:
    """A context in which the process takes at most :data:`MOST_BYTES` more. Contexts of several threads share the bound of the first.

    An engine that asks for more refuses its file. Where the system has no such bound (only Linux has), nothing changes.
    """

    def __init__(self) -> None:
        self._lock = Lock()
        self._inside = 0
        self._before: tuple[int, int] | None = None

    def __enter__(self) -> None:
        with self._lock:
            if self._inside == 0:
                self._before = _lowered()
            self._inside += 1

    def __exit__(self, *_: object) -> None:
        with self._lock:
            self._inside -= 1
            if self._inside == 0 and self._before is not None:
                import resource

                resource.setrlimit(resource.RLIMIT_DATA, self._before)


def hint_for(error: Exception) -> str:
    """What may have been the reason of an error for which an engine gives none; empty where it gives one."""
    if not isinstance(error, RuntimeError):
        return ""
    return f"an attribute without its numbers may be the reason, or that the model takes more than {MOST_BYTES / 1e9:.2g} GB of memory"


def _lowered() -> tuple[int, int] | None:
    """Lower the limit of this process. Returns the limits before; None where it stays as it is."""
    try:
        import resource

        used = int(Path("/proc/self/statm").read_text().split()[5]) * resource.getpagesize()
    except (ImportError, OSError):
        return None
    before = resource.getrlimit(resource.RLIMIT_DATA)
    known = [limit for limit in before if limit != resource.RLIM_INFINITY]
    resource.setrlimit(resource.RLIMIT_DATA, (min([used + MOST_BYTES, *known]), before[1]))
    return before


bounded_memory = BoundedMemory()
"""The one of this process."""
