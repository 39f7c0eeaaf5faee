"""`hymeko-x convert IN OUT`: any format -> any format, with its meshes, and what got lost."""

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
    parser.add_argument("input", metavar="IN", help="the robot to read; - is standard input")
    parser.add_argument("output", metavar="OUT", help="where to write; its suffix tells the format; - is standard output")
    parser.add_argument("--to", dest="to_format", metavar="FORMAT", help="the format to write, where the output's suffix does not tell")
    parser.add_argument("--json", action="store_true", help="print diagnostics and losses as JSON to standard output")
    input_arguments(parser)
    output_arguments(parser)


def run(chosen: argparse.Namespace) -> int:
    """Convert one file."""
    if chosen.output == "-" and not chosen.to_format:
        raise UsageError("say which format to write to standard output: --to FORMAT")
    if chosen.output == "-" and chosen.json:
        raise UsageError("--json prints to standard output, which already carries the result; use --report FILE.json")
    format = formats.by_name(chosen.to_format) if chosen.to_format else formats.of_output(chosen.output)
    report = Report()
    return deliver(read_input(chosen.input, chosen, report), Output(format, chosen.output), chosen, report)
