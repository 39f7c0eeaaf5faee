"""Transmissions (ROS 1): an actuator vertex per <actuator>, and one drive edge from the actuators to the joints.

The mechanical reduction is the weight of the arc to the element that has it; in a simple transmission (one actuator,
one joint, one reduction) it is always that of the joint. Everything else stays an extra.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats.urdf import notations
from hymeko_x.formats.urdf.notations import Reduction, TypeAs
from hymeko_x.frontends.urdf.builder import take_name
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.parts import Actuator, Drive
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from hymeko_x.frontends.urdf.builder import UrdfBuilder
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.ir.parts import Parameters
    from hymeko_x.xml.tree import XmlNode

_REDUCTION = "mechanicalReduction"


def read_transmission(node: XmlNode, builder: UrdfBuilder) -> None:
    """Add a transmission with its actuators."""
    key = take_name(node, "drive", builder.drives, builder)
    kind = _read_kind(node, key, builder)
    joints = [joint for joint in node.take_children("joint") if _is_known(node, joint, builder)]
    actuators = [actuator for actuator in node.take_children("actuator") if _is_named(node, actuator, builder)]
    if len(joints) == len(actuators) == 1:
        by_actuator, by_joint = _simple_reductions(node, key, actuators[0], joints[0], builder)
        arcs = [_actuator_arc(actuators[0], by_actuator, builder), _joint_arc(joints[0], by_joint, builder)]
    else:
        arcs = [_actuator_arc(actuator, _take_reduction(actuator), builder) for actuator in actuators]
        arcs += [_joint_arc(joint, _take_reduction(joint), builder) for joint in joints]
    parameters = _take_parameters(joints[0]) if len(joints) == 1 else ()
    builder.edges[key] = Edge(Drive(kind, parameters), tuple(arcs))
    builder.close(node)


def _read_kind(node: XmlNode, key: Id, builder: UrdfBuilder) -> str:
    """The transmission's type: a child with text (ROS 1), or an attribute (PR2)."""
    child = node.take_child("type")
    kind = child.take_text() if child is not None else node.take("type")
    if kind is not None:
        builder.choose(key, notations.TYPE_AS, TypeAs.CHILD if child is not None else TypeAs.ATTRIBUTE)
    return kind or ""


def _is_known(transmission: XmlNode, joint: XmlNode, builder: UrdfBuilder) -> bool:
    """Whether the joint exists; a reference that leads nowhere stays as it was written."""
    name = joint.attributes.get("name", "")
    if name in builder.joints:
        return True
    message = f"{transmission.subject} names joint '{name}', which is not defined; the reference is kept as written"
    builder.warn(codes.UNDEFINED_REFERENCE, joint, message)
    transmission.leave(joint)
    return False


def _is_named(transmission: XmlNode, actuator: XmlNode, builder: UrdfBuilder) -> bool:
    if actuator.attributes.get("name"):
        return True
    message = f"{transmission.subject} has an <actuator> without a name; it is kept as written"
    builder.warn(codes.BAD_NAME, actuator, message)
    transmission.leave(actuator)
    return False


# ---- reduction ---------------------------------------------------------------------------------------------------------------


def _take_reduction(node: XmlNode) -> float | None:
    """The number in <mechanicalReduction>; one that cannot be read stays as it was written."""
    child = node.take_child(_REDUCTION)
    if child is None:
        return None
    numbers = read_numbers(child.take_text())
    if numbers is None or len(numbers) != 1:
        node.leave(child)
        return None
    return numbers[0]


def _simple_reductions(
    node: XmlNode, key: Id, actuator: XmlNode, joint: XmlNode, builder: UrdfBuilder
) -> tuple[float | None, float | None]:
    """The weights of actuator and joint in a simple transmission: a single reduction is the joint's, wherever it is written."""
    found = {"actuator": _take_reduction(actuator), "joint": _take_reduction(joint)}
    if found["actuator"] is None and found["joint"] is None:
        found["transmission"] = _take_reduction(node)
    places = [place for place, value in found.items() if value is not None]
    if len(places) != 1:
        return found["actuator"], found["joint"]
    builder.choose(key, notations.REDUCTION, Reduction(places[0]))
    return None, found[places[0]]


# ---- arcs --------------------------------------------------------------------------------------------------------------------


def _actuator_arc(node: XmlNode, weight: float | None, builder: UrdfBuilder) -> RobotArc:
    role = _take_role(node)
    part = Actuator("transmission", _take_parameters(node))
    return Arc(_actuator(node, part, builder), 1, None if weight is None else (weight,), role)


def _actuator(node: XmlNode, part: Actuator, builder: UrdfBuilder) -> Id:
    """The vertex of an actuator; transmissions with the same one, described alike, share it."""
    name = node.take("name") or ""
    known = builder.actuators.get(name)
    if known is not None and builder.vertices[known] == part:
        return known
    key = builder.names.take("actuator", name)
    builder.vertices[key] = part
    builder.origins[key] = node.origin
    if known is not None:
        message = f"there are two different actuators called '{name}'; this one is called '{key.name}'"
        builder.report.warn(codes.DUPLICATE_NAME, message, node.origin, element=str(key))
    builder.actuators.setdefault(name, key)
    return key


def _joint_arc(node: XmlNode, weight: float | None, builder: UrdfBuilder) -> RobotArc:
    joint = builder.joints[node.take("name") or ""]
    return Arc(joint, -1, None if weight is None else (weight,), _take_role(node))


def _take_role(node: XmlNode) -> str:
    child = node.take_child("role")
    return "" if child is None else child.take_text()


def _take_parameters(node: XmlNode) -> Parameters:
    """The children of an element that contain nothing but text, in their order; numbers become numbers."""
    found: list[tuple[str, float | str | tuple[float, ...]]] = []
    for child in node.unread_children():
        if child.children or child.attributes or child.text is None:
            continue
        child.taken = True
        text = child.take_text()
        numbers = read_numbers(text)
        found.append((child.tag, numbers[0] if numbers is not None and len(numbers) == 1 else text))
    return tuple(found)
