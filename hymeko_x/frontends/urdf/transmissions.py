"""Transmissions (ROS 1): an actuator vertex per <actuator>, and one drive edge from the actuators to the joints.

The mechanical reduction is the weight of the arc to the element that says it; in a simple transmission (one actuator,
one joint, one reduction) it is always that of the joint. What does not fit stays an extra.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats import urdf as words
from hymeko_x.frontends.urdf.draft import take_name
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.parts import Actuator, Drive
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from hymeko_x.frontends.urdf.draft import Draft
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.ir.parts import Parameters
    from hymeko_x.xml.tree import Node

_REDUCTION = "mechanicalReduction"


def read_transmission(node: Node, draft: Draft) -> None:
    """Add a transmission with its actuators."""
    key = take_name(node, "drive", draft.drives, draft)
    kind = _read_kind(node, key, draft)
    joints = [joint for joint in node.take_children("joint") if _is_known(node, joint, draft)]
    actuators = [actuator for actuator in node.take_children("actuator") if _is_named(node, actuator, draft)]
    if len(joints) == len(actuators) == 1:
        by_actuator, by_joint = _simple_reductions(node, key, actuators[0], joints[0], draft)
        arcs = [_actuator_arc(actuators[0], by_actuator, draft), _joint_arc(joints[0], by_joint, draft)]
    else:
        arcs = [_actuator_arc(actuator, _take_reduction(actuator), draft) for actuator in actuators]
        arcs += [_joint_arc(joint, _take_reduction(joint), draft) for joint in joints]
    parameters = _take_parameters(joints[0]) if len(joints) == 1 else ()
    draft.edges[key] = Edge(Drive(kind, parameters), tuple(arcs))
    draft.close(node)


def _read_kind(node: Node, key: Id, draft: Draft) -> str:
    """The transmission's type: a child with text (ROS 1), or an attribute (PR2)."""
    child = node.take_child("type")
    kind = child.take_text() if child is not None else node.take("type")
    if kind is not None:
        draft.choose(key, words.TYPE_AS, "child" if child is not None else "attribute")
    return kind or ""


def _is_known(transmission: Node, joint: Node, draft: Draft) -> bool:
    """Whether the joint exists; a reference that leads nowhere stays as it was written."""
    name = joint.attributes.get("name", "")
    if name in draft.joints:
        return True
    said = f"{transmission.subject} names joint '{name}', which is not defined; the reference is kept as written"
    draft.report.warn(codes.UNDEFINED_REFERENCE, said, joint.origin, element=transmission.element)
    transmission.leave(joint)
    return False


def _is_named(transmission: Node, actuator: Node, draft: Draft) -> bool:
    if actuator.attributes.get("name"):
        return True
    said = f"{transmission.subject} has an <actuator> without a name; it is kept as written"
    draft.report.warn(codes.BAD_NAME, said, actuator.origin, element=transmission.element)
    transmission.leave(actuator)
    return False


# ---- reduction ---------------------------------------------------------------------------------------------------------------


def _take_reduction(node: Node) -> float | None:
    """The number in <mechanicalReduction>; one that cannot be read stays as it was written."""
    child = node.take_child(_REDUCTION)
    if child is None:
        return None
    numbers = read_numbers(child.take_text())
    if numbers is None or len(numbers) != 1:
        node.leave(child)
        return None
    return numbers[0]


def _simple_reductions(node: Node, key: Id, actuator: Node, joint: Node, draft: Draft) -> tuple[float | None, float | None]:
    """The weights of actuator and joint in a simple transmission: a reduction said once is the joint's, whoever says it."""
    said = {"actuator": _take_reduction(actuator), "joint": _take_reduction(joint)}
    if said["actuator"] is None and said["joint"] is None:
        said["transmission"] = _take_reduction(node)
    places = [place for place, value in said.items() if value is not None]
    if len(places) != 1:
        return said["actuator"], said["joint"]
    draft.choose(key, words.REDUCTION, places[0])
    return None, said[places[0]]


# ---- arcs --------------------------------------------------------------------------------------------------------------------


def _actuator_arc(node: Node, weight: float | None, draft: Draft) -> RobotArc:
    role = _take_role(node)
    part = Actuator("transmission", _take_parameters(node))
    return Arc(_actuator(node, part, draft), 1, None if weight is None else (weight,), role)


def _actuator(node: Node, part: Actuator, draft: Draft) -> Id:
    """The vertex of an actuator; transmissions that name the same one, and say the same of it, share it."""
    name = node.take("name") or ""
    known = draft.actuators.get(name)
    if known is not None and draft.vertices[known] == part:
        return known
    key = draft.names.take("actuator", name)
    draft.vertices[key] = part
    draft.origins[key] = node.origin
    if known is not None:
        said = f"there are two different actuators called '{name}'; this one is called '{key.name}'"
        draft.report.warn(codes.DUPLICATE_NAME, said, node.origin, element=str(key))
    draft.actuators.setdefault(name, key)
    return key


def _joint_arc(node: Node, weight: float | None, draft: Draft) -> RobotArc:
    joint = draft.joints[node.take("name") or ""]
    return Arc(joint, -1, None if weight is None else (weight,), _take_role(node))


def _take_role(node: Node) -> str:
    child = node.take_child("role")
    return "" if child is None else child.take_text()


def _take_parameters(node: Node) -> Parameters:
    """What an element says in children that hold nothing but text, in their order; numbers become numbers."""
    found: list[tuple[str, float | str | tuple[float, ...]]] = []
    for kid in node.unread_children():
        if kid.children or kid.attributes or kid.text is None:
            continue
        kid.taken = True
        text = kid.take_text()
        numbers = read_numbers(text)
        found.append((kid.tag, numbers[0] if numbers is not None and len(numbers) == 1 else text))
    return tuple(found)
