"""Links that stand for something else: for the world, for the end of a closure, for six dofs between two bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from msgspec.structs import replace

from hymeko_x.verify.model import WORLD, Array, Body, Dof, Joint, Kind, Loop

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


_WORLD_LINK = "world_geometry"
"""A link of this name that is fixed to the world holds what is on the world itself."""
_ANCHOR = "_anchor"
"""A link that is called as a closure with this behind, and is fixed to another one, holds the end of the closure on that."""
_FLOAT = (Kind.SLIDE, Kind.SLIDE, Kind.SLIDE, Kind.BALL)


def without_stand_ins(bodies: Sequence[Body], loops: Sequence[Loop]) -> tuple[tuple[Body, ...], tuple[Loop, ...]]:
    """The robot with what these links stand for in their place."""
    children = [0] * len(bodies)
    for body in bodies[1:]:
        children[body.parent] += 1
    leaves = [i for i, body in enumerate(bodies) if i and not children[i] and not body.joint.dofs and not body.joint.open]
    anchors = {(body, f"{loop.name}{_ANCHOR}") for loop in loops for body in (loop.body_a, loop.body_b)}
    gone: dict[int, tuple[int, Array]] = {}
    for i in leaves:
        body = bodies[i]
        if (body.name == _WORLD_LINK and body.parent == WORLD) or ((i, body.name) in anchors and _is_nothing(body)):
            gone[i] = body.parent, body.joint.placement
    floating = dict(_floating(bodies, children))
    bodies = list(bodies)
    for top, last in floating.items():
        gone |= {carrier: (bodies[top].parent, np.eye(4)) for carrier in range(top, last)}
        joint = Joint(None, bodies[top].joint.placement, (Dof(Kind.FREE, np.array([0.0, 0.0, 1.0])),))
        bodies[last] = replace(bodies[last], parent=bodies[top].parent, joint=joint)
    return _without(bodies, loops, gone) if gone else (tuple(bodies), tuple(loops))


def _is_nothing(body: Body) -> bool:
    return not (body.mass or body.shapes)


def _floating(bodies: Sequence[Body], children: Sequence[int]) -> list[tuple[int, int]]:
    """The first and the last body of each chain of three slides along x, y and z and a ball; such bodies follow each other."""
    found = []
    for top in range(1, len(bodies) - 3):
        chain = bodies[top : top + 4]
        dofs = [dof for body in chain for dof in body.joint.dofs]
        if tuple(dof.kind for dof in dofs) != _FLOAT or not all(
            np.array_equal(dof.axis, axis) for dof, axis in zip(dofs, np.eye(3), strict=False)
        ):
            continue
        is_chain = all(body.parent == top + place for place, body in enumerate(chain[1:]))
        at_once = all(np.array_equal(body.joint.placement, np.eye(4)) for body in chain[1:])
        if is_chain and at_once and all(_is_nothing(body) for body in chain[:3]) and children[top : top + 3] == [1, 1, 1]:
            found.append((top, top + 3))
    return found


def _without(
    bodies: Sequence[Body], loops: Sequence[Loop], gone: Mapping[int, tuple[int, Array]]
) -> tuple[tuple[Body, ...], tuple[Loop, ...]]:
    """The robot without these bodies; each gives its shapes, and the ends of closures on it, to another one, in which it has a pose."""
    kept = [i for i in range(len(bodies)) if i not in gone]
    numbers = {i: number for number, i in enumerate(kept)}
    shapes = {i: list(bodies[i].shapes) for i in kept}
    for i, (onto, pose) in gone.items():
        if onto in shapes:
            shapes[onto] += [replace(shape, pose=pose @ shape.pose) for shape in bodies[i].shapes]
    found = tuple(replace(bodies[i], parent=numbers.get(bodies[i].parent, -1), shapes=tuple(shapes[i])) for i in kept)

    def moved(body: int, pose: Array) -> tuple[int, Array]:
        onto, place = gone.get(body, (body, np.eye(4)))
        return numbers[onto], place @ pose

    ends = [(loop, moved(loop.body_a, loop.pose_a), moved(loop.body_b, loop.pose_b)) for loop in loops]
    closures = (replace(loop, body_a=a, pose_a=pose_a, body_b=b, pose_b=pose_b) for loop, (a, pose_a), (b, pose_b) in ends)
    return found, tuple(closures)
