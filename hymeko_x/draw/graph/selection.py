"""What of a mechanism is drawn: how deep, which kinds of edges, and repeated parts once."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x.draw.graph.facts import symbol, vertex_facts
from hymeko_x.draw.graph.letters import shown
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import WORLD

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge

EDGE_KINDS = (
    "joint",
    "coupling",
    "loop",
    "tendon",
    "drive",
    "sense",
    "shape",
    "mount",
    "contact",
    "stance",
    "layer",
    "subset",
    "constitutive",
    "relation",
    "nest",
)
OVER_THE_TREE = ("coupling", "loop", "tendon")
MEANT = ("joint", *OVER_THE_TREE, "constitutive", "relation", "nest")
"""The kinds of edges that are drawn where none is asked for: how a mechanism moves, and whatever a plain graph has."""
PLAIN = frozenset({"body", "datum", "spring", "damper", "mass", "port"})
"""The kinds of vertices that are drawn with or without an edge."""


class Wanted(Struct, frozen=True):
    """What the user asks for. ``depth``: joints below a base; ``only``: kinds of edges; ``fold``: equal parts of one parent once."""

    depth: int | None = None
    only: tuple[str, ...] = ()
    fold: bool = False


class Selection(Struct, frozen=True):
    """The bodies and the edges that are drawn, in order, and for a body what of it is not: ``+ 12 bodies``, ``×4: also rear, left``."""

    bodies: tuple[Id, ...]
    edges: tuple[Id, ...]
    notes: Mapping[Id, str]
    hidden: int
    """The number of edges of the wanted kinds that are not drawn, because they lead to bodies that are not."""


def select(robot: Mechanism, wanted: Wanted) -> Selection:
    """The elements to draw."""
    tree = _Tree(robot)
    kinds = frozenset(wanted.only or MEANT)
    edges = [key for key in robot.graph.edges if key.kind in kinds]
    kept, notes = tree.kept(wanted, edges)
    shown_edges = tuple(key for key in edges if all(body in kept for body in tree.bodies_of(robot.graph.edges[key])))
    return Selection(tuple(key for key in tree.order if key in kept), shown_edges, notes, len(edges) - len(shown_edges))


def homes(robot: Mechanism) -> dict[Id, Id]:
    """For every element that belongs to a body, that body: of a joint its child, of a shape, frame or sensor what it sits on."""
    found = {key: key for key, _ in robot.vertices(parts.Body)}
    found[WORLD] = WORLD
    found |= {key: view.child for key, view in robot.joints.items()}
    found |= {view.id: view.body for view in robot.every_shape()}
    for body, views in robot.mounts.items():
        found |= {view.mounted: body for view in views}
    return found


class _Tree:
    """The kinematic tree as lists: every body once, those that no base leads to at the end."""

    def __init__(self, robot: Mechanism) -> None:
        self.robot = robot
        self.homes = homes(robot)
        reached = dict.fromkeys(robot.depth_first())
        self.order = [*reached, *(key for key, _ in robot.vertices(parts.Body) if key not in reached)]
        above = robot.parent_joint
        self.parent = {key: above[key].parent for key in reached if key in above}

    def bodies_of(self, edge: RobotEdge) -> Iterator[Id]:
        """The bodies at the ends of an edge, and those that its ends sit on."""
        for arc in edge.arcs:
            home = self.homes.get(arc.target)
            if home is not None and home != WORLD:
                yield home

    def kept(self, wanted: Wanted, edges: Iterable[Id]) -> tuple[frozenset[Id], dict[Id, str]]:
        """The bodies to draw, with a note where something of theirs is not drawn."""
        kept = self._touched(edges) if wanted.only and "joint" not in wanted.only else dict.fromkeys(self.order)
        others = _repeated(self) if wanted.fold else {}
        leave = {other for found in others.values() for other in found}
        depth: dict[Id, int] = {}
        notes: dict[Id, str] = {}
        missing: dict[Id, int] = {}
        stays: set[Id] = set()
        for key in self.order:
            parent = self.parent.get(key, WORLD)
            depth[key] = depth.get(parent, -1) + 1
            is_below = parent == WORLD or parent in stays
            if key in kept and key not in leave and is_below and (wanted.depth is None or depth[key] <= wanted.depth):
                stays.add(key)
        for key in reversed(self.order):
            if key not in stays and key not in leave:
                parent = self.parent.get(key, WORLD)
                missing[parent] = missing.get(parent, 0) + missing.pop(key, 0) + 1
        notes |= {key: f"+ {count} {'body' if count == 1 else 'bodies'}" for key, count in missing.items() if key in stays}
        for key in stays & others.keys():
            names = ", ".join(shown(other.name) for other in others[key])
            notes[key] = " · ".join(filter(None, (notes.get(key), f"×{len(others[key]) + 1}, also {names}")))
        return frozenset(stays), notes

    def _touched(self, edges: Iterable[Id]) -> dict[Id, None]:
        """The bodies that edges lead to, with those between them and their base."""
        found: dict[Id, None] = {}
        for edge in edges:
            for body in self.bodies_of(self.robot.graph.edges[edge]):
                step: Id | None = body
                while step is not None and step != WORLD and step not in found:
                    found[step] = None
                    step = self.parent.get(step)
        return found


def _repeated(tree: _Tree) -> dict[Id, list[Id]]:
    """For each first of several equal children of a parent the others: equal in masses, motions and in what is below them."""
    numbers: dict[object, int] = {}
    form: dict[Id, int] = {}
    below: dict[Id, list[Id]] = {}
    for key in tree.order:
        if key in tree.parent:
            below.setdefault(tree.parent[key], []).append(key)
    for key in reversed(tree.order):
        joint = tree.robot.parent_joint.get(key)
        moves = symbol(joint.joint) if joint else ""
        facts = (moves, vertex_facts(tree.robot.graph.vertices[key]), tuple(sorted(form[child] for child in below.get(key, ()))))
        form[key] = numbers.setdefault(facts, len(numbers))
    found: dict[Id, list[Id]] = {}
    for children in below.values():
        first: dict[int, Id] = {}
        for key in children:
            if first.setdefault(form[key], key) != key:
                found.setdefault(first[form[key]], []).append(key)
    return found
