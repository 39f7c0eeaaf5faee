"""Mesh prims: points, triangles, normals, texture coordinates, and subsets with materials of their own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from pxr import Sdf, Vt

from hymeko_x.backends.usd.materials import bind
from hymeko_x.backends.usd.sheet import T, put
from hymeko_x.formats import usd as words
from hymeko_x.ir.parts import Mesh
from hymeko_x.meshes.measures import face_normals
from hymeko_x.meshes.submesh import LoadedMesh

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hymeko_x.backends.usd.sheet import Triangles, UsdSheet, WrittenPrim
    from hymeko_x.ir.mechanism import Id, Mechanism, ShapeView
    from hymeko_x.ir.notations import Notation
    from hymeko_x.ir.values import Vec3
    from hymeko_x.meshes.submesh import Submesh

_ST = "primvars:st"
_NORMALS = "primvars:normals"


# ---- meshes --------------------------------------------------------------------------------------------------------------------


def write_mesh_shape(sheet: UsdSheet, spec: Any, view: ShapeView, users: dict[Id, int], shared: dict[Id, Any]) -> Vec3 | None:
    """The mesh itself, or a reference to where it is; without points the prim stays a mere place."""
    mesh = sheet.mechanism.part(view.mesh, Mesh)
    if view.mesh is None or mesh is None:
        return None
    if view.mesh not in sheet.triangles:
        sheet.triangles[view.mesh] = surface_of(mesh)
    surface = sheet.triangles[view.mesh]
    if users[view.mesh] == 1 or surface is None:
        _carry_mesh(sheet, spec, view.mesh)
        if surface is not None:
            write_triangles(spec, surface)
            _write_attributes(spec, sheet.mechanism, view.id, mesh, surface)
    else:
        if view.mesh not in shared:
            shared[view.mesh] = _write_prototype(sheet, view.id, view.mesh, mesh, surface)
            _carry_mesh(sheet, spec, view.mesh)
        spec.kind = "Mesh"
        spec.reference = shared[view.mesh]
    return None if mesh.scale == (1.0, 1.0, 1.0) or surface is None else mesh.scale


def _write_attributes(spec: WrittenPrim, mechanism: Mechanism, shape: Id, mesh: Mesh, surface: Triangles) -> None:
    """Normals and texture coordinates of a mesh, as far as the prim of the shape gets them."""
    normals = normals_of(mesh)
    if normals is not None and has_own(mechanism, shape, words.CORNER_NORMALS):
        _write_corners(spec, _NORMALS, T.Normal3fArray, Vt.Vec3fArray.FromNumpy(normals[0]), normals[1])
    elif normals is None and has_own(mechanism, shape, words.NORMALS):
        write_normals(spec, surface)
    places = places_of(mesh) if has_own(mechanism, shape, words.TEXCOORDS) else None
    if places is not None:
        _write_corners(spec, _ST, T.TexCoord2fArray, Vt.Vec2fArray.FromNumpy(places[0]), places[1])


def has_own(mechanism: Mechanism, shape: Id, notation: Notation[bool]) -> bool:
    """Whether the prim of a mesh gets such an attribute: new prims do, those from a stage where they had it."""
    return mechanism.notation(shape, words.PATH) is None or mechanism.notation(shape, notation) is not None


def _carry_mesh(sheet: UsdSheet, spec: Any, mesh: Id) -> None:
    """The prim of a mesh represents it."""
    sheet.paths[mesh] = spec.path


def _write_prototype(sheet: UsdSheet, shape: Id, key: Id, mesh: Mesh, surface: Triangles) -> Any:
    """A mesh that is shown several times, for the first time by this shape: a class, which is seen only through references to it."""
    scope = sheet.root.AppendChild("meshes")
    if scope not in sheet.prims:
        group = sheet.define(scope, "Scope")
        group.specifier = Sdf.SpecifierClass
        put(group, f"{words.PREFIX}scope", T.Bool, True)
    spec = sheet.define(sheet.free_path(scope, key.name), "Mesh")
    write_triangles(spec, surface)
    _write_attributes(spec, sheet.mechanism, shape, mesh, surface)
    return spec.path


def write_triangles(prim: WrittenPrim, surface: Triangles) -> None:
    """Points in single precision, triangles, and no subdivision."""
    points, faces = surface
    prim.kind = "Mesh"
    put(prim, "points", T.Point3fArray, Vt.Vec3fArray.FromNumpy(points))
    put(prim, "faceVertexCounts", T.IntArray, Vt.IntArray(len(faces) // 3, 3))
    put(prim, "faceVertexIndices", T.IntArray, Vt.IntArray.FromNumpy(faces))
    put(prim, "subdivisionScheme", T.Token, "none")
    axes = np.ascontiguousarray(points.T)  # of which a least value is found much faster
    box = np.stack([axes.min(axis=1), axes.max(axis=1)])
    put(prim, "extent", T.Float3Array, Vt.Vec3fArray.FromNumpy(box))


def write_normals(prim: WrittenPrim, surface: Triangles) -> None:
    """One normal for each triangle, for programs that compute none of their own; a degenerate triangle has some unit vector."""
    put(prim, "normals", T.Normal3fArray, Vt.Vec3fArray.FromNumpy(face_normals(*surface)))
    prim.interpolation["normals"] = "uniform"


def _write_corners(prim: WrittenPrim, name: str, kind: Any, table: Any, rows: NDArray[np.int32]) -> None:
    """A table of values, and its row for each corner of the triangles."""
    put(prim, name, kind, table)
    put(prim, f"{name}:indices", T.IntArray, Vt.IntArray.FromNumpy(rows))
    prim.interpolation[name] = "faceVarying"


def write_subsets(sheet: UsdSheet, spec: WrittenPrim, view: ShapeView) -> None:
    """The triangles of a mesh that show other materials, each a prim below it."""
    surface = sheet.triangles.get(view.mesh) if view.mesh is not None else None
    count = 0 if surface is None else len(surface[1]) // 3
    for subset in sheet.mechanism.subsets.get(view.id, ()):
        if not subset.faces or min(subset.faces) < 0 or max(subset.faces) >= count or subset.material not in sheet.paths:
            continue
        prim = sheet.add_prim(subset.id, spec.path, "GeomSubset", subset.id.name.partition("#")[0], below=True)
        put(prim, "elementType", T.Token, words.FACE)
        put(prim, "familyName", T.Token, words.MATERIAL_BIND)
        put(prim, "indices", T.IntArray, Vt.IntArray(subset.faces))
        bind(sheet, prim, subset.material)
        put(spec, words.FAMILY, T.Token, words.NON_OVERLAPPING)


# ---- triangles of meshes as arrays -------------------------------------------------------------------------------------------------


def places_of(mesh: Mesh) -> Triangles | None:
    """The places of a mesh in its image (n x 2, single precision) and the row of each corner; None where they are none or broken."""
    if isinstance(mesh, LoadedMesh):
        return _loaded(mesh.loaded.uv, mesh.loaded.corners, mesh.loaded)
    return _of_lists(mesh.texcoords, mesh.texfaces or mesh.faces, 2, mesh)


def normals_of(mesh: Mesh) -> Triangles | None:
    """The normals of a mesh (n x 3, single precision) and the row of each corner; None where they are none or broken."""
    if isinstance(mesh, LoadedMesh):
        return _loaded(mesh.loaded.normals, mesh.loaded.normal_corners, mesh.loaded)
    return _of_lists(mesh.normals, mesh.normalfaces or mesh.faces, 3, mesh)


def _loaded(table: NDArray[Any] | None, corners: NDArray[Any] | None, part: Submesh) -> Triangles | None:
    return None if table is None else _in_single(table, (part.faces if corners is None else corners).ravel())


def _of_lists(numbers: tuple[float, ...], rows: tuple[int, ...], width: int, mesh: Mesh) -> Triangles | None:
    if not numbers or len(numbers) % width or len(rows) != len(mesh.faces):
        return None
    return _in_single(np.fromiter(numbers, np.float64, len(numbers)).reshape(-1, width), np.fromiter(rows, np.int64, len(rows)))


def surface_of(mesh: Mesh) -> Triangles | None:
    """What of a mesh can be drawn; None without points, with one that single precision cannot hold, or with a broken triangle."""
    table = (mesh.loaded.points, mesh.loaded.faces.ravel()) if isinstance(mesh, LoadedMesh) else _listed(mesh)
    return None if table is None or not len(table[0]) else _in_single(*table)


def _in_single(rows: NDArray[Any], corners: NDArray[Any]) -> Triangles | None:
    """Rows of numbers and the row of each corner; None where single precision cannot hold a number, or a row is not there."""
    with np.errstate(over="ignore"):
        numbers = rows.astype(np.float32)
    if not np.isfinite(numbers).all() or (corners.size and (corners.min() < 0 or corners.max() >= len(numbers))):
        return None
    return numbers, corners.astype(np.int32)


def _listed(mesh: Mesh) -> Triangles | None:
    if len(mesh.vertices) % 3 or len(mesh.faces) % 3:
        return None
    points = np.fromiter(mesh.vertices, np.float64, len(mesh.vertices)).reshape(-1, 3)
    return points, np.fromiter(mesh.faces, np.int64, len(mesh.faces))
