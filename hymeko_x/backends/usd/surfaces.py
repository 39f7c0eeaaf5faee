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
