"""Bodies that do not move against each other as one body."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import pipeline
from hymeko_x.ir.kinematics import below
from hymeko_x.ir.mechanism import ROOT, WORLD, Id, Mechanism, pose_weight
from hymeko_x.ir.parts import Body, Contact, Inertial
from hymeko_x.ir.solids import Solid, joined
from hymeko_x.ir.values import IDENTITY, Pose, apply, compose, rotate_tensor
from hymeko_x.rewrite.references import named_in, targets
from hymeko_x.robot.errors import unknown_name

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.ir.mechanism import RobotArc, RobotEdge

_NO_TENSOR = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
Places = dict[Id, tuple[Id, Pose]]
"""By body, the body that it becomes a part of, and its pose there."""


def merge_fixed(mechanism: Mechanism, keep: Iterable[str]) -> Mechanism:
    """Every body that a joint without dofs attaches to another body becomes a part of that one, except for those to keep.

    Shapes, frames, joints and relations move along; inertials are added. What is fixed to the world stays a body, and so do bodies that
    a camera, a light or an extra of the whole names. Elements of what is merged have all that they inherited from classes.

    Raises: KeyError for a body to keep that is not there.
    """
    kept = [Id("body", name) for name in keep]
    for key in kept:
        if key not in mechanism.graph.vertices:
            raise unknown_name("body", key.name, [body.name for body, _ in mechanism.vertices(Body)])
    places = _places(mechanism, frozenset(kept) | targets(mechanism) | named_in(mechanism.extras.get(ROOT, ())))
    if not places:
        return mechanism
    mechanism = pipeline.flattened(mechanism)
    joints = {mechanism.parent_joint[key].id for key in places}
    edges = {key: _moved(edge, places) for key, edge in mechanism.graph.edges.items() if any(arc.target in places for arc in edge.arcs)}
    idle = {
        key for key, edge in edges.items() if isinstance(edge.data, Contact) and len({arc.target for arc in edge.arcs}) < len(edge.arcs)
    }
    graph = mechanism.graph.replace(vertices=_inertials(mechanism, places), edges=edges, without={*places, *joints, *idle})
    there = {key: found for key, found in mechanism.extras.items() if key not in places and key not in joints and key not in idle}
    layout = tuple(key for key in mechanism.layout if key not in places and key not in joints and key not in idle)
    return replace(mechanism, graph=graph, extras=there, layout=layout)


def _places(mechanism: Mechanism, kept: frozenset[Id]) -> Places:
    places: Places = {}
    for body in mechanism.depth_first():
        joint = mechanism.parent_joint.get(body)
        if joint is None or joint.joint.dofs or joint.parent == WORLD or body in kept:
            continue
        pose = below(IDENTITY, joint.parent_pose, joint.child_pose)
        top, there = places.get(joint.parent, (joint.parent, IDENTITY))
        places[body] = (top, compose(there, pose))
    return places


def _moved(edge: RobotEdge, places: Places) -> RobotEdge:
    return replace(edge, arcs=tuple([_moved_arc(arc, places) for arc in edge.arcs]))


def _moved_arc(arc: RobotArc, places: Places) -> RobotArc:
    if arc.target not in places:
        return arc
    body, pose = places[arc.target]
    if arc.weight is not None and not isinstance(arc.weight, Pose):
        return replace(arc, target=body)
    weight = compose(pose, pose_weight(arc))
    return replace(arc, target=body, weight=None if weight == IDENTITY else weight)


# ---- inertials -----------------------------------------------------------------------------------------------------------------


def _inertials(mechanism: Mechanism, places: Places) -> dict[Id, Body]:
    """The bodies that others become a part of, with the inertials of all of them together."""
    members: dict[Id, list[Inertial]] = {}
    for key, (top, pose) in places.items():
        inertial = mechanism.vertex(key, Body).inertial
        if inertial is not None:
            members.setdefault(top, []).append(_seen_from(inertial, pose))
    found: dict[Id, Body] = {}
    for top, others in members.items():
        body = mechanism.vertex(top, Body)
        own = [] if body.inertial is None else [body.inertial]
        found[top] = replace(body, inertial=_sum([*own, *others]))
    return found


def _seen_from(inertial: Inertial, pose: Pose) -> Inertial:
    tensor = None if inertial.tensor is None else rotate_tensor(pose.quat, inertial.tensor)
    return Inertial(inertial.mass, apply(pose, inertial.com), tensor)


def _sum(parts: list[Inertial]) -> Inertial:
    """The inertial of several in the same frame; a mass or a tensor that one of them lacks counts as zero."""
    if len(parts) == 1:
        return parts[0]
    return joined([Solid(part.mass or 0.0, part.com, part.tensor or _NO_TENSOR) for part in parts]).inertial()
