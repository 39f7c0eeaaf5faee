"""Keyframes of MJCF by joint and actuator, so that they fit a robot that has other joints and actuators as well."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x.formats.mjcf import NAME
from hymeko_x.formats.mjcf.tree import parse_text, verbatim
from hymeko_x.ir.mechanism import ROOT, Extra, Id, Mechanism, end_of, numbers_weight
from hymeko_x.ir.parts import Actuator, DofKind, Stance
from hymeko_x.ir.values import compose, inverse, numbers_text
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from hymeko_x.ir.mechanism import JointView

_WIDTHS: Mapping[DofKind, tuple[int, int]] = {DofKind.FREE: (7, 6), DofKind.BALL: (4, 3)}
_BY_JOINT = ("qpos", "qvel")


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
    slots = {name: list(_slots(mechanism, name)) for name in (*_BY_JOINT, "ctrl")}
    keys = [_key(dict(node.attributes), slots) for section in sections for node in section.children if node.tag == "key"]
    return [key for key in keys if key is not None]


def poses(mechanism: Mechanism) -> list[tuple[str, Mapping[Id, tuple[float, ...]]]]:
    """The name of each keyframe with coordinates, and these by joint, in rad or m."""
    found = [
        (key.attributes.get("name", ""), {of: numbers for (word, of), numbers in key.numbers.items() if word == "qpos"})
        for key in keys_of(mechanism)
    ]
    return [(name, values) for name, values in found if values]


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
    own = keys_of(mechanism)
    known = {key.attributes.get("name") for key in own}
    widths = {key: len(rest) for key, rest in _slots(mechanism, "qpos")}
    new = []
    for _, _, arcs in mechanism.edges(Stance):
        pose = end_of(arcs, 1)
        if pose is not None and pose.name not in known:
            values = {("qpos", arc.target): numbers_weight(arc) for arc in arcs if arc.sign == 0}
            new.append(Key({"name": pose.name}, {(of, key): found for (of, key), found in values.items() if widths.get(key) == len(found)}))
    return with_keys(mechanism, [*own, *new]) if new else mechanism


def is_keyframes(extra: Extra) -> bool:
    """Whether an extra is a <keyframe> section of MJCF."""
    return extra.format == NAME and extra.text.startswith("<keyframe")


def _slots(mechanism: Mechanism, name: str) -> Iterator[tuple[Id, tuple[float, ...]]]:
    """Each joint or actuator in the order of the numbers, with those that it has without a key."""
    if name == "ctrl":
        yield from ((key, (0.0,)) for key, _ in mechanism.vertices(Actuator))
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
    return _WIDTHS.get(kind, (1, 1))


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
            values = [number for slot, rest in _slots(mechanism, name) for number in key.numbers.get((name, slot), rest)]
            attributes[name] = numbers_text(tuple(values))
    node = parse_text("<key/>")
    node.attributes.update(attributes)
    return verbatim(node).removeprefix("<key").removesuffix("/>")


_OF_ONE_ROBOT = ("act", "mpos", "mquat")
"""Numbers of a key whose order is not known of joints and actuators."""


def joined(whole: Mechanism, host: Mechanism, part: Mechanism, change: Callable[[str], str]) -> Mechanism:
    """The whole with the keyframes of the host and, under changed names, those of the part."""
    own = keys_of(host)
    others = [_changed(key, change) for key in keys_of(part)]
    return with_keys(whole, [_alone(key) for key in (*own, *others)])


def _changed(key: Key, change: Callable[[str], str]) -> Key:
    attributes = {name: change(text) if name == "name" else text for name, text in key.attributes.items()}
    return Key(attributes, {(of, Id(slot.kind, change(slot.name))): found for (of, slot), found in key.numbers.items()})


def _alone(key: Key) -> Key:
    return Key({name: text for name, text in key.attributes.items() if name not in _OF_ONE_ROBOT}, key.numbers)
