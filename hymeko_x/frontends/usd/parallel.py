"""Several joints between the same two bodies: dofs of one joint, as MuJoCo's and Newton's tools write them.

UsdPhysics alone would read them as constraints that hold together, which leaves nothing free; no tool means that.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from hymeko_x.formats import usd as words
from hymeko_x.ir.parts import Dof, DofKind
from hymeko_x.ir.values import Pose, compose, inverse, rotate, rotation_angle, unit

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.draft import Draft
    from hymeko_x.frontends.usd.joints import ReadJoint

_TYPES = ("PhysicsRevoluteJoint", "PhysicsPrismaticJoint", "PhysicsSphericalJoint")
_SAME = 1e-5
"""In rad, and in m or of the distance where that is longer: frames of joints have single precision."""


def merge_parallel(joints: list[ReadJoint], draft: Draft) -> list[ReadJoint]:
    """The joints with every run of hinges, slides and balls between the same two bodies made one, at the place of its first."""
    groups: dict[object, list[ReadJoint]] = {}
    for joint in joints:
        first, second = joint.ends
        is_simple = joint.prim.kind in _TYPES and joint.is_enabled and not joint.is_excluded
        groups.setdefault((first.body, second.body) if is_simple else joint.id, []).append(joint)
    return [merged for group in groups.values() for merged in _merged(group, draft)]


def _merged(group: list[ReadJoint], draft: Draft) -> list[ReadJoint]:
    """One joint for those that agree on where the child is; the others, if any, stay by themselves and close a loop."""
    first = group[0]
    at = _child_at(first)
    agreeing = [joint for joint in group if _is_close(_child_at(joint), at)]
    if len(agreeing) < 2:
        return group
    dofs = tuple(_dof_seen_from(first, joint) for joint in agreeing)
    draft.note(first.id, words.PATH, " ".join(joint.prim.path for joint in agreeing))
    for joint in agreeing:
        if joint.prim.display_name == joint.id.name:  # which the dof is called
            draft.take(joint.prim, "displayName")
    for joint in agreeing[1:]:
        draft.elements[joint.prim.path] = [first.id]
        draft.notations.pop(joint.id, None)
    rest = [joint for joint in group if joint not in agreeing]
    return [replace(first, dofs=dofs, merged=tuple(joint.prim for joint in agreeing)), *rest]


def _child_at(joint: ReadJoint) -> Pose:
    """The child in its parent where all coordinates are at their reference."""
    return compose(joint.ends[0].pose, inverse(joint.ends[1].pose))


def _is_close(a: Pose, b: Pose) -> bool:
    size = max(1.0, *map(abs, (*a.xyz, *b.xyz)))
    return max(abs(p - q) for p, q in zip(a.xyz, b.xyz, strict=True)) < _SAME * size and rotation_angle(a.quat, b.quat) < _SAME


def _dof_seen_from(first: ReadJoint, joint: ReadJoint) -> Dof:
    """A joint's dof in the frame of the first one, under the joint's name."""
    dof = replace(joint.dofs[0], name=joint.id.name)
    if joint.ends[0].pose == first.ends[0].pose:
        return dof
    frame = compose(inverse(first.ends[0].pose), joint.ends[0].pose)
    anchor = (0.0, 0.0, 0.0) if dof.kind is DofKind.SLIDE else frame.xyz
    axis = dof.axis if dof.kind is DofKind.BALL else unit(rotate(frame.quat, dof.axis))
    return replace(dof, axis=axis, anchor=_tidy(anchor))


def _tidy(vector: tuple[float, float, float]) -> tuple[float, float, float]:
    """Rounding errors of single precision are no anchors."""
    x, y, z = (0.0 if abs(value) < 1e-9 else value for value in vector)
    return (x, y, z)
