"""`hymeko-x check FILE`: whether a robot is complete and sane, as codes that a person or a program can act on."""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING

from hymeko_x.cli import exits
from hymeko_x.cli.inputs import input_arguments, read_input
from hymeko_x.cli.terminal import show
from hymeko_x.diagnostics import Report, Severity

if TYPE_CHECKING:
    from hymeko_x.cli.inputs import Input

PROFILES = ("kinematics", "simulation", "display")


def arguments(parser: argparse.ArgumentParser) -> None:
    """The verb's own words."""
    parser.add_argument("input", metavar="FILE", help="the robot to check; - is standard input")
    parser.add_argument("--profile", action="append", choices=PROFILES, help="what it is for (repeatable; default: everything)")
    parser.add_argument("--links", type=_count, metavar="N", help="how many links there should be")
    parser.add_argument("--joints", type=_count, metavar="N", help="how many joints there should be")
    parser.add_argument(
        "--fail-on", choices=("error", "warning"), default="error", help="exit 3 when one of these was found (default error)"
    )
    parser.add_argument("--json", action="store_true", help="print JSON")
    input_arguments(parser)


def run(chosen: argparse.Namespace) -> int:
    """Print what is wrong; exit 3 when it is bad enough."""
    from hymeko_x.validation import Declared, Profile, validate

    report = Report()
    given = read_input(chosen.input, chosen, report)
    profiles = [Profile(word) for word in chosen.profile or PROFILES]
    validate(given.mechanism, given.source.files, report, profiles, Declared(chosen.links, chosen.joints))
    failed = report.worst in ((Severity.ERROR,) if chosen.fail_on == "error" else (Severity.ERROR, Severity.WARNING))
    if chosen.json:
        print(json.dumps(as_json(given, report, passed=not failed), indent=2, ensure_ascii=False))
    else:
        show(report)
        print(summary(report))
    return exits.FAIL_ON if failed else exits.DONE


def as_json(given: Input, report: Report, *, passed: bool) -> dict[str, object]:
    """The document of `--json`; diagnostics have the keys of `convert --report`."""
    source = {"path": given.source.name, "format": given.format.name}
    return {"source": source, "passed": passed, "diagnostics": [diagnostic.as_json() for diagnostic in report]}


def summary(report: Report) -> str:
    """How many of each severity there are."""
    counts = {severity: sum(d.severity is severity for d in report) for severity in (Severity.ERROR, Severity.WARNING)}
    if not any(counts.values()):
        return "nothing is wrong"
    return ", ".join(f"{count} {severity.value}{'s' if count != 1 else ''}" for severity, count in counts.items() if count)


def _count(text: str) -> int:
    if not text.isascii() or not text.isdigit():
        raise argparse.ArgumentTypeError(f"expected a number, found '{text}'")
    return int(text)
