"""Meshes whose points only MuJoCo has: of its own file type, of a formula, moved, the hull of points, or with tables in the text."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from hymeko_x.formats.mjcf.words import NAME
from hymeko_x.ir.parts import Mesh
from hymeko_x.source import file_stem

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism

_MOVED = ("@builtin", "@refpos", "@refquat")
_TABLES = ("@normal", "@texcoord")


def is_made(mechanism: Mechanism, key: Id, mesh: Mesh) -> bool:
    """Whether only MuJoCo has the points of a mesh, or what belongs to them."""
    if any(_has(mechanism, key, name) for name in (*_MOVED, *_TABLES)):
        return True
    return mesh.uri.lower().endswith(".msh") if mesh.uri is not None else bool(mesh.vertices and not mesh.faces)


def with_points(mechanism: Mechanism, mujoco: Any, model: Any, key: Id, files: Mapping[str, bytes]) -> Mesh:
    """A mesh with its points and triangles where MuJoCo has them, in the frame that poses of shapes mean.

    It has texture coordinates where its author gave it some, and normals likewise; those that MuJoCo computes are left out. ``files`` are
    the files of meshes by path.
    """
    mesh = mechanism.vertex(key, Mesh)
    names = [mesh.name, key.name, file_stem(mesh.uri or "")]
    found = (mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_MESH, name) for name in names if name)
    number = next((number for number in found if number >= 0), -1)
    if number < 0:
        return mesh
    turn = _rotation(mujoco, model.mesh_quat[number]).T
    faces = slice(int(model.mesh_faceadr[number]), int(model.mesh_faceadr[number] + model.mesh_facenum[number]))
    if _has_own_points(mechanism, key, mesh):
        made = mesh
    else:
        points = _rows(model.mesh_vert, model.mesh_vertadr[number], model.mesh_vertnum[number]) @ turn + model.mesh_pos[number]
        made = Mesh(None, (1.0, 1.0, 1.0), mesh.name, _flat(points), _flat(model.mesh_face[faces]))
    if model.mesh_texcoordadr[number] >= 0:
        places = _rows(model.mesh_texcoord, model.mesh_texcoordadr[number], model.mesh_texcoordnum[number])
        places[:, 1] = 1.0 - places[:, 1]  # MuJoCo counts from the upper left corner of an image
        made = replace(made, texcoords=_flat(places), texfaces=_flat(model.mesh_facetexcoord[faces]))
    if _has(mechanism, key, "@normal") or _file_has_normals(mesh.uri or "", files):
        normals = _rows(model.mesh_normal, model.mesh_normaladr[number], model.mesh_normalnum[number]) @ turn
        made = replace(made, normals=_flat(normals), normalfaces=_flat(model.mesh_facenormal[faces]))
    return made


def _has_own_points(mechanism: Mechanism, key: Id, mesh: Mesh) -> bool:
    """Whether the points and triangles in the text are those of MuJoCo, which only adds to them what belongs to its corners."""
    is_moved = mesh.scale != (1.0, 1.0, 1.0) or any(_has(mechanism, key, name) for name in _MOVED)
    return mesh.uri is None and bool(mesh.vertices and mesh.faces) and not is_moved


def _has(mechanism: Mechanism, key: Id, attribute: str) -> bool:
    return any(extra.format == NAME and extra.path == attribute for extra in mechanism.extras.get(key, ()))


def _file_has_normals(uri: str, files: Mapping[str, bytes]) -> bool:
    data = files.get(uri, b"")
    if uri.lower().endswith(".msh"):
        return len(data) >= 8 and struct.unpack_from("<i", data, 4)[0] > 0  # its second number counts normals
    return uri.lower().endswith(".obj") and (data.startswith(b"vn ") or b"\nvn " in data)


def _rows(table: Any, first: int, count: int) -> Any:
    return table[first : first + count].astype(float)


def _flat(table: Any) -> tuple[Any, ...]:
    return tuple(table.ravel().tolist())


def _rotation(mujoco: Any, quat: Any) -> Any:
    import numpy as np

    matrix = np.zeros(9)
    mujoco.mju_quat2Mat(matrix, quat)
    return matrix.reshape(3, 3)
