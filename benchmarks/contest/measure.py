"""Timing the entrants of a way in turns, so that a busy machine disturbs all alike."""

from __future__ import annotations

import shutil
import statistics
import subprocess
import sys
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

from msgspec import Struct, field

from benchmarks import process
from benchmarks.contest.inputs import SUFFIXES
from benchmarks.contest.rows import CALL, PROCESS, Row
from peers.session import Session

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from benchmarks.contest.inputs import Input
    from benchmarks.contest.ways import Entrant, Way

WHOLE = ("Panda", "1,000 links")
"""The robots for which whole processes are measured."""

ROUNDS = 5
PROCESS_ROUNDS = 3
ENOUGH = 5.0
"""After so many seconds of work on one robot a program is not asked again; what takes longer is measured once, without warming up."""


class _Runner(Struct):
    """An entrant at work on a way."""

    way: Way
    entrant: Entrant
    session: Session
    folder: Path
    limit: float
    """Seconds that one conversion may take."""
    largest: tuple[int, float] = (0, 0.0)
    """Links and seconds of the largest made robot so far."""
    times: list[float] = field(default_factory=list)
    reason: str = ""

    def begin(self, robot: Input) -> None:
        """Forget the last robot, and decide whether this one is worth a try: time grows at least as the number of links."""
        self.times, self.reason = [], ""
        links, seconds = self.largest
        if links and seconds * robot.links / links > self.limit:
            self.reason = f"not tried: {links:,} links took {seconds:.3g} s"

    def call(self, robot: Input) -> None:
        """Once more, unless it failed or was at work for long enough."""
        if self.reason or sum(self.times) > ENOUGH:
            return
        answer = self.session.ask(self.job(robot), self.limit)
        self.reason = answer.get("error", "") or self._missing(robot, answer)
        if not self.reason:
            self.times.append(answer["seconds"])

    def end(self, robot: Input) -> float | None:
        """The median time; what was measured first counts only when there is nothing else."""
        if self.reason.startswith("no answer") and robot.links:
            self.largest = (robot.links, 2.0 * self.limit)
        if self.reason:
            return None
        seconds = statistics.median(self.times[1:] or self.times)
        if robot.links:
            self.largest = (robot.links, seconds)
        return seconds

    def job(self, robot: Input) -> dict[str, Any]:
        """What is asked of the driver."""
        job: dict[str, Any] = {"source": str(robot.path), "measure": self.entrant.measure}
        if self.way.target:
            shutil.rmtree(self.folder, ignore_errors=True)
            self.folder.mkdir()
            usd = self.way.target == "usd" and not self.entrant.is_ours
            job |= {"folder": str(self.folder / "stage")} if usd else {"out": str(self.out(robot))}
        return job

    def out(self, robot: Input) -> Path:
        return self.folder / f"{robot.path.stem}{SUFFIXES[self.way.target]}"

    def command(self, robot: Input) -> list[str]:
        """The whole process: `convert` for what we have a verb for, and the driver otherwise."""
        if not self.entrant.measure:
            return self.entrant.peer.command(self.job(robot))
        self.job(robot)
        return [sys.executable, "-m", "hymeko_x", "convert", str(robot.path), str(self.out(robot))]

    def _missing(self, robot: Input, answer: dict[str, Any]) -> str:
        if not self.way.target or "stage" in answer or self.out(robot).is_file():
            return ""
        return "it wrote nothing and did not say why"


def measured(way: Way, robots: Sequence[Input], folder: Path, limit: float, tell: Callable[[str], None]) -> Iterator[Row]:
    """The rows of a way; robots stand from small to large, and for some of them whole processes are measured too."""
    with ExitStack() as stack:
        runners = [
            _runner(way, number, stack.enter_context(Session(entrant.peer)), folder, limit) for number, entrant in enumerate(way.entrants)
        ]
        for robot in robots:
            tell(f"{way.name}, {robot.name}")
            yield from _calls(runners, robot)
            if robot.name in WHOLE:
                yield from _processes(runners, robot)


def _runner(way: Way, number: int, session: Session, folder: Path, limit: float) -> _Runner:
    entrant = way.entrants[number]
    return _Runner(way, entrant, session, folder / f"entrant{number}", limit)


def _calls(runners: Sequence[_Runner], robot: Input) -> Iterator[Row]:
    for runner in runners:
        runner.begin(robot)
    for _ in range(ROUNDS + 1):
        for runner in runners:
            runner.call(robot)
    for runner in runners:
        yield _row(runner, robot, CALL, runner.end(robot), None)


def _processes(runners: Sequence[_Runner], robot: Input) -> Iterator[Row]:
    found: list[list[tuple[float, float]]] = [[] for _ in runners]
    for number in range(PROCESS_ROUNDS):
        for runner, own in zip(runners, found, strict=True):
            if not runner.reason and (number == 0 or own[-1][0] < ENOUGH):
                try:
                    own.append(process.run(runner.command(robot), limit=3.0 * runner.limit))
                except (subprocess.CalledProcessError, subprocess.TimeoutExpired) as error:
                    runner.reason = f"as a whole process: {str(error)[-200:]}"
    for runner, own in zip(runners, found, strict=True):
        medians = (None, None) if runner.reason else (statistics.median(one[0] for one in own), statistics.median(one[1] for one in own))
        yield _row(runner, robot, PROCESS, *medians)


def _row(runner: _Runner, robot: Input, kind: str, seconds: float | None, megabytes: float | None) -> Row:
    entrant = runner.entrant
    reason = " ".join(runner.reason.replace(str(runner.folder.parent), "").split())
    return Row(runner.way.name, entrant.name, entrant.version, robot.name, kind, seconds, megabytes, reason)
