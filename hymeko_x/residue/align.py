"""Finding the alignment: which element of the image is which of the source, and what the image only describes otherwise.

A wrong guess is never a wrong result, only a longer residue: whatever differs behind the alignment becomes an entry.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from hymeko_x.ir.kinematics import displacement
from hymeko_x.ir.mechanism import WORLD, Id
from hymeko_x.ir.parts import Role
from hymeko_x.ir.values import IDENTITY, Pose, compose, inverse, rotation_angle
from hymeko_x.residue import Alignment, Fold, Join
from hymeko_x.residue.chains import fold_chains
from hymeko_x.residue.pairing import content_of, other_names
from hymeko_x.residue.realign import are_twins, join_twins, move_frames, realign

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.ir.mechanism import JointView, Mechanism

_SAME_PLACE = 1e-5
"""Frames closer than this (m, rad) are the same: what is left is rounding, in single precision for some formats."""
_ROUNDING = 1e-13
"""How much a number of a quaternion may change when it is written as angles."""


def align(image: Mechanism, source: Mechanism) -> tuple[Alignment, Mechanism]:
    """The alignment that leads from the image to the source, and the aligned image. Linear in both."""
    names = other_names(image, source)
    renamed = realign(image, Alignment(tuple(names.items())))
    folds = tuple(_folds(renamed, source))
    folded = fold_chains(renamed, folds)
    joins = tuple(_joins(folded, source))
    joined = join_twins(folded, joins)
    frames = {} if _agree_in_poses(joined, source) else dict(_frames(joined, source))
    return Alignment(tuple(names.items()), folds, joins, tuple(frames.items())), move_frames(joined, frames)


# ---- chains ----------------------------------------------------------------------------------------------------------------


def _folds(image: Mechanism, source: Mechanism) -> Iterable[Fold]:
    """The joints that are a chain in the image, with bodies in it that the source does not have."""
    if not any(key.kind == "body" for key in image.graph.vertices.keys() - source.graph.vertices.keys()):
        return
    for view in source.joints.values():
        chain = _chain_above(image, source, view.child)
        kinds = [dof.kind for joint in chain for dof in joint.joint.dofs]
        if len(chain) > 1 and chain[0].parent == view.parent and kinds == [dof.kind for dof in view.joint.dofs]:
            yield Fold(view.id, tuple(joint.id for joint in chain), tuple(joint.child for joint in chain[:-1]))


def _chain_above(image: Mechanism, source: Mechanism, body: Id) -> list[JointView]:
    """The joints of the image from a body up to the next one that the source knows as well, from above."""
    chain: list[JointView] = []
    above = image.parent_joint.get(body)
    while above is not None:
        chain.append(above)
        if above.parent in source.graph.vertices or above.parent == WORLD:
            return chain[::-1]
        above = image.parent_joint.get(above.parent)
    return []


# ---- shapes ----------------------------------------------------------------------------------------------------------------


def _joins(image: Mechanism, source: Mechanism) -> Iterable[Join]:
    """The shapes of the source that are both visual and collision, which are two shapes in the image."""
    for body, views in source.shapes.items():
        both = [view.id for view in views if view.shape.role is Role.BOTH]
        if not both or body not in image.shapes:
            continue
        free: dict[object, list[Id]] = defaultdict(list)
        for view in reversed(image.shapes[body]):
            if view.shape.role is Role.COLLISION and view.id not in source.graph.edges:
                free[content_of(image.graph.edges[view.id])].append(view.id)
        for key in both:
            seen = image.graph.edges.get(key)
            twins = free[content_of(seen)] if seen is not None else []
            if seen is not None and twins and are_twins(seen, image.graph.edges[twins[-1]]):
                yield Join(key, twins.pop())


# ---- frames and coordinates --------------------------------------------------------------------------------------------------


def _agree_in_poses(image: Mechanism, source: Mechanism) -> bool:
    """Whether all bodies have the same parents at the same poses, so that no frame can be another one."""
    below = image.parent_joint
    for body, view in source.parent_joint.items():
        other = below.get(body)
        if other is None or view.parent != other.parent:
            return False
        if not (_alike(view.parent_pose, other.parent_pose) and _alike(view.child_pose, other.child_pose)):
            return False
        if _displacements(view) != _displacements(other):
            return False
    return True


def _displacements(view: JointView) -> dict[int, Pose]:
    """How far the dofs move the body where their coordinates are zero, by their numbers; those that start there do not."""
    return {number: displacement(dof, -dof.ref) for number, dof in enumerate(view.joint.dofs) if dof.ref}


def _alike(a: Pose, b: Pose) -> bool:
    """Whether two poses are the same but for the rounding of a rotation that was written in another notation."""
    return a.xyz == b.xyz and (a.quat == b.quat or all(abs(x - y) <= _ROUNDING for x, y in zip(a.quat, b.quat, strict=True)))


def _frames(image: Mechanism, source: Mechanism) -> Iterable[tuple[Id, Pose]]:
    """Where the source's body frames are in the image's, for the bodies where they differ. Roots have the same in both."""
    there: dict[Id, Pose] = {}
    here: dict[Id, Pose] = {}
    for body in image.depth_first():
        here[body] = _zero_pose(image, body, here)
    for body in source.depth_first():
        above = source.parent_joint.get(body)
        if above is None or above.parent == WORLD or above.parent not in there:
            there[body] = here.get(body, IDENTITY)
            continue
        there[body] = _zero_pose(source, body, there)
        if body not in here:
            continue
        shift = compose(inverse(here[body]), there[body])
        if max(map(abs, shift.xyz)) > _SAME_PLACE or rotation_angle(shift.quat, IDENTITY.quat) > _SAME_PLACE:
            yield body, shift


def _zero_pose(mechanism: Mechanism, body: Id, poses: dict[Id, Pose]) -> Pose:
    """The pose of a body where all coordinates are zero, in its root's frame."""
    above = mechanism.parent_joint.get(body)
    if above is None:
        return IDENTITY
    pose = compose(poses.get(above.parent, IDENTITY), above.parent_pose)
    for dof in above.joint.dofs:
        pose = compose(pose, displacement(dof, -dof.ref))
    return compose(pose, inverse(above.child_pose))
