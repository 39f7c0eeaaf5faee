"""Links that only hold the end of a closure, which SDF needs between links that a joint joins already; other formats do not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.formats import sdf as words
from hymeko_x.ir.mechanism import Id, pose_weight
from hymeko_x.ir.parts import Body, Loop
from hymeko_x.ir.values import IDENTITY, compose, inverse
from hymeko_x.rewrite.inertia import LEAST

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import JointView, Mechanism, RobotArc, RobotEdge


def without_anchors(mechanism: Mechanism) -> Mechanism:
    """The mechanism in which the closures join the links themselves."""
    edges: dict[Id, RobotEdge] = {}
    gone: list[Id] = []
    for key, _, arcs in mechanism.edges(Loop):
        holders = {arc.target: holder for arc in arcs if (holder := _holder(arc.target, key, mechanism)) is not None}
        if holders:
            edges[key] = replace(mechanism.graph.edges[key], arcs=tuple([_moved(arc, holders.get(arc.target)) for arc in arcs]))
            gone += [*holders, *(holder.id for holder in holders.values())]
    return mechanism.replace(edges=edges, without=gone)


def _holder(body: Id, closure: Id, mechanism: Mechanism) -> JointView | None:
    """The joint that holds the link of a closure's end; None for a link that is more than that."""
    holder = mechanism.parent_joint.get(body)
    part = mechanism.graph.vertices.get(body)
    if body.name != f"{closure.name}{words.ANCHOR}" or holder is None or holder.joint.dofs or not isinstance(part, Body):
        return None
    is_used = mechanism.shapes.get(body) or mechanism.mounts.get(body) or mechanism.children.get(body)
    mass = 0.0 if part.inertial is None else part.inertial.mass or 0.0
    return None if is_used or mass > LEAST or len([*mechanism.graph.edges_at(body)]) != 2 else holder


def _moved(arc: RobotArc, holder: JointView | None) -> RobotArc:
    """The end on the link to which the joint of its anchor leads."""
    if holder is None:
        return arc
    pose = compose(compose(holder.parent_pose, inverse(holder.child_pose)), pose_weight(arc))
    return replace(arc, target=holder.parent, weight=None if pose == IDENTITY else pose)
