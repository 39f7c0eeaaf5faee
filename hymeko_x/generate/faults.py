"""The faults that models make: elements that are missing or made up, wrong numbers, a file that breaks off.

The paper reports how often a file was not valid, and not by which fault: here all are equally likely. It reports no rate for wrong
numbers in valid files, which "LLMs are prone to"; they come as often again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.api import dumps
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import Id, joint_edge
from hymeko_x.ir.values import Pose, add

if TYPE_CHECKING:
    import random

    from hymeko_x.formats import Format
    from hymeko_x.ir.graph import Edge
    from hymeko_x.ir.mechanism import Mechanism

STRUCTURE = ("cut off", "no inertia", "no shapes", "no link", "made-up link")
NUMBERS = ("mass", "place", "axis", "limit")


def damaged(robot: Mechanism, format: Format, rate: float, chance: random.Random) -> str:
    """The robot as text of a format, with a fault of structure at this rate, and with a wrong number at the same rate."""
    cut = False
    if chance.random() < rate:
        fault = chance.choice(STRUCTURE)
        cut = fault == "cut off"
        robot = _with_fault(robot, fault, chance)
    if chance.random() < rate:
        robot = _with_fault(robot, chance.choice(NUMBERS), chance)
    text = dumps(robot, format.name, lenient=True)
    text = text[: len(text) * 2 // 3] if cut else text
    return f"Here is the file:\n```xml\n{text}\n```\n" if chance.random() < 0.5 else text


def _with_fault(robot: Mechanism, fault: str, chance: random.Random) -> Mechanism:
    """The robot with one fault, somewhere; the robot itself where it has no such element."""
    bodies = [key for key, _ in robot.vertices(parts.Body)]
    leaves = [key for key in bodies if key not in robot.children and key in robot.parent_joint]
    joints = list(robot.joints.values())
    body = chance.choice(bodies)
    if fault == "no inertia":
        return robot.replace(vertices={body: parts.Body()})
    if fault == "no shapes":
        return robot.replace(without=[view.id for view in robot.shapes.get(body, ())])
    if fault == "no link" and leaves:
        leaf = chance.choice(leaves)
        gone = {leaf, *(view.id for view in robot.shapes.get(leaf, ())), *(key for key, _, _ in robot.graph.edges_at(leaf))}
        return robot.replace(without=gone)
    if fault == "made-up link":
        extra = Id("body", "tool_link")
        edges = {Id("joint", "tool_joint"): joint_edge(parts.Joint(), body, extra)}
        return robot.replace(vertices={extra: parts.Body()}, edges=edges)
    if fault == "mass":
        inertial = robot.vertex(body, parts.Body).inertial
        heavier = None if inertial is None or inertial.mass is None else replace(inertial, mass=inertial.mass * 10)
        return robot.replace(vertices={body: parts.Body(heavier)}) if heavier else robot
    return _with_joint_fault(robot, fault, chance.choice(joints).id) if fault in NUMBERS and joints else robot


def _with_joint_fault(robot: Mechanism, fault: str, key: Id) -> Mechanism:
    """The robot with a wrong number in a joint."""
    view = robot.joints[key]
    joint, place = view.joint, view.parent_pose
    if fault == "place":
        place = Pose(add(place.xyz, (0.1, 0.0, 0.0)), place.quat)
    elif joint.dofs:
        first = joint.dofs[0]
        x, y, z = first.axis
        wrong = replace(first, axis=(y, z, x)) if fault == "axis" else replace(first, limits=replace(first.limits, upper=0.5, lower=-0.5))
        joint = parts.Joint((replace(wrong, written=None), *joint.dofs[1:]))
    edge: Edge[Id, parts.EdgePart, parts.Weight] = joint_edge(joint, view.parent, view.child, place, view.child_pose)
    return robot.replace(edges={key: edge})
