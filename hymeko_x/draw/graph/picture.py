"""The hypergraph of a robot as SVG: its kinematic tree, or the incidence graph of whatever has no bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from hymeko_x.draw.graph.diagram import diagram
from hymeko_x.draw.graph.incidence import incidence_picture
from hymeko_x.draw.graph.selection import Wanted
from hymeko_x.draw.graph.tree import tree
from hymeko_x.draw.graph.tree_picture import tree_picture
from hymeko_x.ir import parts

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Mechanism

EVERYTHING = Wanted()


def has_tree(robot: Mechanism) -> bool:
    """Whether there are bodies, and so a tree."""
    return any(True for _ in robot.vertices(parts.Body))


def picture(robot: Mechanism, wanted: Wanted = EVERYTHING, view: Literal["tree", "incidence"] | None = None) -> str:
    """The SVG. Without a wish for a view, a robot is a tree, and whatever has no bodies an incidence graph."""
    if view == "tree" or (view is None and has_tree(robot)):
        return tree_picture(tree(robot, wanted))
    return incidence_picture(diagram(robot, wanted))
