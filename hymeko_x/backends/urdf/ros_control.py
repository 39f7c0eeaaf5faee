"""Transmissions of ROS 1 in <ros2_control>: the commands of their joints, and the same transmissions in the words of ROS 2.

Source: ros2_control, hardware_interface/src/component_parser.cpp and the loaders of transmission_interface, which are those of ros_control.
"""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x.formats.urdf import ros2_control as words
from hymeko_x.ir.digits import number_text
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import numbers_weight
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.parts import Actuator, Drive
from hymeko_x.rewrite.roots import without
from hymeko_x.rewrite.transmissions import HARDWARE_INTERFACE, is_transmission
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc, RobotEdge
    from hymeko_x.xml.printing import Tag

_OLD: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "PositionJointInterface": (words.POSITION,),
        "VelocityJointInterface": (words.VELOCITY,),
        "PosVelJointInterface": (words.POSITION, words.VELOCITY),
        "EffortJointInterface": (words.EFFORT,),
        "JointStateInterface": (),
    }
)
"""The command interfaces of an interface of ROS 1."""
_ENDS: Mapping[str, int] = MappingProxyType({"SimpleTransmission": 1, "DifferentialTransmission": 2, "FourBarLinkageTransmission": 2})
"""The transmissions that ROS 2 has as well, with their numbers of joints and of actuators."""
_LIBRARY = "transmission_interface/"
_OFFSET = re.compile(r"<offset>\s*([^<\s]+)\s*<")


class Transmission(Struct, frozen=True):
    """A drive that ROS 2 has a transmission for: its kind, its ends, and by joint the command interfaces and the text of an offset."""

    key: Id
    kind: str
    actuators: list[RobotArc]
    joints: list[RobotArc]
    commands: dict[Id, list[str]]
    offsets: dict[Id, str]


def transmissions(mechanism: Mechanism) -> tuple[list[Transmission], list[Id]]:
    """The transmissions that ROS 2 has as well, one for each joint, and the others."""
    found: list[Transmission] = []
    left: list[Id] = []
    taken: set[Id] = set()
    for key, drive, arcs in mechanism.edges(Drive):
        ends = [arc for arc in arcs if arc.sign > 0]
        if not ends or not all(is_transmission(mechanism, arc.target) for arc in ends) or drive.kind == words.TAG:
            continue
        made = _transmission(mechanism, key, drive, arcs)
        if made is None or not taken.isdisjoint(made.commands):
            left.append(key)
        else:
            found.append(made)
            taken.update(made.commands)
    return found, left


def _transmission(mechanism: Mechanism, key: Id, drive: Drive, arcs: tuple[RobotArc, ...]) -> Transmission | None:
    """The drive as a transmission of ROS 2; None where ROS 2 has no such one."""
    kind = drive.kind.rpartition("/")[2] or "SimpleTransmission"
    actuators, joints = ([arc for arc in arcs if arc.sign == sign] for sign in (1, -1))
    views = [mechanism.joints.get(arc.target) for arc in joints]
    if not len(actuators) == len(joints) == _ENDS.get(kind) or any(view is None or len(view.joint.dofs) != 1 for view in views):
        return None
    own = [f"<{name}>{value}<" for name, value in (*drive.parameters, *mechanism.vertex(actuators[0].target, Actuator).parameters)]
    commands: dict[Id, list[str]] = {}
    offsets: dict[Id, str] = {}
    for number, arc in enumerate(joints, 1):
        path = "joint" if number == 1 else f"joint[{number}]"
        texts = [extra.text for extra in mechanism.extras.get(key, ()) if extra.path == path] + (own if len(joints) == 1 else [])
        names = [found[1] for text in texts if (found := HARDWARE_INTERFACE.search(text))]
        commands[arc.target] = [*dict.fromkeys(new for name in names for new in _OLD.get(name, ()))] if names else [words.EFFORT]
        offset = next((found[1] for text in texts if (found := _OFFSET.search(text))), "")
        if offset and (read_numbers(offset) or (0.0,))[0]:
            offsets[arc.target] = offset
    return Transmission(key, kind, actuators, joints, commands, offsets)


# ---- writing -----------------------------------------------------------------------------------------------------------------


def add_transmission(system: Tag, transmission: Transmission) -> None:
    """The <transmission> of a system: its plugin, its ends with their reductions, offsets, and roles, which two need."""
    tag = system.add("transmission", name=transmission.key.name)
    tag.add("plugin").children.append(f"{_LIBRARY}{transmission.kind}")
    for name, arcs in (("actuator", transmission.actuators), ("joint", transmission.joints)):
        for number, arc in enumerate(arcs, 1):
            end = tag.add(name, name=arc.target.name, role=arc.role or f"{name}{number}")
            for weight in numbers_weight(arc)[:1]:
                end.add(words.REDUCTIONS[0]).children.append(number_text(weight))
            if name == "joint" and arc.target in transmission.offsets:
                end.add("offset").children.append(transmission.offsets[arc.target])


def with_commands(
    mechanism: Mechanism, moved: list[Transmission], limits: Mapping[Id, Mapping[str, tuple[tuple[str, float], ...]]]
) -> Mechanism:
    """The robot with the actuators of the command interfaces in place of those of ROS 1, as they are read again."""
    gone = [arc.target for one in moved for arc in one.actuators]
    mechanism = without(mechanism, [*dict.fromkeys(gone), *(one.key for one in moved)])
    extras = {one.key: tuple(extra for extra in mechanism.extras.get(one.key, ()) if not _is_moved(extra.text)) for one in moved}
    mechanism = replace(mechanism, extras={key: found for key, found in {**mechanism.extras, **extras}.items() if found})
    names = names_in_use(mechanism)
    vertices: dict[Id, Actuator] = {}
    edges: dict[Id, RobotEdge] = {}
    for one, joint in [(each, joint) for each in moved for joint in each.joints if each.commands[joint.target]]:
        commands = one.commands[joint.target]
        simple = len(one.joints) == 1
        key = names.take("actuator", one.actuators[0].target.name if simple else joint.target.name)
        vertices[key] = Actuator("transmission", limits[joint.target].get(commands[0], ()))
        end: RobotArc = Arc(joint.target, -1, numbers_weight(joint)[:1] or None if simple else None)
        parameters = tuple((words.COMMAND, name) for name in commands)
        arcs: tuple[RobotArc, ...] = Arc(key, 1), end
        edges[names.take("drive", key.name)] = Edge(Drive(words.TAG, parameters), arcs)
    return mechanism.replace(vertices=vertices, edges=edges)


def _is_moved(text: str) -> bool:
    return bool(HARDWARE_INTERFACE.match(text) or _OFFSET.match(text))
