"""`hymeko-x check`: whether a robot is complete and sane, and mechanical repairs of what is not."""

from __future__ import annotations

import argparse
import json
import sys
from functools import partial
from typing import TYPE_CHECKING

from hymeko_x.cli import exits
from hymeko_x.cli.exits import UsageError
from hymeko_x.cli.inputs import inertia_arguments, input_arguments, read_input
from hymeko_x.cli.report import show_diagnostics
from hymeko_x.diagnostics import Report, Severity

if TYPE_CHECKING:
    from hymeko_x.cli.inputs import Input

PROFILES = ("kinematics", "simulation", "display", "complete")
"""The values of `validation.Profile`, which is loaded only when the verb runs."""


def check_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `check`."""
    parser.add_argument("inputs", nargs="+", metavar="FILE", help="the robot to check, or several; - is standard input")
    parser.add_argument("--profile", action="append", choices=PROFILES, help="what it is for (repeatable; default: all but complete)")
    parser.add_argument("--links", type=_count, metavar="N", help="how many links there should be")
    parser.add_argument("--joints", type=_count, metavar="N", help="how many joints there should be")
    parser.add_argument(
        "--fail-on", choices=("error", "warning"), default="error", help="exit 3 when one of these was found (default error)"
    )
    parser.add_argument("--fix", action="store_true", help="repair in FILE what can be repaired mechanically, and check the result")
    parser.add_argument("-o", "--output", metavar="OUT", help="with --fix: write the repaired robot there instead")
    parser.add_argument("--dry-run", action="store_true", help="with --fix: print what would change in the text, and write nothing")
    inertia_arguments(parser)
    parser.add_argument("--json", action="store_true", help="print JSON")
    input_arguments(parser)


def run_check(chosen: argparse.Namespace) -> int:
    """Print what is wrong; exit 3 when it is bad enough in one of the files, 1 when one cannot be read."""
    _check_options(chosen)
    if len(chosen.inputs) == 1:
        return _check(chosen.inputs[0], chosen)
    if chosen.json:
        raise UsageError("--json is for one robot at a time")
    codes = [exits.guarded("check", partial(_check, path, chosen)) for path in chosen.inputs]
    return next((code for code in (exits.BUG, exits.FAILED, exits.FAIL_ON) if code in codes), exits.DONE)


def _check_options(chosen: argparse.Namespace) -> None:
    """Raises: UsageError for options of --fix without it, and for files that it cannot write."""
    given = {"-o": chosen.output, "--dry-run": chosen.dry_run, "--density": chosen.density, "--inertia-from": chosen.inertia_from}
    alone = next((option for option, value in given.items() if value and not chosen.fix), None)
    if alone is not None:
        raise UsageError(f"{alone} goes with --fix")
    if chosen.fix and "-" in chosen.inputs:
        raise UsageError("--fix repairs files, and no pipes")
    if chosen.output and len(chosen.inputs) > 1:
        raise UsageError("-o is for one robot at a time")


def _check(path: str, chosen: argparse.Namespace) -> int:
    from hymeko_x.validation import USUAL, Declared, Profile, validate

    report = Report()
    given = read_input(path, chosen, report, anyway=True)
    if chosen.fix:
        given, report = _fixed(given, path, report, chosen)
    profiles = [Profile(word) for word in chosen.profile] if chosen.profile else USUAL
    validate(given.mechanism, given.source.files, report, profiles, Declared(chosen.links, chosen.joints))
    failed = report.worst in ((Severity.ERROR,) if chosen.fail_on == "error" else (Severity.ERROR, Severity.WARNING))
    if chosen.json:
        print(json.dumps(_check_json(given, report, passed=not failed), indent=2, ensure_ascii=False))
    else:
        show_diagnostics(report, chosen)
        print(_summary(report) if len(chosen.inputs) == 1 else f"{path}: {_summary(report)}")
    return exits.FAIL_ON if failed else exits.DONE


def _fixed(given: Input, path: str, found: Report, chosen: argparse.Namespace) -> tuple[Input, Report]:
    """The robot in the repaired text, which is written unless it is a rehearsal, and a report of the repairs and of what is left."""
    from hymeko_x import disk, pipeline
    from hymeko_x.edits.repairs import repaired, repaired_source
    from hymeko_x.rewrite import Options

    report = Report()
    options = Options(density=chosen.density, inertia_from=chosen.inertia_from)
    result = repaired(given.source, given.format, given.mechanism, tuple(found), options, report)
    files = result.files(path, chosen.output)
    if chosen.dry_run:
        sys.stdout.write("" if chosen.json else result.diff)
    else:
        disk.write_files(files)
        for name in files:
            print(f"written: {name}", file=sys.stderr)
    source = repaired_source(given.source, result)
    return given._replace(mechanism=pipeline.read_anyway(source, given.format, report), source=source), report


def _check_json(given: Input, report: Report, *, passed: bool) -> dict[str, object]:
    """The document of `--json`; diagnostics have the keys of `convert --report`."""
    source = {"path": given.source.name, "format": given.format.name}
    return {"source": source, "passed": passed, "diagnostics": [diagnostic.as_json() for diagnostic in report]}


def _summary(report: Report) -> str:
    """How many of each severity there are."""
    counts = {severity: sum(d.severity is severity for d in report) for severity in (Severity.ERROR, Severity.WARNING)}
    if not any(counts.values()):
        return "nothing is wrong"
    return ", ".join(f"{count} {severity.value}{'s' if count != 1 else ''}" for severity, count in counts.items() if count)


def _count(text: str) -> int:
    if not text.isascii() or not text.isdigit():
        raise argparse.ArgumentTypeError(f"expected a number, found '{text}'")
    return int(text)
