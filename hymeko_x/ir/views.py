"""Views of edges: joints, shapes, subsets and mounts with the elements that their arcs lead to."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from hymeko_x.ir import parts
    from hymeko_x.ir.ids import Id
    from hymeko_x.ir.values import Pose


class JointView(NamedTuple):
    """A joint with its two ends: T_parent_child(q) = parent_pose * motion(q) * inverse(child_pose)."""

    id: Id
    joint: parts.Joint
    parent: Id
    child: Id
    parent_pose: Pose
    child_pose: Pose


class ShapeView(NamedTuple):
    """A shape with its body, its pose in the body, and its mesh and material if it has them."""

    id: Id
    shape: parts.Shape
    body: Id
    pose: Pose
    mesh: Id | None
    material: Id | None


class SubsetView(NamedTuple):
    """Triangles of a shape's mesh with the material that they show."""

    id: Id
    faces: tuple[int, ...]
    material: Id


class MountView(NamedTuple):
    """A frame, camera, light or sensor with the body that it sits on, and its pose there."""

    id: Id
    mounted: Id
    body: Id
    pose: Pose
