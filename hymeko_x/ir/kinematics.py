"""Dofs and poses of a mechanism's tree."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Coupling, DofKind, Drive, Joint, Sense, Tendon
from hymeko_x.ir.values import IDENTITY, ZERO, Pose, add, compose, inverse, quat_about, rotate, scaled

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc, RobotEdge
    from hymeko_x.ir.parts import Dof
    from hymeko_x.ir.values import Quat, Vec3

    Dofs = Mapping[tuple[Id, int], tuple[Id, str]]


def dof_number(joint: Joint, role: str) -> int | None:
    """The number of the dof that an arc's role means: by name, else by number, else the only one. None when there is none."""
    for number, dof in enumerate(joint.dofs):
        if role and dof.name == role:
            return number
    if role.isascii() and role.isdigit() and int(role) < len(joint.dofs):
        return int(role)
    return 0 if not role and len(joint.dofs) == 1 else None


def dof_at(edges: Mapping[Id, RobotEdge], arc: RobotArc) -> tuple[int, Dof] | None:
    """The dof to which an arc leads, with its number in its joint; None where it leads to no single dof."""
    edge = edges.get(arc.target)
    if edge is None or not isinstance(edge.data, Joint):
        return None
    number = dof_number(edge.data, arc.role)
    return None if number is None else (number, edge.data.dofs[number])


def edges_to_moved_dofs(mechanism: Mechanism, moved: Dofs) -> dict[Id, RobotEdge]:
    """The couplings, drives, senses and tendons with arcs to dofs that move, with these arcs to the new places.

    ``moved`` has the new joint and role of each dof that moves, by its joint and number.
    """
    joints = {joint for joint, _ in moved}
    return {
        key: replace(edge, arcs=tuple([_moved_arc(arc, mechanism, moved) for arc in edge.arcs]))
        for key, edge in mechanism.graph.edges.items()
        if isinstance(edge.data, Coupling | Drive | Sense | Tendon) and any(arc.target in joints for arc in edge.arcs)
    }


def _moved_arc(arc: RobotArc, mechanism: Mechanism, moved: Dofs) -> RobotArc:
    found = dof_at(mechanism.graph.edges, arc)
    if found is None or (arc.target, found[0]) not in moved:
        return arc
    target, role = moved[arc.target, found[0]]
    return replace(arc, target=target, role=role)


def displacement(dof: Dof, by: float) -> Pose:
    """The motion of a joint's frame when a dof with one coordinate is ``by`` (m or rad) from its reference; none for other dofs."""
    if not by or dof.kind in (DofKind.BALL, DofKind.FREE):
        return IDENTITY
    if dof.kind is DofKind.SLIDE:
        return Pose(add(ZERO, scaled(dof.axis, by)))  # a sum has no negative zeros
    return turn_about(dof.anchor, quat_about(dof.axis, by), scaled(dof.axis, dof.pitch * by))


def turn_about(anchor: Vec3, turn: Quat, shift: Vec3 = ZERO) -> Pose:
    """A turn that keeps the anchor in place, followed by a shift."""
    return Pose(add(add(anchor, scaled(rotate(turn, anchor), -1.0)), shift), turn)


def reference_poses(mechanism: Mechanism) -> dict[Id, Pose]:
    """The pose of each body, in the world or its own root, where every coordinate is at its reference. Not recursive."""
    poses: dict[Id, Pose] = {WORLD: IDENTITY}
    for body in mechanism.depth_first():
        above = mechanism.parent_joint.get(body)
        poses[body] = IDENTITY if above is None else below(poses.get(above.parent, IDENTITY), above.parent_pose, above.child_pose)
    return poses


def below(parent: Pose, parent_pose: Pose, child_pose: Pose) -> Pose:
    """The pose of a joint's child at its reference, given the pose of its parent and the joint's pose in both."""
    return compose(parent, compose(parent_pose, inverse(child_pose)))
