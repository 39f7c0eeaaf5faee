"""ROS 2: a URDF for robot_state_publisher, MoveIt and ros2_control, and an SRDF beside it. docs/targets.md has the sources."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.backends.urdf.gazebo import hold_sensors
from hymeko_x.backends.urdf.ros2_control import declare_ros2_control
from hymeko_x.backends.urdf.rules import with_joints_of_urdf
from hymeko_x.diagnostics import counted
from hymeko_x.formats import urdf as words
from hymeko_x.formats.urdf import srdf
from hymeko_x.formats.urdf.notations import VIRTUAL
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import ROOT, WORLD, Extra, joint_edge
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import Actuator, Contact, PoseSet, Role
from hymeko_x.rewrite.apart import call_joints_apart
from hymeko_x.rewrite.mimics import driven_joints, moving_joints, put_driven_first
from hymeko_x.rewrite.poses import name_poses
from hymeko_x.rewrite.roots import floating_joint, leave_scenery_out
from hymeko_x.rewrite.transmissions import followers
from hymeko_x.xml.printing import Tag, render

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge
    from hymeko_x.rewrite.context import Context, Rule

# ---- the base ------------------------------------------------------------------------------------------------------------------


def let_base_float_in_srdf(mechanism: Mechanism, context: Context) -> Mechanism:
    """The joint by which the only tree floats is a virtual joint of the SRDF: the URDF begins with the base, as tf and planners expect."""
    held = floating_joint(mechanism)
    if held is None or mechanism.notation(held.id, VIRTUAL) is not None:
        return mechanism
    where = "" if held.parent_pose == held.child_pose else "; it begins at the origin of the world"
    message = f"{held.id} is a virtual joint of the SRDF, and {held.child} the open base{where} ({context.reason})"
    context.report.note(codes.FOR_TARGET, message, mechanism.origin(held.id), element=str(held.id))
    edges = {held.id: joint_edge(held.joint, WORLD, held.child)}
    return mechanism.replace(edges=edges).with_note([held.id], VIRTUAL, True)


# ---- SRDF ----------------------------------------------------------------------------------------------------------------------


def give_reasons(mechanism: Mechanism, _context: Context) -> Mechanism:
    """Every exclusion has a reason: that a joint connects its links, or that a person wants it."""
    edges: dict[Id, RobotEdge] = {}
    for key, contact, arcs in mechanism.edges(Contact):
        if contact.kind == "exclude" and len(arcs) == 2 and srdf.REASON not in dict(contact.parameters):
            reason = srdf.ADJACENT if _are_adjacent(arcs[0].target, arcs[1].target, mechanism) else srdf.USER
            edges[key] = replace(mechanism.graph.edges[key], data=replace(contact, parameters=((srdf.REASON, reason),)))
    return mechanism.replace(edges=edges)


def _are_adjacent(a: Id, b: Id, mechanism: Mechanism) -> bool:
    above = mechanism.parent_joint
    return (a in above and above[a].parent == b) or (b in above and above[b].parent == a)


def exclude_neighbours(mechanism: Mechanism, context: Context) -> Mechanism:
    """Links with collision shapes that a joint connects, or links without such shapes between them, are known never to touch."""
    known = {frozenset(arc.target for arc in arcs) for _, contact, arcs in mechanism.edges(Contact) if contact.kind == "exclude"}
    pairs = [pair for pair in _neighbours(mechanism) if frozenset(pair) not in known]
    if not pairs:
        return mechanism
    names = names_in_use(mechanism)
    data = Contact("exclude", ((srdf.REASON, srdf.ADJACENT),))
    edges: dict[Id, RobotEdge] = {names.take("contact", f"{a.name}_{b.name}"): Edge(data, (Arc(a, 0), Arc(b, 0))) for a, b in pairs}
    context.report.note(codes.FOR_TARGET, f"{counted(len(pairs), 'pair')} of adjacent links excluded from collision ({context.reason})")
    notations = {**mechanism.notations}
    for body in {body for pair in pairs for body in pair} & notations.keys():  # what is referred to has its name written
        notations[body] = {name: text for name, text in notations[body].items() if name != UNNAMED.name}
    mechanism = replace(mechanism, notations=notations)
    return mechanism.replace(edges=edges).with_note(edges, UNNAMED, True)


def _neighbours(mechanism: Mechanism) -> Iterator[tuple[Id, Id]]:
    """Each body that can be touched with the next one above it, unless that is the world."""
    above: dict[Id, Id | None] = {}
    for body in mechanism.depth_first():
        joint = mechanism.parent_joint.get(body)
        parent = None if joint is None or joint.parent == WORLD else joint.parent
        nearest = parent if parent is None or _can_be_touched(parent, mechanism) else above.get(parent)
        above[body] = nearest
        if nearest is not None and _can_be_touched(body, mechanism):
            yield nearest, body


def _can_be_touched(body: Id, mechanism: Mechanism) -> bool:
    return any(view.shape.role is not Role.VISUAL for view in mechanism.shapes.get(body, ()))


def declare_groups(mechanism: Mechanism, context: Context) -> Mechanism:
    """A group of every joint that moves by itself, and what is passive; poses are of that group. A robot with groups keeps them."""
    own = mechanism.extras.get(ROOT, ())
    if any(extra.path == srdf.PATH and extra.text.startswith("<group ") for extra in own):
        return mechanism
    seen = with_joints_of_urdf(mechanism, context)
    following = followers(seen)
    driven = set(driven_joints(seen))
    moving = [key for key in moving_joints(seen) if key not in following]
    group = [key for key in moving if not driven or key in driven] or moving
    if not group:
        return mechanism
    chosen = set(group)
    passive = [key for key in moving if key not in chosen] if any(True for _ in mechanism.vertices(Actuator)) else []
    joints = Tag("group", {"name": srdf.ALL}, [Tag("joint", {"name": key.name}) for key in group])
    tags = [joints, *(Tag("passive_joint", {"name": key.name}) for key in passive)]
    extras = tuple(Extra(words.FORMAT, srdf.PATH, "".join(line.strip() for line in render(tag))) for tag in tags)
    context.report.note(codes.FOR_TARGET, f"the SRDF has the group '{srdf.ALL}' of {counted(len(group), 'joint')} ({context.reason})")
    poses = {key: replace(pose, group=pose.group or srdf.ALL) for key, pose in mechanism.vertices(PoseSet)}
    mechanism = mechanism.replace(vertices=poses)
    return replace(mechanism, extras={**mechanism.extras, ROOT: (*own, *extras)})


RULES: tuple[Rule, ...] = (
    leave_scenery_out,
    let_base_float_in_srdf,
    name_poses,
    call_joints_apart,
    put_driven_first,
    give_reasons,
    exclude_neighbours,
    declare_groups,
    hold_sensors,
    declare_ros2_control,
)
