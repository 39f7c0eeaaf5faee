"""The size of a mesh file that has no unit, without a library for meshes."""

from __future__ import annotations

from struct import unpack_from
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hymeko_x.ir.values import Vec3

_HEADER, _FACE, _NORMAL = 84, 50, 12  # bytes of a binary STL file: what stands before the triangles, a triangle, its normal
_LOOKED_AT = 500
"""Triangles that are looked at: enough to tell millimetres from metres."""


def extents_of_stl(data: bytes) -> Vec3 | None:
    """The sizes along x, y, z of a binary STL file in its own unit, by a sample of its triangles; None for other content."""
    count = (len(data) - _HEADER) // _FACE
    if count < 1 or len(data) != _HEADER + count * _FACE or unpack_from("<I", data, _HEADER - 4) != (count,):
        return None
    faces = [unpack_from("<9f", data, _HEADER + _FACE * n + _NORMAL) for n in range(0, count, 1 + count // _LOOKED_AT)]
    x, y, z = (max(max(face[n::3]) for face in faces) - min(min(face[n::3]) for face in faces) for n in range(3))
    return x, y, z
