"""Mesh files as triangles, and how far the meshes of two bodies differ: by bounding box, area, volume and points."""

from __future__ import annotations

import hashlib
import math
import re
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec.structs import replace

from hymeko_x.verify.mesh_files import read_obj, read_stl
from hymeko_x.verify.model import MeshFile, Surface

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from hymeko_x.verify.model import Array, Index, Shape

ALLOWED = 3e-6
"""Of the mesh's extent: engines keep vertices as floats."""

_POLYGONS = 0.05
"""By this part area and volume may differ where readers split larger faces into other triangles."""

_SURFACE = 0.1
"""The weight of the relative differences of area and volume beside those of lengths."""

_THIN = 1e-3
"""Of the squared extent: areas below it are compared as if they were that large."""

_SAME_POSE = 1e-12
"""In m and as entries of a rotation: two readers compute the pose of a mesh in doubles."""

_MOST_POINTS = 4000  # of each side are searched among all points of the other: a tenth of a second

_THICKNESS = 2e-4
"""Of the mesh's extent: so thick is a solid at most that stands for a flat mesh."""

_EMPTY = "holds no triangles"
_REFERRING = (".gltf",)
_PLAIN = {".obj": read_obj, ".stl": read_stl}
_POLYGON = re.compile(rb"^f(?:[ \t]+[\d/-]+){4}", re.MULTILINE)


class Meshes:
    """Reads mesh files, those of one content once; without ``read`` none at all."""

    def __init__(self, *, read: bool = True) -> None:
        self._wanted = read
        self._files: dict[Path, Surface | str] = {}
        self._digests: dict[Path, bytes] = {}
        self._contents: dict[bytes, Surface | str] = {}
        self._scaled: dict[MeshFile, Surface] = {}

    def surface(self, mesh: Surface | MeshFile | None) -> Surface | str:
        """The triangles of a mesh in its own frame, scaled; or the reason why there are none. The same mesh gives the same object."""
        return self._surface(mesh) if self._wanted else "meshes were not compared, as asked"

    def _surface(self, mesh: Surface | MeshFile | None) -> Surface | str:
        if isinstance(mesh, Surface):
            return mesh if len(mesh.faces) else f"a mesh in the file {_EMPTY}"
        if mesh is None or mesh.path is None:
            return f"the mesh '{mesh.uri if mesh else ''}' was not found"
        if mesh.path not in self._files:
            self._files[mesh.path] = self._read(mesh.path)
        found = self._files[mesh.path]
        if isinstance(found, str):
            return found
        if mesh not in self._scaled:
            scale = np.asarray(mesh.scale)
            other = None if found.other is None else (found.other[0] * scale, found.other[1])
            self._scaled[mesh] = replace(found, vertices=found.vertices * scale, other=other)
        return self._scaled[mesh]

    def why_none(self, shapes: Sequence[Shape]) -> str:
        """Why none of these meshes can be read; "" when one can: an engine that needs the files leaves such meshes out.

        These are read also where no meshes are compared.
        """
        surfaces = [self._surface(shape.mesh) for shape in shapes]
        reasons = [surface for surface in surfaces if isinstance(surface, str)]
        return reasons[0] if len(reasons) == len(surfaces) else ""

    def together(self, shapes: Sequence[Shape]) -> Surface | str:
        """All triangles of several mesh shapes in the body's frame; or the reason why there are none."""
        surfaces = [(shape, self.surface(shape.mesh)) for shape in shapes]
        found = [(surface, shape.pose) for shape, surface in surfaces if isinstance(surface, Surface)]
        if len(found) < len(surfaces):
            return next(surface for _, surface in surfaces if isinstance(surface, str))
        own = _placed([(surface.vertices, surface.faces, place) for surface, place in found])
        other = None
        if any(surface.other is not None for surface, _ in found):
            other = _placed([(*(surface.other or (surface.vertices, surface.faces)), place) for surface, place in found])
        return Surface(*own, any(surface.polygons for surface, _ in found), other)

    def are_placed_alike(self, left: Sequence[Shape], right: Sequence[Shape]) -> bool:
        """Whether both sides have files of the same bytes with the same scales and poses: they need not be read to be the same."""
        if not self._wanted or len(left) != len(right):
            return False
        return all(
            np.abs(a.pose - b.pose).max() <= _SAME_POSE and self._is_one_content(a.mesh, b.mesh) for a, b in zip(left, right, strict=True)
        )

    def _is_one_content(self, a: Surface | MeshFile | None, b: Surface | MeshFile | None) -> bool:
        if not isinstance(a, MeshFile) or not isinstance(b, MeshFile) or a.path is None or b.path is None or a.scale != b.scale:
            return False
        try:
            return self._digest(a.path) == self._digest(b.path)
        except OSError:
            return False

    def _digest(self, path: Path) -> bytes:
        if path not in self._digests:
            self._digests[path] = _digest(path)
        return self._digests[path]

    def _read(self, path: Path) -> Surface | str:
        """The triangles of a file, which several names may have: a copy beside the result is the file that was copied."""
        try:
            digest = self._digest(path)
        except OSError as error:
            return f"the mesh '{path.name}' cannot be read: {error}"
        if digest not in self._contents:
            self._contents[digest] = _load(path)
        return self._contents[digest]


def _placed(tables: Sequence[tuple[Array, Index, Array]]) -> tuple[Array, Index]:
    """Points and triangles of several meshes, each at its pose, as one."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _, _ in tables)])
    vertices = [vertices @ place[:3, :3].T + place[:3, 3] for vertices, _, place in tables]
    return np.concatenate(vertices), np.concatenate([faces + start for (_, faces, _), start in zip(tables, starts, strict=False)])


def _digest(path: Path) -> bytes:
    """Equal for files of the same triangles: of content and kind; of a kind that refers to other files also of its path."""
    kind = path.suffix.lower()
    place = str(path) if kind in _REFERRING else ""
    digest = hashlib.sha256(path.read_bytes())
    digest.update(f"\n{kind}\n{place}".encode())
    return digest.digest()


def _load(path: Path) -> Surface | str:
    """The triangles of a file: at once if it is of a plain kind, else by trimesh."""
    read = _PLAIN.get(path.suffix.lower())
    found = None if read is None else read(path.read_bytes())
    surface = _load_by_trimesh(path) if found is None else found
    if isinstance(surface, Surface) and surface.polygons:
        return replace(surface, other=_split_as_mujoco(path))
    return surface


def _load_by_trimesh(path: Path) -> Surface | str:
    import trimesh

    from hymeko_x.meshes.scene import GLTF, check_accessors, raised_by_loaders
    from hymeko_x.meshes.submesh import Unreadable

    kind = path.suffix.lower()
    refusals: tuple[type[Exception], ...] = (Unreadable, *raised_by_loaders(kind))
    try:
        if kind in GLTF:
            check_accessors(path.read_bytes(), kind)
        loaded = trimesh.load_scene(str(path), process=False)
        whole = loaded.to_mesh()
    except refusals as error:
        return f"the mesh '{path.name}' cannot be read: {error}"
    if len(whole.faces) == 0:
        return f"the mesh '{path.name}' {_EMPTY}"
    polygons = kind == ".obj" and _POLYGON.search(path.read_bytes()) is not None
    points = np.asarray(whole.vertices, dtype=float) * (_metres(loaded) if kind == ".dae" else 1.0)
    return Surface(points, np.asarray(whole.faces, dtype=np.intp), polygons)


def _split_as_mujoco(path: Path) -> tuple[Array, Index] | None:
    """An OBJ file with its polygons split as MuJoCo splits them; None where it does not read the file."""
    from hymeko_x.meshes.submesh import Unreadable
    from hymeko_x.meshes.tables import read_mesh

    try:
        part = read_mesh(path.read_bytes(), ".obj")
    except Unreadable:
        return None
    return None if part is None else (part.points, np.asarray(part.faces, dtype=np.intp))


def _metres(scene: Any) -> float:
    """The length in m of the unit of a COLLADA file, which holds for all of its geometry."""
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


def mesh_distance(left: Sequence[Shape], right: Sequence[Shape], meshes: Meshes) -> tuple[float, str, str]:
    """The worst difference of two bodies' meshes relative to their extent, the measure that differs, or why they cannot be compared."""
    if meshes.are_placed_alike(left, right):
        return 0.0, "", ""
    ours, theirs = meshes.together(left), meshes.together(right)
    if isinstance(ours, str):
        return 0.0, "", ours
    if isinstance(theirs, str):
        return (math.inf, "nothing is left", "") if theirs.endswith(_EMPTY) else (0.0, "", theirs)
    points_a, points_b = used(ours.vertices, ours.faces), used(theirs.vertices, theirs.faces)
    extent = float(np.ptp(points_a, axis=0).max()) or 1.0
    if len(ours.faces) == len(theirs.faces):
        in_order = _in_order(ours, theirs) / extent
        if in_order <= ALLOWED:  # the same triangles: box, area and volume cannot differ by more
            return in_order, "the points of the meshes", ""
    box_a, box_b = (np.stack([points.min(axis=0), points.max(axis=0)]) for points in (points_a, points_b))
    split = _POLYGONS if ours.polygons or theirs.polygons else 0.0
    area, volume = min(_difference(a, b, extent) for a in _splits(ours) for b in _splits(theirs))
    candidates = [
        (float(np.abs(box_a - box_b).max()) / extent, "the bounding box"),
        (_SURFACE * area if area > split else 0.0, "the area"),
        (_SURFACE * volume if volume > split else 0.0, "the volume"),
        (_points_distance(points_a, points_b) / extent, "the points"),
    ]
    difference, where = max(candidates)
    return difference, f"{where} of the meshes", ""


def is_thickened(left: Sequence[Shape], right: Sequence[Shape], meshes: Meshes) -> bool:
    """Whether the meshes of one body are flat, and those of the other are as near to them as the faces of a thin solid."""
    ours, theirs = meshes.together(left), meshes.together(right)
    if isinstance(ours, str) or isinstance(theirs, str):
        return False
    a, b = used(ours.vertices, ours.faces), used(theirs.vertices, theirs.faces)
    extent = float(np.ptp(a, axis=0).max())
    return min(_height(a), _height(b)) <= ALLOWED * extent and _points_distance(a, b) <= _THICKNESS * extent


def _height(points: Array) -> float:
    """The length of points in m along the direction in which they are spread least."""
    centred = points - points.mean(axis=0)
    _, axes = np.linalg.eigh(centred.T @ centred)
    return float(np.ptp(centred @ axes[:, 0]))


def _in_order(ours: Surface, theirs: Surface) -> float:
    """The largest distance in m between corners of triangles in their order; points may be stored once, or for every triangle."""
    same = len(ours.vertices) == len(theirs.vertices) and np.array_equal(ours.faces, theirs.faces)
    a, b = (surface.vertices if same else surface.vertices[surface.faces].reshape(-1, 3) for surface in (ours, theirs))
    return float(np.linalg.norm(a - b, axis=1).max())


def _splits(surface: Surface) -> Iterator[tuple[float, float]]:
    """Area and volume of a surface, and those with its polygons split as MuJoCo does."""
    yield measures(surface.vertices, surface.faces)[1:]
    if surface.other is not None:
        yield measures(*surface.other)[1:]


def _difference(ours: tuple[float, float], theirs: tuple[float, float], extent: float) -> tuple[float, float]:
    """How far areas and volumes differ, relative to area and extent."""
    (area_a, volume_a), (area_b, volume_b) = ours, theirs
    return abs(area_a - area_b) / max(area_a, extent * extent * _THIN), abs(abs(volume_a) - abs(volume_b)) / extent**3


def _points_distance(a: Array, b: Array) -> float:
    """The largest distance from a point of one side to the nearest point of the other, both ways; of large meshes every n-th point."""
    if a.shape == b.shape:
        in_order = float(np.linalg.norm(a - b, axis=1).max())
        if in_order <= ALLOWED * float(np.abs(a).max()):
            return in_order
    from scipy.spatial import cKDTree

    def one_way(points: Array, others: Array) -> float:
        few = points[:: max(1, len(points) // _MOST_POINTS)]
        return float(cKDTree(others).query(few)[0].max())

    return max(one_way(a, b), one_way(b, a))
