"""`hymeko-x convert IN OUT`: any format -> any format, with its meshes, and what got lost."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from hymeko_x import formats
from hymeko_x.cli import exits
from hymeko_x.cli.guard import UsageError
from hymeko_x.cli.inputs import input_arguments, read_input
from hymeko_x.cli.outputs import Output, deliver, output_arguments
from hymeko_x.cli.verify import verify_arguments
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
    parser.add_argument("--verify", action="store_true", help="ask the formats' own engines whether it is the same robot; else exit 4")
    verify_arguments(parser)


def run(chosen: argparse.Namespace) -> int:
    """Convert one file."""
    if chosen.output == "-" and not chosen.to_format:
        raise UsageError("say which format to write to standard output: --to FORMAT")
    if chosen.output == "-" and chosen.json:
        raise UsageError("--json prints to standard output, which already carries the result; use --report FILE.json")
    if chosen.verify and "-" in (chosen.input, chosen.output):
        raise UsageError("--verify reads the files again with other engines, so that neither can be a pipe")
    format = formats.of_output(chosen.output, chosen.to_format)
    report = Report()
    code = deliver(read_input(chosen.input, chosen, report), Output(format, chosen.output), chosen, report)
    return verified(chosen.input, chosen.output, chosen) if chosen.verify and code == exits.DONE else code


def verified(before: str, after: str, chosen: argparse.Namespace) -> int:
    """Say what the formats' own engines think of source and result; exit 4 when they see different robots."""
    from hymeko_x.cli import verify

    verdict = verify.verdict_of(before, after, chosen)
    print("\n".join(verify.lines(verdict, coloured=False, brief=True)), file=sys.stderr)
    return verify.CODES[verdict.verdict]
