"""Meshes by what can be measured on them: their triangles, bounding box, area and volume."""

from __future__ import annotations

import hashlib
import re
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec.structs import replace

from hymeko_x.verify.model import MeshFile, Surface

if TYPE_CHECKING:
    from pathlib import Path

    from hymeko_x.verify.model import Array, Index


EMPTY = "holds no triangles"
_REFERRING = (".gltf",)
_POLYGON = re.compile(rb"^f(?:[ \t]+[\d/-]+){4}", re.MULTILINE)


class Meshes:
    """Reads mesh files, those of one content once; without ``read`` none at all."""

    def __init__(self, *, read: bool = True) -> None:
        self._wanted = read
        self._files: dict[Path, Surface | str] = {}
        self._contents: dict[bytes, Surface | str] = {}
        self._scaled: dict[MeshFile, Surface] = {}

    def surface(self, mesh: Surface | MeshFile | None) -> Surface | str:
        """The triangles of a mesh in its own frame, scaled; or the reason why there are none. The same mesh gives the same object."""
        if not self._wanted:
            return "meshes were not to be compared"
        if isinstance(mesh, Surface):
            return mesh if len(mesh.faces) else f"a mesh in the file {EMPTY}"
        if mesh is None or mesh.path is None:
            return f"the mesh '{mesh.uri if mesh else ''}' was not found"
        if mesh.path not in self._files:
            self._files[mesh.path] = self._read(mesh.path)
        found = self._files[mesh.path]
        if isinstance(found, str):
            return found
        if mesh not in self._scaled:
            self._scaled[mesh] = replace(found, vertices=found.vertices * np.asarray(mesh.scale))
        return self._scaled[mesh]

    def _read(self, path: Path) -> Surface | str:
        """The triangles of a file, which several names may have: a copy beside the result is the file that was copied."""
        try:
            digest = _digest(path)
        except OSError as error:
            return f"the mesh '{path.name}' cannot be read: {error}"
        if digest not in self._contents:
            self._contents[digest] = _load(path)
        return self._contents[digest]


def _digest(path: Path) -> bytes:
    """What tells the triangles of files apart: content and kind; for a kind that refers to other files also its place."""
    kind = path.suffix.lower()
    place = str(path) if kind in _REFERRING else ""
    digest = hashlib.sha256(path.read_bytes())
    digest.update(f"\n{kind}\n{place}".encode())
    return digest.digest()


def _load(path: Path) -> Surface | str:
    import trimesh

    try:
        loaded = trimesh.load_scene(str(path), process=False)
        whole = loaded.to_mesh()
    except (ValueError, KeyError, IndexError, TypeError, AttributeError, OSError, ImportError, NotImplementedError) as error:
        return f"the mesh '{path.name}' cannot be read: {error}"
    if len(whole.faces) == 0:
        return f"the mesh '{path.name}' {EMPTY}"
    polygons = path.suffix.lower() == ".obj" and _POLYGON.search(path.read_bytes()) is not None
    points = np.asarray(whole.vertices, dtype=float) * (_metres(loaded) if path.suffix.lower() == ".dae" else 1.0)
    return Surface(points, np.asarray(whole.faces, dtype=np.intp), polygons)


def _metres(scene: Any) -> float:
    """The length in m of the unit of a COLLADA file, which says it once for all of its geometry."""
    import trimesh

    units = next((mesh.units for mesh in scene.geometry.values() if mesh.units), None)
    return 1.0 if units is None else float(trimesh.units.unit_conversion(units, "meters"))


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
