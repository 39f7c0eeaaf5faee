"""The kinematic tree as rows: one row for each body with its parent joint, and one for each hyperedge that lies over the tree.

Lanes are the columns of the tree: a body with one child has it in its own lane, children of a body with several are one lane further
right. Hyperedges have a row below their last member and a track at the right of all text, on which their members are marked; tracks are
shared by hyperedges that do not meet.
"""

from __future__ import annotations

from heapq import heappop, heappush
from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x.draw.graph.diagram import not_drawn
from hymeko_x.draw.graph.facts import SIGNS, edge_facts, motion, vertex_facts, weight
from hymeko_x.draw.graph.letters import lines, shown
from hymeko_x.draw.graph.selection import OVER_THE_TREE, Wanted, homes, select
from hymeko_x.ir.mechanism import WORLD

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from hymeko_x.draw.graph.selection import Selection
    from hymeko_x.ir.mechanism import Id, JointView, Mechanism, RobotEdge


LINE = 0.5
"""The distance of lines of text by that of rows."""


class BodyRow(Struct, frozen=True):
    """A body, or the world: its row, lane, parent's row (None at the top), the joint to it, its mass, and what is not drawn."""

    key: Id
    row: float
    lane: int
    parent: float | None
    joint: JointView | None
    mass: str
    note: str


class OverRow(Struct, frozen=True):
    """A hyperedge over the tree: its first row, its lines of text, its track, and by member's row the sign with which it is there."""

    key: Id
    row: float
    text: tuple[str, ...]
    track: int
    members: Mapping[float, int]


class DrawnTree(Struct, frozen=True):
    """The rows of a tree from top to bottom."""

    name: str
    bodies: tuple[BodyRow, ...]
    over: tuple[OverRow, ...]
    note: str


def tree(robot: Mechanism, wanted: Wanted) -> DrawnTree:
    """The chosen part of a robot as rows; hyperedges come first where there is no body."""
    wanted = Wanted(wanted.depth, wanted.only or ("joint", *OVER_THE_TREE), wanted.fold)
    chosen = select(robot, wanted)
    over = [key for key in chosen.edges if not _is_in_tree(robot, key)]
    world = [WORLD] if any(view.parent == WORLD for view in robot.joints.values()) else []
    return _Rows(robot, chosen, [*world, *chosen.bodies], over).tree()


def joint_text(view: JointView) -> tuple[str, str]:
    """The name and the motion of a joint."""
    return shown(view.id.name), motion(view.joint)


def _is_in_tree(robot: Mechanism, key: Id) -> bool:
    """Whether an edge is the parent joint of a body."""
    view = robot.joints.get(key)
    return view is not None and robot.parent_joint[view.child].id == key


class _Rows:
    def __init__(self, robot: Mechanism, chosen: Selection, bodies: Sequence[Id], over: Sequence[Id]) -> None:
        self.robot = robot
        self.chosen = chosen
        self.bodies = bodies
        home = homes(robot)
        place = {key: number for number, key in enumerate(bodies)}
        self.members = {key: _members(robot.graph.edges[key], home, place) for key in over}
        self.text = {key: tuple(lines(_words(robot.graph.edges[key]))) for key in over}
        self.row: dict[Id, float] = {}
        self.lanes = _lanes(robot, bodies)

    def tree(self) -> DrawnTree:
        below: dict[int, list[Id]] = {}
        for key, members in self.members.items():
            below.setdefault(max(members, default=len(self.bodies) - 1), []).append(key)
        row = 0.0
        for number, body in enumerate((None, *self.bodies), -1):
            if body is not None:
                self.row[body] = row
                row += 1
            for key in below.get(number, ()):
                self.row[key] = row
                row += 1 + LINE * (len(self.text[key]) - 1)
        over = self._over()
        return DrawnTree(self.robot.name, tuple(map(self._body, self.bodies)), over, not_drawn(self.chosen))

    def _body(self, key: Id) -> BodyRow:
        view = self.robot.parent_joint.get(key)
        parent = None if view is None else self.row.get(view.parent)
        if parent is not None and parent > self.row[key]:
            parent = None
        mass = vertex_facts(self.robot.graph.vertices.get(key))
        return BodyRow(key, self.row[key], self.lanes[key], parent, view, mass, self.chosen.notes.get(key, ""))

    def _over(self) -> tuple[OverRow, ...]:
        """The hyperedges with their tracks: the first that is free, in the order of their upper ends."""
        rows = {key: {self.row[self.bodies[place]]: sign for place, sign in members.items()} for key, members in self.members.items()}
        busy: list[tuple[float, int]] = []
        free: list[int] = []
        track: dict[Id, int] = {}
        for key in sorted(rows, key=lambda key: min(rows[key], default=self.row[key])):
            while busy and busy[0][0] < min(rows[key], default=self.row[key]):
                heappush(free, heappop(busy)[1])
            track[key] = heappop(free) if free else len(busy)
            heappush(busy, (self.row[key], track[key]))
        return tuple(OverRow(key, self.row[key], self.text[key], track[key], rows[key]) for key in rows)


def _members(edge: RobotEdge, home: Mapping[Id, Id], place: Mapping[Id, int]) -> dict[int, int]:
    """The bodies at which an edge is, by number, with the sign of its first arc there."""
    found: dict[int, int] = {}
    for arc in edge.arcs:
        body = home.get(arc.target)
        if body is not None and body in place:
            found.setdefault(place[body], arc.sign)
    return found


def _words(edge: RobotEdge) -> list[str]:
    """What an edge is and its arcs, each in the order of HyMeKo text: weight, direction, target."""
    arcs = [f"{weight(arc)} {SIGNS[arc.sign]} {shown(arc.target.name)}".lstrip() for arc in edge.arcs]
    return [f"{edge_facts(edge.data)}:", *(f"{arc}," for arc in arcs[:-1]), *arcs[-1:]]


def _lanes(robot: Mechanism, bodies: Sequence[Id]) -> dict[Id, int]:
    """The lane of every body: that of its parent where it is the only child."""
    drawn = set(bodies)
    children: dict[Id, int] = {}
    for key in bodies:
        view = robot.parent_joint.get(key)
        if view is not None and view.parent in drawn:
            children[view.parent] = children.get(view.parent, 0) + 1
    lanes: dict[Id, int] = {}
    for key in bodies:
        view = robot.parent_joint.get(key)
        parent = view.parent if view is not None and view.parent in lanes else None
        lanes[key] = 0 if parent is None else lanes[parent] + (children[parent] > 1)
    return lanes
