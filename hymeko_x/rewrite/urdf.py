"""What URDF has no word for, rewritten into what it has: one root, and joints of one dof in the frame of their child.

Links keep their frames: where a joint turns beside the frame of its child, a link without mass in between carries the
joint's frame. So every link of the source is in the result, at the same place for the same coordinates.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.formats.urdf.notations import TYPE
from hymeko_x.ir.kinematics import dof_number
from hymeko_x.ir.mechanism import WORLD, Id, JointView, Mechanism, joint_edge
from hymeko_x.ir.names import names_in_use, rename
from hymeko_x.ir.parts import UNLIMITED, Body, Coupling, Dof, DofKind, Drive, Joint, Sense, Tendon
from hymeko_x.ir.values import IDENTITY, ZERO, Pose, X, Y, Z, add, compose, inverse, plane_axes, quat_about, scaled

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.ir.mechanism import RobotArc, RobotEdge
    from hymeko_x.ir.names import Names
    from hymeko_x.rewrite.context import Context

_SINGLE = (DofKind.HINGE, DofKind.SLIDE)


# ---- base and root -----------------------------------------------------------------------------------------------------------


def hold_or_free_open_bases(mechanism: Mechanism, context: Context) -> Mechanism:
    """Where the user says what the base does, each open base gets a fixed or a free joint to the world."""
    if context.options.base is None:
        return mechanism
    joint = Joint((Dof(DofKind.FREE),)) if context.options.base == "free" else Joint()
    names = names_in_use(mechanism)
    open_bases = [root for root in mechanism.roots if root not in mechanism.parent_joint and not stands_for_world(root, mechanism)]
    edges = {names.take("joint", f"{root.name}_base"): joint_edge(joint, WORLD, root) for root in open_bases}
    return mechanism.with_graph(mechanism.graph.replace(edges=edges)) if edges else mechanism


def stands_for_world(root: Id, mechanism: Mechanism) -> bool:
    """Whether a root is the link without mass that stands for the world."""
    return root.name.partition("#")[0] == WORLD.name and mechanism.vertex(root, Body).inertial is None


def make_world_a_link(mechanism: Mechanism, _context: Context) -> Mechanism:
    """The world, if anything hangs on it, is a link called ``world`` without mass: URDF's usual way to fix a base.

    So is the world of a mechanism without bodies: URDF wants a link. A link that stands for the world already needs no other.
    """
    mechanism = _without_held_worlds(mechanism)
    there, alone = WORLD in mechanism.graph.vertices, not any(True for _ in mechanism.vertices(Body))
    used = any(WORLD in [arc.target for arc in edge.arcs] for edge in mechanism.graph.edges.values())
    if not used and not (there and alone):
        return mechanism.with_graph(mechanism.graph.replace(without=[WORLD])) if there else mechanism
    link = names_in_use(mechanism).take("body", WORLD.name)
    mechanism = rename(mechanism, {WORLD: link})
    return mechanism.with_graph(mechanism.graph.replace(vertices={link: Body()}))


def _without_held_worlds(mechanism: Mechanism) -> Mechanism:
    """Without the joints that hold a link which stands for the world right there."""
    idle = [
        joint.id
        for joint in mechanism.children.get(WORLD, ())
        if not joint.joint.dofs and joint.parent_pose == joint.child_pose and stands_for_world(joint.child, mechanism)
    ]
    return mechanism.with_graph(mechanism.graph.replace(without=idle)) if idle else mechanism


def join_roots(mechanism: Mechanism, context: Context) -> Mechanism:
    """Several trees are fixed to one root: the world's link if it is a root, else a new link without mass."""
    roots = mechanism.roots
    if len(roots) < 2:
        return mechanism
    names = names_in_use(mechanism)
    world = Id("body", WORLD.name)
    root = world if world in roots else names.take("body", WORLD.name)
    hung = [other for other in roots if other != root]
    edges = {names.take("joint", f"{other.name}_base"): joint_edge(Joint(), root, other) for other in hung}
    said = ", ".join(f"'{other.name}'" for other in hung[:5]) + (", ..." if len(hung) > 5 else "")
    context.report.warn(
        codes.REWRITTEN,
        f"URDF has one root, and {len(roots)} links have no parent; fixed to link '{root.name}': {said}",
        element=str(root),
    )
    vertices = {} if root in mechanism.graph.vertices else {root: Body()}
    return mechanism.with_graph(mechanism.graph.replace(vertices=vertices, edges=edges))


# ---- joints ------------------------------------------------------------------------------------------------------------------


class _Step(NamedTuple):
    """A joint of a chain: where it stands, seen from the joint before, and what moves."""

    pose: Pose
    dof: Dof
    number: int


class _Chains(Struct):
    """The links and joints that chains are made of, and where the dofs of the old joints went."""

    names: Names
    vertices: dict[Id, Body]
    edges: dict[Id, RobotEdge]
    moved: dict[tuple[Id, int], Id]


def chain_dofs(mechanism: Mechanism, context: Context) -> Mechanism:
    """Each joint that URDF cannot say becomes a chain of joints with one dof; balls become three hinges about x, y and z."""
    unsayable = [view for view in mechanism.joints.values() if not _is_sayable(view, mechanism)]
    if not unsayable:
        return mechanism
    chains = _Chains(names_in_use(mechanism), {}, {}, {})
    for view in unsayable:
        count = _add_chain(view, chains)
        if count:
            said = f"{view.id} has dofs or a frame that URDF has no word for; it is written as a chain of {count + 1} joints"
            context.report.note(codes.REWRITTEN, said, mechanism.origin(view.id), element=str(view.id))
    edges = dict(_following(mechanism, chains.moved)) | chains.edges
    old = {view.id for view in unsayable}
    return mechanism.with_graph(mechanism.graph.replace(vertices=chains.vertices, edges=edges, without=old - set(chains.edges)))


def _is_sayable(view: JointView, mechanism: Mechanism) -> bool:
    """Whether URDF has a word for the joint as it is."""
    dofs = view.joint.dofs
    if view.child_pose != IDENTITY or any(any(dof.anchor) or dof.ref for dof in dofs):
        return False
    kinds = tuple(dof.kind for dof in dofs)
    if kinds == (DofKind.BALL,):
        return mechanism.notation(view.id, TYPE) is not None
    if kinds == (DofKind.SLIDE, DofKind.SLIDE, DofKind.HINGE):
        plain = all(dof == Dof(dof.kind, dof.axis) for dof in dofs)  # a planar joint has one name, and no limits or damping
        return plain and tuple(dof.axis for dof in dofs[:2]) == plane_axes(dofs[2].axis)
    return not dofs or (len(dofs) == 1 and kinds[0] in (*_SINGLE, DofKind.FREE))


def _add_chain(view: JointView, chains: _Chains) -> int:
    """Add the chain of a joint; returns how many links it adds."""
    steps, offset = _steps(view)
    if not steps:
        chains.edges[view.id] = joint_edge(Joint(), view.parent, view.child, offset)
        return 0
    parent = view.parent
    count = len(steps) - (offset == IDENTITY)
    for place, step in enumerate(steps):
        last = place == len(steps) - 1
        body = view.child if last and offset == IDENTITY else chains.names.take("body", f"{view.child.name}_carrier")
        if body != view.child:
            chains.vertices[body] = Body()
        key = _joint_name(view, step, last, chains)
        chains.moved[view.id, step.number] = key
        chains.edges[key] = joint_edge(Joint((step.dof,)), parent, body, step.pose)
        parent = body
    if offset != IDENTITY:
        chains.edges[chains.names.take("joint", f"{view.id.name}_frame")] = joint_edge(Joint(), parent, view.child, offset)
    return count


def _joint_name(view: JointView, step: _Step, last: bool, chains: _Chains) -> Id:
    """The dof's own name if it has one; the last nameless one keeps the joint's unless a dof has it, the others are numbered."""
    name = view.id.name
    is_nameless_last = last and step.dof.name is None and all(dof.name != name for dof in view.joint.dofs)
    if is_nameless_last or (step.dof.name == name and view.id not in chains.edges):
        return view.id
    return chains.names.take("joint", step.dof.name or f"{view.id.name}_{step.number + 1}")


def _steps(view: JointView) -> tuple[list[_Step], Pose]:
    """The joints of the chain, each with its frame in the one before, and the child's frame in the last one.

    Tr(a) M(q - ref) Tr(-a) is a joint at Tr(a) M(-ref) with the same axis and coordinate, followed by Tr(-a).
    """
    steps = []
    frame = view.parent_pose
    for number, dof in enumerate(view.joint.dofs):
        for single in _singles(dof):
            at = compose(frame, Pose(dof.anchor))
            steps.append(_Step(compose(at, _moved_by(single, -dof.ref)), replace(single, anchor=ZERO, ref=0.0), number))
            frame = Pose(add(ZERO, scaled(dof.anchor, -1.0)))  # a sum has no negative zeros
    if not steps:
        return [], compose(frame, inverse(view.child_pose))
    return steps, compose(frame, inverse(view.child_pose))


def _singles(dof: Dof) -> list[Dof]:
    """The dof itself, or three hinges for a ball; their damping and friction are those of the ball."""
    if dof.kind is not DofKind.BALL:
        return [dof]
    same = replace(dof, kind=DofKind.HINGE, limits=UNLIMITED, written=None)
    return [replace(same, axis=axis, name=f"{dof.name}_{letter}" if dof.name else None) for axis, letter in ((X, "x"), (Y, "y"), (Z, "z"))]


def _moved_by(dof: Dof, coordinate: float) -> Pose:
    if not coordinate:
        return IDENTITY
    if dof.kind is DofKind.SLIDE:
        return Pose(scaled(dof.axis, coordinate))
    return Pose(ZERO, quat_about(dof.axis, coordinate)) if dof.kind is DofKind.HINGE else IDENTITY


def _following(mechanism: Mechanism, moved: dict[tuple[Id, int], Id]) -> Iterator[tuple[Id, RobotEdge]]:
    """The couplings, drives, senses and tendons whose dofs are joints of their own now."""
    joints = {joint for joint, _ in moved}
    for key, edge in mechanism.graph.edges.items():
        if isinstance(edge.data, Coupling | Drive | Sense | Tendon) and any(arc.target in joints for arc in edge.arcs):
            yield key, replace(edge, arcs=tuple(_moved_arc(arc, mechanism, moved) for arc in edge.arcs))


def _moved_arc(arc: RobotArc, mechanism: Mechanism, moved: dict[tuple[Id, int], Id]) -> RobotArc:
    edge = mechanism.graph.edges.get(arc.target)
    number = dof_number(edge.data, arc.role) if edge is not None and isinstance(edge.data, Joint) else None
    new = moved.get((arc.target, number)) if number is not None else None
    return arc if new is None else replace(arc, target=new, role="")
