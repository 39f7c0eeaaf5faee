"""The tables of a robot, for looking around and for changing: elements by id, and for each element the edges at it.

A :class:`Robot` reads a locked draft; an editing session owns an open one. Every change keeps the index of incidence, so that it costs
what is at the element, and not what is in the robot.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, TypeVar

from msgspec.structs import replace

from hymeko_x import formats
from hymeko_x.ir.graph import Arc, Hypergraph
from hymeko_x.ir.ids import KINDS
from hymeko_x.ir.mechanism import WORLD, Id, Mechanism
from hymeko_x.ir.names import names_in_use, with_dof_names
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import Body, Joint, Material, Mesh, Shape, Texture, World
from hymeko_x.rewrite.references import with_references, without_references
from hymeko_x.robot.errors import EditError
from hymeko_x.states import states_of, with_ids, with_states

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from hymeko_x.ir.mechanism import RobotArc, RobotEdge
    from hymeko_x.ir.names import Names
    from hymeko_x.ir.parts import EdgePart, Inertial, VertexPart

T = TypeVar("T")
BODY, JOINT, SHAPE = KINDS[Body], KINDS[Joint], KINDS[Shape]


class Draft:
    """Vertices and edges by id, the edges at each element, and what was renamed or removed so far, by the ids of the mechanism."""

    def __init__(self, mechanism: Mechanism, completed: Callable[[], Mechanism], *, is_locked: bool) -> None:
        self.mechanism = mechanism
        self.completed = completed
        self.is_locked = is_locked
        self.vertices: dict[Id, VertexPart] = dict(mechanism.graph.vertices)
        self.edges: dict[Id, RobotEdge] = dict(mechanism.graph.edges)
        self._was: dict[Id, Id] = {}
        self._gone: set[Id] = set()
        self._named: set[Id] = set()
        self._states: dict[str, str | None] = {}
        self._at: dict[Id, dict[Id, None]] = {}
        for key, edge in self.edges.items():
            for arc in edge.arcs:
                self._at.setdefault(arc.target, {})[key] = None
        self._names: Names | None = None

    # ---- looking around --------------------------------------------------------------------------------------------------

    def __contains__(self, key: object) -> bool:
        """Whether an element has this id."""
        return key in self.vertices or key in self.edges

    def find(self, kind: str, name: str) -> Id | None:
        """The id of this kind and name. A shape, whose name need not be unique, is also found by the name that its author gave it."""
        key = Id(kind, name)
        if key in self:
            return key
        if kind != SHAPE:
            return None
        found = [shape for shape in self._shapes_called.get(name, ()) if shape in self and _name_of(self.edges[shape]) == name]
        return found[0] if len(found) == 1 else None

    @cached_property
    def _shapes_called(self) -> dict[str, dict[Id, None]]:
        """The shapes by their authors' names; changed shapes are also under the names that they had."""
        called: dict[str, dict[Id, None]] = {}
        for key in self.ids(SHAPE):
            called.setdefault(_name_of(self.edges[key]) or "", {})[key] = None
        return called

    def ids(self, kind: str) -> Iterator[Id]:
        """The ids of this kind in order."""
        return (key for table in (self.vertices, self.edges) for key in table if key.kind == kind)

    def part(self, key: Id) -> VertexPart | EdgePart:
        """The part of a vertex or an edge."""
        return self.vertices[key] if key in self.vertices else self.edges[key].data

    def at(self, key: Id, kind: str) -> Iterator[tuple[Id, RobotEdge]]:
        """The edges of this kind that have an arc to the element."""
        return ((edge, self.edges[edge]) for edge in self._at.get(key, ()) if edge.kind == kind)

    def computed_inertial(self, key: Id) -> Inertial | None:
        """The inertial that the engine of the robot's format computes for a body; None where there is no such engine."""
        found = self.completed().graph.vertices.get(self._was.get(key, key))
        return found.inertial if isinstance(found, Body) else None

    # ---- changing --------------------------------------------------------------------------------------------------------

    def check_open(self, key: Id) -> None:
        """Raises: EditError where this is a robot, which never changes, and not an editing session."""
        if self.is_locked:
            raise EditError(f"{key} belongs to a robot, which does not change; use `with robot.edit() as e:` and the elements of e")

    def set_part(self, key: Id, part: VertexPart | EdgePart) -> None:
        """Give an element another part of the same kind."""
        self.check_open(key)
        if key in self.vertices:
            self.vertices[key] = part  # type: ignore[assignment]
        else:
            self.edges[key] = replace(self.edges[key], data=part)

    def set_edge(self, key: Id, edge: RobotEdge) -> None:
        """Add an edge, or exchange it for another one."""
        self.check_open(key)
        if key in self.edges:
            self._unlink(key)
        self.edges[key] = edge
        for arc in edge.arcs:
            self._at.setdefault(arc.target, {})[key] = None
        if key.kind == SHAPE:
            self._shapes_called.setdefault(_name_of(edge) or "", {})[key] = None

    def add_vertex(self, key: Id, part: VertexPart) -> None:
        """Add a vertex."""
        self.check_open(key)
        self.vertices[key] = part

    def new_id(self, kind: str, name: str) -> Id:
        """The id of an element that is to be added. Raises: EditError when there is one of this kind and name."""
        key = Id(kind, name)
        self.check_open(key)
        if not name:
            raise EditError(f"a {kind} needs a name")
        if key in self:
            raise EditError(f"there is a {key} already")
        return key

    def check_shape_name(self, name: str) -> None:
        """Raises: EditError when a shape cannot get this name, because another one is found by it."""
        self.check_open(Id(SHAPE, name))
        if not name or self.find(SHAPE, name) is not None:
            raise EditError(f"there is a shape '{name}' already" if name else "a shape needs a name")

    def free_id(self, kind: str, name: str) -> Id:
        """A free id as close to the name as possible, for an element that needs no name of its own."""
        if self._names is None:
            self._names = names_in_use(self.mechanism)
        key = self._names.take(kind, name)
        while key in self:
            key = self._names.take(kind, name)
        return key

    def need_world(self) -> Id:
        """The world, which is there from now on."""
        if WORLD not in self.vertices:
            self.vertices = {WORLD: World(), **self.vertices}
        return WORLD

    def rename(self, old: Id, name: str) -> Id:
        """Give an element another name, wherever it occurs; what its reader named after it follows. Raises: EditError when it is taken."""
        if old.kind == SHAPE:
            return self._rename_shape(old, name)
        if name == old.name:
            return old
        new = self._moved(old, self.new_id(old.kind, name))
        self.set_part(new, _renamed(self.part(new), old.name, name))
        self._named.add(new)
        if old.kind == BODY:
            for key in [key for key in self._at.get(new, ()) if self._is_named_after(key, old)]:
                self._moved(key, self.free_id(key.kind, name + key.name.removeprefix(old.name)))
        return new

    def _rename_shape(self, key: Id, name: str) -> Id:
        if self.find(SHAPE, name) == key:
            return key
        self.check_shape_name(name)
        edge = self.edges[key]
        assert isinstance(edge.data, Shape)
        self.set_edge(key, replace(edge, data=replace(edge.data, name=name)))
        return key

    def _is_named_after(self, key: Id, body: Id) -> bool:
        """Whether a reader made the name of an edge from that of its body: a shape's, and that of a joint without a name."""
        if key.kind == SHAPE:
            return key.name.startswith(f"{body.name}/")
        return key.kind == JOINT and key.name == body.name and self.is_unnamed(key)

    def is_unnamed(self, key: Id) -> bool:
        """Whether neither the author of the file nor an edit named the element: it has that note, or is a fixed joint where its body is."""
        if key in self._named:
            return False
        was, origins = self._was.get(key, key), self.mechanism.origins
        part = self.edges[key].data if key.kind == JOINT else None
        is_implied = isinstance(part, Joint) and not part.dofs and was in origins and origins[was] == origins.get(Id(BODY, was.name))
        return is_implied or self.mechanism.notation(was, UNNAMED) is not None

    def _moved(self, old: Id, new: Id) -> Id:
        """The element under another id, to which all arcs lead."""
        if old in self.vertices:
            self.vertices[new] = self.vertices.pop(old)
        else:
            self._unlink(old)
            self.set_edge(new, self.edges.pop(old))
        for key in list(self._at.get(old, ())):
            edge = self.edges[key]
            self.edges[key] = replace(edge, arcs=tuple([_redirected(arc, old, new) for arc in edge.arcs]))
        if old in self._at:
            self._at[new] = self._at.pop(old)
        self._was[new] = self._was.pop(old, old)
        return new

    def remove(self, keys: Iterable[Id]) -> None:
        """Take elements away with every edge at them, and what those were for; a stance only loses the joint, a shape its material."""
        waiting = list(keys)
        while waiting:
            key = waiting.pop()
            if key not in self:
                continue
            self.check_open(key)
            waiting += self._orphans(key)
            if key in self.vertices:
                del self.vertices[key]
            else:
                self._unlink(key)
                del self.edges[key]
            self._at.pop(key, None)
            self._gone.add(self._was.pop(key, key))

    def _orphans(self, key: Id) -> list[Id]:
        """What goes when an element goes: edges at it, and vertices that were there for it alone."""
        found: list[Id] = []
        for edge in list(self._at.get(key, ())):
            if (edge.kind, key.kind) in _LOSES_ARC:
                kept = tuple([arc for arc in self.edges[edge].arcs if arc.target != key])
                self.set_edge(edge, replace(self.edges[edge], arcs=kept))
            else:
                found.append(edge)
        if key in self.edges:
            found += [arc.target for arc in self.edges[key].arcs if arc.target.kind in _OWNED.get(key.kind, ()) and self._is_last(arc, key)]
        return found

    def _is_last(self, arc: RobotArc, edge: Id) -> bool:
        """Whether nothing else needs what the arc leads to; what a site is measured or driven by does not."""
        others = (other for other in self._at.get(arc.target, ()) if other != edge)
        return all(arc.target.kind == "frame" and other.kind != "mount" for other in others)

    def _unlink(self, key: Id) -> None:
        for arc in self.edges[key].arcs:
            self._at.get(arc.target, {}).pop(key, None)

    def call_state(self, name: str, new: str | None) -> None:
        """Give a named configuration that the robot's format keeps as text another name, or none to remove it."""
        self.check_open(Id("pose", name))
        own = next((old for old, now in self._states.items() if now == name), name)
        self._states[own] = new

    def states(self) -> dict[str, Mapping[Id, tuple[float, ...]]]:
        """The named configurations that the robot's format keeps as texts, as they are now: coordinates by joint, in rad or m."""
        now = {old: new for new, old in self._was.items()}
        named = ((self._states.get(name, name), values) for name, values in self._kept_states.items())
        return {
            name: {key: numbers for old, numbers in values.items() if (key := now.get(old, old)) in self}
            for name, values in named
            if name is not None
        }

    @cached_property
    def _kept_states(self) -> dict[str, Mapping[Id, tuple[float, ...]]]:
        return states_of(self.mechanism)

    def _called(self, name: str) -> str | None:
        return self._states.get(name, name)

    # ---- the result ------------------------------------------------------------------------------------------------------

    def finished(self, name: str | None = None, inlined: Callable[[], Mechanism] | None = None) -> Mechanism:
        """The mechanism with all changes; side tables follow renamed elements and forget removed ones.

        ``inlined`` gives the mechanism without files that name elements, for when names change.
        """
        source = self.mechanism
        now = {old: new for new, old in self._was.items() if old not in self._gone}
        graph = Hypergraph(_in_order(self.vertices, source.graph.vertices, now), _in_order(self.edges, source.graph.edges, now))
        changed = replace(source, name=source.name if name is None else name, graph=graph)
        if not (now or self._gone):
            return with_states(refitted(changed, source), source, with_ids(now), self._called)
        changed = replace(
            changed,
            extras=self._kept((source if inlined is None else inlined()).extras, now),
            origins=self._kept(source.origins, now),
            notations=self._notations(now),
            stereotypes=self._kept(source.stereotypes, now),
            stored=self._kept(source.stored, now),
            layout=tuple([now.get(key, key) for key in source.layout if key not in self._gone]),
        )
        named = with_references(without_references(changed, frozenset(self._gone_names())), now)
        return with_states(refitted(named, source), source, with_ids(now), self._called)

    def _gone_names(self) -> Iterator[Id]:
        """What removed elements are called in their file: their ids, the names of shapes, and those of dofs."""
        for key in self._gone:
            yield key
            edge = self.mechanism.graph.edges.get(key)
            if edge is not None and isinstance(edge.data, Shape) and edge.data.name:
                yield Id(SHAPE, edge.data.name)
            if edge is not None and isinstance(edge.data, Joint):
                yield from (Id(JOINT, dof.name) for dof in edge.data.dofs if dof.name)

    def _notations(self, now: Mapping[Id, Id]) -> dict[Id, Mapping[str, str]]:
        """The notations by present id; an element that got a name is no longer unnamed."""
        kept = self._kept(self.mechanism.notations, now)
        for key in self._named & kept.keys():
            kept[key] = {word: text for word, text in kept[key].items() if word != UNNAMED.name}
        return kept

    def _kept(self, table: Mapping[Id, T], now: Mapping[Id, Id]) -> dict[Id, T]:
        """A side table with the present ids."""
        return {now.get(key, key): value for key, value in table.items() if key not in self._gone}


_LOSES_ARC = frozenset({("stance", "joint"), ("shape", "material")})
"""The kinds of edges that stay when they lose an element of a kind."""
_OWNED = {"mount": ("frame", "camera", "light", "sensor"), "drive": ("actuator",), "sense": ("sensor",)}
"""By the kind of an edge, the vertices that go with it when nothing else needs them."""


def refitted(changed: Mechanism, source: Mechanism) -> Mechanism:
    """The changed mechanism, to whose joints each format has fitted what it holds of the whole."""
    for row in formats.FORMATS:
        if row.refits is not None and not row.container_of:
            changed = formats.loaded(row.refits)(changed, source)
    return changed


def _name_of(edge: RobotEdge) -> str | None:
    return edge.data.name if isinstance(edge.data, Shape) else None


def _renamed(part: VertexPart | EdgePart, old: str, new: str) -> VertexPart | EdgePart:
    """The part of an element with another name, where the part holds its name."""
    if isinstance(part, Joint):
        return with_dof_names(part, lambda name: new if name == old else name)
    return replace(part, name=new) if isinstance(part, Material | Mesh | Texture) and part.name is not None else part


def _redirected(arc: RobotArc, old: Id, new: Id) -> RobotArc:
    return Arc(new, arc.sign, arc.weight, arc.role) if arc.target == old else arc


def _in_order(table: Mapping[Id, T], source: Mapping[Id, object], now: Mapping[Id, Id]) -> dict[Id, T]:
    """A table in the order of the source; new elements follow."""
    there = [new for new in (now.get(key, key) for key in source) if new in table]
    return {**{key: table[key] for key in there}, **table}
