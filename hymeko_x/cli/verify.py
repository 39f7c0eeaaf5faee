"""`hymeko-x verify A B`: whether two files are the same robot, as the formats' own engines see them."""

from __future__ import annotations

import argparse
import os
import sys
from typing import TYPE_CHECKING

from hymeko_x.assets.resolve import search_path
from hymeko_x.cli import exits
from hymeko_x.cli.inputs import input_arguments
from hymeko_x.cli.terminal import is_coloured, paint

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.verify.verdict import Check, Verdict

CODES = {"same": exits.DONE, "different": exits.DIFFERENT, "not comparable": exits.FAILED}
"""The exit code of each verdict."""
_COLOURS = {"same": "32", "different": "31", "not comparable": "33"}


def arguments(parser: argparse.ArgumentParser) -> None:
    """The verb's own words."""
    parser.add_argument("a", metavar="A", help="a robot in any format")
    parser.add_argument("b", metavar="B", help="the robot to compare it with")
    verify_arguments(parser)
    parser.add_argument("--match", choices=("name", "structure"), default="name", help="how to find each body's counterpart (default name)")
    parser.add_argument("--json", action="store_true", help="print JSON")
    input_arguments(parser)


def verify_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of every verb that verifies."""
    parser.add_argument("--samples", type=_count, default=100, metavar="N", help="random configurations to compare at (default 100)")
    parser.add_argument("--no-meshes", dest="meshes", action="store_false", help="do not read mesh files, which takes most of the time")
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="where the random numbers start (default 0)")


def run(chosen: argparse.Namespace) -> int:
    """Print the verdict; exit 4 when the robots are different, 1 when they cannot be compared."""
    verdict = verdict_of(chosen.a, chosen.b, chosen, structure=chosen.match == "structure")
    import json

    print(json.dumps(verdict.as_json(), indent=2, ensure_ascii=False) if chosen.json else "\n".join(lines(verdict)))
    return CODES[verdict.verdict]


def verdict_of(a: str, b: str, chosen: argparse.Namespace, *, structure: bool = False) -> Verdict:
    """The verdict about two files, with the options of :func:`verify_arguments` and of every verb that reads a robot."""
    from hymeko_x.verify import verify

    return verify(
        a,
        b,
        samples=chosen.samples,
        seed=chosen.seed,
        structure=structure,
        meshes=chosen.meshes,
        packages=dict(chosen.package),
        search_path=search_path(os.environ),
        arguments=dict(chosen.arg),
        variants=dict(chosen.variant),
    )


def lines(verdict: Verdict, *, coloured: bool | None = None, brief: bool = False) -> Iterator[str]:
    """The verdict as text: the answer, a table of the checks (of those that failed, if ``brief``), and what was not compared."""
    colour = is_coloured(sys.stdout) if coloured is None else coloured
    yield _painted(_COLOURS[verdict.verdict], verdict.verdict, colour) + (f": {verdict.reason}" if verdict.reason else "")
    if verdict.failed if brief else verdict.checks:
        yield f"  {verdict.engines[0]}  |  {verdict.engines[1]}"
        yield f"  {'':4} {'quantity':<32} {'worst':>9} {'allowed':>9} {'unit':<10} at"
    for check in verdict.failed if brief else verdict.checks:
        yield _line(check, colour)
    for note in () if brief else verdict.not_compared:
        yield f"  note: {note}"


def _line(check: Check, colour: bool) -> str:
    mark = _painted("32", "ok  ", colour) if check.passed else _painted("31", "FAIL", colour)
    return f"  {mark} {check.quantity:<32} {check.worst:>9.3g} {check.allowed:>9.3g} {check.unit:<10} {check.at}".rstrip()


def _painted(style: str, text: str, colour: bool) -> str:
    return paint(style, text) if colour else text


def _count(text: str) -> int:
    if not text.isascii() or not text.isdigit():
        raise argparse.ArgumentTypeError(f"expected a number of configurations, found '{text}'")
    return int(text)
