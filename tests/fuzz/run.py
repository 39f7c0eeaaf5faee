"""Many cases, in a child process that may die: what killed it is known, kept, and passed over."""

from __future__ import annotations

import multiprocessing
import os
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from msgspec import Struct, field

from tests.fuzz.cases import SECONDS, Finding, data_of, limit_memory, run, warm_up

if TYPE_CHECKING:
    from collections.abc import Iterator

FOUND = Path(__file__).parents[2] / "build" / "fuzz"
PATIENCE = 30 * SECONDS
"""How long the child may stay at one case, whose own clock cannot stop what hangs in C code; a busy machine is slow, and no hang."""

MEMORY_DISK = "/dev/shm"
"""Where the temporary files of readers cost nothing, on systems that have it."""


class Tally(Struct):
    """How many cases were run, and the first case of every kind of finding."""

    cases: int = 0
    kinds: dict[str, int] = field(default_factory=dict)


class Task(Struct, frozen=True):
    """Which cases: a format, what to write them as, the first number, and how many cases or seconds there are."""

    format: str
    through: str
    start: int
    cases: int
    seconds: float


def fuzz(task: Task) -> Tally:
    """Run the cases; keep the first text of every kind of finding under build/fuzz."""
    tally, deadline, number = Tally(), time.monotonic() + task.seconds, task.start
    stop = task.start + task.cases
    while number < stop and time.monotonic() < deadline:
        reached, kinds = _in_child(task, number, stop, deadline)
        for kind, first in kinds:
            if kind not in tally.kinds:
                tally.kinds[kind] = first
        number = reached
    tally.cases = number - task.start
    return tally


def _in_child(task: Task, start: int, stop: int, deadline: float) -> tuple[int, list[tuple[str, int]]]:
    """Run on from a case until the end or the child's death; the case to go on with, and what was found."""
    context = multiprocessing.get_context("spawn")
    at, ours = context.Value("q", start, lock=False), context.Pipe(duplex=False)
    child = context.Process(target=_work, args=(task, start, stop, deadline, at, ours[1]), daemon=True)
    child.start()
    ours[1].close()
    is_stuck = _wait(child, at, start)
    kinds = list(_received(ours[0]))
    if child.exitcode == 0 and not is_stuck:
        return at.value, kinds
    kind = "hang" if is_stuck else f"death {child.exitcode}"
    keep(task.format, Finding(kind, ""), data_of(task.format, at.value), at.value)
    return at.value + 1, [*kinds, (kind, at.value)]


def _wait(child: Any, at: Any, start: int) -> bool:
    """Wait for the end of the child; kill it when it does not move on. Before its first case it loads the libraries."""
    last, since = at.value, time.monotonic()
    while child.is_alive():
        child.join(0.2)
        if at.value != last:
            last, since = at.value, time.monotonic()
        elif time.monotonic() - since > PATIENCE * (3 if last == start else 1):
            child.kill()
            child.join()
            return True
    return False


def _received(pipe: Any) -> Iterator[tuple[str, int]]:
    while True:
        try:
            yield pipe.recv()
        except EOFError:
            return


def _work(task: Task, start: int, stop: int, deadline: float, at: Any, pipe: Any) -> None:
    """The child: case after case."""
    os.environ["PXR_WORK_THREAD_LIMIT"] = "1"  # threads of USD cost more than small stages do
    if os.access(MEMORY_DISK, os.W_OK):
        os.environ["TMPDIR"] = MEMORY_DISK
    warm_up(task.format)
    limit_memory()
    known: set[str] = set()
    for number in range(start, stop):
        at.value = number
        data = data_of(task.format, number)
        finding = run(task.format, data, task.through)
        if finding is not None and finding.where not in known:
            known.add(finding.where)
            keep(task.format, finding, data, number)
            pipe.send((finding.where, number))
        if number % 256 == 0 and time.monotonic() > deadline:
            stop = number + 1
            break
    at.value = stop
    pipe.close()
    os._exit(0)  # libraries of others may wait for their threads


def keep(format: str, finding: Finding, data: bytes, number: int) -> Path:
    """Put a case where somebody can look at it."""
    FOUND.mkdir(parents=True, exist_ok=True)
    name = "".join(letter if letter.isalnum() else "-" for letter in finding.where)
    place = FOUND / f"{format}-{name}-{number}"
    place.write_bytes(data)
    place.with_suffix(".txt").write_text(finding.text, encoding="utf-8", errors="backslashreplace")
    return place
