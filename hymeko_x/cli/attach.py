"""`hymeko-x attach`: one robot on another, written as any format."""

from __future__ import annotations

from pathlib import PurePath
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import disk, formats
from hymeko_x.cli.convert import Destination, deliver, output_arguments
from hymeko_x.cli.exits import UsageError
from hymeko_x.cli.inputs import Input, input_arguments, lenient_argument, read_input
from hymeko_x.diagnostics import Report
from hymeko_x.ir.values import Pose
from hymeko_x.robot import EditError, Robot, UnknownName

if TYPE_CHECKING:
    import argparse


def attach_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `attach`."""
    parser.add_argument("host", metavar="ARM", help="the robot to which the other one is attached")
    parser.add_argument("part", metavar="HAND", help="the robot that is attached")
    parser.add_argument("--at", default="world", metavar="NAME", help="the frame (site) or body of ARM for HAND (default: the world)")
    parser.add_argument("-o", "--output", required=True, metavar="OUT", help="where to write; its suffix tells the format")
    parser.add_argument("--to", dest="to_format", metavar="FORMAT", help="the format to write, where the output's suffix does not tell")
    parser.add_argument("--prefix", help="what the names of HAND begin with (default: the name of its file and a slash)")
    parser.add_argument("--joint", metavar="TYPE", help="a joint between the two: hinge, slide, ball, free (default: fixed)")
    parser.add_argument("--xyz", nargs=3, type=float, default=(0.0, 0.0, 0.0), metavar=("X", "Y", "Z"), help="where HAND is there, in m")
    parser.add_argument("--rpy", nargs=3, type=float, default=(0.0, 0.0, 0.0), metavar=("R", "P", "Y"), help="how it is turned, in rad")
    input_arguments(parser)
    lenient_argument(parser)
    output_arguments(parser)


def run_attach(chosen: argparse.Namespace) -> int:
    """Read both, attach, write."""
    if chosen.output == "-" and not chosen.to_format:
        raise UsageError("say which format to write to standard output: --to FORMAT")
    format = formats.of_output(chosen.output, chosen.to_format)
    disk.check_outputs(chosen.output, chosen.report)
    report = Report()
    host, part = (read_input(path, chosen, report) for path in (chosen.host, chosen.part))
    prefix = f"{PurePath(part.source.name).stem}/" if chosen.prefix is None else chosen.prefix
    pose = Pose.from_rpy(chosen.rpy, chosen.xyz)
    try:
        whole = _robot(host).attach(_robot(part), chosen.at, prefix=prefix, joint=chosen.joint, pose=pose)
    except (EditError, UnknownName) as error:
        raise UsageError(str(error)) from error
    source = replace(host.source, files=whole.files)
    return deliver(Input(whole.mechanism, host.format, source), Destination(format, chosen.output), chosen, report)


def _robot(given: Input) -> Robot:
    return Robot(given.mechanism, given.source.files)
