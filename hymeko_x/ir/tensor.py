"""The arcs of a hypergraph as one sparse tensor with their vector-valued weights, and the graph of a tensor.

Source: Hajdu & Hegyi, Appl. Mech. 2025, 6(4), 74, section 4: the star expansion with directions and weights.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from msgspec import Struct

from hymeko_x.ir.graph import Arc, Edge, Hypergraph
from hymeko_x.ir.mechanism import has_numbers
from hymeko_x.ir.values import Pose

if TYPE_CHECKING:
    from scipy.sparse import coo_array

    from hymeko_x.ir.parts import Weight

K = TypeVar("K", bound=Hashable)
V = TypeVar("V")
E = TypeVar("E")

SIGN, WEIGHT = 1, 2
"""The component of an arc's sign, and the first one of its weight; component 0 is 1 where there is an arc."""
_POSE = 7


class Label(Struct, frozen=True):
    """What an arc has beside numbers: its role, and its weight as the graph has it."""

    role: str = ""
    weight: Any = None


class Tensor(Struct, Generic[K, V, E], frozen=True, eq=False):
    """The arcs as numbers, and the labels that make a graph of them.

    ``array`` is sparse, of order 4 and shape (elements, edges, places, components). Component 0 of entry (i, e, k) is 1 where the arc at
    place k of edge e leads to element i, component 1 is the arc's sign, and the others are its weight: a pose is x, y, z in m and the
    quaternion w, x, y, z; coefficients are as they are. ``elements`` are the keys of the rows: vertices, edges, and what else arcs lead to.
    ``labels`` are by edge and place.
    """

    array: coo_array
    elements: tuple[K, ...]
    vertices: Mapping[K, V]
    edges: Mapping[K, E]
    labels: Mapping[tuple[K, int], Label]


def to_tensor(graph: Hypergraph[K, V, E, Weight]) -> Tensor[K, V, E]:
    """The tensor of a graph; :func:`from_tensor` gives the graph back."""
    from scipy.sparse import coo_array

    rows = {key: row for row, key in enumerate(dict.fromkeys([*graph.vertices, *graph.edges]))}
    labels: dict[tuple[K, int], Label] = {}
    places: list[tuple[int, int, int, int]] = []
    values: list[float] = []
    for column, (key, edge) in enumerate(graph.edges.items()):
        for place, arc in enumerate(edge.arcs):
            labels[key, place] = Label(arc.role, arc.weight)
            row = rows.setdefault(arc.target, len(rows))
            vector = (1.0, float(arc.sign), *_numbers(arc.weight))
            places.extend((row, column, place, component) for component in range(len(vector)))
            values.extend(vector)
    sizes = (max((place[axis] for place in places), default=-1) + 1 for axis in (2, 3))
    shape = (len(rows), len(graph.edges), *sizes)
    array = coo_array((values, [*zip(*places, strict=True)] or ([],) * 4), shape=shape, dtype="float64")
    return Tensor(array, tuple(rows), dict(graph.vertices), {key: edge.data for key, edge in graph.edges.items()}, labels)


def from_tensor(tensor: Tensor[K, V, E]) -> Hypergraph[K, V, E, Weight]:
    """The graph of a tensor: its arcs are those of the array, also after numbers of it were changed.

    A quaternion need not have unit length. An arc without a label has no role, and a weight of seven components is a pose.

    Raises: ValueError for two arcs at one place of an edge.
    """
    keys = [*tensor.edges]
    arcs: dict[K, list[Arc[K, Weight]]] = {key: [] for key in keys}
    for (column, place), (row, vector) in sorted(_vectors(tensor.array, keys).items()):
        if vector.get(0):
            label = tensor.labels.get((keys[column], place), Label())
            arcs[keys[column]].append(Arc(tensor.elements[row], int(vector.get(SIGN, 0)), _weight(vector, label.weight), label.role))
    return Hypergraph(tensor.vertices, {key: Edge(data, tuple(arcs[key])) for key, data in tensor.edges.items()})


def _vectors(array: coo_array, edges: list[K]) -> dict[tuple[int, int], tuple[int, dict[int, float]]]:
    """By edge and place the row of the arc there, and its components."""
    found: dict[tuple[int, int], tuple[int, dict[int, float]]] = {}
    coordinates = [axis.tolist() for axis in array.coords]
    for row, column, place, component, value in zip(*coordinates, array.data.tolist(), strict=True):
        first, vector = found.setdefault((column, place), (row, {}))
        if first != row:
            raise ValueError(f"place {place} of edge {edges[column]} has two arcs")
        vector[component] = vector.get(component, 0.0) + value
    return found


def _numbers(weight: Weight | None) -> tuple[float, ...]:
    """The components of a weight; none for one that is not of numbers alone."""
    if isinstance(weight, Pose):
        return (*weight.xyz, *weight.quat)
    return tuple(map(float, weight)) if has_numbers(weight) else ()


def _weight(vector: Mapping[int, float], known: Weight | None) -> Weight | None:
    """The weight of these components: the known one, with what is noted about it, where they are its own."""
    before = _numbers(known)
    size = len(before) or max(vector) + 1 - WEIGHT
    numbers = tuple(vector.get(WEIGHT + number, 0.0) for number in range(size))
    if numbers == before:
        return known
    if isinstance(known, Pose) or (known is None and size == _POSE):
        return Pose.from_quat(numbers[3:], numbers[:3])  # type: ignore[arg-type]
    return numbers
