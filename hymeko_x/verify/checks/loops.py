"""Closures of the tree: how open each one is at every configuration.

Compared: the gap of each closure in m, and its misalignment in rad, in the motions that its kind forbids. Allowed: twice as much as for
forward kinematics, because two bodies are off.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from msgspec.structs import replace

from hymeko_x.verify.checks.kinematics import Peaks, allowance, batches
from hymeko_x.verify.checks.pair import Differences, Pair, counted
from hymeko_x.verify.features import Feature
from hymeko_x.verify.model import Array, KinematicModel, Loop
from hymeko_x.verify.spatial import angle_between, frame_with_z, inverse

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from hymeko_x.verify.verdict import Check

_SLIDING = ("slide", "cylinder", "other")
"""The kinds of closures along which the two bodies may slide, or move in several ways."""
_OPEN = 2e-9
"""In m: a closure whose ends are this far apart is open; nearer ones are within what the check of closures allows."""

LoopPair = tuple[Loop, Loop, bool]
"""A closure of each robot, and whether the second names the two bodies the other way round."""


def check_loops(pair: Pair) -> Iterator[Check]:
    """Every closure of the first robot in the second, no new ones, and how open they are."""
    loops, findings = _pair_loops(pair)
    loops = _without_open_ones(pair, loops)
    if not loops and not findings:
        return
    gaps, angles = Peaks(len(loops)), Peaks(len(loops))
    reach = 0.0
    for rows, poses_a, poses_b in batches(pair):
        reach = max(reach, float(np.abs(poses_a[..., :3, 3]).max()))
        for k, (loop_a, loop_b, swapped) in enumerate(loops):
            gap, angle = _compare_loop(poses_a, poses_b, loop_a, loop_b, swapped=swapped)
            gaps.add(k, gap, rows.start)
            angles.add(k, angle, rows.start)
    anchors = max((float(np.abs(pose[:3, 3]).max()) for loop, _, _ in loops for pose in (loop.pose_a, loop.pose_b)), default=0.0)
    allowed = allowance(pair, reach, anchors)
    yield counted("loops", findings)
    position, rotation = Differences("loop closure, position", "m"), Differences("loop closure, rotation", "rad")
    for k, (loop, _, _) in enumerate(loops):
        position.add(gaps.values[k], 2 * allowed.metres, _loop_label(pair.a, loop))
        rotation.add(angles.values[k], 2 * allowed.radians, _loop_label(pair.a, loop))
    yield from (*position.checks(), *rotation.checks())


def _without_open_ones(pair: Pair, loops: list[LoopPair]) -> list[LoopPair]:
    """The pairs without closures that are open in the zero pose, where the second robot's format closes every one there."""
    if Feature.OPEN_LOOPS in pair.b.features:
        return loops
    opened = [
        found
        for found in loops
        if float(np.linalg.norm(gap_between(*ends(pair.zero_a[None], found[0], swapped=False), found[0].kind))) > _OPEN
    ]
    pair.add_gap(pair.b, Feature.OPEN_LOOPS, [_loop_label(pair.a, loop) for loop, _, _ in opened])
    return [found for found in loops if found not in opened]


# ---- counterparts ----------------------------------------------------------------------------------------------------


def _pair_loops(pair: Pair) -> tuple[list[LoopPair], list[str]]:
    """Closures by name, else by the two bodies that they join; and words about those without a counterpart.

    None where the second robot's format has none: trees are then compared, and a gap names the closures, as it does those by a screw and
    those that leave a slide free where the format has none of these.
    """
    if Feature.LOOPS not in pair.b.features:
        labels = [f"'{loop.name}'" if loop.name else f"between {_ends_of(pair.a, loop)}" for loop in pair.a.loops]
        pair.add_gap(pair.b, Feature.LOOPS, labels)
        return [], []
    back = {j: i for i, j in pair.match.bodies}
    there = dict(pair.match.bodies)
    waiting = list(_with_hinges(pair.b.loops, pair.a.loops, there))
    pairs: list[LoopPair] = []
    findings: list[str] = []
    unrepresented: dict[Feature, list[str]] = {}
    names = {loop.name for loop in pair.a.loops if loop.name is not None}
    for loop in _with_hinges(pair.a.loops, pair.b.loops, back):
        other = _counterpart(loop, [other for other in waiting if other.name == loop.name or other.name not in names], back)
        if other is None and (feature := _needed(loop)) not in pair.b.features:
            unrepresented.setdefault(feature, []).append(_loop_label(pair.a, loop))
            continue
        if other is None:
            findings.append(f"{_loop_label(pair.a, loop)} is missing")
            continue
        waiting.remove(other)
        ends = back.get(other.body_a), back.get(other.body_b)
        if set(ends) != {loop.body_a, loop.body_b}:
            findings.append(f"{_loop_label(pair.a, loop)} joins other bodies")
        elif (other.kind, other.words) != (loop.kind, loop.words):
            findings.append(f"{_loop_label(pair.a, loop)} is a {loop.words or loop.kind}, and a {other.words or other.kind} in the other")
        else:
            pairs.append((loop, other, ends[0] != loop.body_a))
    findings += [f"loop '{loop.name or loop.kind}' is new" for loop in waiting]
    for feature, labels in unrepresented.items():
        pair.add_gap(pair.b, feature, labels)
    return pairs, findings


def _needed(loop: Loop) -> Feature:
    """What a format must have for a closure of this kind, beside closures."""
    if loop.words == "screw":
        return Feature.SCREW_LOOPS
    return Feature.SLIDING_LOOPS if loop.kind in _SLIDING else Feature.LOOPS


def _with_hinges(loops: Iterable[Loop], others: Iterable[Loop], place: Mapping[int, int]) -> Iterator[Loop]:
    """The loops, two points that stay together as one hinge where the other robot has one; ``place`` leads from its bodies to ours.

    Of several hinges between two bodies each has the points whose names begin with its own.
    """
    hinges: dict[frozenset[int | None], list[str]] = {}
    for other in others:
        if other.kind == "hinge":
            hinges.setdefault(frozenset((place.get(other.body_a), place.get(other.body_b))), []).append(other.name or "")
    points: dict[tuple[int, int, str], list[Loop]] = {}
    for loop in loops:
        names = hinges.get(frozenset((loop.body_a, loop.body_b)))
        if loop.kind == "connect" and names:
            name = next((name for name in names if (loop.name or "").startswith(name)), "") if len(names) > 1 else ""
            points.setdefault((loop.body_a, loop.body_b, name), []).append(loop)
        else:
            yield loop
    for found in points.values():
        yield from [_hinge_of(*found)] if len(found) == 2 else found


def _hinge_of(first: Loop, second: Loop) -> Loop:
    """The hinge that two points on both bodies make: its origin is the first one, its axis leads to the second."""
    ends = []
    for here, there in ((first.pose_a, second.pose_a), (first.pose_b, second.pose_b)):
        axis = there[:3, 3] - here[:3, 3]
        ends.append(frame_with_z(axis, here[:3, 3]) if axis.any() else here)
    return replace(first, kind="hinge", pose_a=ends[0], pose_b=ends[1])


def _counterpart(loop: Loop, waiting: list[Loop], back: dict[int, int]) -> Loop | None:
    named = [other for other in waiting if loop.name is not None and other.name == loop.name]
    if named:
        return named[0]
    ends = {loop.body_a, loop.body_b}
    return next((other for other in waiting if {back.get(other.body_a), back.get(other.body_b)} == ends), None)


def _loop_label(model: KinematicModel, loop: Loop) -> str:
    between = f"between {_ends_of(model, loop)}"
    return f"loop '{loop.name}' {between}" if loop.name else f"the loop {between}"


def _ends_of(model: KinematicModel, loop: Loop) -> str:
    return f"{model.body_label(loop.body_a)} and {model.body_label(loop.body_b)}"


# ---- residuals -------------------------------------------------------------------------------------------------------


def _compare_loop(poses_a: Array, poses_b: Array, loop_a: Loop, loop_b: Loop, *, swapped: bool) -> tuple[Array, Array]:
    """By how much the residuals of two closures differ: in m for what must coincide, in rad for what must align, (n,) each."""
    first_a, second_a = ends(poses_a, loop_a, swapped=False)
    first_b, second_b = ends(poses_b, loop_b, swapped=swapped)
    if loop_a.kind == "weld":  # the same wherever on the two bodies its frames are
        first_b, second_b = first_a, second_b @ inverse(first_b) @ first_a
    gap = gap_between(first_a, second_a, loop_a.kind) - gap_between(first_b, second_b, loop_a.kind)
    distance: Array = np.linalg.norm(gap, axis=-1)
    match loop_a.kind:
        case "connect":
            return distance, np.zeros(len(gap))
        case "hinge" | "cylinder" | "slide":
            angle = np.maximum(_axis_angle(first_a, first_b), _axis_angle(second_a, second_b))
            if loop_a.kind == "slide":
                angle = np.maximum(angle, _relative_angle(first_a, second_a, first_b, second_b))
            return distance, angle
        case _:
            return distance, _relative_angle(first_a, second_a, first_b, second_b)


def ends(poses: Array, loop: Loop, *, swapped: bool) -> tuple[Array, Array]:
    """The closure's frame on both bodies in the world, (n, 4, 4) each."""
    ends = poses[:, loop.body_a] @ loop.pose_a, poses[:, loop.body_b] @ loop.pose_b
    return (ends[1], ends[0]) if swapped else ends


def gap_between(first: Array, second: Array, kind: str) -> Array:
    """The vector between the two origins; without its part along the free axis where one is free to slide."""
    gap = first[:, :3, 3] - second[:, :3, 3]
    if kind not in ("slide", "cylinder"):
        return gap
    axis = first[:, :3, 2]
    across: Array = gap - np.einsum("ni,ni->n", gap, axis)[:, None] * axis
    return across


def _axis_angle(a: Array, b: Array) -> Array:
    """The angle between the z axes, as lines."""
    cross = np.linalg.norm(np.cross(a[:, :3, 2], b[:, :3, 2]), axis=-1)
    angle: Array = np.arctan2(cross, np.abs(np.einsum("ni,ni->n", a[:, :3, 2], b[:, :3, 2])))
    return angle


def _relative_angle(first_a: Array, second_a: Array, first_b: Array, second_b: Array) -> Array:
    """The angle between the rotations of the two closures, whatever frame each was written in."""
    turn_a = second_a[:, :3, :3] @ np.swapaxes(first_a[:, :3, :3], 1, 2)
    turn_b = second_b[:, :3, :3] @ np.swapaxes(first_b[:, :3, :3], 1, 2)
    return angle_between(turn_a, turn_b)
