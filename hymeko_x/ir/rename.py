"""A mechanism with some of its elements under other ids: vertices, edges, arcs and every side table follow."""

from __future__ import annotations

from dataclasses import replace
from itertools import chain
from typing import TYPE_CHECKING, TypeVar

from hymeko_x.ir.graph import Arc, Edge, Hypergraph
from hymeko_x.ir.mechanism import Names

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Extra, Id, Mechanism

T = TypeVar("T")


def rename(mechanism: Mechanism, names: Mapping[Id, Id]) -> Mechanism:
    """The mechanism with every key of ``names`` replaced by its value, wherever it occurs.

    Where the new id is there already (a body that turns out to be the world), the element of that id stays and
    takes over the arcs and extras of the old one.
    """
    if not names:
        return mechanism
    graph = mechanism.graph
    taken = set(graph.vertices) | set(graph.edges)
    merged = {old for old, new in names.items() if new in taken and new not in names}
    vertices = {names.get(key, key): data for key, data in graph.vertices.items() if key not in merged}
    edges = {}
    for key, edge in graph.edges.items():
        if not names.keys().isdisjoint([arc.target for arc in edge.arcs]):
            edge = Edge(edge.data, tuple([Arc(names.get(arc.target, arc.target), arc.sign, arc.weight, arc.role) for arc in edge.arcs]))
        edges[names.get(key, key)] = edge
    extras: dict[Id, tuple[Extra, ...]] = {}
    for key, found in mechanism.extras.items():
        new = names.get(key, key)
        extras[new] = extras.get(new, ()) + found
    return replace(
        mechanism,
        graph=Hypergraph(vertices, edges),
        extras=extras,
        origins=_rekeyed(mechanism.origins, names),
        notations=_rekeyed(mechanism.notations, names),
        stereotypes=_rekeyed(mechanism.stereotypes, names),
        layout=tuple(names.get(key, key) for key in mechanism.layout),
    )


def _rekeyed(table: Mapping[Id, T], names: Mapping[Id, Id]) -> dict[Id, T]:
    """A side table under the new keys; what the new key had already wins."""
    moved = {names[key]: value for key, value in table.items() if key in names}
    return {**moved, **{key: value for key, value in table.items() if key not in names}}


def names_in_use(mechanism: Mechanism) -> Names:
    """A giver of new ids that knows every id of the mechanism."""
    return Names(chain(mechanism.graph.vertices, mechanism.graph.edges))
