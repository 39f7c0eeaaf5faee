"""The words on the command line that say what to write, and the writing: output, report, exit code."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple

from hymeko_x import codes, disk, pipeline
from hymeko_x.cli import exits
from hymeko_x.cli.losses import lines
from hymeko_x.cli.terminal import MOST_LINES, show
from hymeko_x.delivery import Delivery
from hymeko_x.diagnostics import Severity
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Package

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterable

    from hymeko_x.cli.inputs import Input
    from hymeko_x.compare.ledger import Loss
    from hymeko_x.diagnostics import Report
    from hymeko_x.formats import Format
    from hymeko_x.pipeline import Result

FAIL_ON = ("error", "loss", "warning")


class Output(NamedTuple):
    """Where the result goes: its format, and a path (`-` is standard output)."""

    format: Format
    path: str


def output_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of every verb that writes a robot."""
    parser.add_argument("--base", choices=("fixed", "free"), help="what becomes of a base that the source leaves open")
    parser.add_argument("--actuators", choices=("none", "motor", "position", "velocity"), help="the actuators to write")
    parser.add_argument("--assets", choices=("copy", "reference"), help="put meshes beside the output, or refer to them where they are")
    layouts = "USD: one file, or an interface with files for geometry, materials and physics behind it"
    parser.add_argument("--layout", choices=("single", "layered"), help=layouts)
    parser.add_argument("--nested", action="store_true", default=None, help="USD: put each body inside of its parent")
    parser.add_argument("--pure", action="store_true", help="write no residue of what the format cannot say itself")
    parser.add_argument("--split", action="store_true", help="xacro: put the macros into a file of their own")
    parser.add_argument("--report", metavar="FILE.json", help="write diagnostics and losses to a file")
    parser.add_argument("--fail-on", choices=FAIL_ON, help="exit 3, and write no output, when one of these (or worse) happened")


def deliver(given: Input, output: Output, chosen: argparse.Namespace, report: Report, *, measured: bool = True) -> int:
    """Write the mechanism that was read, say what there is to say, and return the exit code.

    With ``measured`` the result is read back and its losses are listed.
    """
    path = "" if output.path == "-" else output.path
    options = Options(chosen.base, chosen.actuators, chosen.layout, chosen.nested, chosen.split, chosen.pure, Path(path).stem)
    delivery = Delivery(given.mechanism, output.format, options, given.source.files, _place(output, chosen.assets), path)
    result = delivery.convert(report, measured=measured)
    beside = [*result.package.files, *result.package.copies]
    if output.path == "-" and beside:
        names = ", ".join(beside[:3]) + (f" and {len(beside) - 3} more" if len(beside) > 3 else "")
        report.warn(codes.ASSET_NOT_WRITTEN, f"standard output cannot carry {names}", hint="-o FILE writes them beside the file")
    failed = is_reached(chosen.fail_on, report, result.losses)
    if not failed:
        _write(delivery, output, result)
    show(report)
    _show_losses(result.losses or ())
    wants_json = getattr(chosen, "json", False)
    document = as_json(given, output, report, result.losses) if chosen.report or wants_json else ""
    if chosen.report:
        disk.write_package(Package(f"{document}\n".encode()), chosen.report, NoFiles())
    if wants_json:
        print(document)
    return exits.FAIL_ON if failed else exits.DONE


def _place(output: Output, assets: Literal["copy", "reference"] | None) -> pipeline.Place:
    """Beside standard output nothing can be put, so that files are referred to from the working folder."""
    if output.path == "-":
        return pipeline.Place(assets="reference")
    return pipeline.Place(os.path.dirname(output.path) or ".", assets)


def _write(delivery: Delivery, output: Output, result: Result) -> None:
    if output.path == "-":
        sys.stdout.buffer.write(result.package.main)
    else:
        delivery.put(result)


def as_json(given: Input, output: Output, report: Report, losses: Iterable[Loss] | None) -> str:
    """The document of `--report` and of `convert --json`."""
    import json

    document = {
        "source": {"path": given.source.name, "format": given.format.name},
        "target": {"path": output.path, "format": output.format.name},
        "diagnostics": [diagnostic.as_json() for diagnostic in report],
        "losses": [loss.as_json() for loss in losses or ()],
    }
    return json.dumps(document, indent=2, ensure_ascii=False)


def is_reached(threshold: str | None, report: Report, losses: tuple[Loss, ...] | None) -> bool:
    """Whether something at least as bad as the threshold happened; an error is worse than a loss, and that than a warning.

    Where nothing could be measured, what the writer said it could not say counts as a loss.
    """
    if threshold is None:
        return False
    happened = {
        "error": report.worst == Severity.ERROR,
        "loss": any(loss.fate != "carried" for loss in losses or ()) or any(said.code == codes.NOT_SAID for said in report),
        "warning": report.worst == Severity.WARNING,
    }
    return any(happened[level] for level in FAIL_ON[: FAIL_ON.index(threshold) + 1])


def _show_losses(losses: tuple[Loss, ...]) -> None:
    groups = list(lines(losses))
    for line in groups[:MOST_LINES]:
        print(line, file=sys.stderr)
    if len(groups) > MOST_LINES:
        print(f"... and {len(groups) - MOST_LINES} more kinds of losses", file=sys.stderr)
    if len(groups) < len(losses) or len(groups) > MOST_LINES:
        print(f"{len(losses)} losses in all; --report FILE.json lists each", file=sys.stderr)
