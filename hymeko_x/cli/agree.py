"""`hymeko-x agree`: whether the files of a repository that are one robot in several formats agree."""

from __future__ import annotations

import os
import sys
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.agree import config, files, pages
from hymeko_x.assets.resolve import search_path
from hymeko_x.cli import exits
from hymeko_x.cli.exits import UsageError
from hymeko_x.disk import write_files
from hymeko_x.reporting.blocks import renewed_blocks

if TYPE_CHECKING:
    import argparse

    from hymeko_x.agree.robots import Compared


def agree_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `agree`."""
    parser.add_argument("config", nargs="?", default=config.NAME, metavar="hymeko.toml", help="the robots to compare (default hymeko.toml)")
    parser.add_argument("--only", action="append", default=[], metavar="ROBOT", help="compare this robot alone (repeatable)")
    since = "compare the robots whose files, with what they include and show, differ from this revision of git"
    parser.add_argument("--changed-since", metavar="REF", help=since)
    known = "differences that this result of `agree --report FILE.json` has are known"
    parser.add_argument("--baseline", metavar="FILE.json", help=known)
    parser.add_argument("--format", dest="style", choices=tuple(pages.STYLES), default="text", help="what to print (default text)")
    what = f"write the result to a file as well, by its suffix: {' '.join(pages.OF_SUFFIXES)} (repeatable)"
    parser.add_argument("--report", action="append", default=[], metavar="FILE", help=what)
    largest = "of each quantity the largest difference between two files alone, and how many there are"
    parser.add_argument("--summary", action="store_true", help=largest)
    parser.add_argument(
        "--page", metavar="FILE.md", help="renew the tables of the summary in this page, between the marks of `hymeko-x agree`"
    )
    parser.add_argument("-q", "--quiet", action="store_true", help="print nothing where all robots agree")


def run_agree(chosen: argparse.Namespace) -> int:
    """Print the result; exit 4 when robots differ."""
    unknown = next((path for path in chosen.report if Path(path).suffix.lower() not in pages.OF_SUFFIXES), None)
    if unknown:
        raise UsageError(f"the suffix of '{unknown}' names no kind of report; known: {' '.join(pages.OF_SUFFIXES)}")
    results = _results(chosen)
    if chosen.baseline:
        results = _without_known(results, chosen.baseline)
    summary = [result.summary for result in results]
    if chosen.summary:
        results = summary
    is_wrong = any(result.wrong for result in results)
    if is_wrong or not chosen.quiet:
        print(pages.STYLES[chosen.style](results), end="")
    write_files({path: pages.STYLES[pages.OF_SUFFIXES[Path(path).suffix.lower()]](results).encode() for path in chosen.report})
    if chosen.page:
        _renew(chosen.page, pages.tables(summary))
    return exits.DIFFERENT if is_wrong else exits.DONE


def _results(chosen: argparse.Namespace) -> list[Compared]:
    os.environ.setdefault("MUJOCO_GL", "disable")  # nothing is drawn, and importing what draws takes a twentieth of the time
    from hymeko_x.agree.robots import compare

    found = config.load(chosen.config)
    where = search_path(os.environ)
    robots = files.changed_robots(found, chosen.config, chosen.changed_since, where) if chosen.changed_since else found.robot
    names = {robot.name for robot in found.robot}
    if unknown := next((name for name in chosen.only if name not in names), None):
        raise UsageError(f"there is no robot '{unknown}' in {chosen.config}; it has: {', '.join(sorted(names))}")
    wanted = [robot for robot in robots if not chosen.only or robot.name in chosen.only]
    if not wanted:
        print("no robot has changed" if chosen.changed_since else "there is no robot", file=sys.stderr)
    return [compare(robot, Path(chosen.config).parent, date.today(), where) for robot in wanted]


def _renew(page: str, tables: str) -> None:
    """Raises: UsageError where the page cannot be read or has no place for tables."""
    try:
        text = renewed_blocks(Path(page).read_text("utf-8"), "hymeko-x agree", lambda _: tables.rstrip("\n"))
    except (OSError, ValueError) as error:
        raise UsageError(f"{page}: {error}") from error
    write_files({page: text.encode()})


def _without_known(results: list[Compared], path: str) -> list[Compared]:
    """The results without the differences of a baseline. Raises: UsageError where the file is none."""
    try:
        known = pages.baseline_of(Path(path).read_text("utf-8"))
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise UsageError(f"{path} is no result of `agree --report FILE.json`: {error}") from error
    return [replace(result, found=tuple(found for found in result.found if found.key not in known)) for result in results]
