"""`hymeko-x import FILE`: any format -> HyMeKo."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import formats
from hymeko_x.cli.inputs import input_arguments, read_input
from hymeko_x.cli.outputs import Output, deliver, output_arguments
from hymeko_x.diagnostics import Report

if TYPE_CHECKING:
    import argparse


def arguments(parser: argparse.ArgumentParser) -> None:
    """The verb's own words."""
    parser.add_argument("input", metavar="FILE", help="the robot to read; - is standard input")
    parser.add_argument("-o", "--output", default="-", metavar="OUT.hymeko", help="where to write (default: standard output)")
    input_arguments(parser)
    output_arguments(parser)


def run(chosen: argparse.Namespace) -> int:
    """Read the file and print it as HyMeKo, which says everything: losses are measured only for whoever asks for them."""
    report = Report()
    given = read_input(chosen.input, chosen, report)
    return deliver(given, Output(formats.OWN, chosen.output), chosen, report, measured=bool(chosen.report or chosen.fail_on))
