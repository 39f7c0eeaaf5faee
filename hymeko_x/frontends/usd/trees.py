"""From an undirected graph of joints to trees and loops, the same way every time.

Joints that UsdPhysics excludes from the articulation, and in stage order every further one that closes a cycle, become
loops. The others are directed away from the world, from articulation roots, or from bodies that no joint has as body1.
"""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING

from hymeko_x.formats import usd as words
from hymeko_x.formats.usd.joints import DISTANCE, opposite
from hymeko_x.frontends.usd.joints import merge_parallel
from hymeko_x.ir.graph import Arc, Edge, Hypergraph
from hymeko_x.ir.kinematics import reference_poses
from hymeko_x.ir.mechanism import WORLD, Id, Mechanism, joint_edge
from hymeko_x.ir.parts import Dof, DofKind, Joint, Loop, World
from hymeko_x.ir.values import rotation_angle

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.frontends.usd.builder import UsdBuilder
    from hymeko_x.frontends.usd.joints import JointEnd, ReadJoint
    from hymeko_x.ir.mechanism import RobotArc
    from hymeko_x.ir.parts import Parameters

_NEAR = 1e-7
FREE_SUFFIX = "_free"


def build_trees(joints: list[ReadJoint], roots: Iterable[Id], held: Iterable[Id], builder: UsdBuilder) -> list[ReadJoint]:
    """Add every joint as an edge of a tree or as a loop, and a free joint above each body that is left without one.

    Returns the joints as they are in the result. ``roots`` are the bodies that have an articulation root, ``held`` those
    whose simulation is switched off: they are fixed.
    """
    joints = merge_parallel(joints, builder)
    tree, loops = _split(joints)
    above = _directed(tree, [*roots], builder)
    if any(joint.ends[side].body == WORLD for joint in joints for side in (0, 1)):
        builder.vertices.setdefault(WORLD, World())
    for joint in joints:
        if joint.id in loops:
            _add_loop(joint, builder)
        else:
            _add_joint(joint, joint.id in above, builder)
    _join_free_bodies({end.body for joint in tree for end in [_child(joint, above)]}, set(held), builder)
    return joints


def note_poses(builder: UsdBuilder) -> None:
    """Note the pose of a body's prim where that is not the one that its joints give: only their frames count for the robot."""
    poses = reference_poses(Mechanism("", Hypergraph(builder.vertices, builder.edges)))
    for path, body in builder.bodies.items():
        pose, given = builder.transforms.of(builder.prim_at(path)).pose, poses[body]
        if not (math.dist(given.xyz, pose.xyz) < _NEAR and rotation_angle(given.quat, pose.quat) < _NEAR):
            builder.note(body, words.POSE, pose)


def _split(joints: list[ReadJoint]) -> tuple[list[ReadJoint], set[Id]]:
    """The joints of the spanning trees, and those that close cycles. Joins components in stage order."""
    leader: dict[Id, Id] = {}
    tree, loops = [], set()
    for joint in joints:
        first, second = (_leader(end.body, leader) for end in joint.ends)
        if joint.is_excluded or not joint.is_enabled or joint.prim.kind == DISTANCE or first == second:
            loops.add(joint.id)
            continue
        leader[second] = first
        tree.append(joint)
    return tree, loops


def _leader(body: Id, leader: dict[Id, Id]) -> Id:
    """The representative of a body's component; the way there is halved on each visit."""
    while leader.setdefault(body, body) != body:
        leader[body] = leader[leader[body]]
        body = leader[body]
    return body


def _directed(tree: list[ReadJoint], roots: list[Id], builder: UsdBuilder) -> set[Id]:
    """The joints whose parent is their body1. Breadth first from each component's root."""
    ends: dict[Id, list[tuple[ReadJoint, int]]] = {}
    for joint in tree:
        for side in (0, 1):
            ends.setdefault(joint.ends[side].body, []).append((joint, side))
    below = {joint.ends[1].body for joint in tree}
    first = [WORLD, *roots, *(body for body in builder.bodies.values() if body not in below), *builder.bodies.values()]
    turned: set[Id] = set()
    seen: set[Id] = set()
    for root in first:
        if root in seen or root not in ends:
            continue
        seen.add(root)
        waiting = deque([root])
        while waiting:
            for joint, side in ends[waiting.popleft()]:
                other = joint.ends[1 - side].body
                if other not in seen:
                    seen.add(other)
                    waiting.append(other)
                    turned.update([joint.id] if side == 1 else [])
    return turned


def _child(joint: ReadJoint, turned: set[Id]) -> JointEnd:
    return joint.ends[0] if joint.id in turned else joint.ends[1]


# ---- edges -------------------------------------------------------------------------------------------------------------------


def _add_joint(joint: ReadJoint, is_turned: bool, builder: UsdBuilder) -> None:
    """A turned joint moves the other way: its dofs are in reverse order with opposite axes, so that coordinates keep their sign."""
    parent, child = (joint.ends[1], joint.ends[0]) if is_turned else joint.ends
    dofs = joint.dofs
    if is_turned:
        dofs = tuple(opposite(dof) for dof in reversed(dofs))
        builder.note(joint.id, words.REVERSED, True)
    builder.edges[joint.id] = joint_edge(Joint(dofs), parent.body, child.body, parent.pose, child.pose)


def _add_loop(joint: ReadJoint, builder: UsdBuilder) -> None:
    """A closure under the joint's name: weld, connect, distance, or a joint of its dofs."""
    kind, dofs, parameters = _loop_kind(joint, builder)
    key = builder.names.take("loop", joint.id.name)
    arcs: tuple[RobotArc, ...] = tuple(Arc(end.body, 0, end.pose) for end in joint.ends)
    builder.edges[key] = Edge(Loop(kind, dofs, joint.is_enabled, parameters), arcs)
    builder.origins[key] = builder.origin_of(joint.prim)
    builder.notations[key] = builder.notations.pop(joint.id, {})
    builder.note(key, words.TYPE, joint.prim.kind)
    builder.elements[joint.prim.path] = [key]
    builder.mark_read(joint.prim, "physics:jointEnabled")
    builder.mark_read(joint.prim, "physics:excludeFromArticulation")
    if not joint.is_excluded:
        builder.note(key, words.ARTICULATED, True)


def _loop_kind(joint: ReadJoint, builder: UsdBuilder) -> tuple[str, tuple[Dof, ...], Parameters]:
    if joint.prim.kind == DISTANCE:
        found: list[tuple[str, float | str | tuple[float, ...]]] = []
        for name in ("minDistance", "maxDistance"):
            value = builder.number(joint.prim, f"physics:{name}", -1.0)
            if value >= 0.0:
                found.append((name, value * builder.scene.metres))
        return "distance", (), tuple(found)
    if not joint.dofs:
        return "weld", (), ()
    if len(joint.dofs) == 1 and joint.dofs[0].kind is DofKind.BALL:
        return "connect", (), ()
    return "joint", joint.dofs, ()


def _join_free_bodies(children: set[Id], held: set[Id], builder: UsdBuilder) -> None:
    """In UsdPhysics a body without a parent joint falls: it gets a free joint at its pose."""
    for path, body in builder.bodies.items():
        if body in children:
            continue
        prim = builder.prim_at(path)
        key = builder.new_id(prim, "joint", body.name + FREE_SUFFIX)
        dofs = () if body in held else (Dof(DofKind.FREE),)
        if body in held:
            builder.note(key, words.HELD, True)
        builder.vertices.setdefault(WORLD, World())
        builder.edges[key] = joint_edge(Joint(dofs), WORLD, body, builder.transforms.of(prim).pose)
