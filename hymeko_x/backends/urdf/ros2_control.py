"""<ros2_control> of the drives of a robot: which joint takes which command, within which limits, and from which state it starts."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.backends.urdf.ros_control import add_transmission, transmissions, with_commands
from hymeko_x.backends.urdf.rules import with_joints_of_urdf
from hymeko_x.diagnostics import counted, listed
from hymeko_x.formats import urdf as urdf_words
from hymeko_x.formats.urdf import ros2_control as words
from hymeko_x.ir.digits import number_text, numbers_text
from hymeko_x.ir.kinematics import dof_at
from hymeko_x.ir.mechanism import ROOT, Extra, end_of, numbers_weight
from hymeko_x.ir.parts import Actuator, DofKind, Drive, Stance, Tendon
from hymeko_x.ir.tendons import FIXED
from hymeko_x.rewrite.mimics import moving_joints
from hymeko_x.rewrite.transmissions import followers
from hymeko_x.xml.printing import Tag, ready
from hymeko_x.xml.text import escaped

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from hymeko_x.backends.urdf.ros_control import Transmission
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.ir.parts import Dof
    from hymeko_x.rewrite.context import Context

_SHOWN = 4
_PLAIN = ("", "jointinparent")
"""The kinds of drives that act along the axis of a hinge or a slide."""
Command = tuple[str, "Id", Actuator, tuple[float, ...]]
"""What a joint is commanded, the actuator that takes it with its id, and its gear."""


class Combination(NamedTuple):
    """An actuator on a linear combination of joints: its command, the tendon, the gear, and each joint with its coefficient."""

    actuator: Id
    interface: str
    tendon: Id
    gear: tuple[float, ...]
    joints: tuple[tuple[str, float], ...]


def declare_ros2_control(mechanism: Mechanism, context: Context) -> Mechanism:
    """The drives of joints as command interfaces of <ros2_control>, unless the robot has such an element already."""
    own = mechanism.extras.get(ROOT, ())
    if any(extra.text.startswith(f"<{words.TAG}") for extra in own):
        return mechanism
    seen = with_joints_of_urdf(mechanism, context)
    commands, left = _commands(seen, _on_balls(mechanism))
    combined = [one for key in left if (one := _combination(seen, key)) is not None]
    left = [key for key in left if key not in {one.actuator for one in combined}]
    if left:
        names = listed([f"'{key.name}'" for key in left], _SHOWN)
        message = f"{counted(len(left), 'actuator')} without a single joint and a command of its own, and without <{words.TAG}>: {names}"
        context.report.warn(codes.NOT_REPRESENTED, message, element=str(left[0]))
    moved = _moved(seen, commands, context)
    if not commands and not moved and not combined:
        return mechanism
    driven = len(commands) + sum(len(one.joints) for one in moved)
    parts = [counted(driven, "joint")] if driven else []
    parts += [f"{counted(len(combined), 'combination')} of joints"] if combined else []
    context.report.note(codes.FOR_TARGET, f"<{words.TAG}> has the drives of {' and '.join(parts)} ({context.reason})")
    text = ready(_system(seen, commands, combined, moved), 1)
    last = max(len(mechanism.graph.vertices) + len(mechanism.graph.edges), *(extra.index for extra in own), 0)
    extra = Extra(urdf_words.FORMAT, "", text, last + 1)
    ends = [arc.target for one in moved for arc in one.joints]
    mechanism = with_commands(mechanism, moved, {joint: _all_limits(mechanism, joint) for joint in ends}) if moved else mechanism
    return replace(mechanism, extras={**mechanism.extras, ROOT: (*mechanism.extras.get(ROOT, ()), extra)})


def _moved(mechanism: Mechanism, commands: dict[Id, list[Command]], context: Context) -> list[Transmission]:
    """The transmissions of ROS 1 that are written in the system, of joints that nothing else drives; the others are reported."""
    found, left = transmissions(mechanism)
    taken = {*followers(mechanism), *commands}
    moved = [one for one in found if taken.isdisjoint(one.commands)]
    left += [one.key for one in found if not taken.isdisjoint(one.commands)]
    if left:
        kinds = {key: drive.kind.rpartition("/")[2] for key, drive, _ in mechanism.edges(Drive)}
        names = listed([f"'{key.name}' ({kinds[key]})" for key in left], _SHOWN)
        why = "of other kinds, and of joints that are fixed or follow others"
        message = f"{counted(len(left), 'transmission')} of ROS 1 ({why}) stay as they are, and ROS 2 does not read them: {names}"
        context.report.warn(codes.NOT_REPRESENTED, message, element=str(left[0]))
    return moved


def _all_limits(mechanism: Mechanism, joint: Id) -> dict[str, tuple[tuple[str, float], ...]]:
    dof = mechanism.joints[joint].joint.dofs[0]
    return {name: tuple(_limits(name, dof)) for name in (words.POSITION, words.VELOCITY, words.EFFORT)}


def _on_balls(mechanism: Mechanism) -> set[Id]:
    """The drives of joints that have no single coordinate, and become several joints in URDF."""
    edges = mechanism.graph.edges
    ends = ((key, found) for key, _, arcs in mechanism.edges(Drive) for arc in arcs if (found := dof_at(edges, arc)) is not None)
    return {key for key, (_, dof) in ends if dof.kind in (DofKind.BALL, DofKind.FREE)}


def _commands(mechanism: Mechanism, without: set[Id]) -> tuple[dict[Id, list[Command]], list[Id]]:
    """The commands of each joint, and the actuators that have none, as those of the drives ``without`` one."""
    found: dict[Id, list[Command]] = {}
    left: list[Id] = []
    for number, drive, arcs in mechanism.edges(Drive):
        key = end_of(arcs, 1)
        part = mechanism.part(key, Actuator)
        if key is None or part is None or part.kind == "transmission":
            continue
        targets = [arc for arc in arcs if arc.sign < 0]
        is_plain = len(targets) == 1 and drive.kind in _PLAIN and number not in without
        view = mechanism.joints.get(targets[0].target) if is_plain else None
        interface = words.interface_of(part.kind, dict(part.parameters))
        if view is None or len(view.joint.dofs) != 1 or interface is None or interface in [name for name, *_ in found.get(view.id, ())]:
            left.append(key)
        else:
            found.setdefault(view.id, []).append((interface, key, part, numbers_weight(targets[0])))
    return found, left


def _combination(mechanism: Mechanism, key: Id) -> Combination | None:
    """What an actuator drives that is a linear combination of joints and has a command; None of every other."""
    drives = [arcs for _, drive, arcs in mechanism.edges(Drive) if end_of(arcs, 1) == key and not drive.kind]
    ends = [arc for arcs in drives for arc in arcs if arc.sign < 0]
    edge = mechanism.graph.edges.get(ends[0].target) if len(ends) == 1 else None
    part = mechanism.vertex(key, Actuator)
    interface = words.interface_of(part.kind, dict(part.parameters))
    if edge is None or interface is None or not isinstance(edge.data, Tendon) or edge.data.kind != FIXED:
        return None
    joints = [(arc.target.name, numbers_weight(arc)) for arc in edge.arcs]
    if any(arc.target not in mechanism.joints for arc in edge.arcs) or any(len(numbers) != 1 for _, numbers in joints):
        return None
    return Combination(key, interface, ends[0].target, numbers_weight(ends[0]), tuple((name, numbers[0]) for name, numbers in joints))


def _system(mechanism: Mechanism, commands: dict[Id, list[Command]], combined: list[Combination], moved: list[Transmission]) -> Tag:
    """The element, with joints and combinations of joints in the order of their actuators."""
    system = Tag(words.TAG, {"name": mechanism.name, "type": "system"})
    system.add("hardware").add("plugin").children.append(words.PLUGIN)
    place = {key: number for number, (key, _) in enumerate(mechanism.vertices(Actuator))}
    start = _start(mechanism)
    driven = [(place[found[0][1]], _joint(mechanism, joint, found, start.get(joint))) for joint, found in commands.items()]
    driven += [(place[one.actuator], _gpio(mechanism, one)) for one in combined]
    system.children += [tag for _, tag in sorted(driven, key=lambda pair: pair[0])]
    for joint, names in ((joint, names) for one in moved for joint, names in one.commands.items()):
        tag = system.add("joint", name=joint.name)
        for interface in names:
            _add_parameters(tag.add("command_interface", name=interface), _all_limits(mechanism, joint)[interface])
        _add_states(tag, start.get(joint))
    named = {*commands, *(joint for one in moved for joint in one.commands)}
    for joint in moving_joints(mechanism):
        if joint not in named:  # what is not among the joints has no state, and tf no place for the links behind it
            _add_states(system.add("joint", name=joint.name), start.get(joint))
    for one in moved:
        add_transmission(system, one)
    return system


def _joint(mechanism: Mechanism, joint: Id, found: list[Command], start: float | None) -> Tag:
    """The commands that a joint takes, each with the parameters of its actuator, and its states."""
    tag = Tag("joint", {"name": joint.name})
    dof = mechanism.joints[joint].joint.dofs[0]
    for interface, key, actuator, gear in found:
        command = tag.add("command_interface", name=interface)
        _add_parameters(command, _limits(interface, dof))
        _add_parameters(command, [(words.NAME, key.name), (words.TYPE, actuator.kind)])
        _add_parameters(command, [(words.GEAR, gear)] if gear else [])
        _add_parameters(command, actuator.parameters)
    _add_states(tag, start)
    return tag


def _gpio(mechanism: Mechanism, one: Combination) -> Tag:
    """The command of a combination of joints, with the parameters of its actuator, and the combination."""
    actuator = mechanism.vertex(one.actuator, Actuator)
    tag = Tag(words.COMBINED, {"name": one.actuator.name})
    command = tag.add("command_interface", name=one.interface)
    _add_parameters(command, [(words.TYPE, actuator.kind), *([(words.GEAR, one.gear)] if one.gear else []), *actuator.parameters])
    names, numbers = zip(*one.joints, strict=True)
    _add_parameters(tag, [(words.TENDON, one.tendon.name), (words.JOINTS, " ".join(names)), (words.COEFFICIENTS, numbers)])
    return tag


def _add_states(tag: Tag, start: float | None) -> None:
    for interface in (words.POSITION, words.VELOCITY, words.EFFORT):
        state = tag.add("state_interface", name=interface)
        if interface == words.POSITION and start:
            _add_parameters(state, [("initial_value", start)])


def _limits(interface: str, dof: Dof) -> Iterator[tuple[str, float]]:
    limits = dof.limits
    most = limits.velocity if interface == words.VELOCITY else limits.effort
    low, high = (limits.lower, limits.upper) if interface == words.POSITION else (None if most is None else -most, most)
    yield from ((name, value) for name, value in (("min", low), ("max", high)) if value is not None)


def _start(mechanism: Mechanism) -> dict[Id, float]:
    """The coordinate of each joint in the first named pose; a follower has none of its own."""
    following = followers(mechanism)
    first = next((arcs for _, _, arcs in mechanism.edges(Stance)), ())
    values = {arc.target: numbers_weight(arc) for arc in first if arc.sign == 0 and arc.target not in following}
    return {joint: numbers[0] for joint, numbers in values.items() if len(numbers) == 1}


def _add_parameters(tag: Tag, parameters: Iterable[tuple[str, float | str | tuple[float, ...]]]) -> None:
    for name, value in parameters:
        text = value if isinstance(value, str) else numbers_text(value) if isinstance(value, tuple) else number_text(value)
        tag.add("param", name=name).children.append(escaped(text))
