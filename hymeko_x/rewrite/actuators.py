"""Which actuators of a mechanism are written: those that drive something and that the format knows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import counted, listed
from hymeko_x.ir.graph import Edge
from hymeko_x.ir.parts import Actuator, Drive, Sense, Sensor

if TYPE_CHECKING:
    from collections.abc import Iterator, Set

    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge
    from hymeko_x.rewrite.context import Context

_SHOWN = 3
"""How many names a message lists."""

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


def drop_foreign_actuators(mechanism: Mechanism, _context: Context) -> Mechanism:
    """Actuators of kinds that MJCF has no element for are left out: the transmissions that are no commands of one joint."""
    return without_actuators(mechanism, [key for key, actuator in mechanism.vertices(Actuator) if actuator.kind not in MUJOCO_KINDS])


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
        context.report.warn(
            codes.NOT_REPRESENTED, f"{key} drives nothing, and is left out", mechanism.origin(key), element=str(key), hint=hint
        )
    return without_actuators(mechanism, idle)


def without_actuators(mechanism: Mechanism, actuators: list[Id]) -> Mechanism:
    """The mechanism without these actuators, the edges that lead to them and the sensors that measure them."""
    if not actuators:
        return mechanism
    gone = set(actuators)
    drives = [key for key, _, arcs in mechanism.edges(Drive) if any(arc.target in gone for arc in arcs)]
    return mechanism.replace(without=[*gone, *drives, *_sensing(mechanism, gone)])


def _sensing(mechanism: Mechanism, measured: Set[Id]) -> Iterator[Id]:
    """The sensors that measure one of these elements, and the edges with which they do."""
    for key, _, arcs in mechanism.edges(Sense):
        if any(arc.target in measured for arc in arcs):
            yield key
            yield from (arc.target for arc in arcs if arc.sign < 0)


def with_sensors(mechanism: Mechanism, before: Mechanism, report: Report) -> Mechanism:
    """The robot with other actuators, in which the sensors of those before measure the new ones that drive the same dof.

    The others are left out, with a note. The sensors stay in their order.
    """
    driving = {driven: key for key, driven in _driven_by(mechanism)}
    successors = {key: driving[driven] for key, driven in _driven_by(before) if driven in driving}
    gone = {key for key, _ in before.vertices(Actuator) if key not in successors and key not in mechanism.graph.vertices}
    lost = dict.fromkeys(_sensing(before, gone))
    sensors = {key: part for key, part in before.vertices(Sensor) if key not in lost}
    edges: dict[Id, RobotEdge] = {}
    for key, sense, arcs in before.edges(Sense):
        if key not in lost:
            edges[key] = Edge(sense, tuple([replace(arc, target=successors.get(arc.target, arc.target)) for arc in arcs]))
    names = [f"'{key.name}'" for key in lost if key.kind == "sensor"]
    if names:
        message = f"{counted(len(names), 'sensor')} left out with the actuators that they measure: {listed(names, _SHOWN)}"
        report.note(codes.REWRITTEN, message, element=str(next(iter(lost))))
    there = {**dict(mechanism.vertices(Sensor)), **dict.fromkeys(key for key, _, _ in mechanism.edges(Sense))}
    return mechanism.replace(without=there).replace(vertices=sensors, edges=edges)


def _driven_by(mechanism: Mechanism) -> Iterator[tuple[Id, tuple[Id, str]]]:
    """The actuators that drive one element, with that element and the role of its arc."""
    for _, _, arcs in mechanism.edges(Drive):
        driven = [(arc.target, arc.role) for arc in arcs if arc.sign < 0]
        if len(driven) == 1:
            yield from ((arc.target, driven[0]) for arc in arcs if arc.sign > 0)
