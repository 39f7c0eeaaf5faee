"""The report of a conversion on standard error: at most a dozen lines, or everything, or nothing but errors."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

from hymeko_x.assets.archives import is_archive
from hymeko_x.cli.terminal import alike_diagnostics, is_coloured, render, render_alike, show
from hymeko_x.diagnostics import Severity
from hymeko_x.reporting.summary import counted, kept_line, minor_line, summary_lines
from hymeko_x.source import DIGESTS, KEPT_FOLDER

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterable, Sequence

    from hymeko_x.compare.ledger import Loss
    from hymeko_x.diagnostics import Diagnostic, Report
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.source import Package

MOST_LINES = 12
"""How many lines a report has; `-v` shows everything."""
_FOR_NOTES = 2
"""So many lines are left for notes, such as that a base was fixed to the world."""
_FOLDERS = 3


def report_arguments(parser: argparse.ArgumentParser) -> None:
    """Where the report goes."""
    formats = "write diagnostics and losses to a file: as JSON, or as SARIF if it is called *.sarif"
    parser.add_argument("--report", metavar="FILE.json", help=formats)


def show_diagnostics(report: Report, chosen: argparse.Namespace) -> None:
    """Print the diagnostics of a verb that writes no robot: alike ones together, or each (`-v`), or errors alone (`-q`)."""
    if chosen.verbose:
        print("".join(f"{render(diagnostic, is_coloured(sys.stderr))}\n" for diagnostic in report), end="", file=sys.stderr)
    else:
        show(diagnostic for diagnostic in report if not chosen.quiet or diagnostic.severity is Severity.ERROR)


def show_report(written: str, report: Report, losses: Sequence[Loss], chosen: argparse.Namespace) -> None:
    """Print the report; ``written`` is the line about what was written where, empty where nothing was."""
    coloured = is_coloured(sys.stderr)
    if chosen.quiet:
        lines = [render(diagnostic, coloured) for diagnostic in report if diagnostic.severity is Severity.ERROR]
    elif chosen.verbose:
        lines = [*_non_empty(written), *(render(diagnostic, coloured) for diagnostic in report), *map(str, losses)]
    else:
        lines = brief_lines(written, report, losses, coloured=coloured)
    for line in lines:
        print(line, file=sys.stderr)


def one_line(written: str, report: Report, losses: Sequence[Loss]) -> str:
    """The report of a conversion in one line."""
    counts = ((len(losses), "loss"), *((sum(d.severity is s for d in report), s.value) for s in (Severity.ERROR, Severity.WARNING)))
    found = ", ".join(counted(count, word) for count, word in counts if count)
    return (written or "not written") + (f"; {found}" if found else "")


def brief_lines(written: str, report: Iterable[Diagnostic], losses: Sequence[Loss], *, coloured: bool = False) -> list[str]:
    """The report in at most a dozen lines: what was written, problems, losses, notes, and how to see the rest."""
    alike = sorted(alike_diagnostics(report), key=_weight, reverse=True)
    rendered = [(group[0].severity is Severity.NOTE, render_alike(group, coloured).splitlines()) for group in alike]
    problems, notes = ([lines for is_note, lines in rendered if is_note is wanted] for wanted in (False, True))
    lost, ends = summary_lines(losses), _non_empty(kept_line(losses), minor_line(losses))
    room = MOST_LINES - len(_non_empty(written)) - len(ends) - 1
    shown = _that_fit(problems, max(room - len(lost) - _FOR_NOTES, room // 2))
    room -= sum(map(len, shown))
    kinds = lost[: max(room - min(_FOR_NOTES, sum(map(len, notes))), 0)]
    noted = _that_fit(notes, room - len(kinds))
    lines = [*_non_empty(written), *_flat(shown), *kinds, *ends, *_flat(noted)]
    left = len(alike) - len(shown) - len(noted) + len(lost) - len(kinds)
    if losses or left:
        rest = f"{counted(left, 'more kind')}; " if left else ""
        lines.append(f"{rest}-v lists each with its place, --report FILE.json has all")
    return lines


def _weight(alike: Sequence[Diagnostic]) -> tuple[int, int]:
    """Errors before warnings before notes; of the first two those that there are most of."""
    severity = alike[0].severity
    return severity.rank, 0 if severity is Severity.NOTE else len(alike)


def _flat(groups: list[list[str]]) -> list[str]:
    return [line for group in groups for line in group]


def _that_fit(groups: list[list[str]], room: int) -> list[list[str]]:
    """The first groups of lines that fit into the room."""
    shown: list[list[str]] = []
    for group in groups:
        room -= len(group)
        if room < 0:
            break
        shown.append(group)
    return shown


def written_line(path: str, mechanism: Mechanism, package: Package) -> str:
    """What was written where: the file, what is in it, and the files beside it."""
    beside = {*package.files, *package.copies}
    folders = sorted({os.path.dirname(name) for name in beside})
    named = ", ".join(f"{folder}/" if folder else "the same folder" for folder in folders[:_FOLDERS])
    more = f", ... ({len(folders)} folders)" if len(folders) > _FOLDERS else ""
    where = f" and {counted(len(beside), 'file')} in {named}{more}" if beside else ""
    if is_archive(path):
        where = f" with {counted(len(beside), 'file')} inside" if beside else ""
    bodies = sum(key.kind == "body" for key in mechanism.graph.vertices)
    joints = sum(key.kind == "joint" for key in mechanism.graph.edges)
    count = sum(name != DIGESTS for name in package.originals)
    originals = f", {counted(count, 'original')} in {os.path.basename(path)}{KEPT_FOLDER}/" if count else ""
    return f"wrote {path} ({counted(bodies, 'body')}, {counted(joints, 'joint')}){where}{originals}"


def _non_empty(*lines: str) -> list[str]:
    return [line for line in lines if line]
