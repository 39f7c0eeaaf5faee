"""`hymeko-x diff A B`: two robots compared element by element."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from hymeko_x.cli import exits
from hymeko_x.cli.inputs import input_arguments, read_input
from hymeko_x.cli.terminal import show
from hymeko_x.compare.diff import Tolerance, diff
from hymeko_x.diagnostics import Report

if TYPE_CHECKING:
    import argparse

    from hymeko_x.cli.inputs import Input
    from hymeko_x.compare.diff import Difference


def arguments(parser: argparse.ArgumentParser) -> None:
    """The verb's own words."""
    parser.add_argument("a", metavar="A", help="a robot in any format; - is standard input")
    parser.add_argument("b", metavar="B", help="the robot to compare it with")
    parser.add_argument("--tolerance", type=float, default=1e-12, metavar="T", help="numbers this close are equal (default 1e-12)")
    parser.add_argument("--json", action="store_true", help="print JSON")
    input_arguments(parser)


def run(chosen: argparse.Namespace) -> int:
    """Print one line per difference; exit 4 if there is any."""
    report = Report()
    a, b = (read_input(path, chosen, report) for path in (chosen.a, chosen.b))
    found = diff(a.mechanism, b.mechanism, Tolerance(chosen.tolerance, chosen.tolerance))
    show(report)
    print(json.dumps(_as_json(a, b, found), indent=2, ensure_ascii=False)) if chosen.json else print_lines(found)
    return exits.DIFFERENT if found else exits.DONE


def print_lines(found: tuple[Difference, ...]) -> None:
    """One line per difference."""
    for difference in found:
        print(difference)


def _as_json(a: Input, b: Input, found: tuple[Difference, ...]) -> dict[str, object]:
    rows = [{"element": str(row.element), "field": row.field, "before": row.before, "after": row.after} for row in found]
    names = {key: {"path": given.source.name, "format": given.format.name} for key, given in (("a", a), ("b", b))}
    return {**names, "differences": rows}
