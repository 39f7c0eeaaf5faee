"""Keyframes of MJCF by joint and actuator, so that they fit a robot that has other joints and actuators as well."""

from __future__ import annotations

from collections.abc import Callable
from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x.formats.mjcf import NAME
from hymeko_x.formats.mjcf.lengths import COORDINATES, controls_of, is_keyframes
from hymeko_x.formats.mjcf.tree import parse_text, verbatim
from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.mechanism import ROOT, Extra, Id, Mechanism, end_of, numbers_weight
from hymeko_x.ir.parts import Actuator, DofKind, Stance
from hymeko_x.ir.values import IDENTITY, Pose, compose, inverse
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from hymeko_x.ir.mechanism import JointView

_BY_JOINT = ("qpos", "qvel")


Change = Callable[[str, Id | None, tuple[float, ...]], tuple[Id | None, tuple[float, ...]]]


class Key(Struct, frozen=True):
    """One keyframe: its attributes without these numbers, and the numbers of each joint (qpos, qvel) and actuator (ctrl)."""

    attributes: dict[str, str]
    numbers: dict[tuple[str, Id], tuple[float, ...]]


def has_keyframes(mechanism: Mechanism) -> bool:
    """Whether a mechanism has keyframes of MJCF."""
    return any(map(is_keyframes, mechanism.extras.get(ROOT, ())))


def keys_of(mechanism: Mechanism) -> list[Key]:
    """The keyframes of a mechanism from MJCF; one whose numbers do not fit its joints and actuators is left out."""
    sections = [parse_text(extra.text) for extra in mechanism.extras.get(ROOT, ()) if is_keyframes(extra)]
    if not sections:
        return []
    slots = {name: list(_slots(mechanism, name)) for name in (*_BY_JOINT, "ctrl")}
    keys = [_key(dict(node.attributes), slots) for section in sections for node in section.children if node.tag == "key"]
    return [key for key in keys if key is not None]


def poses(mechanism: Mechanism) -> list[tuple[str, Mapping[Id, tuple[float, ...]]]]:
    """The name of each keyframe with coordinates, and these by joint, in rad or m; of a free joint from its own frame."""
    found: list[tuple[str, Mapping[Id, tuple[float, ...]]]] = []
    for key in keys_of(mechanism):
        values = {of: _in_joint(mechanism, of, numbers) for (word, of), numbers in key.numbers.items() if word == "qpos"}
        if values:
            found.append((key.attributes.get("name", ""), values))
    return found


def with_keys(mechanism: Mechanism, keys: Sequence[Key]) -> Mechanism:
    """The mechanism with these keyframes and no others; what a key has no numbers for stays as it is without one."""
    own = tuple(extra for extra in mechanism.extras.get(ROOT, ()) if not is_keyframes(extra))
    if keys:
        lines = "".join(f"<key{_text(mechanism, key)}/>" for key in keys)
        place = 1 + max((extra.index for extra in own), default=len(mechanism.layout))
        own += (Extra(NAME, "", f"<keyframe>{lines}</keyframe>", place),)
    extras = {**mechanism.extras, ROOT: own}
    return replace(mechanism, extras={key: found for key, found in extras.items() if found})


def with_poses(mechanism: Mechanism) -> Mechanism:
    """The mechanism with its named poses as keyframes; a joint that a pose has no fitting numbers of is as it is without one."""
    stances = [(pose, arcs) for _, _, arcs in mechanism.edges(Stance) if (pose := end_of(arcs, 1)) is not None]
    if not stances:
        return mechanism
    own = keys_of(mechanism)
    known = {key.attributes.get("name") for key in own}
    widths = {key: len(rest) for key, rest in _slots(mechanism, "qpos")}
    new = []
    for pose, arcs in stances:
        if pose.name not in known:
            values = {arc.target: numbers_weight(arc) for arc in arcs if arc.sign == 0}
            fitting = {key: found for key, found in values.items() if widths.get(key) == len(found)}
            new.append(Key({"name": pose.name}, {("qpos", key): _in_world(mechanism, key, found) for key, found in fitting.items()}))
    return with_keys(mechanism, [*own, *new]) if new else mechanism


def _in_joint(mechanism: Mechanism, key: Id, numbers: tuple[float, ...]) -> tuple[float, ...]:
    """MuJoCo's coordinates of a joint as those of the mechanism: of a free joint in its frame in the parent, and not in the world."""
    view = mechanism.joints[key]
    if not _is_turned(view):
        return numbers
    found = compose(inverse(view.parent_pose), compose(_pose_of(numbers), view.child_pose))
    return (*found.xyz, *found.quat)


def _in_world(mechanism: Mechanism, key: Id, numbers: tuple[float, ...]) -> tuple[float, ...]:
    """The inverse of :func:`_in_joint`."""
    view = mechanism.joints[key]
    if not _is_turned(view):
        return numbers
    found = compose(view.parent_pose, compose(_pose_of(numbers), inverse(view.child_pose)))
    return (*found.xyz, *found.quat)


def _is_turned(view: JointView) -> bool:
    is_free = [dof.kind for dof in view.joint.dofs] == [DofKind.FREE]
    return is_free and (view.parent_pose, view.child_pose) != (IDENTITY, IDENTITY)


def _pose_of(numbers: tuple[float, ...]) -> Pose:
    x, y, z, *quat = numbers
    return Pose.from_quat((quat[0], quat[1], quat[2], quat[3]), (x, y, z))


def _slots(mechanism: Mechanism, name: str) -> Iterator[tuple[Id, tuple[float, ...]]]:
    """Each joint or actuator in the order of the numbers, with those that it has without a key."""
    if name == "ctrl":
        yield from ((key, (0.0,) * controls_of(actuator)) for key, actuator in mechanism.vertices(Actuator))
        return
    for body in mechanism.depth_first():
        view = mechanism.parent_joint.get(body)
        if view is not None and view.joint.dofs:
            yield view.id, tuple(_rest(mechanism, view)) if name == "qpos" else (0.0,) * sum(_width(dof.kind)[1] for dof in view.joint.dofs)


def _rest(mechanism: Mechanism, view: JointView) -> Iterator[float]:
    for dof in view.joint.dofs:
        if dof.kind is DofKind.FREE:
            pose = compose(view.parent_pose, inverse(view.child_pose))
            yield from (*pose.xyz, *pose.quat)
        elif dof.kind is DofKind.BALL:
            yield from (1.0, 0.0, 0.0, 0.0)
        else:
            yield dof.ref


def _width(kind: DofKind) -> tuple[int, int]:
    return COORDINATES.get(kind, (1, 1))


def _key(attributes: dict[str, str], slots: Mapping[str, list[tuple[Id, tuple[float, ...]]]]) -> Key | None:
    numbers: dict[tuple[str, Id], tuple[float, ...]] = {}
    for name, own in slots.items():
        if name not in attributes:
            continue
        found = read_numbers(attributes.pop(name))
        if found is None or len(found) != sum(len(rest) for _, rest in own):
            return None
        start = 0
        for key, rest in own:
            numbers[name, key] = tuple(found[start : start + len(rest)])
            start += len(rest)
    return Key(attributes, numbers)


def _text(mechanism: Mechanism, key: Key) -> str:
    attributes = dict(key.attributes)
    for name in (*_BY_JOINT, "ctrl"):
        if any(of == name for of, _ in key.numbers):
            values = [number for slot, rest in _slots(mechanism, name) for number in _fitting(key.numbers.get((name, slot), rest), rest)]
            attributes[name] = numbers_text(tuple(values))
    node = parse_text("<key/>")
    node.attributes.update(attributes)
    return verbatim(node).removeprefix("<key").removesuffix("/>")


def _fitting(numbers: tuple[float, ...], rest: tuple[float, ...]) -> tuple[float, ...]:
    """The numbers of a joint, or those at rest where the joint has got another number of coordinates."""
    return numbers if len(numbers) == len(rest) else rest


_OF_MOCAP: Mapping[str, int] = MappingProxyType({"mpos": 3, "mquat": 4})
"""The numbers of a key for each mocap body."""
_OF_ONE_ROBOT = ("act", *_OF_MOCAP)
"""Numbers of a key whose order is not known of joints and actuators."""


def joined(whole: Mechanism, host: Mechanism, part: Mechanism, change: Callable[[str], str]) -> Mechanism:
    """The whole with the keyframes of the host and, under changed names, those of the part."""
    own = keys_of(host)
    others = [_changed(key, change) for key in keys_of(part)]
    return with_keys(whole, [_alone(key) for key in (*own, *others)])


def restated(changed: Mechanism, source: Mechanism, change: Change, called: Callable[[str], str | None]) -> Mechanism:
    """A changed robot with the keyframes of its source, whose numbers follow their joints and actuators.

    ``change(word, element, numbers)`` gives the present id and the present numbers of a joint (``qpos``, ``qvel``) or an actuator
    (``ctrl``); without an element it gives those of a mocap body (``mpos``, ``mquat``). ``called`` gives the present name of a key, or
    None for one that goes. Keyframes to which nothing happened stay as they are written.
    """
    keys = keys_of(source)
    if not keys:
        return changed
    new = [_restated(key, change, name) for key in keys if (name := called(key.attributes.get("name", ""))) is not None]
    names = (*_BY_JOINT, "ctrl")
    is_same = all(_widths(_slots(source, name), name, change) == _widths(_slots(changed, name)) for name in names)
    if is_same and [_content(key) for key in new] == [_content(key) for key in keys]:
        return changed
    return with_keys(changed, new if is_same else [_alone(key) for key in new])


def _content(key: Key) -> tuple[dict[str, str], list[tuple[float, ...]]]:
    return key.attributes, [*key.numbers.values()]


def _widths(slots: Iterator[tuple[Id, tuple[float, ...]]], name: str = "", change: Change | None = None) -> list[tuple[Id | None, int]]:
    """How many numbers each joint or actuator has in order, under its present id."""
    return [(slot if change is None else change(name, slot, rest)[0], len(rest)) for slot, rest in slots]


def _restated(key: Key, change: Change, name: str) -> Key:
    attributes = {**key.attributes, **({"name": name} if name else {})}
    for word, width in _OF_MOCAP.items():
        numbers = read_numbers(attributes.get(word, "")) or ()
        if numbers:
            groups = [change(word, None, tuple(numbers[start : start + width]))[1] for start in range(0, len(numbers), width)]
            attributes[word] = numbers_text(tuple(number for group in groups for number in group))
    numbers_now = {}
    for (word, slot), numbers in key.numbers.items():
        now, found = change(word, slot, numbers)
        if now is not None:
            numbers_now[word, now] = found
    return Key(attributes, numbers_now)


def _changed(key: Key, change: Callable[[str], str]) -> Key:
    attributes = {name: change(text) if name == "name" else text for name, text in key.attributes.items()}
    return Key(attributes, {(of, Id(slot.kind, change(slot.name))): found for (of, slot), found in key.numbers.items()})


def _alone(key: Key) -> Key:
    return Key({name: text for name, text in key.attributes.items() if name not in _OF_ONE_ROBOT}, key.numbers)
