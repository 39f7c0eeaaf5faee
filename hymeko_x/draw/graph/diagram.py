"""The incidence graph of a mechanism as data: vertices and hyperedges are nodes, arcs are the lines between them.

This is the star expansion (2-factor graph): a tail (+) leads from its target into the edge, a head (-) from the edge to its target.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x.draw.graph.facts import SIGNS, axis_name, dof_text, edge_facts, symbol, vertex_facts, weight
from hymeko_x.draw.graph.letters import shown
from hymeko_x.draw.graph.selection import PLAIN, select
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import Id

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.draw.graph.selection import Selection, Wanted
    from hymeko_x.ir.mechanism import Mechanism, RobotEdge

_FEW_JOINTS = 12
"""Up to so many joints the axes are vertices, as in the paper's figures; among more of them they would hide the rest."""
_AXIS = "axis"


class DrawnNode(Struct, frozen=True):
    """A vertex (circle) or an edge (box) with its symbol, its name, and what stands below the name."""

    key: Id
    is_edge: bool
    symbol: str
    label: str
    facts: str = ""


class DrawnArc(Struct, frozen=True):
    """One arc: its edge, its target, its direction as in :class:`hymeko_x.ir.graph.Arc`, and its weight and role as text."""

    edge: Id
    target: Id
    sign: int
    weight: str = ""

    @property
    def label(self) -> str:
        """Sign and weight: ``+ [0 0 0.63]``."""
        return f"{SIGNS[self.sign]} {self.weight}".rstrip()


class Diagram(Struct, frozen=True):
    """Nodes by key in order, lines in order of their edges, and what is not drawn."""

    name: str
    nodes: dict[Id, DrawnNode]
    lines: tuple[DrawnArc, ...]
    note: str = ""


def diagram(robot: Mechanism, wanted: Wanted) -> Diagram:
    """The chosen part of a mechanism as an incidence graph."""
    chosen = select(robot, wanted)
    edges = {key: robot.graph.edges[key] for key in chosen.edges}
    joints = [key for key, edge in edges.items() if isinstance(edge.data, parts.Joint)]
    with_axes = frozenset(joints if len(joints) <= _FEW_JOINTS else ())
    lines = [DrawnArc(key, arc.target, arc.sign, weight(arc)) for key, edge in edges.items() for arc in edge.arcs]
    lines += [line for key in joints if key in with_axes for line in _axis_lines(key, edges[key])]
    keys = _vertices(robot, chosen, wanted) | dict.fromkeys(edges) | dict.fromkeys(line.target for line in lines)
    nodes = {key: _node(robot, key, chosen, with_axes) for key in keys}
    return Diagram(robot.name, nodes, tuple(lines), not_drawn(chosen))


def not_drawn(chosen: Selection) -> str:
    """How many edges are left out because they lead to bodies that are."""
    return f"{chosen.hidden} more edges lead to bodies that are not drawn" if chosen.hidden else ""


def _vertices(robot: Mechanism, chosen: Selection, wanted: Wanted) -> dict[Id, None]:
    """The vertices that are drawn whether an edge leads to them or not."""
    if wanted.only:
        return {}
    others = (key for key in robot.graph.vertices if key.kind in PLAIN and key.kind != "body")
    return dict.fromkeys((*chosen.bodies, *others))


def _axis_lines(key: Id, edge: RobotEdge) -> Iterator[DrawnArc]:
    """The arcs to the directions about and along which a joint moves, as in the paper: ``+ AXIS_Z``."""
    assert isinstance(edge.data, parts.Joint)
    for dof in edge.data.dofs:
        if dof.kind not in (parts.DofKind.BALL, parts.DofKind.FREE):
            name = axis_name(dof)
            yield DrawnArc(key, Id(_AXIS, name if name.startswith("[") else f"{name[:-1]}AXIS_{name[-1]}"), 1)


def _node(robot: Mechanism, key: Id, chosen: Selection, with_axes: frozenset[Id]) -> DrawnNode:
    edge = robot.graph.edges.get(key)
    if edge is None:
        facts = (vertex_facts(robot.graph.vertices.get(key)), chosen.notes.get(key, ""))
        return DrawnNode(key, False, key.kind, shown(key.name), " · ".join(filter(None, facts)))
    if key in with_axes and isinstance(edge.data, parts.Joint) and edge.data.dofs:
        return DrawnNode(
            key, True, symbol(edge.data), shown(key.name), " · ".join(dof_text(dof, with_axis=False) for dof in edge.data.dofs)
        )
    return DrawnNode(key, True, symbol(edge.data), shown(key.name), edge_facts(edge.data))
