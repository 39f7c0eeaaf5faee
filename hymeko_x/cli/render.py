"""`hymeko-x render`: a picture of a robot, or of several, or a film in which its joints move."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING

from hymeko_x import disk
from hymeko_x.cli import exits
from hymeko_x.cli.exits import UsageError
from hymeko_x.cli.inputs import input_arguments, lenient_argument, read_input
from hymeko_x.cli.report import show_diagnostics
from hymeko_x.diagnostics import Report

if TYPE_CHECKING:
    from hymeko_x.draw.render import Studio

VIEWS = ("front", "side", "top", "iso")
_LARGEST = 8192
_FILMS = (".gif", ".mp4")


def render_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `render`."""
    parser.add_argument("inputs", nargs="+", metavar="FILE", help="the robots to draw; several are drawn side by side")
    parser.add_argument("-o", "--output", required=True, metavar="OUT", help="the picture (.png), or the film (.gif, .mp4) with --animate")
    parser.add_argument("--view", choices=VIEWS, default="iso", help="from where (default: iso)")
    parser.add_argument("--pose", metavar="NAME|FILE.json", help="a keyframe, or positions by joint (default: the keyframe home, if any)")
    parser.add_argument("--size", type=size_of, default=(960, 720), metavar="WxH", help="pixels of one picture (default: 960x720)")
    parser.add_argument("--collision", action="store_true", help="the collision shapes instead of the visual ones")
    parser.add_argument("--frames", action="store_true", help="the frames of the bodies too")
    parser.add_argument("--inertia", action="store_true", help="the inertias of the bodies too, as boxes")
    parser.add_argument("--animate", action="store_true", help="a film in which each joint goes through its limits")
    input_arguments(parser)
    lenient_argument(parser)


def run_render(chosen: argparse.Namespace) -> int:
    """Draw, and write the picture."""
    suffix = Path(chosen.output).suffix.lower()
    if suffix not in (_FILMS if chosen.animate else (".png",)):
        raise UsageError(f"{'a film' if chosen.animate else 'a picture'} ends in {' or '.join(_FILMS if chosen.animate else ('.png',))}")
    disk.check_outputs(chosen.output, makes_folders=True)
    from hymeko_x.draw.render import choose_backend

    choose_backend()
    from hymeko_x.draw.files import film, grid, png

    studios = [_studio(path, chosen) for path in chosen.inputs]
    if chosen.animate:
        if len(studios) > 1:
            raise UsageError("--animate draws one robot")
        data = film(studios[0].sweep(), suffix)
    else:
        data = png(grid([studio.still() for studio in studios]))
    disk.write_files({chosen.output: data})
    return exits.DONE


def _studio(path: str, chosen: argparse.Namespace) -> Studio:
    from hymeko_x.draw.render import PictureOptions, is_drawn, open_studio
    from hymeko_x.robot import Robot

    report = Report()
    given = read_input(path, chosen, report)
    show_diagnostics(report, chosen)
    wanted = PictureOptions(chosen.size, chosen.view, chosen.pose, chosen.collision, chosen.frames, chosen.inertia)
    return open_studio(
        Robot(given.mechanism, given.source.files), given.source.name if is_drawn(given.format) and path != "-" else None, wanted
    )


def size_of(text: str) -> tuple[int, int]:
    """Width and height in pixels, as a user gives them."""
    found = re.fullmatch(r"(\d+)x(\d+)", text)
    if found is None or not all(16 <= int(number) <= _LARGEST for number in found.groups()):
        raise argparse.ArgumentTypeError(f"expected WIDTHxHEIGHT with numbers from 16 to {_LARGEST}, found '{text}'")
    return int(found[1]), int(found[2])
