"""`hymeko-x report`: two robots on one page: verdict, checks, pictures, what was lost, trees."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from hymeko_x import disk
from hymeko_x.cli.exits import UsageError, output_suffix
from hymeko_x.cli.inputs import input_arguments, lenient_argument, read_input, refuse_own_reading
from hymeko_x.cli.render import size_of
from hymeko_x.cli.report import show_diagnostics
from hymeko_x.cli.verdicts import engine_arguments, exit_code, verdict_lines, verdict_of
from hymeko_x.diagnostics import Report

if TYPE_CHECKING:
    import argparse

    from hymeko_x.draw.comparison.facts import Comparison, Side

_SUFFIXES = (".html", ".md")


def report_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `report`."""
    parser.add_argument("a", metavar="A", help="a robot in any format")
    parser.add_argument("b", metavar="B", help="the robot to compare it with, such as its conversion")
    where = "the page: OUT.html with everything inside, or OUT.md with its pictures beside it"
    parser.add_argument("-o", "--output", required=True, metavar="OUT", help=where)
    parser.add_argument("--size", type=size_of, default=(640, 480), metavar="WxH", help="pixels of each picture (default: 640x480)")
    engine_arguments(parser)
    input_arguments(parser)
    lenient_argument(parser)


def run_report(chosen: argparse.Namespace) -> int:
    """Write the page, print the verdict; exit as `verify` does."""
    suffix = output_suffix(chosen.output, _SUFFIXES)
    if "-" in (chosen.a, chosen.b):
        raise UsageError("the robots are files: the formats' own engines read them as well")
    refuse_own_reading(chosen)
    disk.check_outputs(chosen.output, makes_folders=True)
    from hymeko_x.draw.comparison.facts import comparison, draw

    a, b = (read_side(path, chosen) for path in (chosen.a, chosen.b))
    drawn = draw(a, b, chosen.size)
    page = comparison(a, b, verdict_of(chosen.a, chosen.b, chosen), drawn)
    disk.write_files(_files(page, Path(chosen.output), suffix))
    print("\n".join(list(verdict_lines(page.verdict))[: 1 if chosen.quiet else None]))
    return exit_code(page.verdict)


def read_side(path: str, chosen: argparse.Namespace) -> Side:
    """A robot to compare, by its path or its name. Raises: Refusal; Stopped when it has errors, without `--lenient`."""
    from hymeko_x.draw.comparison.facts import Side

    report = Report()
    given = read_input(path, chosen, report)
    show_diagnostics(report, chosen)
    return Side(path, given.mechanism, given.format, given.source)


def _files(page: Comparison, output: Path, suffix: str) -> dict[str, bytes]:
    """The page, and the pictures beside it."""
    if suffix == ".html":
        from hymeko_x.draw.comparison.page import html

        return {str(output): html(page).encode()}
    from hymeko_x.draw.comparison.markdown import markdown

    text, pictures = markdown(page, output.stem)
    return {str(output): text.encode(), **{str(output.with_name(name)): data for name, data in pictures.items()}}
