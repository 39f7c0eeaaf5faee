"""Which elements of a robot belong to some of its bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.ir.mechanism import ROOT, WORLD
from hymeko_x.ir.parts import Body
from hymeko_x.rewrite.references import named_in

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, Mechanism

ASSETS = frozenset({"material", "mesh", "texture", "layer"})
"""The kinds of elements that several bodies share."""
_THINGS = frozenset({"frame", "camera", "light", "sensor", "actuator", "pose"})
"""The kinds of vertices that are where an edge puts them."""
_PLACING = frozenset({"mount", "drive", "sense"})


def below(mechanism: Mechanism, top: Id) -> set[Id]:
    """The body and all below it."""
    found: set[Id] = set()
    stack = [top]
    while stack:
        body = stack.pop()
        if body not in found:
            found.add(body)
            stack += [joint.child for joint in mechanism.children.get(body, ())]
    return found


def part_of(mechanism: Mechanism, bodies: set[Id]) -> set[Id]:
    """These bodies with everything that concerns them alone, the assets that they use, and the named configurations of their joints."""
    sides = _Sides(mechanism, bodies)
    graph = mechanism.graph
    inside = {key for table in (graph.vertices, graph.edges) for key in table if key.kind not in ASSETS and sides.of(key)}
    used = {arc.target for key in inside & graph.edges.keys() for arc in graph.edges[key].arcs if arc.target.kind in ASSETS}
    used |= _of_whole(mechanism)
    for key, edge in graph.edges.items():
        if key.kind == "layer" and any(arc.target in used for arc in edge.arcs):
            used |= {key, *(arc.target for arc in edge.arcs)}
    return inside | used


def _of_whole(mechanism: Mechanism) -> set[Id]:
    """The assets that extras of the whole name which name nothing else, such as default classes."""
    named = (named_in([extra]) for extra in mechanism.extras.get(ROOT, ()))
    return {key for keys in named if all(key.kind in ASSETS for key in keys) for key in keys if key in mechanism.graph.vertices}


class _Sides:
    """Which elements belong to the bodies: those all of whose ends do."""

    def __init__(self, mechanism: Mechanism, bodies: set[Id]) -> None:
        self._graph = mechanism.graph
        self._known: dict[Id, bool] = {key: key in bodies for key, _ in mechanism.vertices(Body)}
        self._known[WORLD] = False

    def of(self, key: Id) -> bool:
        """Whether the element belongs to them. Not deep: relations are between elements, which are on bodies."""
        if key not in self._known:
            self._known[key] = False
            self._known[key] = self._computed(key)
        return self._known[key]

    def _computed(self, key: Id) -> bool:
        if key.kind == "pose":
            return any(self._is_about(edge) for edge, _, _ in self._graph.edges_at(key))
        if key.kind == "stance":
            return self._is_about(key)
        if key in self._graph.vertices:
            placing = {"mount"} if key.kind == "frame" else _PLACING  # what a site is measured or driven by does not place it
            ends = [edge for edge, _, _ in self._graph.edges_at(key) if edge.kind in placing]
        else:
            skipped = ASSETS | (_THINGS if key.kind in _PLACING else frozenset({"pose"}))
            arcs = self._graph.edges[key].arcs
            ends = [arc.target for arc in arcs if arc.target.kind not in skipped and arc.target != key]
            ends += [arc.target for arc in arcs if key.kind in ("sense", "drive") and arc.target.kind == "frame"]
        return bool(ends) and all(map(self.of, ends))

    def _is_about(self, stance: Id) -> bool:
        return any(arc.target.kind == "joint" and self.of(arc.target) for arc in self._graph.edges[stance].arcs)
