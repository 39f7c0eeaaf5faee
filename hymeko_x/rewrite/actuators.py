"""Which actuators are written: those that the mechanism has and the target knows, one kind for every dof, or none."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.kinematics import dof_number
from hymeko_x.ir.names import Names
from hymeko_x.ir.parts import Actuator, Coupling, DofKind, Drive

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.ir.mechanism import Id, JointView, Mechanism, RobotEdge
    from hymeko_x.ir.parts import Dof, Parameters
    from hymeko_x.rewrite.context import Context

MUJOCO_KINDS = frozenset(
    (
        "general",
        "motor",
        "position",
        "velocity",
        "intvelocity",
        "orientation",
        "pid",
        "damper",
        "cylinder",
        "muscle",
        "adhesion",
        "dcmotor",
        "plugin",
    )
)
"""The kinds of actuators that MJCF has an element for."""

_STIFFNESS = 100.0
"""Position gain in Nm/rad or N/m of a joint without effort limit."""
_FULL_EFFORT_AT = 0.1
"""The error (rad or m; for velocities a part of the limit) at which a servo asks for all of the effort limit."""


def choose_actuators(mechanism: Mechanism, context: Context) -> Mechanism:
    """Actuators as the options ask. By default those of kinds that MJCF has (a URDF transmission is none)."""
    present = dict(mechanism.vertices(Actuator))
    if context.options.actuators is None:
        return _without(mechanism, [key for key, actuator in present.items() if actuator.kind not in MUJOCO_KINDS])
    vertices: dict[Id, Actuator] = {}
    edges: dict[Id, RobotEdge] = {}
    if context.options.actuators != "none":
        names = Names()
        for view, name, dof in _driven_dofs(mechanism):
            key = names.take("actuator", name)
            vertices[key] = Actuator(context.options.actuators, _parameters(context.options.actuators, dof))
            role = dof.name or "" if len(view.joint.dofs) > 1 else ""
            edges[names.take("drive", name)] = Edge(Drive(), (Arc(key, 1), Arc(view.id, -1, None, role)))
    if present == vertices:
        return mechanism
    replaced = [key for key, actuator in present.items() if actuator.kind in MUJOCO_KINDS]
    if replaced:
        what = "left out" if context.options.actuators == "none" else f"replaced by one {context.options.actuators} per driven dof"
        context.report.note(codes.REWRITTEN, f"{len(replaced)} actuators of the source are {what}, as asked", element=str(replaced[0]))
    bare = _without(mechanism, list(present))
    return bare.with_graph(bare.graph.replace(vertices=vertices, edges=edges))


def drop_idle_actuators(mechanism: Mechanism, context: Context) -> Mechanism:
    """An actuator that drives nothing is left out: MuJoCo refuses it."""
    driving: set[Id] = set()
    pointless: set[Id] = set()
    for _, _, arcs in mechanism.edges(Drive):
        found = driving if any(arc.sign < 0 for arc in arcs) else pointless
        found.update(arc.target for arc in arcs if arc.sign > 0)
    idle = [key for key, _ in mechanism.vertices(Actuator) if key not in driving]
    for key in idle:
        hint = "a '-' arc of its drive leads to what it drives" if key in pointless else ""
        context.report.warn(codes.NOT_SAID, f"{key} drives nothing, and is left out", mechanism.origin(key), element=str(key), hint=hint)
    return _without(mechanism, idle)


def _without(mechanism: Mechanism, actuators: list[Id]) -> Mechanism:
    """The mechanism without these actuators and the edges that hang on them."""
    if not actuators:
        return mechanism
    gone = set(actuators)
    drives = [key for key, _, arcs in mechanism.edges(Drive) if any(arc.target in gone for arc in arcs)]
    return mechanism.with_graph(mechanism.graph.replace(without=[*gone, *drives]))


def _driven_dofs(mechanism: Mechanism) -> Iterator[tuple[JointView, str, Dof]]:
    """Every hinge and slide that follows no other dof, with the name that it is written under."""
    followers = set()
    for _, _, arcs in mechanism.edges(Coupling):
        for arc in arcs:
            if arc.sign > 0 and arc.target in mechanism.joints:
                followers.add((arc.target, dof_number(mechanism.joints[arc.target].joint, arc.role)))
    for view in mechanism.joints.values():
        for number, dof in enumerate(view.joint.dofs):
            if dof.kind in (DofKind.HINGE, DofKind.SLIDE) and (view.id, number) not in followers:
                yield view, dof.name or view.id.name, dof


def _parameters(kind: str, dof: Dof) -> Parameters:
    """Control ranges from the limits; gains so that the effort limit is reached at a small error."""
    limits = dof.limits
    match kind:
        case "position":
            gain = limits.effort / _FULL_EFFORT_AT if limits.effort else _STIFFNESS
            reach = ((limits.lower, limits.upper),) if limits.lower is not None and limits.upper is not None else ()
            return (("kp", gain), ("dampratio", 1.0), *(("ctrlrange", span) for span in reach))
        case "velocity":
            speed = limits.velocity or 0.0
            gain = limits.effort / (_FULL_EFFORT_AT * (speed or 1.0)) if limits.effort else _STIFFNESS * _FULL_EFFORT_AT
            return (("kv", gain), *((("ctrlrange", (-speed, speed)),) if speed else ()))
        case _:
            return (("ctrlrange", (-limits.effort, limits.effort)),) if limits.effort else ()
