"""`hymeko-x verify`: the verdict of the formats' own engines, as text: the answer, what a format cannot say, what failed, all checks.

Of this program it loads the verifier alone, so that it answers at once.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from typing import TYPE_CHECKING

from hymeko_x.assets.resolve import search_path
from hymeko_x.cli import exits
from hymeko_x.cli.inputs import engine_input, input_arguments, refuse_own_reading
from hymeko_x.cli.terminal import is_coloured, paint
from hymeko_x.verify.renaming import is_renaming

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.verify.verdict import Check, Verdict

_MOST_LINES = 12
"""So many findings are shown; `-v` shows all."""


def verify_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `verify`."""
    parser.add_argument("a", metavar="A", help="a robot in any format")
    parser.add_argument("b", metavar="B", help="the robot to compare it with")
    engine_arguments(parser)
    parser.add_argument("--strict", action="store_true", help="exit 4 as well where a format cannot say what the other robot has")
    how = "find each body's counterpart by its name, by the structure of the tree, or by the joint above it, with what is fixed to it"
    parser.add_argument("--match", choices=("name", "structure", "joints"), default="name", help=f"{how} (default name)")
    names = "with --match joints: other names for joints, such as 'panda_*=*' (repeatable)"
    parser.add_argument("--rename", action="append", type=_renaming, default=[], metavar="OLD=NEW", help=names)
    parser.add_argument("--json", action="store_true", help="print JSON")
    input_arguments(parser)


def engine_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of every verb that verifies."""
    parser.add_argument("--samples", type=_samples, default=100, metavar="N", help="random configurations to compare at (default 100)")
    parser.add_argument("--no-meshes", dest="meshes", action="store_false", help="do not read mesh files, which takes most of the time")
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="where the random numbers start (default 0)")


def run_verify(chosen: argparse.Namespace) -> int:
    """Print the verdict; exit 4 when the robots are different, 1 when they cannot be compared, as :func:`exit_code` says."""
    refuse_own_reading(chosen)
    verdict = verdict_of(chosen.a, chosen.b, chosen, match=chosen.match, rename=dict(chosen.rename))
    if chosen.json:
        print(json.dumps(verdict.as_json(), indent=2, ensure_ascii=False))
    else:
        lines = list(verdict_lines(verdict, verbose=chosen.verbose))
        print("\n".join(lines[:1] if chosen.quiet else lines))
    return exit_code(verdict, strict=chosen.strict)


def verdict_of(a: str, b: str, chosen: argparse.Namespace, *, match: str = "name", rename: Mapping[str, str] | None = None) -> Verdict:
    """The verdict about two files, with the options of :func:`engine_arguments` and of every verb that reads a robot."""
    os.environ.setdefault("MUJOCO_GL", "disable")  # nothing is drawn, and importing what draws takes a twentieth of the time
    from hymeko_x.verify import verify

    first, second = engine_input(a, chosen), engine_input(b, chosen)
    return verify(
        first.path,
        second.path,
        samples=chosen.samples,
        seed=chosen.seed,
        structure=match == "structure",
        joints=match == "joints",
        rename=rename,
        meshes=chosen.meshes,
        packages=dict(chosen.package),
        search_path=search_path(os.environ),
        arguments={**first.arguments, **second.arguments, **dict(chosen.arg)},
        variants=dict(chosen.variant),
    )


def _renaming(text: str) -> tuple[str, str]:
    old, equals, new = text.partition("=")
    if not equals or not is_renaming(old, new):
        raise argparse.ArgumentTypeError(f"expected OLD=NEW with at most one * in each, found '{text}'")
    return old, new


def _samples(text: str) -> int:
    if not text.isascii() or not text.isdigit():
        raise argparse.ArgumentTypeError(f"expected a number of configurations, found '{text}'")
    return int(text)


# ---- as text -----------------------------------------------------------------------------------------------------------


def exit_code(verdict: Verdict, *, strict: bool = False) -> int:
    """0 for the same robot, 4 for another one, 1 where that is unknown; with ``strict`` 4 where a format cannot say everything."""
    if verdict.reason:
        return exits.FAILED
    return exits.DIFFERENT if verdict.failed or (strict and verdict.gaps) else exits.DONE


def verdict_lines(verdict: Verdict, *, coloured: bool | None = None, verbose: bool = False) -> Iterator[str]:
    """The verdict as text; ``verbose``: with the table of all checks and everything that was not compared."""
    colour = is_coloured(sys.stdout) if coloured is None else coloured
    yield _answer(verdict, colour)
    if verdict.reason:
        return
    failed = [_failed_line(check, colour) for check in verdict.failed]
    gaps = [f"  {gap.format} cannot say {gap}" for gap in verdict.gaps]
    for lines in (failed, gaps):
        yield from lines if verbose else lines[:_MOST_LINES]
        if len(lines) > _MOST_LINES and not verbose:
            yield f"  ... and {len(lines) - _MOST_LINES} more"
    if verbose:
        yield from _table(verdict, colour)
        yield from (f"  note: {note}" for note in verdict.not_compared)
    passed = len(verdict.checks) - len(verdict.failed)
    notes = len(verdict.not_compared)
    noted = f", {notes} {'note' if notes == 1 else 'notes'}" if notes else ""
    yield f"{passed} {'check' if passed == 1 else 'checks'} passed{noted}" + ("" if verbose else "; -v has the table")


def _answer(verdict: Verdict, colour: bool) -> str:
    style = "33" if verdict.reason else "31" if verdict.failed else "33" if verdict.gaps else "32"
    return _painted(style, verdict.verdict, colour) + (f": {verdict.reason}" if verdict.reason else "")


def _failed_line(check: Check, colour: bool) -> str:
    """What failed and where, both values, and by how much they are off."""
    mark = _painted("31", "FAIL", colour)
    if not check.unit:
        return f"  {mark} {check.quantity}: {check.at}"
    size = f"{check.worst:.3g} {check.unit} off, {check.allowed:.3g} allowed"
    found = f"{check.values[0]} and {check.values[1]} {check.unit} ({size})" if check.values else size
    return f"  {mark} {check.quantity}, {check.at}: {found}"


def _table(verdict: Verdict, colour: bool) -> Iterator[str]:
    yield f"  {verdict.engines[0]}  |  {verdict.engines[1]}"
    yield f"  {'':4} {'quantity':<32} {'worst':>9} {'allowed':>9} {'unit':<10} at"
    for check in verdict.checks:
        mark = _painted("32", "ok  ", colour) if check.passed else _painted("31", "FAIL", colour)
        yield f"  {mark} {check.quantity:<32} {check.worst:>9.3g} {check.allowed:>9.3g} {check.unit:<10} {check.at}".rstrip()
    for quantity in verdict.nothing:
        yield f"  -    {quantity}"


def _painted(style: str, text: str, colour: bool) -> str:
    return paint(style, text) if colour else text
