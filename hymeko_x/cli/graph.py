"""`hymeko-x graph`: the hypergraph of a robot as a picture, or as text for other programs that draw graphs."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from hymeko_x import disk
from hymeko_x.cli import exits
from hymeko_x.cli.exits import UsageError, output_suffix
from hymeko_x.cli.inputs import input_arguments, lenient_argument, read_input
from hymeko_x.cli.report import show_diagnostics
from hymeko_x.diagnostics import Report
from hymeko_x.draw.graph.diagram import diagram
from hymeko_x.draw.graph.listings import WRITERS
from hymeko_x.draw.graph.picture import has_tree, picture
from hymeko_x.draw.graph.selection import EDGE_KINDS, Wanted

if TYPE_CHECKING:
    from typing import Literal

    from hymeko_x.ir.mechanism import Mechanism

_PICTURES = (".svg", ".png")
_SUFFIXES = (*_PICTURES, *WRITERS)


def graph_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `graph`."""
    parser.add_argument("input", metavar="FILE", help="what to draw; - is standard input")
    parser.add_argument(
        "-o", "--output", required=True, metavar="OUT", help="the picture (.svg, .png), or Graphviz (.dot), Mermaid (.mmd), D2 (.d2)"
    )
    parser.add_argument("--view", choices=("tree", "incidence"), help="a robot's kinematic tree, or vertices and edges with all arcs")
    parser.add_argument("--depth", type=_count, metavar="N", help="no bodies more than N joints below a base")
    only = "only edges of this kind, and what they lead to (repeatable)"
    parser.add_argument("--only", action="append", default=[], choices=EDGE_KINDS, metavar="KIND", help=only)
    parser.add_argument("--fold", action="store_true", help="equal parts of one parent once, with their names")
    input_arguments(parser)
    lenient_argument(parser)


def run_graph(chosen: argparse.Namespace) -> int:
    """Draw, and write the picture."""
    suffix = output_suffix(chosen.output, _SUFFIXES)
    disk.check_outputs(chosen.output, makes_folders=True)
    report = Report()
    robot = read_input(chosen.input, chosen, report).mechanism
    show_diagnostics(report, chosen)
    wanted = Wanted(chosen.depth, tuple(chosen.only), chosen.fold)
    text = _drawn(robot, wanted, suffix, chosen.view)
    disk.write_files({chosen.output: _pixels(text) if suffix == ".png" else text.encode()})
    return exits.DONE


def _drawn(robot: Mechanism, wanted: Wanted, suffix: str, view: Literal["tree", "incidence"] | None) -> str:
    """The text of the output; of pixels the SVG."""
    if suffix not in _PICTURES:
        if view == "tree":
            raise UsageError("--view tree is for .svg and .png: other programs make their own layout of the incidence graph")
        return WRITERS[suffix](diagram(robot, wanted))
    if view == "tree" and not has_tree(robot):
        raise UsageError("the input has no bodies, and so no tree; --view incidence draws what it has")
    return picture(robot, wanted, view)


def _pixels(svg: str) -> bytes:
    from hymeko_x.draw.graph.raster import png

    return png(svg)


def _count(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"expected a number of joints, found '{text}'")
    return int(text)
