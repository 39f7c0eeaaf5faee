"""The triangles of meshes as arrays, once for each mesh: a mesh keeps its numbers as plain tuples, which are slow to turn."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hymeko_x.ir.parts import Mesh

    Surface = tuple[NDArray[Any], NDArray[Any]]
    """Points (n x 3, single precision) and the corners of triangles (flat)."""


def surface_of(mesh: Mesh) -> Surface | None:
    """What of a mesh can be drawn; None without points, with one that single precision cannot hold, or with a broken triangle."""
    if not mesh.vertices or len(mesh.vertices) % 3 or len(mesh.faces) % 3:
        return None
    with np.errstate(over="ignore"):
        points = np.fromiter(mesh.vertices, np.float64, len(mesh.vertices)).astype(np.float32).reshape(-1, 3)
    faces = np.fromiter(mesh.faces, np.int64, len(mesh.faces))
    if not np.isfinite(points).all() or (faces.size and (faces.min() < 0 or faces.max() >= len(points))):
        return None
    return points, faces.astype(np.int32)


def normals_of(surface: Surface) -> NDArray[Any]:
    """The unit normal of each triangle (n x 3, single precision), by the right hand; z where a triangle has none."""
    points, faces = surface
    first, second, third = (points[faces[corner::3]].astype(np.float64) for corner in range(3))
    (ax, ay, az), (bx, by, bz) = (second - first).T, (third - first).T
    normals = np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=1)
    lengths = np.sqrt(np.einsum("ij,ij->i", normals, normals))
    flat = ~(lengths > 0.0)
    normals[flat], lengths[flat] = (0.0, 0.0, 1.0), 1.0
    return np.asarray(normals / lengths[:, None], dtype=np.float32)
