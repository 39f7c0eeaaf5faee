"""Graphs that are no forest, for formats that nest bodies: what closes a loop leaves the tree and becomes a closure."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import Id, JointView, Mechanism, mount_edge, pose_weight
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.parts import Body, DofKind, Frame, Joint, Loop
from hymeko_x.ir.values import IDENTITY, Pose, add, compose, scaled

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import RobotArc, RobotEdge
    from hymeko_x.rewrite.context import Context

_APART = 0.1
"""Distance in m of the two points on a hinge's axis that are held together."""


def open_second_parents(mechanism: Mechanism, context: Context) -> Mechanism:
    """A joint that leads to a body which another joint holds already, or that closes a cycle, becomes closures."""
    extra = [view for view in mechanism.joints.values() if mechanism.parent_joint[view.child] != view]
    extra += _closing_cycles(mechanism)
    if not extra:
        return mechanism
    names = names_in_use(mechanism)
    edges: dict[Id, RobotEdge] = {}
    for view in extra:
        closures = _closures(view, Loop())
        words = "it is written as a closure of the loop" if closures else "a loop cannot be closed by such a joint, which is left out"
        tell = context.report.note if closures else context.report.warn
        code = codes.REWRITTEN if closures else codes.NOT_REPRESENTED
        tell(code, f"{view.id} holds {view.child}, which has another parent; {words}", mechanism.origin(view.id), element=str(view.id))
        edges |= {names.take("loop", view.id.name): closure for closure in closures}
    return mechanism.replace(edges=edges, without=[view.id for view in extra])


def close_in_pairs(mechanism: Mechanism, context: Context) -> Mechanism:
    """A closure of more than two elements becomes closures of the first one with each of the others."""
    joined = [(key, loop, arcs) for key, loop, arcs in mechanism.edges(Loop) if len(arcs) > 2]
    if not joined:
        return mechanism
    names = names_in_use(mechanism)
    edges: dict[Id, RobotEdge] = {}
    for key, loop, (first, second, *others) in joined:
        edges[key] = Edge(loop, (first, second))
        edges |= {names.take("loop", key.name): Edge(loop, (first, other)) for other in others}
        message = f"{key} joins {len(others) + 2} elements; it is written as {len(others) + 1} closures of the first with each other one"
        context.report.note(codes.REWRITTEN, message, mechanism.origin(key), element=str(key))
    return mechanism.replace(edges=edges)


def close_by_points(mechanism: Mechanism, context: Context) -> Mechanism:
    """A loop that a joint closes becomes welds and points that stay together: a hinge is two points on its axis."""
    joints = [(key, loop, arcs) for key, loop, arcs in mechanism.edges(Loop) if loop.kind == "joint" and len(arcs) == 2]
    if not joints:
        return mechanism
    names = names_in_use(mechanism)
    edges: dict[Id, RobotEdge] = {}
    for key, loop, (first, second) in joints:
        view = JointView(key, Joint(loop.dofs), first.target, second.target, pose_weight(first), pose_weight(second))
        closures = _closures(view, loop)
        if not closures:
            _report_left_out(key, loop, mechanism, context)
        for number, closure in enumerate(closures):
            edges[key if number == 0 else names.take("loop", key.name)] = closure
    gone = [key for key, _, _ in joints if key not in edges]
    return mechanism.replace(edges=edges, without=gone)


def leave_screws_open(mechanism: Mechanism, context: Context) -> Mechanism:
    """Closures by a screw are left out."""
    gone = [(key, loop) for key, loop, _ in mechanism.edges(Loop) if any(dof.kind is DofKind.SCREW for dof in loop.dofs)]
    for key, loop in gone:
        _report_left_out(key, loop, mechanism, context)
    return mechanism.replace(without=[key for key, _ in gone])


def _report_left_out(key: Id, loop: Loop, mechanism: Mechanism, context: Context) -> None:
    kinds = " and a ".join(dof.kind.value for dof in loop.dofs)
    message = f"{key} closes a loop by a {kinds}, for which there is no closure; it is left out"
    context.report.warn(codes.NOT_REPRESENTED, message, mechanism.origin(key), element=str(key))


def anchor_closures(mechanism: Mechanism, _context: Context) -> Mechanism:
    """The points that a ``connect`` holds together become frames on their bodies, so that both are exact.

    Nothing is lost and nothing is reported: the closure is the same one.
    """
    loose = [(key, loop, arcs) for key, loop, arcs in mechanism.edges(Loop) if loop.kind == "connect" and not _is_anchored(arcs)]
    if not loose:
        return mechanism
    names = names_in_use(mechanism)
    frames: dict[Id, Frame] = {}
    edges: dict[Id, RobotEdge] = {}
    for key, loop, arcs in loose:
        anchored = []
        for arc in arcs:
            if arc.target.kind == "frame":
                anchored.append(arc)
                continue
            frame = names.take("frame", f"{key.name}_{arc.target.name}")
            frames[frame] = Frame()
            edges[names.take("mount", frame.name)] = mount_edge(arc.target, frame, Pose(pose_weight(arc).xyz))
            anchored.append(Arc(frame))
        edges[key] = Edge(loop, tuple(anchored))
    return mechanism.replace(vertices=frames, edges=edges)


def _is_anchored(arcs: tuple[RobotArc, ...]) -> bool:
    return all(arc.target.kind == "frame" for arc in arcs)


def _closing_cycles(mechanism: Mechanism) -> list[JointView]:
    """Of every cycle of bodies that no root leads to, the joint above its first body."""
    below, roots = mechanism.children, set(mechanism.roots)
    reached: set[Id] = set()
    found = []
    for body in (*mechanism.roots, *[key for key, _ in mechanism.vertices(Body)]):
        if body in reached:
            continue
        if body not in roots:
            found.append(mechanism.parent_joint[body])
        reached.add(body)
        stack = [body]
        while stack:
            for joint in below.get(stack.pop(), ()):
                if joint.child not in reached:
                    reached.add(joint.child)
                    stack.append(joint.child)
    return found


def _closures(view: JointView, like: Loop) -> list[RobotEdge]:
    """A fixed joint is a weld, a ball one point that stays together, a hinge two points on its axis; else nothing."""
    kinds = [dof.kind for dof in view.joint.dofs]
    if not kinds:
        return [_closure(replace(like, kind="weld", dofs=()), view, IDENTITY)]
    if len(kinds) > 1 or kinds[0] not in (DofKind.BALL, DofKind.HINGE):
        return []
    dof = view.joint.dofs[0]
    points = [dof.anchor]
    if kinds[0] is DofKind.HINGE:
        points.append(add(dof.anchor, scaled(dof.axis, _APART)))
    return [_closure(replace(like, kind="connect", dofs=()), view, Pose(point)) for point in points]


def _closure(loop: Loop, view: JointView, offset: Pose) -> RobotEdge:
    ends = ((view.parent, view.parent_pose), (view.child, view.child_pose))
    return Edge(loop, tuple(Arc(body, 0, compose(pose, offset)) for body, pose in ends))
