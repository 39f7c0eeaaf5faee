"""Free bases that a closure holds: elsewhere that closure is the joint above the base, which moves equally."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from msgspec.structs import replace

from hymeko_x.verify.features import Feature
from hymeko_x.verify.model import JOINT, WORLD, Dof, Kind, KinematicModel, between_frames

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.verify.model import Array, Body, Loop, Tendon

_MOTIONS = {"connect": (Kind.BALL,), "weld": (), "hinge": (Kind.HINGE,), "slide": (Kind.SLIDE,)}
"""The dofs that a closure leaves to the body that it holds, along z of its frame."""


def with_bases_held(model: KinematicModel, other: KinematicModel) -> KinematicModel:
    """The robot with the closures that hold its free bases as joints, where the other robot has them so because its format must."""
    if Feature.HELD_BASES in other.features:
        return model
    bodies = list(model.bodies)
    done = set()
    for number, loop in enumerate(model.loops):
        for above, pose_above, base, pose_base in _ways(loop):
            if above < base and _is_free(bodies[base]) and _is_joined(bodies[above], bodies[base], _MOTIONS.get(loop.kind), other):
                dofs = tuple(Dof(kind, np.array([0.0, 0.0, 1.0]), name=loop.name) for kind in _MOTIONS[loop.kind])
                joint = between_frames(loop.name, pose_above, dofs, pose_base)
                bodies[base] = replace(bodies[base], parent=above, joint=joint)
                done.add(number)
                break
    if not done:
        return model
    held = replace(model, bodies=tuple(bodies), loops=tuple(loop for number, loop in enumerate(model.loops) if number not in done))
    return _renumbered(held, dict(_numbers(model, held)))


def _ways(loop: Loop) -> Iterator[tuple[int, Array, int, Array]]:
    yield loop.body_a, loop.pose_a, loop.body_b, loop.pose_b
    yield loop.body_b, loop.pose_b, loop.body_a, loop.pose_a


def _is_free(body: Body) -> bool:
    return body.parent == WORLD and tuple(dof.kind for dof in body.joint.dofs) == (Kind.FREE,)


def _is_joined(above: Body, base: Body, kinds: tuple[Kind, ...] | None, other: KinematicModel) -> bool:
    """Whether the other robot has such a joint between the bodies of these names."""
    there = other.index.get(base.name) if base.name is not None else None
    if there is None or not there:
        return False
    body = other.bodies[there]
    same_parent = body.parent == WORLD if above.parent < 0 else other.bodies[body.parent].name == above.name
    return same_parent and not body.joint.open and tuple(dof.kind for dof in body.joint.dofs) == kinds


def _numbers(old: KinematicModel, new: KinematicModel) -> Iterator[tuple[int, int]]:
    """The new number of each dof of a joint that stayed."""
    for i, (before, after) in enumerate(zip(old.bodies, new.bodies, strict=True)):
        if before is after:
            yield from ((old.first_dof[i] + place, new.first_dof[i] + place) for place in range(len(before.joint.dofs)))


def _renumbered(model: KinematicModel, numbers: Mapping[int, int]) -> KinematicModel:
    """Couplings and tendons that mean the same dofs as before."""
    couplings = tuple(
        replace(c, follower=numbers[c.follower], leaders=tuple((numbers[dof], powers) for dof, powers in c.leaders))
        for c in model.couplings
    )

    def moved(tendon: Tendon) -> Tendon:
        return replace(tendon, path=tuple(replace(step, on=numbers[step.on]) if step.kind == JOINT else step for step in tendon.path))

    return replace(model, couplings=couplings, tendons=tuple(map(moved, model.tendons)))
