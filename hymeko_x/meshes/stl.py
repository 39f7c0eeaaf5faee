"""STL files, binary and text."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any

import numpy as np

from hymeko_x.memory import remembered
from hymeko_x.meshes.submesh import Unreadable

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hymeko_x.meshes.submesh import Submesh

_STL_HEADER = 80
_STL_FACE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("spare", "<u2")])


def read_stl(data: bytes) -> NDArray[Any]:
    """The corners of the triangles of an STL file, binary (single precision) or text (double), as (faces, 3, 3) in its own unit.

    Raises: Unreadable.
    """
    corners = _binary_corners(data) if not _is_text_stl(data) else _text_corners(data)
    if len(corners) == 0:
        raise Unreadable("it has no triangles")
    if not np.isfinite(corners).all():
        raise Unreadable("a coordinate is not a finite number")
    return corners


def stl_is_exact(data: bytes) -> bool:
    """Whether the bytes are a binary STL file whose length follows from its header."""
    return len(data) > _STL_HEADER + 4 and len(data) == _STL_HEADER + 4 + stl_faces(data) * _STL_FACE.itemsize


def stl_faces(data: bytes) -> int:
    """The number of triangles in the header of a binary STL file."""
    (count,) = struct.unpack_from("<I", data, _STL_HEADER)
    return int(count)


def _is_text_stl(data: bytes) -> bool:
    """Text begins with ``solid``, but so do some binary files: those have the length that follows from their header."""
    return data[:80].lstrip().lower().startswith(b"solid") and not stl_is_exact(data) and b"facet" in data[:4096].lower()


def _binary_corners(data: bytes) -> NDArray[np.float32]:
    if len(data) < _STL_HEADER + 4:
        raise Unreadable(f"it has {len(data)} bytes, and an STL file has at least {_STL_HEADER + 4}")
    count, room = stl_faces(data), (len(data) - _STL_HEADER - 4) // _STL_FACE.itemsize
    if count > room:
        raise Unreadable(f"its header promises {count} triangles, and there is room for {room}")
    faces = np.frombuffer(data, _STL_FACE, count, _STL_HEADER + 4)
    return faces["corners"].astype(np.float32)


def _text_corners(data: bytes) -> NDArray[np.float64]:
    rows = [line.split()[1:4] for line in data.splitlines() if line.lstrip()[:7].lower() == b"vertex "]
    try:
        values = np.array(rows, dtype=np.float64)
    except ValueError as error:
        raise Unreadable(f"a vertex is not three numbers ({error})") from error
    if values.size % 9:
        raise Unreadable("the number of its vertices is not a multiple of three")
    return values.reshape(-1, 3, 3)


@remembered
def stl_bytes(part: Submesh) -> bytes:
    """The part as a binary STL file; its normals are computed."""
    corners = part.points[part.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    faces = np.zeros(len(corners), _STL_FACE)
    faces["corners"] = corners
    faces["normal"] = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0.0)
    return b"binary STL".ljust(_STL_HEADER) + struct.pack("<I", len(faces)) + faces.tobytes()
