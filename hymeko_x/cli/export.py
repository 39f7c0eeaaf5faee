"""`hymeko-x export [FILE|-] --to FORMAT`: HyMeKo -> another format."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import formats
from hymeko_x.cli.guard import UsageError
from hymeko_x.cli.inputs import input_arguments, read_input
from hymeko_x.cli.outputs import Output, deliver, output_arguments
from hymeko_x.diagnostics import Report

if TYPE_CHECKING:
    import argparse


def arguments(parser: argparse.ArgumentParser) -> None:
    """The verb's own words."""
    parser.add_argument("input", nargs="?", default="-", metavar="FILE", help="the robot to read (default: standard input)")
    parser.add_argument("--to", dest="to_format", metavar="FORMAT", help="the format to write, where the output's suffix does not tell")
    parser.add_argument("-o", "--output", default="-", metavar="OUT", help="where to write (default: standard output)")
    input_arguments(parser)
    output_arguments(parser)


def run(chosen: argparse.Namespace) -> int:
    """Read HyMeKo and write the wanted format."""
    if chosen.to_format is None and chosen.output == "-":
        raise UsageError("say which format to write: --to FORMAT, or -o FILE with its suffix")
    format = formats.of_output(chosen.output, chosen.to_format)
    report = Report()
    return deliver(read_input(chosen.input, chosen, report), Output(format, chosen.output), chosen, report)
