"""Joints of UsdPhysics: types of prims, axes, and the dofs that they represent."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from msgspec.structs import replace

from hymeko_x.ir.parts import DofKind
from hymeko_x.ir.values import Vec3, X, Y, Z, scaled

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.parts import Dof

GENERIC, FIXED, DISTANCE = "PhysicsJoint", "PhysicsFixedJoint", "PhysicsDistanceJoint"
DOFS: Mapping[str, DofKind] = MappingProxyType(
    {"PhysicsRevoluteJoint": DofKind.HINGE, "PhysicsPrismaticJoint": DofKind.SLIDE, "PhysicsSphericalJoint": DofKind.BALL}
)
"""The joints that have one dof."""
TYPES = (*DOFS, FIXED, GENERIC, DISTANCE)

AXES: Mapping[str, Vec3] = MappingProxyType({"X": X, "Y": Y, "Z": Z})
D6_AXES = ("transX", "transY", "transZ", "rotX", "rotY", "rotZ")
"""The axes of a generic joint in the order in which they move: the first is nearest to the parent."""
PHYSX = ("armature", "maxJointVelocity")
"""The values of PhysX' schema for joints that the IR can represent."""
DRIVES = ("angular", "linear", *D6_AXES)
"""The instances of a DriveAPI."""

LOCKED = (1.0, -1.0)
"""The bounds by which the writer locks an axis of a generic joint."""


class D6Axis(NamedTuple):
    """One axis of a generic joint: the kind of its motion, and the axis of it."""

    kind: DofKind
    axis: Vec3


def d6_axis(name: str) -> D6Axis:
    """The meaning of ``transX`` ... ``rotZ``."""
    kind = DofKind.SLIDE if name.startswith("trans") else DofKind.HINGE
    return D6Axis(kind, AXES[name[-1]])


def opposite(dof: Dof) -> Dof:
    """The dof with parent and child exchanged, so that its coordinate keeps its sign."""
    if dof.kind in (DofKind.BALL, DofKind.FREE):
        return dof
    x, y, z = scaled(dof.axis, -1.0)
    return replace(dof, axis=(x + 0.0, y + 0.0, z + 0.0))
