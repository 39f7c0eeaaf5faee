"""Directed hypergraphs with signed, weighted arcs, and the matrices of the HyMeKo formalism. Knows nothing of robots.

A vertex carries data; an edge carries data and any number of arcs; an arc points at a vertex or at another edge.
Sign +1 is an arc from the target into the edge (tail, ``+`` in the language), -1 an arc from the edge to the target
(head, ``-``), 0 an undirected one (``~``). Source: Hajdu & Hegyi, Appl. Mech. 2025, 6(4), 74, equations (1) and (2).
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Generic, NamedTuple, TypeVar

from msgspec import Struct, field
from msgspec.structs import force_setattr

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from scipy.sparse import coo_array, csr_array

K = TypeVar("K", bound=Hashable)
V = TypeVar("V")
E = TypeVar("E")
W = TypeVar("W")
T = TypeVar("T")


class Arc(Struct, Generic[K, W], frozen=True, gc=False):
    """One end of an edge: whom it points at, in which direction, with what weight and in which role."""

    target: K
    sign: int = 0
    weight: W | None = None
    role: str = ""


class Edge(Struct, Generic[K, E, W], frozen=True, gc=False):
    """A relation: what it means, and its arcs in order."""

    data: E
    arcs: tuple[Arc[K, W], ...] = ()


class Incidence(NamedTuple, Generic[K]):
    """One entry of the incidence index: the edge, and which of its arcs points at the element."""

    edge: K
    arc: int


class Hypergraph(Struct, Generic[K, V, E, W], frozen=True, dict=True):
    """Immutable; vertices and edges by key, both in insertion order, which is the order of every row and column."""

    vertices: Mapping[K, V] = field(default_factory=dict)
    edges: Mapping[K, Edge[K, E, W]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        force_setattr(self, "vertices", MappingProxyType(dict(self.vertices)))
        force_setattr(self, "edges", MappingProxyType(dict(self.edges)))

    def __reduce__(self) -> tuple[object, ...]:
        """What makes an equal graph, in another process too: a view of a mapping cannot be pickled."""
        return type(self), (dict(self.vertices), dict(self.edges))

    def __eq__(self, other: object) -> bool:
        """Same vertices and same edges, in whatever order they were given."""
        if not isinstance(other, Hypergraph):
            return NotImplemented
        return dict(self.vertices) == dict(other.vertices) and dict(self.edges) == dict(other.edges)

    __ne__ = object.__ne__  # the opposite of __eq__, which a Struct's own is not
    __hash__ = None  # type: ignore[assignment]

    def __contains__(self, key: object) -> bool:
        """Whether a vertex or an edge has this key."""
        return key in self.vertices or key in self.edges

    # ---- looking around --------------------------------------------------------------------------------------------------

    @cached_property
    def incidence(self) -> Mapping[K, tuple[Incidence[K], ...]]:
        """For every element the arcs that point at it, in edge order. Built once, in linear time."""
        index: dict[K, list[Incidence[K]]] = {}
        for key, edge in self.edges.items():
            for position, arc in enumerate(edge.arcs):
                index.setdefault(arc.target, []).append(Incidence(key, position))
        return {key: tuple(found) for key, found in index.items()}

    def edges_at(self, key: K) -> Iterator[tuple[K, Edge[K, E, W], Arc[K, W]]]:
        """Each edge that has an arc to the element, with that arc; an edge with two such arcs comes twice."""
        for edge_key, position in self.incidence.get(key, ()):
            edge = self.edges[edge_key]
            yield edge_key, edge, edge.arcs[position]

    def dangling(self) -> Iterator[tuple[K, Arc[K, W]]]:
        """Each arc that points at nothing in the graph, with its edge's key."""
        for key, edge in self.edges.items():
            for arc in edge.arcs:
                if arc.target not in self.vertices and arc.target not in self.edges:
                    yield key, arc

    # ---- changing (by copy) ------------------------------------------------------------------------------------------------

    def replace(
        self,
        *,
        vertices: Mapping[K, V] | None = None,
        edges: Mapping[K, Edge[K, E, W]] | None = None,
        without: Iterable[K] = (),
    ) -> Hypergraph[K, V, E, W]:
        """A graph with these elements added or exchanged in their place, and without the ones named.

        The table of vertices or of edges in which nothing changes is the same object as before.
        """
        gone = set(without)
        changed: Hypergraph[K, V, E, W] = Hypergraph()
        force_setattr(changed, "vertices", _changed(self.vertices, vertices, gone))
        force_setattr(changed, "edges", _changed(self.edges, edges, gone))
        return changed

    # ---- the formalism's matrices (scipy.sparse) -----------------------------------------------------------------------------

    @cached_property
    def _rows(self) -> dict[K, int]:
        """Row number of every element: vertices first, then edges."""
        return {key: row for row, key in enumerate([*self.vertices, *self.edges])}

    def _arc_table(self) -> tuple[list[int], list[int], list[int]]:
        """Row of the target, number of the edge, and sign, for every arc that leads somewhere."""
        rows, columns, signs = [], [], []
        for column, edge in enumerate(self.edges.values()):
            for arc in edge.arcs:
                if arc.target in self._rows:
                    rows.append(self._rows[arc.target])
                    columns.append(column)
                    signs.append(arc.sign)
        return rows, columns, signs

    def incidence_matrix(self, *, signed: bool = True) -> csr_array:
        """The incidence matrix, (vertices + edges) x edges.

        Signed: +1 for a tail, -1 for a head; an undirected arc has no sign and counts 0, and opposite arcs to the
        same target cancel. Unsigned: the number of arcs. Rows of edges are non-zero where arcs point at edges.
        """
        from scipy.sparse import coo_array, csr_array

        rows, columns, signs = self._arc_table()
        data = signs if signed else [1] * len(signs)
        shape = (len(self._rows), len(self.edges))
        return csr_array(coo_array((data, (rows, columns)), shape=shape, dtype="int64"))

    def star_expansion(self) -> csr_array:
        """The directed adjacency matrix of the bipartite 2-factor graph over vertices and edges, square.

        A tail is an arc target -> edge, a head an arc edge -> target, an undirected arc is both.
        """
        from scipy.sparse import coo_array, csr_array

        start, end = [], []
        for row, column, sign in zip(*self._arc_table(), strict=True):
            edge_row = len(self.vertices) + column
            if sign >= 0:
                start.append(row)
                end.append(edge_row)
            if sign <= 0:
                start.append(edge_row)
                end.append(row)
        size = len(self._rows)
        return csr_array(coo_array(([1] * len(start), (start, end)), shape=(size, size), dtype="int64"))

    def clique_expansion(self) -> csr_array:
        """Elements that share an edge, square over vertices and edges: entry (i, j) counts their common edges; diagonal 0."""
        return _without_diagonal(_square(self.incidence_matrix(signed=False), transpose_first=False))

    def line_expansion(self) -> csr_array:
        """Edges that share an element, edges x edges: entry (i, j) counts the common elements; diagonal 0."""
        return _without_diagonal(_square(self.incidence_matrix(signed=False), transpose_first=True))

    def adjacency_tensor(self) -> coo_array:
        """The order-3 adjacency tensor as a sparse array of shape (elements, elements, edges).

        Entry (i, j, e) counts how edge e leads from i to j: i is a tail or undirected, j a head or undirected, i != j.
        This is the star expansion's two-step paths with the edge kept as the third index.
        """
        from scipy.sparse import coo_array

        first: list[int] = []
        second: list[int] = []
        third: list[int] = []
        for column, edge in enumerate(self.edges.values()):
            ends = [(self._rows[arc.target], arc.sign) for arc in edge.arcs if arc.target in self._rows]
            tails = [row for row, sign in ends if sign >= 0]
            heads = [row for row, sign in ends if sign <= 0]
            for i in tails:
                for j in heads:
                    if i != j:
                        first.append(i)
                        second.append(j)
                        third.append(column)
        size = len(self._rows)
        tensor = coo_array(([1] * len(first), (first, second, third)), shape=(size, size, len(self.edges)), dtype="int64")
        tensor.sum_duplicates()
        return tensor


def _changed(table: Mapping[K, T], new: Mapping[K, T] | None, gone: set[K]) -> Mapping[K, T]:
    """A table of a graph with these entries, and without those."""
    if not new and (not gone or gone.isdisjoint(table)):
        return table
    merged = {**table, **(new or {})}
    return MappingProxyType(merged if gone.isdisjoint(merged) else {key: value for key, value in merged.items() if key not in gone})


def _square(incidence: csr_array, *, transpose_first: bool) -> csr_array:
    """B^T B or B B^T of the 0/1 pattern of an incidence matrix."""
    pattern = incidence.copy()
    pattern.data[:] = 1
    return pattern.T @ pattern if transpose_first else pattern @ pattern.T


def _without_diagonal(matrix: csr_array) -> csr_array:
    """The matrix with its diagonal removed."""
    from scipy.sparse import csr_array

    result = matrix.tolil()
    result.setdiag(0)
    cleaned = csr_array(result)
    cleaned.eliminate_zeros()
    return cleaned
