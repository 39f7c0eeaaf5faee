"""Transmissions as actuators: what their hardware interfaces command, by servos and motors that a simulation has."""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x import codes
from hymeko_x.diagnostics import counted, listed
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import Id, numbers_weight
from hymeko_x.ir.parts import Actuator, Coupling, DofKind, Drive, Joint
from hymeko_x.rewrite.servos import loads, parameters_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.ir.mechanism import Mechanism, RobotArc, RobotEdge
    from hymeko_x.ir.parts import Parameters
    from hymeko_x.rewrite.context import Context

_INTERFACES = ("hardwareInterface", "command_interface")
"""Parameters of a drive or an actuator that name what the hardware is commanded."""
HARDWARE_INTERFACE = re.compile(r"<hardwareInterface>\s*(?:\w+/)?(\w+)\s*<")
"""The interface that an element of a transmission names, without its package."""
KINDS: Mapping[str, str] = MappingProxyType(
    {
        "position": "position",
        "velocity": "velocity",
        "effort": "motor",
        "PositionJointInterface": "position",
        "PosVelJointInterface": "position",
        "VelocityJointInterface": "velocity",
        "EffortJointInterface": "motor",
    }
)
"""The actuator of each interface of ros_control and ros2_control that takes commands."""
_USUAL = "motor"
"""Without an interface a transmission is driven by an effort: so for the PR2, and for Drake."""
_SCALED: Mapping[str, int] = MappingProxyType({"position": 1, "velocity": 1, "motor": -1})
"""The power of the gear by which the range of a command grows when it is that of the motor instead of the joint."""
_SHOWN = 3


class _Command(Struct, frozen=True):
    """A transmission that moves one dof: its drive, its actuator, of which kind this is, and the arc to the joint with the gear."""

    drive: Id
    actuator: Id
    kind: str
    end: RobotArc


def drive_by_transmissions(mechanism: Mechanism, context: Context) -> Mechanism:
    """A transmission of one joint becomes the actuator that its hardware interface names, if nothing else drives the joint.

    Its reduction is the gear: commands are those of the motor, so that ranges and gains from the joint's limits are scaled by it.
    Transmissions of several joints stay as they are.

    Source: ros_control, transmission_interface (joint position is that of the actuator by the reduction, joint effort that times it), and
    gazebo_ros_control, DefaultRobotHWSim: only the first interface of a joint counts, and a transmission of several joints is left out.
    """
    commands = _commands(mechanism)
    if not commands:
        return mechanism
    carried = loads(mechanism) if any(command.kind == "position" for command in commands) else {}
    vertices: dict[Id, Actuator] = {}
    edges: dict[Id, RobotEdge] = {}
    for command in commands:
        joint = mechanism.joints[command.end.target]
        parameters = parameters_of(command.kind, joint.joint.dofs[0], carried.get((joint.id, 0)))
        given = _own_range(mechanism.vertex(command.actuator, Actuator))
        vertices[command.actuator] = Actuator(command.kind, _geared(command, {**dict(parameters), **given}))
        edges[command.drive] = Edge(Drive(), (Arc(command.actuator, 1), command.end))
    names = listed([f"'{command.end.target.name}' {command.kind}" for command in commands], _SHOWN)
    message = f"{counted(len(commands), 'transmission')} written as the actuators that the hardware interfaces name: {names}"
    context.report.note(codes.REWRITTEN, message, element=str(commands[0].actuator))
    return mechanism.replace(vertices=vertices, edges=edges)


def commanded(mechanism: Mechanism) -> list[Id]:
    """The transmissions that are written as actuators."""
    return [command.actuator for command in _commands(mechanism)]


def _commands(mechanism: Mechanism) -> list[_Command]:
    """The transmissions to be written: one for each joint, those of ros2_control before older ones."""
    found: dict[Id, _Command] = {}
    taken = moved_otherwise(mechanism)
    drives = sorted(mechanism.edges(Drive), key=lambda item: _INTERFACES[1] not in dict(item[1].parameters))
    for key, drive, arcs in drives:
        command = _command(mechanism, key, drive, arcs)
        if command is not None and command.end.target not in found and not {command.end.target, command.actuator} & taken:
            found[command.end.target] = command
            taken.add(command.actuator)
    return list(found.values())


def moved_otherwise(mechanism: Mechanism) -> set[Id]:
    """The joints that follow another one, or that an actuator drives already."""
    found = followers(mechanism)
    for _, _, arcs in mechanism.edges(Drive):
        if not all(is_transmission(mechanism, arc.target) for arc in arcs if arc.sign > 0):
            found |= {arc.target for arc in arcs if arc.sign < 0}
    return found


def followers(mechanism: Mechanism) -> set[Id]:
    """The joints that follow another one."""
    return {arc.target for _, _, arcs in mechanism.edges(Coupling) for arc in arcs if arc.sign > 0}


def is_transmission(mechanism: Mechanism, actuator: Id) -> bool:
    """Whether an actuator is that of a transmission, of which only the interface is known."""
    part = mechanism.part(actuator, Actuator)
    return part is not None and part.kind == "transmission"


def _command(mechanism: Mechanism, key: Id, drive: Drive, arcs: tuple[RobotArc, ...]) -> _Command | None:
    """What a transmission of one actuator and one joint with one dof commands; None for others, and where it only reads a state."""
    actuators, joints = [arc for arc in arcs if arc.sign > 0], [arc for arc in arcs if arc.sign < 0]
    if len(actuators) != 1 or len(joints) != 1 or not is_transmission(mechanism, actuators[0].target):
        return None
    view = mechanism.joints.get(joints[0].target)
    kind = _kind(drive, mechanism.vertex(actuators[0].target, Actuator))
    if kind is None or view is None or not is_scalar(view.joint):
        return None
    gear = numbers_weight(actuators[0]) or numbers_weight(joints[0])
    return _Command(key, actuators[0].target, kind, Arc(view.id, -1, gear if any(gear) else None))


def is_scalar(joint: Joint) -> bool:
    """Whether a joint is one hinge or one slide."""
    return len(joint.dofs) == 1 and joint.dofs[0].kind in (DofKind.HINGE, DofKind.SLIDE)


def _kind(drive: Drive, actuator: Actuator) -> str | None:
    """The kind of the first interface that takes commands, of the joint before that of the actuator."""
    for parameters in (drive.parameters, actuator.parameters):
        names = [str(value).rpartition("/")[2] for name, value in parameters if name in _INTERFACES]
        if names:
            return next((KINDS[name] for name in names if name in KINDS), None)
    return _USUAL


# ---- ranges ------------------------------------------------------------------------------------------------------------------


def _own_range(actuator: Actuator) -> dict[str, tuple[float, float]]:
    """The range of commands that an interface has itself."""
    own = dict(actuator.parameters)
    low, high = own.get("min"), own.get("max")
    return {"ctrlrange": (low, high)} if isinstance(low, float) and isinstance(high, float) and low < high else {}


def _geared(command: _Command, parameters: Mapping[str, float | str | tuple[float, ...]]) -> Parameters:
    """Gains and range of the joint as those of the motor: it moves the gear times as far, with as much less effort."""
    gear = (*numbers_weight(command.end), 1.0)[0]
    return tuple(_scaled(command.kind, gear, parameters)) if gear != 1.0 else tuple(parameters.items())


def _scaled(
    kind: str, gear: float, parameters: Mapping[str, float | str | tuple[float, ...]]
) -> Iterator[tuple[str, float | str | tuple[float, ...]]]:
    for name, value in parameters.items():
        if isinstance(value, tuple):
            ends = sorted(number * gear ** _SCALED[kind] for number in value)
            yield name, tuple(ends)
        else:
            yield name, value / gear**2 if name in ("kp", "kv") and isinstance(value, float) else value
