"""Shapes that stand for those that URDF has no word for: what a box says of a plane, and a mesh of an ellipsoid."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hymeko_x.verify.model import Array, Shape
    from hymeko_x.verify.surfaces import Meshes

_NEAR = 1e-8  # m, and sine of an angle
_ROUND = 1e-5  # by which part of its radius a point of a mesh may be off the ellipsoid


def stands_for(shape: Shape, unsaid: Shape, meshes: Meshes) -> bool:
    """Whether a shape is where one of another kind is, as far as its own kind can say that."""
    if unsaid.kind == "plane" and shape.kind == "box":
        return _has_face_in(shape, unsaid.pose)
    if unsaid.kind == "ellipsoid" and shape.kind == "mesh":
        return _is_ellipsoid(shape, unsaid, meshes)
    return False


def _has_face_in(box: Shape, plane: Array) -> bool:
    """Whether a face of the box lies in the xy plane of a pose, looking the way of its z axis."""
    normal = plane[:3, 2]
    along = box.pose[:3, :3].T @ normal
    axis = int(np.abs(along).argmax())
    if 1.0 - abs(along[axis]) > _NEAR:
        return False
    height = float(normal @ (box.pose[:3, 3] - plane[:3, 3])) + box.size[axis] / 2.0
    return abs(height) <= _NEAR * max(1.0, float(np.abs(plane[:3, 3]).max()))


def _is_ellipsoid(mesh: Shape, ellipsoid: Shape, meshes: Meshes) -> bool:
    """Whether all points of the mesh are on the ellipsoid and span it. Of a mesh that is not there its pose has to do."""
    surface = meshes.surface(mesh.mesh)
    if isinstance(surface, str):
        return bool(np.abs(mesh.pose - ellipsoid.pose).max() <= _NEAR)
    points = surface.vertices @ mesh.pose[:3, :3].T + mesh.pose[:3, 3]
    unit = (points - ellipsoid.pose[:3, 3]) @ ellipsoid.pose[:3, :3] / np.asarray(ellipsoid.size)
    on_it = np.abs(np.linalg.norm(unit, axis=1) - 1.0).max() <= _ROUND
    spanned = np.abs(np.abs(unit).max(axis=0) - 1.0).max() <= _ROUND
    return bool(on_it and spanned)
