"""What is done with every file of a run: the pairs of formats, verification, and the limits of one process."""

from __future__ import annotations

import os
import threading
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from msgspec import Struct
from msgspec.structs import asdict

from hymeko_x import formats

if TYPE_CHECKING:
    from collections.abc import Iterator

READ, ENGINE, CONVERT, VERIFY = "read", "engine", "convert", "verify"
"""The steps of one file: our reader, the format's reference reader, and for each target a conversion and its verification."""


class ProcessLimits(Struct, frozen=True):
    """What one process may use: wall-clock seconds, and bytes of memory, of which MuJoCo reserves some that it never touches."""

    seconds: float = 180.0
    bytes: int = 5 * 2**30


class Plan(Struct, frozen=True):
    """``pairs`` are (source, target) formats; ``samples`` and ``meshes`` go to the verifier."""

    pairs: tuple[tuple[str, str], ...]
    verify: bool = True
    samples: int = 20
    meshes: bool = True
    limits: ProcessLimits = ProcessLimits()

    def steps(self, source: str) -> tuple[str, ...]:
        """The steps of a file of this format, in order: ``read``, ``engine``, then ``convert:TARGET`` and ``verify:TARGET``."""
        return (READ, *self._steps(source))

    def _steps(self, source: str) -> Iterator[str]:
        if self.verify:
            yield ENGINE
        for target in self.targets(source):
            yield f"{CONVERT}:{target}"
            if self.verify:
                yield f"{VERIFY}:{target}"

    def targets(self, source: str) -> tuple[str, ...]:
        """The formats into which a file of this format is converted."""
        return tuple(target for start, target in self.pairs if start == source)

    def as_json(self) -> dict[str, Any]:
        """What two runs must have in common for the one to continue the other. The limits may differ."""
        return {key: value for key, value in asdict(self).items() if key != "limits"}


def pairs_of(words: str) -> tuple[tuple[str, str], ...]:
    """The pairs named by ``urdf:mjcf,mjcf:usd`` or by ``all``, from the table of formats.

    ``all`` is every format that can be read times every format that can be written; the containers of one format
    are one.

    Raises: Refusal HX003 when a format is not known; ValueError when the words are no pairs.
    """
    if words == "all":
        rows = formats.families()
        return tuple((a.name, b.name) for a in rows if a.frontend for b in rows if b.backend)
    found = []
    for word in words.split(","):
        source, colon, target = word.partition(":")
        if not (source and colon and target):
            raise ValueError(f"expected pairs such as urdf:mjcf, found '{word}'")
        found.append((formats.by_name(source).name, formats.by_name(target).name))
    return tuple(dict.fromkeys(found))


# ---- limits of the operating system on the process of one file, and what it has used ----------------------------------


_CPU_FACTOR = 4
"""Processor seconds per wall-clock second of the limit: the last resort when the process that watches the clock is gone."""

_MEGABYTE = 1e6


def set_limits(limits: ProcessLimits) -> None:
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
