"""Where the tree begins: the world, a link that represents it, and bases that are fixed, floating or open."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import listed
from hymeko_x.ir.mechanism import WORLD, WORLD_LINK, Id, Mechanism, joint_edge
from hymeko_x.ir.names import names_in_use, rename
from hymeko_x.ir.parts import Body, DofKind, Joint, Plane, Sense, Shape, Stance, World

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import JointView, RobotEdge
    from hymeko_x.rewrite.context import Context


RENAMED_LINK = Id("body", "world_link")
"""What a body is called whose author calls it ``world``, which is none."""


# ---- for formats with a world ------------------------------------------------------------------------------------------


def put_world_link_into_world(mechanism: Mechanism, context: Context) -> Mechanism:
    """A root link called ``world`` without a mass is the world; any other body of that name is renamed."""
    return _with_other_name(put_world_links_into_world(mechanism, context), context)


def _with_other_name(mechanism: Mechanism, context: Context) -> Mechanism:
    """A body called ``world``, which is none, has another name: the world alone has this one."""
    body = mechanism.part(WORLD_LINK, Body)
    if body is None:
        return mechanism
    new = names_in_use(mechanism).take(*RENAMED_LINK)
    why = "has a mass" if not is_massless(body) else "is not the root"
    context.report.warn(
        codes.RENAMED,
        f"link 'world' {why}, so it is not the world itself, which alone may have this name; it is written as '{new.name}'",
        mechanism.origin(WORLD_LINK),
        element=str(new),
    )
    return rename(mechanism, {WORLD_LINK: new})


def put_world_links_into_world(mechanism: Mechanism, _context: Context) -> Mechanism:
    """A root link called ``world`` without a mass is the world; other bodies of that name stay."""
    links = [root for root in mechanism.roots if root not in mechanism.parent_joint and stands_for_world(root, mechanism)]
    return rename(with_world(mechanism), dict.fromkeys(links, WORLD)) if links else mechanism


def report_open_bases(mechanism: Mechanism, context: Context) -> Mechanism:
    """An open base stays fixed where it is, which is reported."""
    for root in (root for root in mechanism.roots if root not in mechanism.parent_joint):
        context.report.note(
            codes.REWRITTEN,
            f"{root} has no parent joint; it is fixed to the world",
            mechanism.origin(root),
            element=str(root),
            hint="--base free makes it floating, --base fixed silences this note",
        )
    return mechanism


def is_massless(body: Body) -> bool:
    """Whether a body has neither mass nor inertia."""
    inertial = body.inertial
    return inertial is None or (not inertial.mass and not any(inertial.tensor or ()))


def with_world(mechanism: Mechanism) -> Mechanism:
    """The mechanism with a world."""
    if WORLD in mechanism.graph.vertices:
        return mechanism
    return mechanism.replace(vertices={WORLD: World()})


# ---- for formats without one -------------------------------------------------------------------------------------------


def stands_for_world(root: Id, mechanism: Mechanism) -> bool:
    """Whether a root is the link without mass that stands for the world."""
    return root.name.partition("#")[0] == WORLD.name and is_massless(mechanism.vertex(root, Body))


def make_world_a_link(mechanism: Mechanism, context: Context) -> Mechanism:
    """The world, if anything is attached to it, is a link called ``world`` without mass: the usual way to fix a base.

    A sensor that measures against the world is not attached to it. The world of a mechanism without bodies is a link, too: such formats
    need one. A link that stands for the world already needs no other.
    """
    mechanism = _without_held_worlds(mechanism)
    there, alone = WORLD in mechanism.graph.vertices, not any(True for _ in mechanism.vertices(Body))
    edges = [edge for edge in mechanism.graph.edges.values() if not isinstance(edge.data, Sense)]
    used = any(WORLD in [arc.target for arc in edge.arcs] for edge in edges)
    if not used and not (there and alone):
        return without(mechanism, [WORLD]) if there else mechanism
    mechanism = rename(put_world_link_into_world(mechanism, context), {WORLD: WORLD_LINK})
    return mechanism.replace(vertices={WORLD_LINK: Body()})


def _without_held_worlds(mechanism: Mechanism) -> Mechanism:
    """Without the joints that hold a link which stands for the world right there."""
    idle = [
        joint.id
        for joint in mechanism.children.get(WORLD, ())
        if not joint.joint.dofs and joint.parent_pose == joint.child_pose and stands_for_world(joint.child, mechanism)
    ]
    return mechanism.replace(without=idle)


def open_floating_base(mechanism: Mechanism, context: Context) -> Mechanism:
    """The base of the only tree is open instead of floating by a joint: programs that expect this let an open base float."""
    held = floating_joint(mechanism)
    if held is None:
        return mechanism
    moved = held.parent_pose != held.child_pose
    where = ", and starts at the origin of the world" if moved else ""
    message = f"{held.child} is the open base, which floats; {held.id} is left out{where} ({context.reason})"
    context.report.note(codes.FOR_TARGET, message, mechanism.origin(held.id), element=str(held.id))
    return without(mechanism, [held.id])


def floating_joint(mechanism: Mechanism) -> JointView | None:
    """The free joint of the only tree's root; None where there are several trees or the base does not float."""
    held = mechanism.parent_joint.get(mechanism.roots[0]) if len(mechanism.roots) == 1 else None
    return held if held is not None and [dof.kind for dof in held.joint.dofs] == [DofKind.FREE] else None


def leave_scenery_out(mechanism: Mechanism, context: Context) -> Mechanism:
    """Planes, lights and cameras on the world are left out: they belong to a simulation, and to no robot."""
    shapes = [view.id for view in mechanism.shapes.get(WORLD, ()) if isinstance(view.shape.geometry, Plane)]
    elements = [view.mounted for view in mechanism.mounts.get(WORLD, ()) if view.mounted.kind in ("light", "camera")]
    if not shapes and not elements:
        return mechanism
    named = [data.name for key in shapes if isinstance(data := mechanism.graph.edges[key].data, Shape)]
    names = [f"plane '{name}'" if name else "a plane" for name in named] + [f"{key.kind} '{key.name}'" for key in elements]
    message = f"what only a simulation has on the world is left out ({context.reason}): {listed(names, 4)}"
    context.report.note(codes.FOR_TARGET, message)
    return without(mechanism, [*shapes, *elements])


def without(mechanism: Mechanism, elements: list[Id]) -> Mechanism:
    """The mechanism without these elements, and without edges that lose an end; a stance only loses what it says of them."""
    gone = set(elements)
    edges: dict[Id, RobotEdge] = {}
    for key, edge in mechanism.graph.edges.items():
        left = tuple([arc for arc in edge.arcs if arc.target not in gone])
        if len(left) == len(edge.arcs) or key in gone:
            continue
        if isinstance(edge.data, Stance):
            edges[key] = replace(edge, arcs=left)
        else:
            elements = [*elements, key]
    return mechanism.replace(edges=edges, without=elements)


def join_roots(mechanism: Mechanism, context: Context) -> Mechanism:
    """Several trees are fixed to one root: the world's link if it is a root, else a new link without mass."""
    roots = mechanism.roots
    if len(roots) < 2:
        return mechanism
    names = names_in_use(mechanism)
    root = WORLD_LINK if WORLD_LINK in roots else names.take("body", WORLD.name)
    others = [other for other in roots if other != root]
    edges = {names.take("joint", f"{other.name}_base"): joint_edge(Joint(), root, other) for other in others}
    fixed = listed([f"'{other.name}'" for other in others], 5)
    context.report.warn(
        codes.REWRITTEN,
        f"the format has one root, and {len(roots)} links have no parent; fixed to link '{root.name}': {fixed}",
        element=str(root),
    )
    vertices = {} if root in mechanism.graph.vertices else {root: Body()}
    return mechanism.replace(vertices=vertices, edges=edges)
