"""One file from outside: its process, the clock, and what to make of a process that did not come back."""

from __future__ import annotations

import json
import signal
import tempfile
from concurrent.futures import TimeoutError as Late
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from msgspec.structs import replace

from hymeko_x import formats
from hymeko_x.corpus import rows
from hymeko_x.corpus.plan import CONVERT, ENGINE, READ, VERIFY
from hymeko_x.corpus.rows import Cost, Leg, Outcome, RobotRow
from hymeko_x.corpus.work import NOTES, work

if TYPE_CHECKING:
    import multiprocessing.context
    from collections.abc import Callable, Mapping, Sequence

    from pebble import ProcessFuture

    from hymeko_x.corpus.cases import Case
    from hymeko_x.corpus.plan import Plan

    Task = Callable[[Case, Plan, str, str, Sequence[str]], None]

_PRELOADED = (
    "hymeko_x.meshes.reader",
    "hymeko_x.corpus.work",
    "hymeko_x.verify.checks",
    "networkx",
    "scipy.sparse",
    "scipy.spatial",
    "scipy.spatial.transform",
    "trimesh",
    "yourdfpy",
)
"""What most files' processes need beside all readers and writers."""

_FROM_OUTSIDE = (-signal.SIGTERM, -getattr(signal, "SIGKILL", 9))
_MOST_DEATHS = 3
"""A process that is ended from outside is started again, so often; the kernel kills like this when memory runs out."""
_NO_MEMORY = ("bad_alloc", "allocate memory", "MemoryError", "out of memory")


class Failure(NamedTuple):
    """Why a step did not come to its end."""

    status: str
    reason: str


class Processes:
    """One process per task, each with its own clock; all that run can be ended at once."""

    def __init__(self) -> None:
        self._context = _context()
        self._running: set[ProcessFuture[None]] = set()

    def run(self, task: Task, case: Case, plan: Plan, folder: str, scratch: str, steps: Sequence[str]) -> BaseException | None:
        """Run a task to its end; return what it raised, or what became of its process.

        Raises: concurrent.futures.CancelledError after :meth:`end`.
        """
        from pebble.concurrent import process

        # pebble's types say mp_context, its code reads context, and what it does not know it passes over
        start = process(timeout=plan.limits.seconds, context=self._context, mp_context=self._context)(task)  # type: ignore[call-overload]
        future: ProcessFuture[None] = start(case, plan, folder, scratch, steps)
        self._running.add(future)
        try:
            error: BaseException | None = future.exception()
            return error
        finally:
            self._running.discard(future)

    def end(self) -> None:
        """End every process that runs."""
        for future in tuple(self._running):
            future.cancel()


def _context() -> multiprocessing.context.BaseContext:
    import multiprocessing

    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(list(preloaded()))
    return context


def preloaded() -> tuple[str, ...]:
    """The modules that are loaded once, in the server that the processes are forked from."""
    rows = [row for row in formats.FORMATS if row.frontend]
    ours = [name for row in rows for name in (row.frontend, row.backend, row.reference, row.completes) if name]
    return (*dict.fromkeys(name.partition(":")[0] for name in ours), *_PRELOADED)


def supervise(case: Case, plan: Plan, folder: str, processes: Processes, task: Task = work) -> Outcome:
    """Have a file worked on until each of its steps has an answer. Whatever a step does, the others get theirs."""
    steps = plan.steps(case.format)
    notes: dict[str, dict[str, Any]] = {}
    ends: dict[str, Failure] = {}
    deaths = 0
    while todo := _left(steps, notes, ends):
        with tempfile.TemporaryDirectory(prefix="hymeko-x-", ignore_cleanup_errors=True) as scratch:
            asked = replace(plan, verify=plan.verify and ENGINE not in ends)
            error = processes.run(task, case, asked, folder, scratch, todo)
            notes.update(_read_notes(Path(scratch)))
        stuck = next(iter(_left(steps, notes, ends)), None)
        if stuck is None:
            break
        if _is_from_outside(error) and deaths < _MOST_DEATHS:
            deaths += 1
            continue
        ends[stuck] = _end_of(error, plan)
    return _outcome(case, plan, steps, notes, ends)


def _left(steps: tuple[str, ...], notes: Mapping[str, object], ends: Mapping[str, Failure]) -> tuple[str, ...]:
    """The steps that are still to be done: none when the source cannot be read, no verification of what was not written."""
    read = notes.get(READ)
    if READ in ends or (isinstance(read, dict) and read["found"]["status"] != rows.DONE):
        return ()
    open_steps = (step for step in steps if step not in notes and step not in ends)
    return tuple(step for step in open_steps if not (step.startswith(VERIFY) and step.replace(VERIFY, CONVERT, 1) in ends))


def _read_notes(scratch: Path) -> dict[str, dict[str, Any]]:
    """The steps that came to their end; a line that was cut off is none."""
    try:
        lines = (scratch / NOTES).read_text("utf-8").split("\n")[:-1]
    except FileNotFoundError:
        return {}
    return {note["step"]: note for note in map(json.loads, lines)}


def _is_from_outside(error: BaseException | None) -> bool:
    from pebble import ProcessExpired

    return isinstance(error, ProcessExpired) and error.exitcode in _FROM_OUTSIDE


def _end_of(error: BaseException | None, plan: Plan) -> Failure:
    """The answer for the step at which a process ended."""
    from pebble import ProcessExpired

    if error is None:
        return Failure(rows.FAILED, "the process ended without a word")
    if isinstance(error, Late | TimeoutError):
        return Failure(rows.TIMED_OUT, f"more than {plan.limits.seconds:g} s")
    if isinstance(error, ProcessExpired):
        return _end_of_process(error.exitcode or 0)
    words = f"{type(error).__name__}: {' '.join(str(error).split())}"
    if isinstance(error, MemoryError) or any(word in words for word in _NO_MEMORY):
        return Failure(rows.OUT_OF_MEMORY, f"more than {plan.limits.bytes / 2**20:g} MiB")
    return Failure(rows.FAILED, words[:300])


def _end_of_process(code: int) -> Failure:
    if code >= 0:
        return Failure(rows.CRASHED, f"exit code {code}")
    name = signal.Signals(-code).name
    if name == "SIGXCPU":
        return Failure(rows.TIMED_OUT, "too much processor time")
    return Failure(rows.OUT_OF_MEMORY if name == "SIGKILL" else rows.CRASHED, f"killed by {name}")


# ---- rows ------------------------------------------------------------------------------------------------------------


def _outcome(case: Case, plan: Plan, steps: tuple[str, ...], notes: Mapping[str, dict[str, Any]], ends: Mapping[str, Failure]) -> Outcome:
    robot = _robot(case, plan, notes, ends)
    legs = tuple(_leg(robot, target, notes, ends) for target in plan.targets(case.format))
    return Outcome(robot, legs, tuple(Cost(**notes[step]["cost"]) for step in steps if step in notes))


def _robot(case: Case, plan: Plan, notes: Mapping[str, dict[str, Any]], ends: Mapping[str, Failure]) -> RobotRow:
    if READ in ends:
        return RobotRow(case.key, case.package, case.format, status=ends[READ].status, reason=ends[READ].reason)
    robot = RobotRow(**notes[READ]["found"])
    if ENGINE in ends:
        return replace(robot, engine=ends[ENGINE].status, engine_reason=ends[ENGINE].reason)
    return replace(robot, **notes[ENGINE]["found"]) if ENGINE in notes else robot


def _leg(robot: RobotRow, target: str, notes: Mapping[str, dict[str, Any]], ends: Mapping[str, Failure]) -> Leg:
    convert, verify = f"{CONVERT}:{target}", f"{VERIFY}:{target}"
    empty = Leg(robot.key, robot.format, target)
    if robot.status != rows.DONE:
        return replace(empty, status=rows.UNREAD, reason=robot.reason)
    if convert in ends:
        return replace(empty, status=ends[convert].status, reason=ends[convert].reason)
    leg = Leg(**notes[convert]["found"])
    if verify in ends:
        return replace(leg, verdict="not comparable", verdict_reason=f"the verifier {ends[verify].status}: {ends[verify].reason}")
    return rows.with_verdict(leg, Leg(**notes[verify]["found"])) if verify in notes else leg
