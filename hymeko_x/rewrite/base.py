"""Where the tree begins: the world, a link that stands for it, and bases that are fixed, floating or open."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.ir.mechanism import WORLD, Id, Mechanism, joint_edge
from hymeko_x.ir.names import names_in_use, rename
from hymeko_x.ir.parts import Body, Dof, DofKind, Joint, World

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.rewrite.context import Context

_WORLD_LINK = Id("body", WORLD.name)


def put_world_link_into_world(mechanism: Mechanism, context: Context) -> Mechanism:
    """A root link called ``world`` that says nothing about its mass is the world; any other body of that name is renamed."""
    body = mechanism.graph.vertices.get(_WORLD_LINK)
    if not isinstance(body, Body):
        return mechanism
    if _WORLD_LINK not in mechanism.parent_joint and _massless(body):
        return rename(_with_world(mechanism), {_WORLD_LINK: WORLD})
    new = names_in_use(mechanism).take("body", "world_link")
    why = "has a mass" if not _massless(body) else "is not the root"
    context.report.warn(
        codes.RENAMED,
        f"link 'world' {why}, so it is not the world itself, which alone may have this name; it is written as '{new.name}'",
        mechanism.origin(_WORLD_LINK),
        element=str(new),
    )
    return rename(mechanism, {_WORLD_LINK: new})


def choose_base(mechanism: Mechanism, context: Context) -> Mechanism:
    """An open base gets a free joint where the user wants it to float; else it stays fixed where it is, which is said once."""
    above = mechanism.parent_joint
    open_bases = [root for root in mechanism.roots if root not in above]
    if context.options.base == "free":
        return _floating(mechanism, open_bases, context.report)
    if context.options.base is None:
        for root in open_bases:
            context.report.note(
                codes.REWRITTEN,
                f"{root} hangs on nothing; it is written as fixed to the world",
                mechanism.origin(root),
                element=str(root),
                hint="--base free lets it float, --base fixed silences this note",
            )
    return mechanism


def _floating(mechanism: Mechanism, open_bases: list[Id], report: Report) -> Mechanism:
    if not open_bases:
        _say_why_nothing_floats(mechanism, report)
        return mechanism
    names = names_in_use(mechanism)
    free = Joint((Dof(DofKind.FREE),))
    edges = {names.take("joint", f"{root.name}_free"): joint_edge(free, WORLD, root) for root in open_bases}
    mechanism = _with_world(mechanism)
    return mechanism.with_graph(mechanism.graph.replace(edges=edges))


def _say_why_nothing_floats(mechanism: Mechanism, report: Report) -> None:
    """Silent when the base floats already."""
    for joint in mechanism.children.get(WORLD, ()):
        if not joint.joint.dofs:
            report.warn(
                codes.REWRITTEN,
                f"{joint.child} does not float: {joint.id} fixes it to the world",
                mechanism.origin(joint.id),
                element=str(joint.child),
                hint="remove that joint or the link 'world' to let the robot float",
            )


def _massless(body: Body) -> bool:
    inertial = body.inertial
    return inertial is None or (not inertial.mass and not any(inertial.tensor or ()))


def _with_world(mechanism: Mechanism) -> Mechanism:
    if WORLD in mechanism.graph.vertices:
        return mechanism
    return mechanism.with_graph(mechanism.graph.replace(vertices={WORLD: World()}))
