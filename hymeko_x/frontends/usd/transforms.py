"""Transforms of prims: matrices of USD as poses in metres with z up, and the scale that is left."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from pxr import Gf, UsdGeom

from hymeko_x import codes
from hymeko_x.ir.values import IDENTITY, NO_ROTATION, Pose, Quat, Vec3, cross, dot, scaled, unit_quat
from hymeko_x.ir.written import clean_pose

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Origin, Report
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.frontends.usd.stage import OpenStage

_ORDER = "xformOpOrder"
_RESET = "!resetXformStack!"
_UNIT = 1e-6
"""Scales this close to one another, or to 1, are rounding errors of single-precision rotations."""


class Transform(Struct, frozen=True):
    """A rigid pose in m and the scale along its axes; ``flaw`` says in words what else the matrix has, empty for nothing."""

    pose: Pose
    scale: Vec3
    flaw: str = ""


class Transforms:
    """World matrices in metres with z up, each computed once."""

    def __init__(self, scene: OpenStage) -> None:
        self._cache = UsdGeom.XformCache()
        self._world = scene.world
        self._bodies: dict[str, Transform] = {}

    def matrix(self, prim: Prim) -> Any:
        """Local to world, for row vectors."""
        return self._cache.GetLocalToWorldTransform(prim.composed) * self._world

    def of(self, prim: Prim) -> Transform:
        """The prim in the world."""
        found = self._bodies.get(prim.path)
        if found is None:
            found = self._bodies[prim.path] = decomposed(self.matrix(prim))
        return found

    def seen_from(self, prim: Prim, body: Prim | None) -> Transform:
        """The prim in the rigid frame of a body, without the noise of computing it; in the world without one."""
        found = decomposed(self.relative(prim, body))
        return found if found.pose is IDENTITY else replace(found, pose=clean_pose(found.pose))

    def relative(self, prim: Prim, body: Prim | None) -> Any:
        """The matrix from a prim to the rigid frame of a body, or to the world."""
        if body is None:
            return self.matrix(prim)
        return self.matrix(prim) * matrix_of(self.of(body).pose).GetInverse()


def check_ops(prim: Prim, report: Report, origin: Origin) -> None:
    """Say which steps of the way to a prim are named and not there; USD goes on without them."""
    steps = {step.removeprefix("!invert!"): None for step in prim.value(_ORDER) or ()}
    missing = [step for step in steps if step not in prim.types and step != _RESET]
    if missing:
        message = f"{_ORDER} names {', '.join(missing)}, which {'are' if missing[1:] else 'is'} not there; passed over"
        report.warn(codes.UNDEFINED_REFERENCE, message, origin, element=prim.path)


def matrix_of(pose: Pose) -> Any:
    """The matrix of a rigid pose, for row vectors."""
    w, x, y, z = pose.quat
    rotation = Gf.Matrix4d().SetRotate(Gf.Quatd(w, Gf.Vec3d(x, y, z)))
    return rotation * Gf.Matrix4d().SetTranslate(Gf.Vec3d(*pose.xyz))


_SHEARED = "is sheared, as it is turned in a prim whose scale differs by axis; it is read without the shear"


def decomposed(matrix: Any) -> Transform:
    """The rigid pose and the scale of a matrix; a mirrored one has a negative scale along x. Numbers that are not finite are left out."""
    *rows, at = ((row[0], row[1], row[2]) for row in numbers_of(matrix))
    lengths = [math.sqrt(dot(row, row)) for row in rows]
    xyz = (at[0] + 0.0, at[1] + 0.0, at[2] + 0.0)
    if not all(map(math.isfinite, (*lengths, *xyz))):
        x, y, z = (v if math.isfinite(v) else 0.0 for v in xyz)
        return Transform(Pose((x, y, z)), (1.0, 1.0, 1.0), "has a transform with numbers that are not finite, which do not count")
    if min(lengths) < 1e-12:
        return Transform(Pose(xyz), (lengths[0], lengths[1], lengths[2]), "is scaled to nothing")
    if dot(cross(rows[0], rows[1]), rows[2]) < 0.0:
        lengths[0] = -lengths[0]
    axes = [scaled(row, 1.0 / length) for row, length in zip(rows, lengths, strict=True)]
    is_sheared = max(abs(dot(axes[0], axes[1])), abs(dot(axes[0], axes[2])), abs(dot(axes[1], axes[2]))) > 1e-4
    turn = Gf.Matrix3d(*axes[0], *axes[1], *axes[2])
    turn.Orthonormalize(False)
    return Transform(_pose(xyz, quat_of(turn.ExtractRotation().GetQuat())), _scale(lengths), _SHEARED if is_sheared else "")


def _pose(xyz: Vec3, quat: Quat) -> Pose:
    return IDENTITY if quat == NO_ROTATION and xyz == IDENTITY.xyz else Pose(xyz, quat)


def _scale(lengths: list[float]) -> Vec3:
    x, y, z = (math.copysign(1.0, v) if abs(abs(v) - 1.0) < _UNIT else v for v in lengths)
    return (x, y, z)


def numbers_of(value: Any) -> list[Any]:
    """The numbers of a vector, a matrix (by rows) or an array of numbers. USD hands them out one by one forty times slower."""
    view = memoryview(value)
    return view.tolist() if view.format != "e" else np.array(value).astype(float).tolist()  # halves are no numbers to Python


def quat_of(quat: Any) -> Quat:
    """A quaternion of USD as (w, x, y, z)."""
    x, y, z = numbers_of(quat.imaginary)
    return rotation_of((float(quat.real), x, y, z))


def rotation_of(numbers: Quat) -> Quat:
    """The rotation of four numbers; those that are no rotation turn nothing."""
    try:
        return unit_quat(numbers)
    except ZeroDivisionError:
        return NO_ROTATION
