"""`hymeko-x import`, `export` and `convert`: read a robot, write it in a format, report, and return the exit code."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from msgspec.structs import replace

from hymeko_x import codes, disk, formats, pipeline, targets
from hymeko_x.cli import exits
from hymeko_x.cli.exits import UsageError
from hymeko_x.cli.inputs import input_arguments, lenient_argument, read_input, shape_arguments
from hymeko_x.cli.parser import count
from hymeko_x.cli.report import one_line, report_arguments, show_report, written_line
from hymeko_x.cli.terminal import is_coloured
from hymeko_x.cli.verdicts import engine_arguments, exit_code, verdict_lines, verdict_of
from hymeko_x.delivery import Delivery, archive_suffix, place_of, reason_against, report_unwritten, unchanged
from hymeko_x.diagnostics import Report, Severity
from hymeko_x.reporting.document import document
from hymeko_x.reporting.sarif import sarif
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Package

if TYPE_CHECKING:
    import argparse

    from hymeko_x.cli.inputs import Input
    from hymeko_x.compare.ledger import Loss
    from hymeko_x.formats import Assets, Format
    from hymeko_x.pipeline import Result
    from hymeko_x.reporting.document import Json
    from hymeko_x.source import Source

FAIL_ON = ("error", "loss", "warning")


class Destination(NamedTuple):
    """Where the result goes: its format, and a path (`-` is standard output)."""

    format: Format
    path: str


def import_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `import`."""
    parser.add_argument("input", metavar="FILE", help="the robot to read; - is standard input")
    parser.add_argument("-o", "--output", default="-", metavar="OUT.hymeko", help="where to write (default: standard output)")
    input_arguments(parser)
    lenient_argument(parser)
    output_arguments(parser)


def run_import(chosen: argparse.Namespace) -> int:
    """Read the file and print it as HyMeKo, which represents everything: losses are measured only on request."""
    disk.check_outputs(chosen.output, chosen.report)
    report = Report()
    given = read_input(chosen.input, chosen, report, formats.OWN)
    return deliver(given, Destination(formats.OWN, chosen.output), chosen, report, measured=bool(chosen.report or chosen.fail_on))


def export_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `export`."""
    parser.add_argument("input", nargs="?", default="-", metavar="FILE", help="the robot to read (default: standard input)")
    parser.add_argument("--to", dest="to_format", metavar="FORMAT", help="the format to write, where the output's suffix does not tell")
    parser.add_argument("-o", "--output", default="-", metavar="OUT", help="where to write (default: standard output)")
    input_arguments(parser)
    lenient_argument(parser)
    output_arguments(parser)


def run_export(chosen: argparse.Namespace) -> int:
    """Read HyMeKo and write the wanted format."""
    if not chosen.to_format and not chosen.target and chosen.output == "-":
        raise UsageError("say which format to write: --to FORMAT, or -o FILE with its suffix")
    format = _output_format(chosen, chosen.output)
    _check_outputs(chosen, chosen.output)
    report = Report()
    return deliver(read_input(chosen.input, chosen, report, format), Destination(format, chosen.output), chosen, report)


def convert_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `convert`."""
    parser.usage = "hymeko-x convert IN [OUT] [options]\n       hymeko-x convert IN... --to FORMAT -o DIR [options]"
    what = "the robot to read, then where to write unless -o says so; its suffix tells the format; - is standard input or output"
    parser.add_argument("paths", nargs="+", metavar="IN", help=what)
    parser.add_argument("-o", "--output", metavar="OUT", help="where to write, or the folder for several robots, each in a process")
    parser.add_argument("--jobs", type=count, default=os.cpu_count() or 1, metavar="N", help="robots at a time (default: the processors)")
    parser.add_argument("--to", dest="to_format", metavar="FORMAT", help="the format to write, where the output's suffix does not tell")
    parser.add_argument("--json", action="store_true", help="print diagnostics and losses as JSON to standard output")
    input_arguments(parser)
    lenient_argument(parser)
    output_arguments(parser)
    parser.set_defaults(brief=False)
    parser.add_argument("--verify", action="store_true", help="ask the formats' own engines whether it is the same robot; else exit 4")
    engine_arguments(parser)


def run_convert(chosen: argparse.Namespace) -> int:
    """Convert one file, or each of several."""
    sources, output = _paths(chosen)
    if len(sources) == 1 and not _is_folder(output):
        return _convert(chosen, sources[0], output)
    if not (chosen.to_format or chosen.target):
        raise UsageError("say which format to write into the folder: --to FORMAT")
    from hymeko_x.cli.batch import jobs_into, run_batch

    format = _output_format(chosen, "")
    jobs = jobs_into(output, sources, format, archive_suffix(format) if chosen.assets == "pack" else "")
    if len(jobs) == 1:
        return _convert(chosen, *jobs[0])
    if chosen.json or chosen.report:
        raise UsageError("--json and --report are for one robot at a time")
    chosen.brief = not chosen.verbose
    return run_batch(_convert, jobs, chosen, format)


def _paths(chosen: argparse.Namespace) -> tuple[list[str], str]:
    """What to read, and where to write. Raises: UsageError where the second of two robots would be taken for the output."""
    *sources, last = chosen.paths
    if chosen.output is not None:
        return chosen.paths, chosen.output
    if not sources:
        return chosen.paths, "-"
    if len(sources) > 1:
        raise UsageError("several robots are written into a folder: -o DIR")
    row = formats.of_file(last)
    if row and os.path.isfile(last) and row.family != _output_format(chosen, last).family:
        raise UsageError(f"{last} is there, and {row.name}: several robots are written into a folder (-o DIR), and one with -o FILE")
    return sources, last


def _is_folder(path: str) -> bool:
    return path.endswith(("/", os.sep)) or os.path.isdir(path)


def _convert(chosen: argparse.Namespace, source: str, output: str) -> int:
    """Convert one file."""
    if output == "-" and not (chosen.to_format or chosen.target):
        raise UsageError("name the output file behind the input, or say which format to write to standard output: --to FORMAT")
    if output == "-" and chosen.json:
        raise UsageError("--json prints to standard output, which already carries the result; use --report FILE.json")
    if chosen.verify and "-" in (source, output):
        raise UsageError("--verify reads the files again with other engines, so that neither can be a pipe")
    format = _output_format(chosen, output)
    _check_outputs(chosen, output)
    report = Report()
    given = read_input(source, chosen, report, format)
    own = unchanged(given.source, given.format, format)
    code = deliver(given, Destination(format, output), chosen, report, own=own)
    return _verified(source, output, chosen) if chosen.verify and code == exits.DONE else code


def _output_format(chosen: argparse.Namespace, output: str) -> Format:
    """The format to write: the named one, that of the suffix, and without either the usual one of the target.

    Raises: Refusal HX003, HX012.
    """
    usual = targets.by_name(chosen.target).formats[0] if chosen.target else None
    has_suffix = formats.of_file(output) is not None
    return formats.of_output(output, chosen.to_format or (None if has_suffix else usual))


def _verified(before: str, after: str, chosen: argparse.Namespace) -> int:
    """Say what the formats' own engines think of source and result; exit 4 when they see different robots."""
    verdict = verdict_of(before, after, chosen)
    if not chosen.quiet or not verdict.is_same:
        lines = list(verdict_lines(verdict, coloured=is_coloured(sys.stderr), verbose=chosen.verbose))
        print("\n".join(lines[:1] if chosen.brief and verdict.is_same else lines), file=sys.stderr)
    return exit_code(verdict)


# ---- writing -----------------------------------------------------------------------------------------------------------


def output_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of every verb that writes a robot."""
    parser.add_argument("--base", choices=("fixed", "free"), help="what becomes of a base that the source leaves open")
    parser.add_argument("--actuators", choices=("none", "motor", "position", "velocity"), help="the actuators to write")
    shape_arguments(parser)
    for_help = "the program that the output is for (`hymeko-x formats` lists them): what it expects is added, and reported"
    parser.add_argument("--for", dest="target", metavar="TARGET", help=for_help)
    where = "put meshes beside the output, refer to them where they are, or pack all into one archive (OUT.mjz, .zip, .usdz)"
    parser.add_argument("--assets", choices=("copy", "reference", "pack"), help=where)
    layouts = "USD: one file, an interface with files for geometry, materials and physics behind it, or the layers of REP 158"
    parser.add_argument("--layout", choices=("single", "layered", "rep158"), help=layouts)
    parser.add_argument("--nested", action="store_true", default=None, help="USD: put each body inside of its parent")
    beside = "keep what the format cannot represent in OUT.keep.hymeko beside the output, so that it comes back"
    parser.add_argument("--keep", "--keep=beside", dest="keep", action="store_const", const="beside", help=beside)
    inside = "the same, inside the output, where other programs ignore it"
    parser.add_argument("--keep=inside", dest="keep", action="store_const", const="inside", help=inside)
    sites = "URDF: make every site (frame on a body) a link with a fixed joint"
    parser.add_argument("--sites", action="store_true", default=None, help=sites)
    parser.add_argument("--no-sites", dest="sites", action="store_false", help="leave sites out where the target makes them links")
    prefix = "URDF: what stands before the paths of meshes; `package://` is the package in which the output lies"
    parser.add_argument("--mesh-prefix", metavar="URI", help=prefix)
    model = "SDF: make the output's folder a model that Gazebo finds as model://FOLDER, with model.config, meshes/ and materials/"
    parser.add_argument("--package-layout", action="store_true", help=model)
    parser.add_argument("--split", action="store_true", help="xacro: put the macros into a file of their own")
    report_arguments(parser)
    parser.add_argument("--fail-on", choices=FAIL_ON, help="exit 3, and write no output, when one of these (or worse) happened")


def deliver(
    given: Input, output: Destination, chosen: argparse.Namespace, report: Report, *, measured: bool = True, own: Source | None = None
) -> int:
    """Write the mechanism that was read, show diagnostics and losses, and return the exit code.

    With ``measured`` the result is read back and its losses are listed; ``own`` is the source whose text the output may have.
    """
    path = "" if output.path == "-" else output.path
    _check_applicable(output.format, chosen)
    if chosen.keep == "beside" and not path:
        raise UsageError("standard output has nothing beside it: use --keep=inside, or -o FILE")
    layout = chosen.layout, chosen.nested, chosen.split
    options = Options(chosen.base, chosen.actuators, *layout, chosen.keep, chosen.lenient, Path(path).stem, target=chosen.target)
    options = replace(options, density=chosen.density, inertia_from=chosen.inertia_from, collision=chosen.collision)
    options = replace(options, sites=chosen.sites, mesh_prefix=chosen.mesh_prefix, package_layout=chosen.package_layout)
    if path and (reason := reason_against(path, chosen.assets, output.format)):
        raise UsageError(reason)
    place = _place(output, chosen.assets)
    delivery = Delivery(given.mechanism, output.format, options, given.source.files, place, path, own, given.passed)
    result = delivery.convert(report, measured=measured)
    if output.path == "-":
        report_unwritten(result.package, "standard output", report)
    failed = is_reached(chosen.fail_on, report, result.losses)
    if not failed:
        _write(delivery, output, result)
    written = "" if failed or not path else written_line(path, result.mechanism, result.package)
    if getattr(chosen, "brief", False):
        print(one_line(written, report, result.losses or ()), file=sys.stderr)
    else:
        show_report(written, report, result.losses or (), chosen)
    if chosen.report:
        found = _document(given, output, report, result.losses)
        data = as_text(sarif(found) if chosen.report.lower().endswith(".sarif") else found)
        disk.write_package(Package(f"{data}\n".encode()), chosen.report, NoFiles())
    if getattr(chosen, "json", False):
        print(as_text(_document(given, output, report, result.losses)))
    return exits.FAIL_ON if failed else exits.DONE


def _check_outputs(chosen: argparse.Namespace, output: str) -> None:
    """Refuse outputs that could not be written; the folder of a model of Gazebo will be made. Raises: Refusal HX002."""
    disk.check_outputs(output, makes_folders=chosen.package_layout)
    disk.check_outputs(chosen.report)


def _check_applicable(format: Format, chosen: argparse.Namespace) -> None:
    """Refuse options that change nothing in this format. Raises: UsageError."""
    for option in ("layout", "nested", "split", "sites", "mesh_prefix", "package_layout"):
        if getattr(chosen, option) and option not in format.layout_options:
            takers = ", ".join(row.name for row in formats.FORMATS if option in row.layout_options)
            raise UsageError(f"--{option.replace('_', '-')} is for {takers}, and the output is {format.name}")


def _place(output: Destination, assets: Assets | None) -> pipeline.OutputPlace:
    """Beside standard output nothing can be put, so that files are referred to from the working folder."""
    if output.path == "-":
        return pipeline.OutputPlace(assets="reference")
    return place_of(output.path, assets)


def _write(delivery: Delivery, output: Destination, result: Result) -> None:
    if output.path == "-":
        sys.stdout.buffer.write(result.package.main)
    else:
        delivery.put(result)


def _document(given: Input, output: Destination, report: Report, losses: tuple[Loss, ...] | None) -> Json:
    """The document of `--report` and of `convert --json`."""
    return document((given.source.name, given.format.name), (output.path, output.format.name), report, losses)


def as_text(document: Json) -> str:
    """A document as indented JSON."""
    import json

    return json.dumps(document, indent=2, ensure_ascii=False)


def is_reached(threshold: str | None, report: Report, losses: tuple[Loss, ...] | None) -> bool:
    """Whether something at least as bad as the threshold happened; an error is worse than a loss, and that than a warning.

    Where nothing could be measured, what the writer reports as not represented counts as a loss.
    """
    if threshold is None:
        return False
    happened = {
        "error": report.worst == Severity.ERROR,
        "loss": any(loss.fate != "kept" for loss in losses or ()) or any(diagnostic.code == codes.NOT_REPRESENTED for diagnostic in report),
        "warning": report.worst == Severity.WARNING,
    }
    return any(happened[level] for level in FAIL_ON[: FAIL_ON.index(threshold) + 1])
