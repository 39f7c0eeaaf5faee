"""Triangles of mesh files: submeshes, each of one appearance, and the groups of triangles of one material in a file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from msgspec import Struct

from hymeko_x.ir.parts import Mesh

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hymeko_x.ir.parts import Rgba

MOST_FACES = 20_000_000


class Unreadable(Exception):
    """The bytes are not a mesh of the type of their suffix; the text is the reason."""


class MaterialEntry(NamedTuple):
    """A material in a mesh file: its colour, and the name of its image file there."""

    rgba: Rgba | None = None
    image: str = ""


class MaterialGroup(NamedTuple):
    """The triangles of one material in a file: points (n, 3), triangles (m, 3) as rows of them, and the material's name.

    ``uv`` are texture coordinates (k, 2) from the lower left corner of the image, ``corners`` (m, 3) the rows of them, or both None;
    ``normals`` (l, 3) and ``normal_corners`` likewise.
    ``order`` (m) are ascending numbers by which the triangles of all groups are in the order of the file; None where they already are.
    """

    points: NDArray[np.float64]
    faces: NDArray[Any]
    material: str = ""
    entry: MaterialEntry = MaterialEntry()
    uv: NDArray[np.float64] | None = None
    corners: NDArray[Any] | None = None
    order: NDArray[np.intp] | None = None
    normals: NDArray[np.float64] | None = None
    normal_corners: NDArray[Any] | None = None


class Appearance(Struct, frozen=True):
    """The appearance of triangles in a mesh file: its name there, its colour, and the bytes of its image with the name of that file."""

    name: str
    rgba: Rgba | None
    image: bytes | None = None
    file: str = ""


class Submesh(Struct, frozen=True, eq=False):
    """The triangles of a mesh file that have one appearance (None = the file has none for them).

    ``points`` is (n, 3) in m in the frame of the file, ``faces`` (m, 3) rows of ``points``, ``uv`` (k, 2) or None; ``corners``
    are the rows of ``uv`` of the triangles, None where they are those of ``points``. ``normals`` (l, 3) and ``normal_corners`` are the same
    for the normals of the corners.
    """

    points: NDArray[np.float64]
    faces: NDArray[np.signedinteger[Any]]
    uv: NDArray[np.float64] | None = None
    appearance: Appearance | None = None
    corners: NDArray[np.signedinteger[Any]] | None = None
    normals: NDArray[np.float64] | None = None
    normal_corners: NDArray[np.signedinteger[Any]] | None = None

    @property
    def has_points_alone(self) -> bool:
        """Whether its corners have neither texture coordinates nor normals."""
        return self.uv is None and self.normals is None


class ColouredMesh(NamedTuple):
    """All triangles of a mesh file, and for each appearance the rows of its triangles in ``mesh.faces``; the others have none."""

    mesh: Submesh
    appearances: tuple[tuple[Appearance, NDArray[np.intp]], ...] = ()


class LoadedMesh(Mesh, frozen=True, eq=False, kw_only=True):
    """A mesh with the triangles of its file, for a format that contains triangles itself; its own lists stay empty."""

    loaded: Submesh


def listed(part: Submesh) -> Mesh:
    """The mesh with its points and triangles as lists of its own."""
    places, normals = _listed(part.uv, part.corners, part.faces), _listed(part.normals, part.normal_corners, part.faces)
    return Mesh(None, (1.0, 1.0, 1.0), None, tuple(part.points.ravel().tolist()), indices(part.faces), *places, *normals)


def _listed(table: NDArray[Any] | None, corners: NDArray[Any] | None, faces: NDArray[Any]) -> tuple[tuple[float, ...], tuple[int, ...]]:
    """A table of the corners as flat lists; empty where there is none."""
    return ((), ()) if table is None else (tuple(table.ravel().tolist()), indices(faces if corners is None else corners))


def indices(rows: NDArray[Any]) -> tuple[int, ...]:
    """Indices of points as a flat tuple. Equal ones are one object, which takes a third of the memory: each point has six triangles."""
    if not rows.size or rows.min() < 0 or rows.max() > rows.size:
        return tuple(rows.ravel().tolist())
    return tuple(np.arange(rows.max() + 1).astype(object)[rows.ravel()].tolist())


# ---- polygons ----------------------------------------------------------------------------------------------------------------------


def fans(sizes: NDArray[Any], corners: NDArray[Any]) -> NDArray[Any]:
    """Polygons, given by how many corners each has and all their corners, as fans of triangles (n, 3).

    Raises: ValueError when the corners are not as many as the sizes add up to, or a size is negative.
    """
    if sizes.size and (sizes.min() < 0 or sizes.sum() != corners.size):
        raise ValueError("another number of corners than the polygons have")
    if (sizes == 3).all():
        return corners.reshape(-1, 3)
    count = np.maximum(sizes - 2, 0)
    starts = np.repeat(np.cumsum(sizes) - sizes, count)
    step = np.arange(int(count.sum())) - np.repeat(np.cumsum(count) - count, count)
    return corners[np.stack([starts, starts + step + 1, starts + step + 2], axis=1)] if len(step) else corners[:0].reshape(0, 3)


def used_rows(table: NDArray[np.float64], faces: NDArray[Any]) -> tuple[NDArray[np.float64], NDArray[Any]]:
    """Triangles and the rows of a table that they are of; of a table that is much longer than their own, only those that they use."""
    if len(table) <= faces.size:
        return table, faces
    rows, index = np.unique(faces, return_inverse=True)
    return table[rows], index.reshape(faces.shape)
