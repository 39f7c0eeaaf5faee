"""Tendons that MuJoCo accepts: paths that it can follow, limits that are intervals, and names for the shapes around which they lead."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.ir.graph import Edge
from hymeko_x.ir.parts import Coupling, Drive, Frame, Sense, Shape, Tendon
from hymeko_x.ir.tendons import wrong_path
from hymeko_x.rewrite.limits import interval

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc, RobotEdge
    from hymeko_x.rewrite.context import Context


def drop_odd_tendons(mechanism: Mechanism, context: Context) -> Mechanism:
    """A tendon whose path nobody can follow is left out, with what acts on it."""
    placed = {view.thing for views in mechanism.mounts.values() for view in views}
    gone: set[Id] = set()
    for key, tendon, arcs in mechanism.edges(Tendon):
        wrong = wrong_path(replace(tendon, armature=0.0), arcs, mechanism.graph.edges) or _nowhere(mechanism, arcs, placed)
        if wrong is not None:
            gone.add(key)
            context.report.warn(codes.NOT_SAID, f"{key} is left out: its path {wrong}", mechanism.origin(key), element=str(key))
    if not gone:
        return mechanism
    hanging = [key for key, edge in mechanism.graph.edges.items() if _hangs_on(edge, gone)]
    ends = {arc.target for key in hanging for arc in mechanism.graph.edges[key].arcs}
    things = [end for end in ends if end.kind in ("actuator", "sensor")]
    return mechanism.with_graph(mechanism.graph.replace(without=[*gone, *hanging, *things]))


def _nowhere(mechanism: Mechanism, arcs: tuple[RobotArc, ...], placed: set[Id]) -> str | None:
    """Whether a path leads through a site that is on no body."""
    for arc in arcs:
        if arc.target.kind == "frame" and not (arc.target in placed and isinstance(mechanism.graph.vertices.get(arc.target), Frame)):
            return f"leads through {arc.target}, which is on no body"
    return None


def _hangs_on(edge: RobotEdge, gone: set[Id]) -> bool:
    return isinstance(edge.data, Coupling | Drive | Sense) and any(arc.target in gone for arc in edge.arcs)


def make_tendons_sound(mechanism: Mechanism, context: Context) -> Mechanism:
    """Limits become closed intervals; a cable around a shape has no armature."""
    changed: dict[Id, RobotEdge] = {}
    for key, tendon, arcs in mechanism.edges(Tendon):
        said: list[tuple[bool, str]] = []
        lower, upper = interval(tendon.limits, said)
        sound = replace(tendon, limits=replace(tendon.limits, lower=lower, upper=upper))
        if wrong_path(sound, arcs, mechanism.graph.edges) is not None or tendon.armature < 0.0:
            said.append((True, f"armature {tendon.armature!r} is left out: it is negative, or the cable leads around a shape"))
            sound = replace(sound, armature=0.0)
        for serious, text in said:
            say = context.report.warn if serious else context.report.note
            say(codes.REWRITTEN, f"{key}: {text}", mechanism.origin(key), element=str(key))
        if sound != tendon:
            changed[key] = Edge(sound, arcs)
    return mechanism.with_graph(mechanism.graph.replace(edges=changed)) if changed else mechanism


def name_wrapped_shapes(mechanism: Mechanism, _context: Context) -> Mechanism:
    """A shape around which a tendon leads has a name that no other shape has."""
    wrapped = [arc.target for _, _, arcs in mechanism.edges(Tendon) for arc in arcs if arc.target.kind == "shape"]
    taken = {shape.name for _, shape, _ in mechanism.edges(Shape) if shape.name} if wrapped else set()
    changed: dict[Id, RobotEdge] = {}
    for key in wrapped:
        edge = mechanism.graph.edges[key]
        if key in changed or not isinstance(edge.data, Shape) or edge.data.name:
            continue
        name, number = key.name, 2
        while name in taken:
            name, number = f"{key.name}_{number}", number + 1
        taken.add(name)
        changed[key] = replace(edge, data=replace(edge.data, name=name))
    return mechanism.with_graph(mechanism.graph.replace(edges=changed)) if changed else mechanism
