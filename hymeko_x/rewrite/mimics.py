"""Followers behind their leaders: for programs that build the tree in one pass, and know a joint only once they have met it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from hymeko_x import codes
from hymeko_x.ir.mechanism import coupling_edge, numbers_weight
from hymeko_x.ir.parts import Coupling, DofKind, Drive, Tendon

if TYPE_CHECKING:
    from collections.abc import Container, Iterator, Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc, RobotEdge
    from hymeko_x.rewrite.context import Context


class _Line(NamedTuple):
    """q_follower = offset + multiplier * q_leader."""

    offset: float
    multiplier: float

    def after(self, other: _Line) -> _Line:
        """This line of what follows the other one."""
        return _Line(self.offset + self.multiplier * other.offset, self.multiplier * other.multiplier)

    @property
    def inverse(self) -> _Line:
        return _Line(-self.offset / self.multiplier, 1.0 / self.multiplier)


def put_leaders_first(mechanism: Mechanism, context: Context) -> Mechanism:
    """Joints that follow each other in a line all follow the one that comes first in the tree, in the order of their joints' names.

    That is the order of urdfdom, and so that of Pinocchio. Only groups with a follower before its leader, or as one, change.
    """
    return _reported(mechanism, leaders_first(mechanism), "comes first in the tree", context)


def put_driven_first(mechanism: Mechanism, context: Context) -> Mechanism:
    """As :func:`put_leaders_first`, but joints follow one with an actuator where there is one: ros2_control commands no follower."""
    driven = frozenset(driven_joints(mechanism))
    return _reported(mechanism, leaders_first(mechanism, driven), "comes first in the tree, or has the actuator", context)


def _reported(mechanism: Mechanism, turned: dict[Id, RobotEdge], why: str, context: Context) -> Mechanism:
    """The mechanism with turned couplings, each of them reported."""
    for key, edge in turned.items():
        if edge != mechanism.graph.edges[key]:
            message = f"{edge.arcs[0].target} follows {edge.arcs[1].target}, which {why} ({context.reason})"
            context.report.note(codes.FOR_TARGET, message, mechanism.origin(key), element=str(key))
    return mechanism.replace(edges=turned)


def driven_joints(mechanism: Mechanism) -> Iterator[Id]:
    """The joints that an actuator drives, by itself or by a tendon."""
    for _, _, arcs in mechanism.edges(Drive):
        for arc in arcs:
            tendon = mechanism.graph.edges.get(arc.target) if arc.sign < 0 else None
            yield from [arc.target] if tendon is None or not isinstance(tendon.data, Tendon) else [end.target for end in tendon.arcs]


def moving_joints(mechanism: Mechanism) -> list[Id]:
    """The joints with one hinge or slide, in the order of the tree."""
    place = {body: number for number, body in enumerate(mechanism.depth_first())}
    views = sorted(mechanism.joints.values(), key=lambda view: place.get(view.child, len(place)))
    return [view.id for view in views if [dof.kind for dof in view.joint.dofs] in ([DofKind.HINGE], [DofKind.SLIDE])]


def leaders_first(mechanism: Mechanism, driven: Container[Id] = ()) -> dict[Id, RobotEdge]:
    """The couplings of those groups as they are when all follow one joint: the one that comes first, a driven one before all others."""
    lines = dict(_lines(mechanism))
    order = _visited(mechanism) if lines else {}
    turned: dict[Id, RobotEdge] = {}
    for group in _groups(lines):
        joints = {joint for key in group for joint in (lines[key].follower, lines[key].leader)}
        first = min(joints, key=lambda joint: (joint not in driven, order[joint]))
        if (first in driven and any(lines[key].follower == first for key in group)) or _is_late(
            [lines[key] for key in group], first, order
        ):
            turned |= _turned(group, lines, first)
    return turned


def _is_late(group: list[_Mimic], first: Id, order: Mapping[Id, int]) -> bool:
    """Whether a joint of a group follows one behind it in the tree, or one that follows as well; none does where all follow the first."""
    following = {mimic.follower for mimic in group}
    is_late = any(order[mimic.follower] < order[mimic.leader] or mimic.leader in following for mimic in group)
    return is_late and any(mimic.leader != first for mimic in group)


class _Mimic(NamedTuple):
    follower: Id
    leader: Id
    line: _Line
    active: bool


def _lines(mechanism: Mechanism) -> Iterator[tuple[Id, _Mimic]]:
    """The couplings that are an invertible line between two joints of the tree."""
    for key, coupling, arcs in mechanism.edges(Coupling):
        followers, leaders = ([arc for arc in arcs if arc.sign * sign > 0] for sign in (1, -1))
        if len(followers) != 1 or len(leaders) != 1 or not all(_is_scalar(arc, mechanism) for arc in arcs):
            continue
        weights = (*numbers_weight(leaders[0]), 0.0, 0.0)
        if weights[1] and not any(weights[2:]) and followers[0].target != leaders[0].target:
            yield key, _Mimic(followers[0].target, leaders[0].target, _Line(*weights[:2]), coupling.active)


def _is_scalar(arc: RobotArc, mechanism: Mechanism) -> bool:
    view = mechanism.joints.get(arc.target)
    return view is not None and len(view.joint.dofs) == 1 and mechanism.parent_joint[view.child] == view


def _visited(mechanism: Mechanism) -> Mapping[Id, int]:
    """The number of each joint on the way through the tree, children in order of their joints' names."""
    found: dict[Id, int] = {}
    above = mechanism.parent_joint
    stack = sorted(mechanism.roots, key=lambda key: above[key].id.name if key in above else f"{key.name}_base", reverse=True)
    while stack:
        body = stack.pop()
        if body in above:
            found[above[body].id] = len(found)
        below = (joint for joint in mechanism.children.get(body, ()) if above[joint.child].id == joint.id)
        stack += [joint.child for joint in sorted(below, key=lambda joint: joint.id.name, reverse=True)]
    return found


def _groups(lines: Mapping[Id, _Mimic]) -> Iterator[list[Id]]:
    """The couplings that share joints, together."""
    of_joint: dict[Id, list[Id]] = {}
    for key, mimic in lines.items():
        of_joint.setdefault(mimic.follower, []).append(key)
        of_joint.setdefault(mimic.leader, []).append(key)
    seen: set[Id] = set()
    for start in lines:
        group, waiting = [], [start]
        while waiting:
            key = waiting.pop()
            if key in seen:
                continue
            seen.add(key)
            group.append(key)
            waiting += [other for joint in (lines[key].follower, lines[key].leader) for other in of_joint[joint] if other not in seen]
        if group:
            yield group


def _turned(group: list[Id], lines: Mapping[Id, _Mimic], first: Id) -> dict[Id, RobotEdge]:
    """The couplings of a group with one joint as the leader of all. A joint that is reached twice keeps its first line."""
    beside: dict[Id, list[tuple[Id, Id, _Line]]] = {}
    for key in group:
        mimic = lines[key]
        beside.setdefault(mimic.leader, []).append((key, mimic.follower, mimic.line))
        beside.setdefault(mimic.follower, []).append((key, mimic.leader, mimic.line.inverse))
    found: dict[Id, _Line] = {first: _Line(0.0, 1.0)}
    edges: dict[Id, RobotEdge] = {}
    waiting = [first]
    while waiting:
        joint = waiting.pop()
        for key, other, line in beside[joint]:
            if other in found or key in edges:
                continue
            found[other] = line.after(found[joint])
            edges[key] = coupling_edge(other, ((first, tuple(found[other])),), active=lines[key].active)
            waiting.append(other)
    return edges
