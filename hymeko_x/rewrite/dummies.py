"""Links without mass and shapes as frames on the body that holds them, for programs that simulate every body."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import counted, listed
from hymeko_x.ir.mechanism import joint_edge, mount_edge
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.parts import Body, Contact, Frame, Joint, Mount
from hymeko_x.ir.values import IDENTITY, Pose, compose, inverse
from hymeko_x.rewrite.roots import is_massless, without
from hymeko_x.rewrite.sites import is_link

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, JointView, Mechanism, RobotEdge
    from hymeko_x.rewrite.context import Context

_SHOWN = 4
Held = dict["Id", tuple["Id", Pose]]
"""For each link that becomes a frame the body that holds it, and its pose there."""


def make_dummies_frames(mechanism: Mechanism, context: Context) -> Mechanism:
    """A link without mass and shapes that a fixed joint connects to another body is a frame on that body. Idempotent.

    A root is one where the body behind its fixed joint has the same pose; others stay, since the whole robot would move.

    Source: REP 158 (draft of 2026), 1.3 Mass Properties, Dummy Frames.
    """
    held = _held(mechanism)
    if not held:
        return mechanism
    removed = {view.id for view in mechanism.joints.values() if _is_idle(view, held)}
    names = names_in_use(mechanism)
    frames: dict[Id, Frame] = {}
    edges = _moved(mechanism, held, removed)
    for body, (base, pose) in held.items():
        if any(is_link(view) for view in mechanism.mounts.get(body, ())):
            continue
        frame = names.take("frame", body.name)
        frames[frame] = Frame()
        edges[names.take("mount", frame.name)] = mount_edge(base, frame, pose)
    contacts = [key for key, _, arcs in mechanism.edges(Contact) if any(arc.target in held for arc in arcs)]
    shown = listed([f"'{body.name}'" for body in held], _SHOWN)
    message = f"{counted(len(held), 'link')} without mass and shapes written as frames ({context.reason}): {shown}"
    context.report.note(codes.FOR_TARGET, message, element=str(next(iter(held))))
    moved = mechanism.replace(vertices=frames, edges=edges)
    return without(moved, [*contacts, *removed, *held])


def _held(mechanism: Mechanism) -> Held:
    used = {
        arc.target for edge in mechanism.graph.edges.values() if not isinstance(edge.data, Joint | Mount | Contact) for arc in edge.arcs
    }
    above = Counter(view.child for view in mechanism.joints.values())
    dummies = {key for key, body in mechanism.vertices(Body) if key not in used and is_massless(body) and above[key] < 2}
    found: Held = {}
    for root in mechanism.roots:
        if root not in mechanism.parent_joint:
            found |= _held_by_heir(root, dummies, mechanism)
    for body in mechanism.depth_first():
        view = mechanism.parent_joint.get(body)
        if body in dummies and body not in found and view is not None and not view.joint.dofs:
            base, pose = found.get(view.parent, (view.parent, IDENTITY))
            found[body] = base, compose(pose, _at_rest(view))
    return found


def _held_by_heir(root: Id, dummies: set[Id], mechanism: Mechanism) -> Held:
    """An open root and the dummies behind it, held by the first body with a mass or a shape that has the same pose; else nothing."""
    passed = [root]
    while passed[-1] in dummies:
        views = [view for view in mechanism.children.get(passed[-1], ()) if not view.joint.dofs and _at_rest(view) == IDENTITY]
        heirs = [view.child for view in views if view.child not in dummies] or [view.child for view in views]
        if not heirs:
            return {}
        passed.append(heirs[0])
    return dict.fromkeys(passed[:-1], (passed[-1], IDENTITY))


def _at_rest(view: JointView) -> Pose:
    """The pose of the child of a fixed joint in its parent."""
    return compose(view.parent_pose, inverse(view.child_pose))


def _is_idle(view: JointView, held: Held) -> bool:
    """Whether both ends of a joint are parts of one body now."""
    ends = [held.get(end, (end, IDENTITY))[0] for end in (view.parent, view.child)]
    return ends[0] == ends[1]


def _moved(mechanism: Mechanism, held: Held, removed: set[Id]) -> dict[Id, RobotEdge]:
    """The joints and mounts of the links, on the bodies that hold them."""
    edges: dict[Id, RobotEdge] = {}
    for body, (base, pose) in held.items():
        for view in mechanism.children.get(body, ()):
            if view.id not in removed:
                edges[view.id] = joint_edge(view.joint, base, view.child, compose(pose, view.parent_pose), view.child_pose)
        for mount in mechanism.mounts.get(body, ()):
            edges[mount.id] = mount_edge(base, mount.mounted, compose(pose, mount.pose))
    return edges
