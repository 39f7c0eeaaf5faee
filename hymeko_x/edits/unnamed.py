"""Elements to which their author gave no name: the numbers in their names say only where they stand.

Bodies are found by what they are, contacts and closures by what they join.
"""

from __future__ import annotations

import re
from collections import defaultdict
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.names import Names, rename
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import Body, Role, Shape
from hymeko_x.residue.pairing import essence_of, reordered_shapes, rounded
from hymeko_x.rewrite.references import with_references

if TYPE_CHECKING:
    from collections.abc import Set

    from hymeko_x.ir.mechanism import Mechanism, RobotEdge

_JOINING = frozenset({"contact", "loop", "coupling"})
_COUNTED = re.compile(rf"({'|'.join(role.value for role in Role)})_\d+")


def unnamed_bodies(robot: Mechanism) -> set[Id]:
    """The bodies that have no name in the robot's format."""
    return {key for key, _ in robot.vertices(Body) if robot.notation(key, UNNAMED) is not None}


def with_same_numbers(edited: Mechanism, image: Mechanism, unnamed: Set[Id]) -> Mechanism:
    """The edited robot, in which each of these bodies, and what is called after it, has the number that it has in the image."""
    bodies = {new.name: old.name for new, old in _same_bodies(edited, image, unnamed).items()}
    if not bodies:
        return edited
    there = {*edited.graph.vertices, *edited.graph.edges}
    names: dict[Id, Id] = {}
    for key in there:
        for body, mark, rest in (key.name.partition("/"), key.name.rpartition("_")):
            if body in bodies:  # and what is called after it: its shapes, and joints without names
                names[key] = Id(key.kind, f"{bodies[body]}{mark}{rest}")
    names |= _made_way(edited, names)
    return with_references(rename(edited, names), names)


def _same_bodies(edited: Mechanism, image: Mechanism, unnamed: Set[Id]) -> dict[Id, Id]:
    """The id in the image of each body of the edited robot that is one of these, where it goes by another number. Linear.

    Under one parent those are the same that have one id and one content, then one content, then one id. What is called otherwise than by
    another number has got a name since, and is left out.
    """
    pairs: dict[Id, Id] = {}
    if unnamed.isdisjoint(image.graph.vertices):
        return pairs
    theirs = {parent: [view.child for view in views if view.child in unnamed] for parent, views in image.children.items()}
    for parent in (*(key for key in edited.children if key.kind == "world"), *edited.depth_first()):
        waiting = theirs.get(pairs.get(parent, parent))
        if waiting:
            mine = [view.child for view in edited.children.get(parent, ()) if view.child in unnamed or view.child not in image.graph]
            pairs |= _same(edited, mine, image, waiting)
    return {new: old for new, old in pairs.items() if new != old and stem(new) == stem(old)}


def stem(key: Id) -> str:
    """The name without the number behind it."""
    return key.name.rstrip("0123456789").rstrip("#_")


def _same(edited: Mechanism, mine: list[Id], image: Mechanism, theirs: list[Id]) -> dict[Id, Id]:
    """The pairs among the children of one body."""
    contents = {key: _content(image, key) for key in theirs}
    own = {key: _content(edited, key) for key in mine}
    pairs = {key: key for key in mine if contents.get(key) == own[key]}
    waiting: dict[object, list[Id]] = defaultdict(list)
    for key in reversed(theirs):
        if key not in pairs:
            waiting[contents[key]].append(key)
    for key in mine:
        if key not in pairs and (same := waiting.get(own[key])):
            pairs[key] = same.pop()
    left = {*theirs}.difference(pairs.values())
    return pairs | {key: key for key in mine if key not in pairs and key in left}


def _content(robot: Mechanism, body: Id) -> object:
    """What a body is, where it is, and what it has."""
    view = robot.parent_joint[body]
    shapes = [essence_of(robot.graph, robot.graph.edges[shape.id]) for shape in robot.shapes.get(body, ())]
    joint = [(dof.kind, rounded(dof.axis)) for dof in view.joint.dofs]
    return rounded(view.parent_pose), rounded(view.child_pose), tuple(joint), rounded(robot.vertex(body, Body)), tuple(shapes)


def unnamed_edges(robot: Mechanism) -> set[Id]:
    """The contacts, closures and couplings that have no name in the robot's format."""
    return {key for key in robot.graph.edges if key.kind in _JOINING and robot.notation(key, UNNAMED) is not None}


def with_same_edges(edited: Mechanism, image: Mechanism, unnamed: Set[Id]) -> Mechanism:
    """The edited robot, in which each of these edges has the number that it has in the image. Linear.

    Those are the same that join the same elements, if they are called alike but for a number.
    """
    mine, theirs = ({key: _joined(key, edge) for key, edge in robot.graph.edges.items()} for robot in (edited, image))
    waiting: dict[object, list[Id]] = defaultdict(list)
    for key in reversed([key for key in theirs if key in unnamed and mine.get(key) != theirs[key]]):
        waiting[theirs[key]].append(key)
    names: dict[Id, Id] = {}
    for key, ends in mine.items() if waiting else ():
        if ends in waiting and theirs.get(key) != ends and waiting[ends] and stem(waiting[ends][-1]) == stem(key):
            names[key] = waiting[ends].pop()
    return rename(edited, names | _made_way(edited, names))


def _joined(key: Id, edge: RobotEdge) -> object:
    return key.kind, tuple([(arc.target, arc.sign, arc.role) for arc in edge.arcs])


def with_same_assets(edited: Mechanism, image: Mechanism) -> Mechanism:
    """The edited robot, in which meshes and images that have other ids in the image have the ids of the same ones there.

    Without one shape, a stage without names of meshes counts them otherwise, and names that are made of files are shorter.
    """
    mine, theirs = dict(edited.assets()), dict(image.assets())
    waiting: dict[object, list[Id]] = defaultdict(list)
    for key in reversed([key for key, part in theirs.items() if mine.get(key) != part]):
        waiting[theirs[key]].append(key)
    names = {key: same.pop() for key, part in mine.items() if theirs.get(key) != part and (same := waiting.get(part))}
    return rename(edited, names | _made_way(edited, names)) if names else edited


def without_counted_names(edited: Mechanism, image: Mechanism) -> Mechanism:
    """The edited robot without names of shapes that only count them, such as ``visual_2``, where the same shapes have none in the image.

    They are read as names where a shape before them is gone.
    """
    pairs = reordered_shapes(edited, image)
    edges: dict[Id, RobotEdge] = {}
    for key, shape, _ in edited.edges(Shape):
        name, same = shape.name or "", image.graph.edges.get(pairs.get(key, key))
        if _COUNTED.fullmatch(name) and same is not None and isinstance(same.data, Shape) and not same.data.name:
            edges[key] = replace(edited.graph.edges[key], data=replace(shape, name=None))
    return edited.replace(edges=edges)


def _made_way(robot: Mechanism, names: dict[Id, Id]) -> dict[Id, Id]:
    """Free ids for elements whose own ids others get, such as the joint of a renamed body, which is called as that body is."""
    there = {*robot.graph.vertices, *robot.graph.edges}
    free = Names((*there, *names.values()))
    taken = sorted(set(names.values()) & there - names.keys())
    views = {key: robot.joints.get(key) for key in taken}
    return {key: free.take(key.kind, key.name if view is None else view.child.name) for key, view in views.items()}
