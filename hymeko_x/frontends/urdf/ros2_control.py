"""<ros2_control>: the actuators that its command interfaces describe; the element itself stays an extra."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.formats.urdf import ros2_control as words
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.parts import Actuator, Drive, Tendon
from hymeko_x.ir.tendons import FIXED
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.frontends.urdf.builder import UrdfBuilder
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.ir.parts import Parameters
    from hymeko_x.xml.tree import XmlNode


def read_ros2_control(root: XmlNode, builder: UrdfBuilder) -> None:
    """Add an actuator for each command interface that says which one it is, and one for all others of a joint together."""
    for system in (node for node in root.children if node.tag == words.TAG):
        gears = dict(_gears(system))
        for node in system.children:
            if node.tag == "joint":
                _read_joint(node, gears.get(node.attributes.get("name", ""), ("", None)), builder)
            elif node.tag == words.COMBINED:
                _read_combined(node, builder)


def _read_joint(node: XmlNode, gear: tuple[str, float | None], builder: UrdfBuilder) -> None:
    """Add the actuators of a joint's interfaces."""
    name, interfaces = node.attributes.get("name", ""), [child for child in node.children if child.tag == "command_interface"]
    plain = [child for child in interfaces if not _read_interface(child, name, builder)]
    if len(plain) == len(interfaces) > 0 and name in builder.joints:
        _read_commands(plain, name, gear, builder)


def _gears(system: XmlNode) -> Iterator[tuple[str, tuple[str, float | None]]]:
    """Of each joint with a simple transmission in this system: the name of its actuator, and the reduction."""
    for transmission in (node for node in system.children if node.tag == "transmission"):
        joints, actuators = ([node for node in transmission.children if node.tag == tag] for tag in ("joint", "actuator"))
        if len(joints) == len(actuators) == 1:
            texts = [child.text or "" for child in joints[0].children if child.tag in words.REDUCTIONS]
            numbers = read_numbers(texts[0]) if texts else None
            yield joints[0].attributes.get("name", ""), (actuators[0].attributes.get("name", ""), numbers[0] if numbers else None)


def _read_commands(interfaces: list[XmlNode], joint: str, gear: tuple[str, float | None], builder: UrdfBuilder) -> None:
    """The commands that the hardware takes for a joint, the first one with its parameters."""
    name, reduction = gear
    key = builder.fresh("actuator", name or joint, interfaces[0].origin)
    builder.vertices[key] = Actuator("transmission", _parameters(_texts(interfaces[0])))
    commands = tuple((words.COMMAND, node.attributes.get("name", "")) for node in interfaces)
    arcs: tuple[RobotArc, ...] = Arc(key, 1), Arc(builder.joints[joint], -1, None if reduction is None else (reduction,))
    builder.edges[builder.names.take("drive", key.name)] = Edge(Drive(words.TAG, commands), arcs)


def _read_interface(node: XmlNode, joint: str, builder: UrdfBuilder) -> bool:
    """Add the actuator of a joint's interface that says which one it is; whether it does."""
    kind = _texts(node).get(words.TYPE, "")
    if kind and joint in builder.joints:
        _drive(node, joint, builder.joints[joint], builder)
    return bool(kind)


def _drive(node: XmlNode, default: str, target: Id, builder: UrdfBuilder) -> None:
    """Add the actuator of an interface, of this name by default, and its drive."""
    texts = _texts(node)
    kind = texts.pop(words.TYPE)
    key = builder.fresh("actuator", texts.pop(words.NAME, "") or default, node.origin)
    gear = read_numbers(texts.pop(words.GEAR, ""))
    for name in ("min", "max"):
        texts.pop(name, "")  # the joint's own limits
    builder.vertices[key] = Actuator(kind, _parameters(texts))
    arcs: tuple[RobotArc, ...] = Arc(key, 1), Arc(target, -1, gear or None)
    builder.edges[builder.names.take("drive", key.name)] = Edge(Drive(), arcs)


def _read_combined(node: XmlNode, builder: UrdfBuilder) -> None:
    """Add the combination of joints that a <gpio> names, and the actuators of its interfaces; other ones stay extras alone."""
    texts = _texts(node)
    joints = texts.get(words.JOINTS, "").split()
    numbers = read_numbers(texts.get(words.COEFFICIENTS, "")) or ()
    interfaces = [child for child in node.children if child.tag == "command_interface" and _texts(child).get(words.TYPE)]
    if not interfaces or not joints or len(joints) != len(numbers) or any(name not in builder.joints for name in joints):
        return
    name = node.attributes.get("name", "")
    key = builder.fresh("tendon", texts.get(words.TENDON, "") or name, node.origin)
    arcs: tuple[RobotArc, ...] = tuple(Arc(builder.joints[joint], 1, (number,)) for joint, number in zip(joints, numbers, strict=True))
    builder.edges[key] = Edge(Tendon(FIXED), arcs)
    for interface in interfaces:
        _drive(interface, name, key, builder)


def _texts(node: XmlNode) -> dict[str, str]:
    return {child.attributes.get("name", ""): (child.text or "").strip() for child in node.children if child.tag == "param"}


def _parameters(texts: dict[str, str]) -> Parameters:
    found: list[tuple[str, float | str | tuple[float, ...]]] = []
    for name, text in texts.items():
        numbers = read_numbers(text)
        found.append((name, text if not numbers else numbers[0] if len(numbers) == 1 else numbers))
    return tuple(found)
