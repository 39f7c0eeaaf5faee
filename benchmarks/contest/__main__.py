"""python -m benchmarks.contest [--links N ...] [--no-real] [--ways TEXT] [--limit SECONDS] [--table]     (after `python -m peers`; POSIX)

On each way all programs take turns at one robot; the rows of that robot replace those of the run before in `benchmarks/results`,
and the table of docs/speed.md is written from them. Times are processor times; the ratios mean something, the seconds belong to the
machine.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from benchmarks.contest.inputs import made, real
from benchmarks.contest.measure import measured
from benchmarks.contest.rows import RESULTS, as_csv, from_csv
from benchmarks.contest.table import page
from benchmarks.contest.texts import WAY, texts
from benchmarks.contest.ways import WAYS

if TYPE_CHECKING:
    from benchmarks.contest.inputs import Input
    from benchmarks.contest.rows import Row

PAGE = Path(__file__).parents[2] / "docs" / "speed.md"
LINKS = (2, 100, 1_000, 10_000, 100_000)


def main() -> int:
    """Measure what is asked for, keep it, and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--links", type=int, nargs="*", default=LINKS, help="sizes of the made robots")
    parser.add_argument("--real", action=argparse.BooleanOptionalAction, default=True, help="a real robot as well")
    parser.add_argument("--ways", default="", help="only ways that have this in their name")
    parser.add_argument("--limit", type=float, default=120.0, help="seconds by the clock that one conversion may take, whoever does it")
    parser.add_argument("--table", action="store_true", help="measure nothing, only write the table")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        if not options.table:
            _measure(_robots(Path(folder), sorted(options.links), options.real), Path(folder), options.ways, options.limit)
    PAGE.write_text(page(PAGE.read_text("utf-8"), from_csv(RESULTS.read_text("utf-8"))), "utf-8")
    return 0


def _robots(folder: Path, links: list[int], and_real: bool) -> dict[str, list[Input]]:
    """The robots of each format, from small to large."""
    return {
        format: [*([real(format, folder)] if and_real else []), *(made(format, count, folder) for count in links)]
        for format in ("urdf", "mjcf")
    }


def _measure(robots: dict[str, list[Input]], folder: Path, match: str, limit: float) -> None:
    for way in WAYS:
        if match in way.name:
            _keep(list(measured(way, robots[way.source], folder, limit, _tell)))
    if match in WAY:
        _keep(list(texts([robot for robot in robots["urdf"] if robot.links in (0, 1_000, 10_000)])))


def _keep(rows: list[Row]) -> None:
    """Put rows in the place of those that are there for the same ways and robots."""
    renewed = {(row.way, row.robot) for row in rows}
    there = from_csv(RESULTS.read_text("utf-8")) if RESULTS.is_file() else ()
    ways = [*(way.name for way in WAYS), WAY]
    kept = [row for row in there if (row.way, row.robot) not in renewed and row.way in ways]
    RESULTS.parent.mkdir(exist_ok=True)
    RESULTS.write_text(as_csv(sorted([*kept, *rows], key=lambda row: (ways.index(row.way), _links(row.robot)))), "utf-8")


def _links(robot: str) -> int:
    """What made robots are called after; the real one stands first."""
    count, _, unit = robot.partition(" ")
    return int(count.replace(",", "")) if unit == "links" else 0


def _tell(what: str) -> None:
    print(what, flush=True)


if __name__ == "__main__":
    sys.exit(main())
