"""Robots of imported files as parts of a text: their elements, where they stand, and which joint leads to them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.frontends.hymeko.bodies import is_base_arc
from hymeko_x.frontends.hymeko.builder import ImportedRoot
from hymeko_x.ir.mechanism import ROOT, WORLD, Id, joint_edge, pose_weight
from hymeko_x.ir.parts import Joint, World
from hymeko_x.ir.values import IDENTITY, Pose, compose, inverse
from hymeko_x.joining import held, on_body, with_names
from hymeko_x.language.expansion import Amendment, Instance
from hymeko_x.language.syntax import ArcItem, Comment, Field, Node, Ref, is_field
from hymeko_x.language.templates import is_definition

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.frontends.hymeko.builder import HymekoBuilder
    from hymeko_x.ir.mechanism import Mechanism, RobotArc, RobotEdge
    from hymeko_x.language.expansion import Expanded
    from hymeko_x.source import Parts

_HOSTS = ("body", "world", "frame")
_PLACES = ("at",)


class Imported(Struct):
    """An instance with its robot, whose names have their prefix, and the robot as its file has it."""

    instance: Instance
    robot: Mechanism
    original: Mechanism
    floor: Pose = IDENTITY
    """Where its world is in the world of the text."""

    @property
    def name(self) -> str:
        """The full name of the instance."""
        return self.instance.scope.full(self.instance.node.name)

    def renamed(self, name: str) -> str:
        """A name of the robot as this text has it."""
        return self.instance.inner.prefix + name


def read_instances(builder: HymekoBuilder, expanded: Expanded, parts: Parts | None) -> dict[int, Imported]:
    """The robots of a text's instances, by the identity of the instance; each file is read once per set of arguments.

    Raises: Refusal (HX040) for a file that is not there, and whatever reading it raises.
    """
    found: dict[int, Imported] = {}
    for item in expanded.items:
        if not isinstance(item, Instance):
            continue
        origin = builder.reader.origin(item.node)
        if parts is None:
            raise refuse(codes.UNDEFINED_REFERENCE, "robots cannot be imported here: there are no other files", origin)
        robot = parts(item.source.path, item.arguments, origin)
        prefix = item.inner.prefix
        found[id(item)] = Imported(item, with_names(robot, prefix.__add__), robot)
        item.inner.elements.update(key.name for table in (robot.graph.vertices, robot.graph.edges) for key in table if key != WORLD)
    return found


def declare_instance(builder: HymekoBuilder, imported: Imported) -> None:
    """Add the elements of an imported robot, with everything that is known of them; its world is left out."""
    robot, graph = imported.robot, imported.robot.graph
    for table in (graph.vertices, graph.edges):
        for key in table:
            if key != WORLD:
                builder.reserve(key.kind, key.name, imported.instance.node)
    builder.vertices.update({key: part for key, part in graph.vertices.items() if key != WORLD})
    builder.edges.update(graph.edges)
    start = len(builder.layout)
    builder.layout += [key for key in robot.layout if key != WORLD]
    builder.origins.update(robot.origins)
    builder.notations.update({key: dict(found) for key, found in robot.notations.items() if key not in (ROOT, WORLD)})
    builder.stereotypes.update(robot.stereotypes)
    builder.places.update(robot.places)
    builder.stored.update(robot.stored)
    for key, extras in robot.extras.items():
        shift = start if key == ROOT else 0
        builder.add_extras(key, *(replace(extra, index=extra.index + shift) for extra in extras))
    builder.imported[imported.name] = ImportedRoot(tuple(robot.roots), _frame_of_world(robot))


def _frame_of_world(robot: Mechanism) -> Pose:
    """The frame of the robot's world in its first root, at the reference of the joint between them."""
    for root in robot.roots[:1]:
        joint = robot.parent_joint.get(root)
        if joint is not None:
            return compose(joint.child_pose, inverse(joint.parent_pose))
    return IDENTITY


# ---- placing -------------------------------------------------------------------------------------------------------------------


def changes_in(imported: Imported) -> Iterator[Amendment]:
    """The changes in the block of an instance: its nodes, each called as an element of the robot."""
    for item in imported.instance.node.items:
        if isinstance(item, Node) and not is_definition(item):
            yield Amendment(item, imported.instance.inner)


def place_instance(builder: HymekoBuilder, imported: Imported, owners: dict[Id, tuple[Id, RobotArc]]) -> None:
    """Put what stands in the robot's own world where its block says, or where the text's joint to its root leads.

    ``owners`` has the body and the arc of each frame. Raises: Refusal (HX062) for a block with anything else, and for two places.
    """
    roots = imported.robot.roots
    place = _place(builder, imported, owners)
    taken = _joint_of_text(builder, imported)
    if place is not None and taken is not None:
        message = f"{taken} leads to '{imported.name}', and its block places it as well; one of them is enough"
        raise builder.reader.refuse(imported.instance.node, message)
    if taken is not None:
        place = _parent_of(builder.edges[taken])
    if place is not None and place[0] == WORLD and taken is None:
        imported.floor = place[1]
    gone = _without_joints(builder, imported, place, taken)
    if place is not None and taken is None:
        _hold_open_roots(builder, imported, place, [root for root in roots if root not in imported.robot.parent_joint])
    _forget(builder, imported, gone)
    used = any(arc.target == WORLD for key in imported.robot.graph.edges if key in builder.edges for arc in builder.edges[key].arcs)
    if used:
        builder.vertices.setdefault(WORLD, World())


def _place(builder: HymekoBuilder, imported: Imported, owners: dict[Id, tuple[Id, RobotArc]]) -> tuple[Id, Pose] | None:
    """The body on which the robot's world is, and where: from the arc or the field ``at`` of its block."""
    reader, node = builder.reader, imported.instance.node
    found: list[tuple[Id, Pose]] = []
    for item in node.items:
        if isinstance(item, ArcItem) and is_base_arc(item):
            target = builder.target(item.ref, imported.instance.scope, _HOSTS, item)
            found.append(_on(target, IDENTITY if item.weight is None else reader.pose(item.weight, item), owners))
        elif isinstance(item, Field) and is_field(item, _PLACES):
            if isinstance(item.value, Ref) and not item.value.direction:
                found.append(_on(builder.target(item.value, imported.instance.scope, _HOSTS, item), IDENTITY, owners))
            else:
                found.append((builder.world(), reader.pose(item.value, item)))
        elif not isinstance(item, Node | Comment):
            name = item.ref.dotted if isinstance(item, ArcItem) else getattr(item, "name", "import")
            hint = f"its place is [pose] + body, at=body, or at [pose] in the world; a change of an element is {node.name}.element {{ .. }}"
            raise reader.refuse(item, f"'{name}' has no meaning in the block of the robot '{node.name}'", hint=hint)
    if len(found) > 1:
        raise reader.refuse(node, f"'{imported.name}' is placed {len(found)} times")
    if found and found[0][0] != WORLD and found[0][0] in imported.robot.graph.vertices:
        raise reader.refuse(node, f"'{imported.name}' is placed on itself: on {found[0][0]}")
    return found[0] if found else None


def _on(target: Id, pose: Pose, owners: dict[Id, tuple[Id, RobotArc]]) -> tuple[Id, Pose]:
    """The body of a frame, and the pose there."""
    if target.kind != "frame" or target not in owners:
        return target, pose
    body, arc = owners[target]
    return body, compose(pose_weight(arc), pose)


def frames_on_bodies(builder: HymekoBuilder) -> dict[Id, tuple[Id, RobotArc]]:
    """For each frame the body that it is on, with the arc whose weight is its pose."""
    found: dict[Id, tuple[Id, RobotArc]] = {}
    for key, edge in builder.edges.items():
        if key.kind == "mount":
            body = next((arc for arc in edge.arcs if arc.sign > 0), None)
            found.update({arc.target: (body.target, body) for arc in edge.arcs if body is not None and arc.target.kind == "frame"})
    return found


def _joint_of_text(builder: HymekoBuilder, imported: Imported) -> Id | None:
    """The joint of another part of the text that leads to a root of the robot."""
    roots, own = set(imported.robot.roots), imported.robot.graph.edges
    for key, edge in builder.edges.items():
        if key.kind == "joint" and key not in own and any(arc.sign < 0 and arc.target in roots for arc in edge.arcs):
            return key
    return None


def _parent_of(edge: RobotEdge) -> tuple[Id, Pose]:
    parent = next(arc for arc in edge.arcs if arc.sign > 0)
    return parent.target, pose_weight(parent)


def _without_joints(builder: HymekoBuilder, imported: Imported, place: tuple[Id, Pose] | None, taken: Id | None) -> set[Id]:
    """Put the arcs to the robot's world on the body of its place; returns the joints that the text's joint stands for."""
    gone: set[Id] = set()
    child = None if taken is None else next(arc.target for arc in builder.edges[taken].arcs if arc.sign < 0)
    for key in imported.robot.graph.edges:
        edge = builder.edges[key]
        if all(arc.target != WORLD for arc in edge.arcs):
            continue
        if isinstance(edge.data, Joint) and child is not None and any(arc.target == child for arc in edge.arcs):
            gone.add(key)
        elif place is not None:
            arcs = tuple([on_body(arc, *place) if arc.target == WORLD else arc for arc in edge.arcs])
            builder.edges[key] = replace(edge, data=held(edge.data, place[0]), arcs=arcs)
    return gone


def _hold_open_roots(builder: HymekoBuilder, imported: Imported, place: tuple[Id, Pose], roots: list[Id]) -> None:
    for root in roots:
        key = builder.name_after_place("joint", f"{root.name}_joint", imported.instance.node)
        builder.edges[key] = joint_edge(Joint(), place[0], root, place[1])
        builder.layout.append(key)


def _forget(builder: HymekoBuilder, imported: Imported, gone: set[Id]) -> None:
    """Take joints away with the arcs to them: of named configurations the arc alone, of everything else the edge."""
    if not gone:
        return
    for key in imported.robot.graph.edges:
        edge = builder.edges[key]
        kept = tuple([arc for arc in edge.arcs if arc.target not in gone])
        if len(kept) == len(edge.arcs):
            continue
        if key.kind == "stance":
            builder.edges[key] = replace(edge, arcs=kept)
        else:
            gone.add(key)
    for key in gone:
        del builder.edges[key]
        for table in (builder.extras, builder.notations, builder.stereotypes, builder.origins, builder.stored):
            table.pop(key, None)
    builder.layout = [key for key in builder.layout if key not in gone]
