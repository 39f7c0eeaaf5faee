"""Meshes that a mechanism holds itself, as files from which MuJoCo reads the same points and triangles in the same order."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

import numpy as np
from msgspec.structs import replace

from hymeko_x import formats
from hymeko_x.formats.mjcf import MOST_STL_FACES
from hymeko_x.ir.parts import Mesh
from hymeko_x.meshes.obj import obj_bytes
from hymeko_x.meshes.reader import inline_part
from hymeko_x.meshes.stl import stl_bytes
from hymeko_x.meshes.submesh import Unreadable
from hymeko_x.meshes.weld import joined

if TYPE_CHECKING:
    from hymeko_x.assets.shelf import Shelf
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.meshes.submesh import Submesh

FOLDER = "meshes"
_MOST_POINTS = 200
"""In the text of a model; meshes with more are files."""


def stays_inline(part: Submesh) -> bool:
    """Whether a mesh is small enough for the text of a model, which has no texture coordinates from the lower left, and no normals."""
    return part.has_points_alone and len(part.points) <= _MOST_POINTS


def mesh_file(part: Submesh) -> tuple[str, bytes]:
    """The suffix and the content of the file: STL where its points come in the order of the triangles, MSH without triangles, else OBJ."""
    if not len(part.faces):
        return ".msh", msh_bytes(part)
    if part.has_points_alone and len(part.faces) <= MOST_STL_FACES and _is_in_order_of_stl(part):
        return ".stl", stl_bytes(part)
    return ".obj", obj_bytes(part)


def msh_bytes(part: Submesh) -> bytes:
    """MuJoCo's own binary format, in single precision, without normals and texture coordinates."""
    header = struct.pack("<4i", len(part.points), 0, 0, len(part.faces))
    return header + part.points.astype("<f4").tobytes() + part.faces.astype("<i4").tobytes()


def _is_in_order_of_stl(part: Submesh) -> bool:
    """Whether a reader of STL, which numbers different points as they come, gets the same numbers."""
    rows = np.ascontiguousarray(part.points, dtype=np.float32)
    different, _ = joined(rows.view(np.uint32).astype(np.float64))
    if len(different) < len(rows):
        return False
    used, first = np.unique(part.faces, return_index=True)
    return len(used) == len(rows) and bool((np.diff(first) > 0).all())


def with_points_as_files(mechanism: Mechanism, shelf: Shelf) -> Mechanism:
    """A mechanism that came from MJCF, with a file for each large mesh that another format has given points."""
    row = formats.of_file(mechanism.source.file)
    if row is None or not row.holds_points or shelf.mode == "reference":
        return mechanism
    changed: dict[Id, Mesh] = {}
    for key, mesh in mechanism.vertices(Mesh):
        if mesh.uri is not None or not mesh.vertices:
            continue
        try:
            part = inline_part(mesh)
        except Unreadable:
            continue
        if not stays_inline(part):
            suffix, data = mesh_file(part)
            changed[key] = replace(mesh.without_points(), uri=shelf.place(FOLDER, key.name, suffix, data))
    return mechanism.replace(vertices=changed)
