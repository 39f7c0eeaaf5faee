"""What was run so far, on which code: one line per run under build/fuzz, and its sums."""

from __future__ import annotations

import subprocess
from typing import TYPE_CHECKING, NamedTuple

from tests.fuzz.run import FOUND

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tests.fuzz.run import Tally, Task

LEDGER = "ledger.tsv"


class Line(NamedTuple):
    """One run: the cases from ``first`` up to but without ``stop``, read by the code of a commit."""

    format: str
    through: str
    first: int
    stop: int
    kinds: int
    seconds: int
    commit: str


def note(task: Task, tally: Tally, seconds: float) -> None:
    """Add a run to the ledger."""
    FOUND.mkdir(parents=True, exist_ok=True)
    line = Line(task.format, task.through, task.start, task.start + tally.cases, len(tally.kinds), round(seconds), _commit())
    with (FOUND / LEDGER).open("a", encoding="utf-8") as file:
        file.write("\t".join(map(str, line)) + "\n")


def lines() -> Iterator[Line]:
    """Every run that was noted."""
    place = FOUND / LEDGER
    for text in place.read_text("utf-8").splitlines() if place.exists() else ():
        format, through, first, stop, kinds, seconds, commit = text.split("\t")
        yield Line(format, through, int(first), int(stop), int(kinds), int(seconds), commit)


def next_case(format: str, through: str) -> int:
    """The first case that no run has reached."""
    return max((line.stop for line in lines() if (line.format, line.through) == (format, through)), default=1)


def sums() -> Iterator[str]:
    """Of each format: how many cases were run, and how many of them on which commit."""
    of: dict[tuple[str, str], list[Line]] = {}
    for line in lines():
        of.setdefault((line.format, line.through), []).append(line)
    for (format, through), found in of.items():
        by_commit: dict[str, int] = {}
        for line in found:
            by_commit[line.commit] = by_commit.get(line.commit, 0) + line.stop - line.first
        shares = ", ".join(f"{count} on {commit}" for commit, count in by_commit.items())
        way = f"{format} through {through}" if through else format
        yield f"{way}: {sum(by_commit.values())} cases, {sum(line.kinds for line in found)} findings ({shares})"


def _commit() -> str:
    """The commit that is checked out, as far as git knows."""
    described = subprocess.run(
        ("git", "describe", "--always", "--dirty"), cwd=FOUND.parents[1], capture_output=True, text=True, check=False
    )
    return described.stdout.strip() or "unknown"
