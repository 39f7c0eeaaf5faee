"""The triangles of meshes as arrays, once for each mesh: of a file they are arrays already, of a mechanism plain tuples."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hymeko_x.meshes.part import FilledMesh

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hymeko_x.ir.parts import Mesh
    from hymeko_x.meshes.part import Part

    Surface = tuple[NDArray[Any], NDArray[Any]]
    """Points (n x 3, single precision) and the corners of triangles (flat)."""


def places_of(mesh: Mesh) -> Surface | None:
    """The places of a mesh in its image (n x 2, single precision) and the row of each corner; None where they are none or broken."""
    table = _mapped(mesh.part) if isinstance(mesh, FilledMesh) else _listed_places(mesh)
    return None if table is None else _in_single(*table)


def _mapped(part: Part) -> Surface | None:
    return None if part.uv is None else (part.uv, (part.faces if part.corners is None else part.corners).ravel())


def _listed_places(mesh: Mesh) -> Surface | None:
    rows = mesh.texfaces or mesh.faces
    if not mesh.texcoords or len(mesh.texcoords) % 2 or len(rows) != len(mesh.faces):
        return None
    return np.fromiter(mesh.texcoords, np.float64, len(mesh.texcoords)).reshape(-1, 2), np.fromiter(rows, np.int64, len(rows))


def surface_of(mesh: Mesh) -> Surface | None:
    """What of a mesh can be drawn; None without points, with one that single precision cannot hold, or with a broken triangle."""
    table = (mesh.part.points, mesh.part.faces.ravel()) if isinstance(mesh, FilledMesh) else _listed(mesh)
    return None if table is None or not len(table[0]) else _in_single(*table)


def _in_single(rows: NDArray[Any], corners: NDArray[Any]) -> Surface | None:
    """Rows of numbers and the row of each corner; None where single precision cannot hold a number, or a row is not there."""
    with np.errstate(over="ignore"):
        numbers = rows.astype(np.float32)
    if not np.isfinite(numbers).all() or (corners.size and (corners.min() < 0 or corners.max() >= len(numbers))):
        return None
    return numbers, corners.astype(np.int32)


def _listed(mesh: Mesh) -> Surface | None:
    if len(mesh.vertices) % 3 or len(mesh.faces) % 3:
        return None
    points = np.fromiter(mesh.vertices, np.float64, len(mesh.vertices)).reshape(-1, 3)
    return points, np.fromiter(mesh.faces, np.int64, len(mesh.faces))
