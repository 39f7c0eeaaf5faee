"""The plugins by which Gazebo moves joints: one controller for each driven joint, and one that publishes where they are.

Source: Gazebo Sim 9, the pages of its systems JointPositionController, JointController, ApplyJointForce and JointStatePublisher.
"""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import Report, counted, listed
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import notations
from hymeko_x.formats.sdf.values import NUMBER
from hymeko_x.ir.mechanism import ROOT, Extra, numbers_weight
from hymeko_x.ir.parts import Actuator, Drive
from hymeko_x.rewrite import legalize
from hymeko_x.rewrite.actuators import MUJOCO_KINDS
from hymeko_x.rewrite.choices import with_actuators
from hymeko_x.rewrite.servos import dof_of, loads
from hymeko_x.rewrite.transmissions import drive_by_transmissions
from hymeko_x.xml.printing import Tag, ready
from hymeko_x.xml.text import escaped

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.rewrite.context import Context
    from hymeko_x.rewrite.servos import Load

_SHOWN = 4
_SYSTEMS = {
    "position": ("gz-sim-joint-position-controller-system", "gz::sim::systems::JointPositionController"),
    "velocity": ("gz-sim-joint-controller-system", "gz::sim::systems::JointController"),
    "force": ("gz-sim-apply-joint-force-system", "gz::sim::systems::ApplyJointForce"),
}
_PUBLISHER = ("gz-sim-joint-state-publisher-system", "gz::sim::systems::JointStatePublisher")
_NAMED = re.compile(r"<joint_name>\s*([^<]*?)\s*</joint_name>")
_CONTROLS_ALL = re.compile(r"<plugin\b[^>]*\b(?:gz_|ign_|gazebo_)?ros2?_control")
"""A plugin of ROS that takes the robot's own description of its controllers."""


def control_joints(mechanism: Mechanism, context: Context) -> Mechanism:
    """Each driven joint gets the plugin of its actuator; of a robot without actuators every joint is held by a position servo."""
    own = [extra.text for extra in mechanism.extras.get(ROOT, ())]
    if any(_CONTROLS_ALL.search(text) for text in own):
        return mechanism
    done = {name for text in own for name in _NAMED.findall(text)}
    legal = drive_by_transmissions(legalize(mechanism, words.FORMAT, Report()), context)
    if not any(part.kind in MUJOCO_KINDS for _, part in legal.vertices(Actuator)):
        legal = with_actuators(legal, "position", context.report)
    plugins, left = _plugins(legal)
    plugins = {place: tag for place, tag in plugins.items() if escaped(place[0].name) not in done}
    if left:
        names = listed([f"'{key.name}'" for key in left], _SHOWN)
        context.report.warn(
            codes.NOT_REPRESENTED, f"{counted(len(left), 'actuator')} that no plugin of Gazebo stands for: {names}", element=str(left[0])
        )
    if not plugins:
        return mechanism
    tags = list(plugins.values())
    if not any(_PUBLISHER[0] in text for text in own):
        tags.append(_tag(_PUBLISHER))
    place = "world/model" if mechanism.notation(ROOT, notations.WORLD) is not None else "model"
    last = len(legal.graph.vertices) + len(legal.graph.edges)
    extras = tuple(Extra(words.FORMAT, place, ready(tag, 2), number) for number, tag in enumerate(tags, last))
    context.report.note(codes.FOR_TARGET, f"plugins of Gazebo control {counted(len(plugins), 'joint')} ({context.reason})")
    return replace(mechanism, extras={**mechanism.extras, ROOT: (*mechanism.extras.get(ROOT, ()), *extras)})


def _plugins(mechanism: Mechanism) -> tuple[dict[tuple[Id, int], Tag], list[Id]]:
    """The plugin of each driven dof, and the actuators that have none."""
    found: dict[tuple[Id, int], Tag] = {}
    left: list[Id] = []
    carried = loads(mechanism)
    for _, drive, arcs in mechanism.edges(Drive):
        targets = [arc for arc in arcs if arc.sign < 0]
        key = next((arc.target for arc in arcs if arc.sign > 0), None)
        part = None if key is None else mechanism.graph.vertices.get(key)
        if key is None or not isinstance(part, Actuator) or part.kind not in MUJOCO_KINDS:
            continue
        place = dof_of(mechanism, targets[0]) if len(targets) == 1 and not drive.kind and targets[0].target in mechanism.joints else None
        if place is None or place in found or words.SCOPE in place[0].name:
            left.append(key)
            continue
        gear = (*numbers_weight(targets[0]), 1.0)[0]
        control = _control(part, gear, carried.get(place))
        if control is None:
            left.append(key)
        else:
            found[place] = _controller(place, *control, mechanism)
    return found, left


def _control(actuator: Actuator, gear: float, load: Load | None) -> tuple[str, float, float] | None:
    """What is commanded, and the proportional and derivative gains at the joint; None for another law of force."""
    values = dict(actuator.parameters)
    scale = gear * gear
    bias = values.get("biasprm")
    numbers = tuple(float(value) for value in bias) if isinstance(bias, tuple) else ()
    _, stiffness, damping = (*numbers, 0.0, 0.0, 0.0)[:3]
    if actuator.kind == "position":
        stiffness, damping = -_number(values, "kp", 1.0), -_number(values, "kv", _damping(values, load))
    elif actuator.kind == "velocity":
        stiffness, damping = 0.0, -_number(values, "kv", 1.0)
    elif actuator.kind == "motor":
        return "force", 0.0, 0.0
    elif actuator.kind != "general":
        return None
    elif values.get("biastype", "none") != "affine":
        return ("force", 0.0, 0.0) if values.get("gaintype", "fixed") == "fixed" else None
    if stiffness < 0.0:
        return "position", -stiffness * scale, -damping * scale
    return ("velocity", -damping * scale, 0.0) if damping < 0.0 else None


def _damping(values: Mapping[str, object], load: Load | None) -> float:
    """The damping that a ratio to the critical one means, for the inertia that is moved at home."""
    ratio = _number(values, "dampratio", 0.0)
    return 2.0 * ratio * math.sqrt(_number(values, "kp", 1.0) * load.inertia) if load is not None and load.inertia > 0.0 else 0.0


def _number(values: Mapping[str, object], name: str, usual: float) -> float:
    value = values.get(name, usual)
    return float(value) if isinstance(value, int | float) else usual


def _controller(place: tuple[Id, int], kind: str, proportional: float, derivative: float, mechanism: Mechanism) -> Tag:
    joint, number = place
    tag = _tag(_SYSTEMS[kind])
    for name, text in _parameters(joint, number, kind, proportional, derivative, mechanism):
        tag.add(name).children.append(text)
    return tag


def _parameters(
    joint: Id, number: int, kind: str, proportional: float, derivative: float, mechanism: Mechanism
) -> Iterator[tuple[str, str]]:
    yield "joint_name", escaped(joint.name)
    if number:
        yield "joint_index", str(number)
    if kind == "force":
        return
    if kind == "velocity":
        yield "use_force_commands", "true"
    yield from (("p_gain", NUMBER.write(proportional)), ("i_gain", "0"), ("d_gain", NUMBER.write(derivative)))
    effort = mechanism.joints[joint].joint.dofs[number].limits.effort
    if effort:
        yield from (("cmd_max", NUMBER.write(effort)), ("cmd_min", NUMBER.write(-effort)))


def _tag(system: tuple[str, str]) -> Tag:
    return Tag("plugin", {"filename": system[0], "name": system[1]})
