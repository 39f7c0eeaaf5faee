"""A stage in SI units with z up: poses of prims in the world and in bodies, and the values of attributes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec import Struct
from pxr import UsdGeom, UsdPhysics

from hymeko_x.verify.spatial import inverse, rigid

if TYPE_CHECKING:
    from collections.abc import Container

    from hymeko_x.verify.model import Array

_Z_FROM_Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


class MeasuredStage(Struct, frozen=True, eq=False):
    """A stage with its units: ``metres`` and ``kilograms`` per unit, ``upright`` the rotation that makes z point up."""

    stage: Any
    metres: float
    kilograms: float
    upright: Array

    @classmethod
    def of(cls, stage: Any) -> MeasuredStage:
        """The stage with the units that it declares; y-up stages are turned about x, as every converter does."""
        upright = np.eye(3) if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z else _Z_FROM_Y_UP
        return cls(stage, UsdGeom.GetStageMetersPerUnit(stage), UsdPhysics.GetStageKilogramsPerUnit(stage), upright)

    def pose(self, prim: Any) -> Array:
        """The pose of a prim in the world at rest, in m, z up, without its scale."""
        matrix = np.array(UsdGeom.XformCache().GetLocalToWorldTransform(prim), dtype=float).T
        return rigid(self.upright @ unit_axes(matrix[:3, :3]), self.upright @ matrix[:3, 3] * self.metres)

    def relative(self, body: str, prim: Any) -> tuple[Array, Array]:
        """A prim in the frame of a body ("" is the world): its pose in m, and the 3x3 matrix of scale that is applied before it."""
        world = np.array(UsdGeom.XformCache().GetLocalToWorldTransform(prim), dtype=float).T
        world[:3] = np.block([[self.upright @ world[:3, :3], self.upright @ world[:3, 3:]]])
        base = self.pose(self.stage.GetPrimAtPath(body)) if body else np.eye(4)
        base[:3, 3] /= self.metres
        inside = inverse(base) @ world
        turn = unit_axes(inside[:3, :3])
        return rigid(turn, inside[:3, 3] * self.metres), turn.T @ inside[:3, :3] * self.metres


def unit_axes(matrix: Array) -> Array:
    """The directions of the axes of a 3x3 matrix; axes that a scale of zero has flattened complete the others to a right-handed frame."""
    lengths = np.linalg.norm(matrix, axis=0)
    if lengths.all():
        return np.asarray(matrix / lengths)
    left, _, right = np.linalg.svd(matrix)
    left[:, 2] *= np.sign(np.linalg.det(left @ right))
    return np.asarray(left @ right)


def owner(prim: Any, bodies: Container[str]) -> str:
    """The path of the nearest body that contains a prim, or ""."""
    path = prim.GetPath()
    while not path.IsAbsoluteRootPath():
        if str(path) in bodies:
            return str(path)
        path = path.GetParentPath()
    return ""


# ---- attributes ------------------------------------------------------------------------------------------------------


def value_of(prim: Any, name: str) -> Any:
    """The value of an attribute, or None."""
    attribute = prim.GetAttribute(name)
    return attribute.Get() if attribute else None


def number_of(prim: Any, name: str, default: float) -> float:
    """The number that an attribute holds."""
    value = value_of(prim, name)
    return float(value) if isinstance(value, int | float) else default


def targets_of(prim: Any, name: str) -> list[str]:
    """The paths that a relationship leads to."""
    relationship = prim.GetRelationship(name)
    return [str(path) for path in relationship.GetForwardedTargets()] if relationship else []
