"""Nested graphs: which vertices and edges stand inside of others, by their names, for the reader and the writer of text.

The edge ``nest`` of a vertex or edge of plain data leads to what stands inside of it. In a text that is its block, where each
inner element has the name of the outer one, a dot and a name of its own: ``arm { motor {} }`` has the vertex ``arm.motor``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.formats.hymeko import CHILD_CLASS, FOREIGN
from hymeko_x.ir import parts
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import Id

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.ir.mechanism import RobotEdge

OUTER = frozenset({"datum", "relation"})
"""The kinds of elements that others may stand inside of; those are of these kinds as well."""


BLOCK_SETTINGS = FOREIGN | {"unnamed", "kind", "moves", "scope", "extra", "class", CHILD_CLASS, "written"}
"""Fields that are not about what an element is; as names they stand in backticks."""


def nest_key(outer: Id) -> Id:
    """The edge that tells what stands inside of an element: it has the name of a vertex, and that of an edge behind ``@``."""
    return Id("nest", outer.name if outer.kind == "datum" else f"@{outer.name}")


def nest_edge(outer: Id, inner: Iterable[Id]) -> RobotEdge:
    """The edge that leads from an element to those inside of it."""
    return Edge(parts.Nest(), (Arc(outer, 1), *(Arc(key, -1) for key in inner)))


def prefix_of(outer: Id) -> str:
    """What the names of the elements inside of one begin with."""
    return f"{outer.name}."
