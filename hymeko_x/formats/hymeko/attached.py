"""Edges that are said in the block of the vertex which they put to use: ``tip : frame { [0 0 0.1] + arm }``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.formats.hymeko import ATTACHED
from hymeko_x.ir import parts
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import Id

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import RobotArc, RobotEdge

TEXTURE = "texture"
"""The field of a material that names its texture."""


def attached_key(vertex: Id) -> Id | None:
    """The edge that a vertex may say itself: it has the vertex's name."""
    kind = ATTACHED.get(vertex.kind)
    return None if kind is None else Id(kind, vertex.name)


def attached_edge(vertex: Id, arcs: tuple[RobotArc, ...]) -> RobotEdge:
    """The edge that a vertex with these arcs in its block stands for.

    What is mounted or measured, or the joints of a stance, are the arcs; the vertex itself comes last, for an actuator
    and a stance first.
    """
    match vertex.kind:
        case "actuator":
            return Edge(parts.Drive(), (Arc(vertex, 1), *arcs))
        case "pose":
            return Edge(parts.Stance(), (Arc(vertex, 1), *arcs))
        case "sensor":
            return Edge(parts.Sense(), (*arcs, Arc(vertex, -1)))
        case "material":
            return Edge(parts.Layer(), (*arcs, Arc(vertex, -1)))
        case "body":
            return Edge(parts.Joint(()), (*arcs, Arc(vertex, -1)))
        case _:
            return Edge(parts.Mount(), (*arcs, Arc(vertex, -1)))
