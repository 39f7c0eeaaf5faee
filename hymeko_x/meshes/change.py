"""How far two meshes are apart: what of their tables differs, and volume, area and the distance of their surfaces."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from msgspec.structs import replace

from hymeko_x.meshes.weld import joined

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from hymeko_x.meshes.submesh import Submesh

TRIANGLES = "triangles"
"""The change of the number of triangles, which comes first where there is one."""
ORDER = "order of triangles"
"""The change of meshes that have the same surface, but not triangle by triangle."""
_ROUNDING = 1e-6
"""Lengths that differ by less, as a part of the largest extent, are the same in single precision."""
_TURNED = 1e-4
"""In rad: single precision, and files with five decimals, turn a normal by less."""
_MOST_POINTS = 5_000
"""Of so many points of each mesh the distance to the other surface is taken, evenly through its points."""
_NEAREST = 24
"""So many triangles, those with the nearest centres, are looked at for each point; all of a mesh with few."""
_FEW = 400


class MeshChange(NamedTuple):
    """One quantity that differs: its name, its value before, and its value after."""

    name: str
    before: float
    after: float


def changes(before: Submesh, after: Submesh) -> tuple[MeshChange, ...]:
    """What differs from one mesh to the other, in m; nothing where they show the same triangles, texture coordinates and normals.

    The order of triangles does not count, nor whether points are shared; points of no triangle do where both meshes keep them.
    """
    if _are_same_triangles(before, after):
        return (*_of_places(before, after), *_of_normals(before, after))
    found = [MeshChange(TRIANGLES, len(before.faces), len(after.faces))]
    measures = (("volume", volume), ("area", area)) if is_closed(before) and is_closed(after) else (("area", area),)
    sizes = [MeshChange(name, size(before), size(after)) for name, size in measures]
    found += [change for change in sizes if abs(change.before - change.after) > _ROUNDING * max(abs(change.before), abs(change.after))]
    found.append(MeshChange("distance", 0.0, distance(before, after)))
    rows = [change for change in found if change.before != change.after]
    return (*rows, *_of_places(before, after), *_of_lost_normals(before, after)) or (MeshChange(ORDER, 0.0, 1.0),)


def sorted_triangles(part: Submesh) -> Submesh:
    """The mesh with its triangles in the order of their corners in single precision, the same for the same triangles in any order."""
    corners = part.points[part.faces].astype(np.float32).reshape(-1, 9)
    order = np.lexsort(corners.T[::-1])
    rows = (part.faces, part.corners, part.normal_corners)
    faces, uv_rows, normal_rows = (None if table is None else table[order] for table in rows)
    return replace(part, faces=faces, corners=uv_rows, normal_corners=normal_rows)


def is_closed(part: Submesh) -> bool:
    """Whether every side of a triangle is that of another one as well, in the other direction, so that the mesh has a volume."""
    places = joined(part.points)[1][part.faces]
    sides = np.concatenate([places[:, [0, 1]], places[:, [1, 2]], places[:, [2, 0]]]).astype(np.int64)
    count = int(places.max(initial=0)) + 1
    there, back = np.sort(sides[:, 0] * count + sides[:, 1]), np.sort(sides[:, 1] * count + sides[:, 0])
    return bool(np.array_equal(there, back))


def volume(part: Submesh) -> float:
    """The volume that a closed mesh has by the directions of its triangles, in m^3."""
    a, b, c = (part.points[part.faces[:, corner]] for corner in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)


def area(part: Submesh) -> float:
    """The area of all triangles, in m^2."""
    a, b, c = (part.points[part.faces[:, corner]] for corner in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)


def distance(a: Submesh, b: Submesh) -> float:
    """The largest distance in m from a point of either surface to the other surface, from their points; an upper bound for large meshes."""
    if not len(a.faces) or not len(b.faces):
        return float("inf")
    found = max(_one_way(a, b), _one_way(b, a))
    extent = float(np.ptp(a.points, axis=0).max())
    return found if found > _ROUNDING * extent else 0.0


def _are_same_triangles(a: Submesh, b: Submesh) -> bool:
    """Whether both have the same triangles in the same order, in single precision."""
    if len(a.faces) != len(b.faces) or not len(a.points) or not len(b.points):
        return len(a.faces) == len(b.faces) == 0 and len(a.points) == len(b.points)
    extent = float(np.ptp(a.points, axis=0).max())
    return bool(np.abs(a.points[a.faces] - b.points[b.faces]).max(initial=0.0) <= _ROUNDING * extent)


def _of_places(a: Submesh, b: Submesh) -> Iterator[MeshChange]:
    """The change of texture coordinates: how many triangles have them, and how far they are moved at most."""
    ours, theirs = _places(a), _places(b)
    if ours is None and theirs is None:
        return
    if ours is None or theirs is None:
        yield MeshChange("texture coordinates", 0 if ours is None else len(ours), 0 if theirs is None else len(theirs))
    elif ours.shape == theirs.shape:
        moved = float(np.abs(ours - theirs).max(initial=0.0))
        if moved > _ROUNDING * max(1.0, float(np.abs(ours).max(initial=0.0))):
            yield MeshChange("places in the image", 0.0, moved)


def _places(part: Submesh) -> NDArray[np.float64] | None:
    """The texture coordinates at the corners of the triangles (m, 3, 2)."""
    if part.uv is None:
        return None
    found: NDArray[np.float64] = part.uv[part.faces if part.corners is None else part.corners]
    return found


def _of_normals(a: Submesh, b: Submesh) -> Iterator[MeshChange]:
    """The change of the normals of a mesh that has some, by corner: that they are gone, or how far they are turned at most, in rad."""
    yield from _of_lost_normals(a, b)
    ours, theirs = _normals(a), _normals(b)
    if ours is not None and theirs is not None:
        chord = float(np.linalg.norm(ours - theirs, axis=2).max(initial=0.0))
        if chord > _TURNED:
            yield MeshChange("turn of normals", 0.0, 2.0 * float(np.arcsin(min(chord / 2.0, 1.0))))


def _of_lost_normals(a: Submesh, b: Submesh) -> Iterator[MeshChange]:
    if a.normals is not None and b.normals is None:
        yield MeshChange("normals", len(a.faces), 0)


def _normals(part: Submesh) -> NDArray[np.float64] | None:
    """The unit normals at the corners of the triangles (m, 3, 3); zero where there is no direction."""
    if part.normals is None:
        return None
    lengths = np.linalg.norm(part.normals, axis=1, keepdims=True)
    unit = part.normals / np.where(lengths > 0.0, lengths, 1.0)
    found: NDArray[np.float64] = unit[part.faces if part.normal_corners is None else part.normal_corners]
    return found


def _one_way(a: Submesh, b: Submesh) -> float:
    """The largest distance from the points of one mesh to the surface of the other."""
    from scipy.spatial import cKDTree

    points = np.unique(a.points[np.unique(a.faces)], axis=0)
    points = points[:: max(1, len(points) // _MOST_POINTS)]
    corners = b.points[b.faces]
    if len(corners) <= _FEW:
        near: Any = np.broadcast_to(np.arange(len(corners)), (len(points), len(corners)))
    else:
        near = cKDTree(corners.mean(axis=1)).query(points, _NEAREST)[1]
    to_corners = cKDTree(b.points[np.unique(b.faces)]).query(points)[0]
    to_surface = np.concatenate([_to_triangles(some, corners[rows]).min(axis=1) for some, rows in _pieces(points, near)])
    return float(np.minimum(to_corners, to_surface).max())


def _pieces(points: NDArray[Any], near: NDArray[Any]) -> Iterator[tuple[NDArray[Any], NDArray[Any]]]:
    """Some points at a time, so that memory stays bounded."""
    step = max(1, 200_000 // near.shape[1])
    for start in range(0, len(points), step):
        yield points[start : start + step], near[start : start + step]


def _to_triangles(points: NDArray[Any], corners: NDArray[Any]) -> NDArray[Any]:
    """The distances of points (n, 3) to their triangles (n, k, 3, 3): to the plane where the foot is inside, else to the nearest side."""
    point = points[:, None, :]
    a, b, c = corners[..., 0, :], corners[..., 1, :], corners[..., 2, :]
    normal = np.cross(b - a, c - a)
    length = np.einsum("...i,...i->...", normal, normal)
    is_inside = length > 0.0
    for start, end in ((a, b), (b, c), (c, a)):
        is_inside &= np.einsum("...i,...i->...", np.cross(end - start, point - start), normal) >= 0.0
    height = np.abs(np.einsum("...i,...i->...", point - a, normal)) / np.sqrt(np.where(length > 0.0, length, 1.0))
    sides = np.minimum(np.minimum(_to_side(point, a, b), _to_side(point, b, c)), _to_side(point, c, a))
    found: NDArray[Any] = np.where(is_inside, height, sides)
    return found


def _to_side(point: NDArray[Any], start: NDArray[Any], end: NDArray[Any]) -> NDArray[Any]:
    """The distances of points to the lines between two corners."""
    along = end - start
    length = np.einsum("...i,...i->...", along, along)
    share = np.einsum("...i,...i->...", point - start, along) / np.where(length > 0.0, length, 1.0)
    found: NDArray[Any] = np.linalg.norm(point - start - np.clip(share, 0.0, 1.0)[..., None] * along, axis=-1)
    return found
