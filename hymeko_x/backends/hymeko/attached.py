"""Which edges are said in the block of the vertex that they put to use: mounts, drives, senses, stances and layers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.formats.hymeko.attached import attached_edge, attached_key
from hymeko_x.ir.graph import Arc

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc


def attached_arcs(mechanism: Mechanism) -> Mapping[Id, tuple[RobotArc, ...]]:
    """By vertex the arcs to be said in its block: of an edge that follows it and of which there is nothing else to say."""
    spoken_of = {*mechanism.extras, *mechanism.notations, *mechanism.stereotypes}
    follower = dict(zip(mechanism.layout, mechanism.layout[1:], strict=False))
    placed = set(mechanism.layout)
    found: dict[Id, tuple[RobotArc, ...]] = {}
    for vertex in mechanism.graph.vertices:
        key = attached_key(vertex)
        edge = mechanism.graph.edges.get(key) if key is not None else None
        if key is None or edge is None or key in spoken_of or key in mechanism.graph.incidence:
            continue
        near = follower.get(vertex) == key if vertex in placed else key not in placed
        arcs = tuple(arc for arc in edge.arcs if arc.target != vertex)
        sound = bool(arcs) and _reads_back(vertex, arcs)
        if near and sound and edge == attached_edge(vertex, arcs):
            found[vertex] = arcs
    return found


def _reads_back(vertex: Id, arcs: tuple[RobotArc, ...]) -> bool:
    """Whether the vertex's block has room for these arcs: a material names one texture, a body what it is fixed to."""
    if vertex.kind == "material":
        return arcs == (Arc(arcs[0].target, 1),)
    return vertex.kind != "body" or (len(arcs) == 1 and arcs[0].sign > 0 and not arcs[0].role)
