"""<ros2_control>: the actuators that its command interfaces describe; the element itself stays an extra."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.formats.urdf import ros2_control as words
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.parts import Actuator, Drive
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from hymeko_x.frontends.urdf.builder import UrdfBuilder
    from hymeko_x.ir.mechanism import RobotArc
    from hymeko_x.ir.parts import Parameters
    from hymeko_x.xml.tree import Node


def read_ros2_control(root: Node, builder: UrdfBuilder) -> None:
    """Add an actuator for each command interface that says which one it is."""
    for system in (node for node in root.children if node.tag == words.TAG):
        for joint in (node for node in system.children if node.tag == "joint"):
            for interface in (node for node in joint.children if node.tag == "command_interface"):
                _read_interface(interface, joint.attributes.get("name", ""), builder)


def _read_interface(node: Node, joint: str, builder: UrdfBuilder) -> None:
    texts = {child.attributes.get("name", ""): (child.text or "").strip() for child in node.children if child.tag == "param"}
    kind = texts.pop(words.TYPE, "")
    if not kind or joint not in builder.joints:
        return
    key = builder.fresh("actuator", texts.pop(words.NAME, "") or joint, node.origin)
    gear = read_numbers(texts.pop(words.GEAR, ""))
    for name in ("min", "max"):
        texts.pop(name, "")  # the joint's own limits
    builder.vertices[key] = Actuator(kind, _parameters(texts))
    arcs: tuple[RobotArc, ...] = Arc(key, 1), Arc(builder.joints[joint], -1, gear or None)
    builder.edges[builder.names.take("drive", key.name)] = Edge(Drive(), arcs)


def _parameters(texts: dict[str, str]) -> Parameters:
    found: list[tuple[str, float | str | tuple[float, ...]]] = []
    for name, text in texts.items():
        numbers = read_numbers(text)
        found.append((name, text if not numbers else numbers[0] if len(numbers) == 1 else numbers))
    return tuple(found)
