"""Joints of several dofs as chains of joints with one dof each, in the frame of their child.

Bodies keep their frames: where a joint turns beside the frame of its child, and the format has no pose of a child in its joint, a body
without mass in between has the joint's frame.
So every body of the source is in the result, at the same place for the same coordinates.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.ir.kinematics import displacement, edges_to_moved_dofs
from hymeko_x.ir.mechanism import Id, JointView, Mechanism, joint_edge, numbers_weight
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.parts import UNLIMITED, Body, Dof, DofKind, Joint, Stance
from hymeko_x.ir.values import IDENTITY, ZERO, Pose, X, Y, Z, add, compose, inverse, quat_inverse, rpy_from_quat, scaled

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.ir.mechanism import RobotArc, RobotEdge
    from hymeko_x.ir.names import Names
    from hymeko_x.ir.values import Vec3
    from hymeko_x.rewrite.context import Context


class _Step(NamedTuple):
    """A joint of a chain: where it stands, seen from the joint before, and what moves."""

    pose: Pose
    dof: Dof
    number: int


class _Chains(Struct):
    """The links and joints that chains are made of, and the new joint and role of each old dof."""

    names: Names
    vertices: dict[Id, Body]
    edges: dict[Id, RobotEdge]
    moved: dict[tuple[Id, int], tuple[Id, str]]
    parts: dict[Id, list[tuple[Dof, list[Id]]]]
    """The old dofs of each joint, each with the joints that it has become."""
    order: dict[Id, list[Id]]
    """The joints and links that each joint has become, from the parent on."""


def chain_dofs(
    mechanism: Mechanism, context: Context, chained: list[JointView], *, keeps_balls: bool = False, poses_children: bool = False
) -> Mechanism:
    """Each of these joints becomes a chain of joints with one dof; balls stay, or become three hinges about x, y and z.

    ``poses_children``: a child may be beside its joint's frame.
    """
    if not chained:
        return mechanism
    chains = _Chains(names_in_use(mechanism), {}, {}, {}, {}, {})
    for view in chained:
        count = _add_chain(view, chains, keeps_balls=keeps_balls, poses_children=poses_children)
        if count:
            message = f"{view.id} has dofs or a frame that the format cannot represent; it is written as a chain of {count + 1} joints"
            context.report.note(codes.REWRITTEN, message, mechanism.origin(view.id), element=str(view.id))
    edges = edges_to_moved_dofs(mechanism, chains.moved) | _stances(mechanism, chains.parts) | chains.edges
    old = {view.id for view in chained}
    changed = mechanism.replace(vertices=chains.vertices, edges=edges, without=old - set(chains.edges))
    layout = tuple([key for old in mechanism.layout for key in chains.order.get(old, (old,))])
    return replace(changed, layout=layout)


def _add_chain(view: JointView, chains: _Chains, *, keeps_balls: bool, poses_children: bool) -> int:
    """Add the chain of a joint; returns how many links it adds."""
    steps, offset = _steps(view, keeps_balls=keeps_balls)
    beside, offset = (inverse(offset), IDENTITY) if steps and poses_children and offset != IDENTITY else (IDENTITY, offset)
    if not steps:
        chains.edges[view.id] = joint_edge(Joint(), view.parent, view.child, offset)
        return 0
    parent = view.parent
    keys: list[list[Id]] = [[] for _ in view.joint.dofs]
    chains.parts[view.id] = list(zip(view.joint.dofs, keys, strict=True))
    order = chains.order[view.id] = []
    for place, step in enumerate(steps):
        last = place == len(steps) - 1
        key = _joint_name(view, step, last, chains)
        chains.moved[view.id, step.number] = (key, "")
        keys[step.number].append(key)
        body = view.child if last and offset == IDENTITY else _carrier(view, key, last, chains)
        chains.edges[key] = joint_edge(Joint((step.dof,)), parent, body, step.pose, beside if last else IDENTITY)
        order += [key] if body == view.child else [key, body]
        parent = body
    if offset != IDENTITY:
        order.append(frame := chains.names.take("joint", f"{view.id.name}_frame"))
        chains.edges[frame] = joint_edge(Joint(), parent, view.child, offset)
    return len(steps) - (offset == IDENTITY)


def _carrier(view: JointView, moving: Id, last: bool, chains: _Chains) -> Id:
    """A new link without mass that a joint moves: called after the joint, the last one of a chain after the child that it carries."""
    body = chains.names.take("body", f"{view.child.name}_carrier" if last else f"{moving.name}_link")
    chains.vertices[body] = Body()
    return body


def _joint_name(view: JointView, step: _Step, last: bool, chains: _Chains) -> Id:
    """The dof's own name if it has one; the last nameless one keeps the joint's unless a dof has it, the others are numbered."""
    name = view.id.name
    is_nameless_last = last and step.dof.name is None and all(dof.name != name for dof in view.joint.dofs)
    if is_nameless_last or (step.dof.name == name and view.id not in chains.edges):
        return view.id
    return chains.names.take("joint", step.dof.name or f"{view.id.name}_{step.number + 1}")


_WIDTHS: Mapping[DofKind, int] = MappingProxyType({DofKind.BALL: 4, DofKind.FREE: 7})
"""How many coordinates a dof has; one for all others."""


def _stances(mechanism: Mechanism, parts: Mapping[Id, list[tuple[Dof, list[Id]]]]) -> dict[Id, RobotEdge]:
    """The named configurations that have coordinates of joints that became chains, with those of the joints of the chains."""
    return {
        key: replace(edge, arcs=tuple(new for arc in edge.arcs for new in _arcs_of(arc, parts.get(arc.target))))
        for key, edge in mechanism.graph.edges.items()
        if isinstance(edge.data, Stance) and any(arc.target in parts for arc in edge.arcs)
    }


def _arcs_of(arc: RobotArc, parts: list[tuple[Dof, list[Id]]] | None) -> Iterator[RobotArc]:
    """The coordinates of a joint as those of the joints that it became, if they are as many as it has."""
    numbers = numbers_weight(arc)
    if parts is None or len(numbers) != sum(_WIDTHS.get(dof.kind, 1) for dof, _ in parts):
        yield arc
        return
    start = 0
    for dof, keys in parts:
        own = numbers[start : (start := start + _WIDTHS.get(dof.kind, 1))]
        if len(keys) == 1:
            yield replace(arc, target=keys[0], weight=own)
        else:
            yield from (replace(arc, target=key, weight=(angle,)) for key, angle in zip(keys, _turns(own), strict=True))


def _turns(numbers: tuple[float, ...]) -> Vec3:
    """The angles about x, y and z, each in the frame that the one before has turned, in rad, of a quaternion (w, x, y, z)."""
    w, x, y, z = numbers
    roll, pitch, yaw = rpy_from_quat(quat_inverse((w, x, y, z)))
    return -roll, -pitch, -yaw


def _steps(view: JointView, *, keeps_balls: bool) -> tuple[list[_Step], Pose]:
    """The joints of the chain, each with its frame in the one before, and the child's frame in the last one.

    Tr(a) M(q - ref) Tr(-a) is a joint at Tr(a) M(-ref) with the same axis and coordinate, followed by Tr(-a).
    """
    steps = []
    frame = view.parent_pose
    for number, dof in enumerate(view.joint.dofs):
        for single in [dof] if keeps_balls else _singles(dof, dof.name or view.id.name):
            at = compose(frame, Pose(dof.anchor))
            centred = replace(single, anchor=ZERO, ref=0.0)
            steps.append(_Step(compose(at, displacement(centred, -dof.ref)), centred, number))
            frame = Pose(add(ZERO, scaled(dof.anchor, -1.0)))  # a sum has no negative zeros
    if not steps:
        return [], compose(frame, inverse(view.child_pose))
    return steps, compose(frame, inverse(view.child_pose))


def _singles(dof: Dof, name: str) -> list[Dof]:
    """The dof itself, or three hinges for a ball of this name; their damping and friction are those of the ball.

    The last one of a ball without a name of its own has none either, so that it keeps that of the joint where it can.
    """
    if dof.kind is not DofKind.BALL:
        return [dof]
    same = replace(dof, kind=DofKind.HINGE, limits=UNLIMITED, written=None)
    names = (f"{name}_x", f"{name}_y", f"{name}_z" if dof.name else None)
    return [replace(same, axis=axis, name=own) for axis, own in zip((X, Y, Z), names, strict=True)]
