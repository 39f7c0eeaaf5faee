"""Which actuators of a mechanism are written: those that drive something and that the format knows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.ir.parts import Actuator, Drive

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, Mechanism
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
        context.report.warn(codes.NOT_SAID, f"{key} drives nothing, and is left out", mechanism.origin(key), element=str(key), hint=hint)
    return without_actuators(mechanism, idle)


def without_actuators(mechanism: Mechanism, actuators: list[Id]) -> Mechanism:
    """The mechanism without these actuators and the edges that lead to them."""
    if not actuators:
        return mechanism
    gone = set(actuators)
    drives = [key for key, _, arcs in mechanism.edges(Drive) if any(arc.target in gone for arc in arcs)]
    return mechanism.replace(without=[*gone, *drives])
