"""Nested graphs in text: what is printed in whose block, and how a reference leads there."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from msgspec import Struct, field

from hymeko_x.formats.hymeko import RESERVED
from hymeko_x.formats.hymeko.nesting import OUTER, nest_edge, nest_key, prefix_of
from hymeko_x.ir.ids import KINDS
from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.parts import Nest
from hymeko_x.language.expansion import Scope
from hymeko_x.language.syntax import QuotedName

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Mechanism

_ALL_KINDS = tuple(KINDS.values())
_MAX_DEPTH = 100
"""Blocks inside of blocks that are printed; elements that stand deeper are printed beside the others, with an edge that tells where."""


class BlockNesting(Struct, frozen=True):
    """What is printed in the blocks of data: the elements in each block, the block of each, and the names that are known there.

    ``edges`` are those that the blocks stand for.
    """

    inner: Mapping[Id, tuple[Id, ...]] = field(default_factory=dict)
    outer: Mapping[Id, Id] = field(default_factory=dict)
    scopes: Mapping[Id, Scope] = field(default_factory=dict)
    edges: frozenset[Id] = frozenset()
    root: Scope = field(default_factory=Scope)

    def name(self, key: Id) -> str:
        """The name of an element in its block."""
        outer = self.outer.get(key)
        return key.name if outer is None else key.name.removeprefix(prefix_of(outer))

    def path(self, target: Id, kinds: tuple[str, ...], within: Id | None, names: Mapping[str, list[str]]) -> tuple[str, ...]:
        """The shortest path that means the target in the block of an element (None: in the root)."""
        steps = [name_of(self.name(target))]
        here = target
        while here in self.outer:
            here = self.outer[here]
            steps.insert(0, name_of(self.name(here)))
        scope = self.root if within is None else self.scopes[within]
        ends = [tuple(steps[-count:]) for count in range(1, len(steps) + 1)]
        ends.append((name_of(self.root.name), *steps))
        for path in (*ends, *((target.kind, *end) for end in ends)):
            if _meaning(path, kinds, scope, names) == target:
                return path
        return (target.kind, "", *steps)


def _meaning(path: tuple[str, ...], kinds: tuple[str, ...], scope: Scope, names: Mapping[str, list[str]]) -> Id | None:
    """The element that the reader of text finds behind a path."""
    if len(path) > 1 and path[0] in _ALL_KINDS and (not kinds or path[0] in kinds):
        kinds, path = (path[0],), path[1:]
    for name in (*scope.meanings(path), ".".join(path)):
        for kind in kinds or _ALL_KINDS:
            if kind in names.get(name, ()) or (kind == name == "world" and not isinstance(path[-1], QuotedName)):
                return Id(kind, name)
    return None


def name_of(name: str) -> str:
    """The name of an element, quoted where it would mean something else."""
    return QuotedName(name) if name in RESERVED else name


def nesting_of(mechanism: Mechanism, root: str) -> BlockNesting:
    """The elements that stand in the blocks of others: those whose names tell so, each in one block."""
    found = {arcs[0].target: tuple([arc.target for arc in arcs[1:]]) for key, _, arcs in mechanism.edges(Nest) if _is_block(mechanism, key)}
    if not found:
        return BlockNesting()
    times = Counter(key for inner in found.values() for key in inner)
    found = {outer: inner for outer, inner in found.items() if all(times[key] == 1 for key in inner)}
    outer = {key: place for place, inner in found.items() for key in inner}
    deep = {place for place in found if _is_deep(place, outer)}
    found = {place: inner for place, inner in found.items() if place not in deep}
    outer = {key: place for key, place in outer.items() if place not in deep}
    nesting = BlockNesting(found, outer, {}, frozenset(map(nest_key, found)), Scope(name=root))
    return _with_scopes(nesting, mechanism)


def _is_block(mechanism: Mechanism, key: Id) -> bool:
    """Whether an edge tells nothing but what a block tells: its name, and those of the elements in it, follow from the outer one's."""
    arcs = mechanism.graph.edges[key].arcs
    if len(arcs) < 2 or key in mechanism.extras or key in mechanism.notations or key in mechanism.graph.incidence:
        return False
    outer, inner = arcs[0].target, [arc.target for arc in arcs[1:]]
    if outer.kind not in OUTER or outer not in mechanism.graph or key != nest_key(outer):
        return False
    prefix = prefix_of(outer)
    sound = all(found.kind in OUTER and found in mechanism.graph and found.name.startswith(prefix) for found in inner)
    return sound and mechanism.graph.edges[key] == nest_edge(outer, inner)


def _is_deep(key: Id, outer: Mapping[Id, Id]) -> bool:
    depth = 0
    here: Id | None = key
    while here is not None and depth <= _MAX_DEPTH:
        here = outer.get(here)
        depth += 1
    return depth > _MAX_DEPTH


def _with_scopes(nesting: BlockNesting, mechanism: Mechanism) -> BlockNesting:
    """The nesting with the scope of each block, as the reader of text makes them."""
    scopes: dict[Id, Scope] = {}
    for key in (*mechanism.graph.vertices, *mechanism.graph.edges):
        chain = [key]
        while (place := nesting.outer.get(chain[-1])) is not None:
            chain.append(place)
        scope = nesting.root
        for step in reversed(chain):
            name = nesting.name(step)
            if step not in nesting.edges:
                scope.elements.add(name)
            if step in nesting.inner:
                scope = scope.scopes.setdefault(name, Scope(prefix_of(step), scope))
                scopes[step] = scope
    return BlockNesting(nesting.inner, nesting.outer, scopes, nesting.edges, nesting.root)
