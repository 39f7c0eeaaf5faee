"""`hymeko-x diff` and `roundtrip`: robots compared by this program, on one way or on a whole journey."""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x import api, formats
from hymeko_x.cli import exits
from hymeko_x.cli.exits import UsageError
from hymeko_x.cli.inputs import input_arguments, lenient_argument, read_input
from hymeko_x.cli.report import show_diagnostics
from hymeko_x.cli.verdicts import engine_arguments, exit_code, verdict_of
from hymeko_x.compare.contents import Contents, content_differences, with_same_files
from hymeko_x.compare.diff import Tolerance, diff
from hymeko_x.corpus.names import located
from hymeko_x.diagnostics import Report
from hymeko_x.reporting.changes import markdown
from hymeko_x.residue.originals import fetcher

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator

    from hymeko_x.cli.inputs import Input
    from hymeko_x.compare.diff import Difference
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.verify.verdict import Verdict

# ---- diff --------------------------------------------------------------------------------------------------------------


def diff_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `diff`."""
    parser.add_argument("a", metavar="A", help="a robot in any format; - is standard input")
    parser.add_argument("b", metavar="B", help="the robot to compare it with")
    parser.add_argument("--tolerance", type=float, default=1e-12, metavar="T", help="numbers this close are equal (default 1e-12)")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--markdown", action="store_true", help="print a list for a review, and exit 0: also for `git difftool`")
    input_arguments(parser)
    lenient_argument(parser)


def run_diff(chosen: argparse.Namespace) -> int:
    """Print one line per difference; exit 4 if there is any, except as Markdown for difftools, which take that for a failure."""
    report = Report()
    a, b = (read_input(path, chosen, report) for path in (chosen.a, chosen.b))
    found = _differences(a, b, Tolerance(chosen.tolerance, chosen.tolerance))
    show_diagnostics(report, chosen)
    if chosen.markdown:
        print(markdown((a.source.name, b.source.name), a.mechanism, b.mechanism, found), end="")
        return exits.DONE
    print(json.dumps(_differences_json(a, b, found), indent=2, ensure_ascii=False)) if chosen.json else print_lines(found)
    return exits.DIFFERENT if found else exits.DONE


def _differences(a: Input, b: Input, tolerance: Tolerance) -> tuple[Difference, ...]:
    """The differences of two robots; of their files those of the contents, and places only where a file is missing."""
    ours, theirs = (Contents(given.mechanism, fetcher(given.mechanism, given.source.files)) for given in (a, b))
    return (*diff(a.mechanism, with_same_files(ours, theirs), tolerance), *content_differences(ours, theirs))


def print_lines(found: tuple[Difference, ...]) -> None:
    """One line per difference."""
    for difference in found:
        print(difference)


def _differences_json(a: Input, b: Input, found: tuple[Difference, ...]) -> dict[str, object]:
    rows = [{"element": str(row.element), "field": row.field, "before": row.before, "after": row.after} for row in found]
    names = {key: {"path": given.source.name, "format": given.format.name} for key, given in (("a", a), ("b", b))}
    return {**names, "differences": rows}


# ---- roundtrip ---------------------------------------------------------------------------------------------------------

_TOLERANCE = Tolerance(1e-12, 1e-12)


class ConversionRow(NamedTuple):
    """One conversion: into which format, how large the file is, what got lost on the way, and what the engines say."""

    format: str
    bytes: int
    losses: int | None
    differences: int
    verdict: Verdict


def roundtrip_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `roundtrip`."""
    parser.add_argument("input", metavar="FILE", help="a robot in any format")
    parser.add_argument("--through", default="all", metavar="F[,F...]", help="the formats on the way, in order (default: all others)")
    parser.add_argument("-o", "--output", metavar="DIR", help="leave the files of every leg in this folder")
    parser.add_argument("--json", action="store_true", help="print JSON")
    engine_arguments(parser)
    input_arguments(parser)
    lenient_argument(parser)


def run_roundtrip(chosen: argparse.Namespace) -> int:
    """Print a row per leg; exit 4 when an engine sees another robot, 1 when one cannot tell."""
    chosen.input = located(chosen.input).path
    report = Report()
    given = read_input(chosen.input, chosen, report)
    stops = [*_stops(chosen.through, given.format), given.format]
    show_diagnostics(report, chosen)
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(chosen.output or temporary)
        folder.mkdir(parents=True, exist_ok=True)
        legs = list(_legs(chosen, given.mechanism, stops, folder))
    size = os.path.getsize(chosen.input)
    if chosen.json:
        print(json.dumps(_legs_json(chosen.input, given.format.name, size, legs), indent=2, ensure_ascii=False))
    else:
        print("\n".join(leg_lines(chosen.input, given.format.name, size, legs)))
    return max((exit_code(leg.verdict) for leg in legs), default=exits.DONE)


def _stops(words: str, own: Format) -> list[Format]:
    """The formats on the way. `all` are those that can be both written and read, except the file's own."""
    if words == "all":
        return [format for format in formats.FORMATS if format.backend and format.frontend and format.name != own.name]
    stops = [formats.by_name(word) for word in words.split(",") if word]
    if not stops:
        raise UsageError("--through wants at least one format")
    return stops


def _legs(chosen: argparse.Namespace, original: Mechanism, stops: list[Format], folder: Path) -> Iterator[ConversionRow]:
    """Converts from leg to leg; compares each result with the original, by our own eyes and by the engines'."""
    packages = dict(chosen.package)
    before = chosen.input
    first = {
        "from_format": chosen.from_format,
        "arguments": dict(chosen.arg),
        "environment": dict(chosen.env),
        "variants": dict(chosen.variant),
        "confine": chosen.confine,
        "ignore_kept": chosen.ignore_kept,
    }
    for number, format in enumerate(stops, start=1):
        after = folder / f"leg{number}" / f"robot{format.suffixes[0]}"
        after.parent.mkdir(exist_ok=True)
        result = api.convert(before, after, to_format=format.name, packages=packages, keep="beside", lenient=chosen.lenient, **first)
        first = {}  # the options of reading are for the input alone, not for the results of the legs
        back = api.load(after, format.name, packages=packages, lenient=chosen.lenient).mechanism
        losses = None if result.losses is None else len(result.losses)
        differences = len(diff(original, back, _TOLERANCE))
        yield ConversionRow(format.name, after.stat().st_size, losses, differences, verdict_of(chosen.input, str(after), chosen))
        before = str(after)


def leg_lines(path: str, format: str, size: int, legs: list[ConversionRow]) -> Iterator[str]:
    """A table: the file, then one row per leg, with the checks that failed below it."""
    yield f"  {'leg':<4} {'format':<8} {'bytes':>9} {'losses':>7} {'differs':>8}  verdict"
    yield f"  {0:<4} {format:<8} {size:>9} {'':>7} {'':>8}  {path}"
    for number, leg in enumerate(legs, start=1):
        losses = "-" if leg.losses is None else str(leg.losses)
        yield f"  {number:<4} {leg.format:<8} {leg.bytes:>9} {losses:>7} {leg.differences:>8}  {leg.verdict.verdict}"
        if leg.verdict.reason:
            yield f"       {leg.verdict.reason}"
        for check in leg.verdict.failed:
            yield f"       {check.quantity}: {check.worst:.3g} {check.unit} at {check.at}"


def _legs_json(path: str, format: str, size: int, legs: list[ConversionRow]) -> dict[str, object]:
    """The document of `--json`: the file, and every leg with its verdict."""
    rows = [
        {"format": leg.format, "bytes": leg.bytes, "losses": leg.losses, "differences": leg.differences, **leg.verdict.as_json()}
        for leg in legs
    ]
    return {"source": {"path": path, "format": format, "bytes": size}, "legs": rows}
