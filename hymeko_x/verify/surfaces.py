"""Meshes by what can be measured on them: their triangles, bounding box, area and volume."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hymeko_x.verify.model import MeshFile, Surface

if TYPE_CHECKING:
    from pathlib import Path

    from hymeko_x.verify.model import Array, Index


EMPTY = "holds no triangles"


class Meshes:
    """Reads mesh files, each one once; without ``read`` none at all."""

    def __init__(self, *, read: bool = True) -> None:
        self._wanted = read
        self._read: dict[Path, Surface | str] = {}

    def surface(self, mesh: Surface | MeshFile | None) -> Surface | str:
        """The triangles of a mesh in its own frame, scaled; or the reason why there are none."""
        if not self._wanted:
            return "meshes were not to be compared"
        if isinstance(mesh, Surface):
            return mesh if len(mesh.faces) else f"a mesh in the file {EMPTY}"
        if mesh is None or mesh.path is None:
            return f"the mesh '{mesh.uri if mesh else ''}' was not found"
        if mesh.path not in self._read:
            self._read[mesh.path] = _load(mesh.path)
        found = self._read[mesh.path]
        return found if isinstance(found, str) else Surface(found.vertices * np.asarray(mesh.scale), found.faces)


def _load(path: Path) -> Surface | str:
    import trimesh

    try:
        loaded = trimesh.load_scene(str(path), process=False)
        whole = loaded.to_mesh()
    except (ValueError, KeyError, IndexError, TypeError, AttributeError, OSError, ImportError, NotImplementedError) as error:
        return f"the mesh '{path.name}' cannot be read: {error}"
    if len(whole.faces) == 0:
        return f"the mesh '{path.name}' {EMPTY}"
    return Surface(np.asarray(whole.vertices, dtype=float), np.asarray(whole.faces, dtype=np.intp))


def used(vertices: Array, faces: Index) -> Array:
    """The points that are corners of triangles, in their order."""
    mask = np.zeros(len(vertices), dtype=bool)
    mask[faces.ravel()] = True
    points: Array = vertices[mask]
    return points


def measures(vertices: Array, faces: Index) -> tuple[Array, float, float]:
    """Bounding box (2, 3) in m, area in m^2, and signed volume in m^3 of triangles."""
    corners = vertices[faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    points = used(vertices, faces)
    volume = float(np.einsum("ij,ij->i", corners[:, 0], cross).sum() / 6.0)
    return np.stack([points.min(axis=0), points.max(axis=0)]), float(np.linalg.norm(cross, axis=1).sum() / 2.0), volume
