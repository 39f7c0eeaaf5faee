"""Names of elements: giving out free ones, and a mechanism with some of its elements under other ids."""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING, TypeVar

from msgspec.structs import replace

from hymeko_x.ir.graph import Arc, Edge, Hypergraph
from hymeko_x.ir.mechanism import Id

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterable, Mapping, Sequence

    from hymeko_x.ir.mechanism import Extra, Mechanism
    from hymeko_x.ir.parts import Joint

T = TypeVar("T")


class Names:
    """Gives out ids that are unique per kind: a name that is taken gets ``#2``, ``#3``, ... behind it."""

    def __init__(self, taken: Iterable[Id] = ()) -> None:
        self._taken: set[tuple[str, str]] = set(taken)
        self._next: dict[Id, int] = {}

    def reserve(self, kind: str, name: str) -> None:
        """Keep the id of this name from being given out, or the next free one where it is taken."""
        if (kind, name) in self._taken:
            self.take(kind, name)
        else:
            self._taken.add((kind, name))

    def take(self, kind: str, name: str, mark: str = "#") -> Id:
        """A free id of this kind, as close to the name as possible; the mark stands before a number."""
        wanted = Id(kind, name)
        free = self.free(kind, name, mark) if wanted in self._taken else wanted
        self._taken.add(free)
        return free

    def free(self, kind: str, name: str, mark: str = "#") -> Id:
        """The id that :meth:`take` would give out."""
        wanted = Id(kind, name)
        if wanted not in self._taken:
            return wanted
        number = self._next.get(wanted, 2)
        while Id(kind, f"{name}{mark}{number}") in self._taken:
            number += 1
        self._next[wanted] = number
        return Id(kind, f"{name}{mark}{number}")


def free_name(wanted: str, is_taken: Callable[[str], bool], mark: str = "#") -> str:
    """The name; when it is taken, with the mark and the first free number behind it, counted from 2."""
    name, number = wanted, 2
    while is_taken(name):
        name, number = f"{wanted}{mark}{number}", number + 1
    return name


def first_free_name(wanted: Sequence[str], taken: Container[str], mark: str = "#") -> str:
    """The first of these names that is not taken; where all are, the last one as :func:`free_name` makes it free."""
    for name in wanted:
        if name not in taken:
            return name
    return free_name(wanted[-1], taken.__contains__, mark)


def with_dof_names(joint: Joint, change: Callable[[str], str]) -> Joint:
    """The joint, whose dofs that have names have changed ones."""
    if not any(dof.name for dof in joint.dofs):
        return joint
    return replace(joint, dofs=tuple([replace(dof, name=change(dof.name)) if dof.name else dof for dof in joint.dofs]))


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
        stored=_rekeyed(mechanism.stored, names),
        layout=tuple(names.get(key, key) for key in mechanism.layout),
    )


def _rekeyed(table: Mapping[Id, T], names: Mapping[Id, Id]) -> dict[Id, T]:
    """A side table under the new keys; what the new key had already wins."""
    moved = {names[key]: value for key, value in table.items() if key in names}
    return {**moved, **{key: value for key, value in table.items() if key not in names}}


def names_in_use(mechanism: Mechanism) -> Names:
    """A giver of new ids that knows every id of the mechanism."""
    return Names(chain(mechanism.graph.vertices, mechanism.graph.edges))
