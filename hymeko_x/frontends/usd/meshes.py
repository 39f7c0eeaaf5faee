"""Mesh prims: triangles in metres, texture coordinates (the primvar ``st``), normals, and subsets with a material of their own."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

from hymeko_x import codes
from hymeko_x.formats import usd as words
from hymeko_x.frontends.usd.materials import bound_material, bound_to
from hymeko_x.frontends.usd.prims import BINDING
from hymeko_x.ir.mechanism import Id, subset_edge
from hymeko_x.ir.parts import Mesh

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hymeko_x.frontends.usd.builder import UsdBuilder
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.ir.values import Vec3

    CornerTable = tuple[NDArray[Any], NDArray[Any]] | tuple[None, None]
    """Texture coordinates in an image (n x 2) or normals (n x 3), and their row at each corner of the triangles."""

_OF_NORMALS = frozenset(("typeName", "variability", "custom", "default", "interpolation"))


# ---- meshes --------------------------------------------------------------------------------------------------------------------


def read_mesh(prim: Prim, builder: UsdBuilder, scale: Vec3) -> Id | None:
    """The id of the mesh of a mesh prim; None where the prim is damaged. Equal meshes at equal scale share one; polygons become fans."""
    import numpy as np

    from hymeko_x.meshes.submesh import fans

    arrays = [prim.value(name) for name in ("points", "faceVertexCounts", "faceVertexIndices")]
    points, sizes, corners = (np.asarray([] if array is None else array) for array in arrays)
    vertices = points.astype(np.float64).reshape(-1, 3)
    sizes, corners = sizes.astype(np.int64), corners.astype(np.int64)
    damage = "has no points or no faces" if any(array is None for array in arrays) else _damage(vertices, sizes, corners)
    if damage:
        builder.error(prim, codes.ASSET_UNREADABLE, f"mesh '{prim.path}' {damage}; it is kept as written")
        return None
    faces = fans(sizes, corners)
    if not prim.is_animated("points"):
        builder.mark_read(prim, "points")
    _take_mesh_extent(prim, vertices, builder)
    if prim.value("subdivisionScheme") == "none":  # as the writer sets for every mesh
        builder.mark_read(prim, "subdivisionScheme")
    if (sizes == 3).all():
        builder.mark_read(prim, "faceVertexCounts", "faceVertexIndices")
    tables = (*read_places(prim, sizes, corners), *_read_normals(prim, sizes, corners))
    return _shared_mesh(prim, vertices, faces, tables, scale, builder)


def _damage(vertices: NDArray[Any], sizes: NDArray[Any], corners: NDArray[Any]) -> str:
    """Why polygons cannot be read; empty where they can."""
    import numpy as np

    if sizes.size and (sizes.min() < 0 or sizes.sum() != corners.size):
        return "has another number of corners than its counts add up to"
    if corners.size and (corners.min() < 0 or corners.max() >= len(vertices)):
        return "has a face with a point that does not exist"
    return "" if np.isfinite(vertices).all() else "has points that are not finite"


def _take_mesh_extent(prim: Prim, vertices: NDArray[Any], builder: UsdBuilder) -> None:
    import numpy as np

    authored = prim.value("extent")
    if authored is not None and len(authored) == 2 and len(vertices):
        box = np.stack([vertices.min(axis=0), vertices.max(axis=0)])
        if np.allclose(np.asarray(authored, dtype=np.float64), box, rtol=1e-6, atol=1e-6 * float(np.abs(box).max())):
            builder.mark_read(prim, "extent")


def read_normals(prim: Prim, builder: UsdBuilder) -> bool:
    """Whether the normals of a mesh are those of its triangles, and need not be kept."""
    normals, counts = prim.value("normals"), prim.value("faceVertexCounts")
    if normals is None or len(normals) != len(counts) or "faceVertexCounts" not in builder.read_names.get(prim.path, ()):
        return False
    import numpy as np

    from hymeko_x.meshes.measures import face_normals

    spec = prim.spec.attributes["normals"]
    is_plain = set(spec.ListInfoKeys()) <= _OF_NORMALS and spec.GetInfo("interpolation") == "uniform" and not prim.is_animated("normals")
    points, corners = (np.asarray(prim.value(name)) for name in ("points", "faceVertexIndices"))
    if not is_plain or not np.array_equal(np.asarray(normals), face_normals(points, corners)):
        return False
    builder.mark_read(prim, "normals")
    return True


def _shared_mesh(
    prim: Prim, vertices: NDArray[Any], faces: NDArray[Any], tables: tuple[NDArray[Any] | None, ...], scale: Vec3, builder: UsdBuilder
) -> Id:
    """``tables`` are the texture coordinates with their rows, and the normals with theirs, or None."""
    about = tuple(f"{factor:.12g}" for factor in scale)  # computed from the prim's ancestors: its last bits are rounding errors
    arrays = [b"" if table is None else table.tobytes() for table in (vertices, faces, *tables)]
    content = hashlib.sha256(b"|".join([*arrays, repr(about).encode()])).hexdigest()
    known = builder.meshes.get(content)
    if known is not None:
        return known
    key = builder.new_id(prim, "mesh", prim.name)
    builder.meshes[content] = key
    places, place_rows, normals, normal_rows = tables
    lists = (*_listed(vertices, faces), *_listed(places, place_rows), *_listed(normals, normal_rows))
    builder.vertices[key] = Mesh(None, scale, None, *lists)
    return key


def _listed(table: NDArray[Any] | None, rows: NDArray[Any] | None) -> tuple[tuple[float, ...], tuple[int, ...]]:
    from hymeko_x.meshes.submesh import indices

    return ((), ()) if table is None or rows is None else (tuple(table.ravel().tolist()), indices(rows))


# ---- texture coordinates and normals ---------------------------------------------------------------------------------------------

ST = "primvars:st"
NORMALS = "primvars:normals"
_TYPES = {ST: ("texCoord2f[]", "float2[]"), NORMALS: ("normal3f[]", "float3[]", "vector3f[]")}
_BY_CORNER = ("faceVarying", "vertex", "varying")
_OF_PLACES = frozenset(("typeName", "variability", "custom", "default", "interpolation"))


def read_places(prim: Prim, sizes: NDArray[Any], corners: NDArray[Any]) -> CornerTable:
    """The places of a mesh in an image, and for each corner of its triangles the row of its place; nothing where it has none."""
    return _read_table(prim, ST, _TYPES[ST], sizes, corners)


def _read_normals(prim: Prim, sizes: NDArray[Any], corners: NDArray[Any]) -> CornerTable:
    """The normals of the corners, likewise. The primvar counts where there is one too."""
    name = NORMALS if prim.value(NORMALS) is not None else "normals"
    return _read_table(prim, name, _TYPES[NORMALS], sizes, corners)


def _read_table(prim: Prim, name: str, types: tuple[str, ...], sizes: NDArray[Any], corners: NDArray[Any]) -> CornerTable:
    authored = prim.value(name)
    if authored is None or prim.types[name] not in types or prim.is_animated(name):
        return None, None
    import numpy as np

    from hymeko_x.meshes.submesh import fans

    table, rows = np.asarray(authored, dtype=np.float64), prim.value(f"{name}:indices")
    spread = prim.spec.attributes[name].GetInfo("interpolation")
    index = np.arange(len(corners)) if spread == "faceVarying" else corners
    if rows is not None:
        rows = np.asarray(rows, dtype=np.int64)
    is_broken = spread not in _BY_CORNER or (rows is not None and index.size and index.max() >= len(rows))
    if is_broken or not len(table):
        return None, None
    index = index if rows is None else rows[index]
    if not np.isfinite(table).all() or (index.size and (index.min() < 0 or index.max() >= len(table))):
        return None, None
    return table, fans(sizes, index)


def is_table_as_written(prim: Prim, name: str, builder: UsdBuilder) -> bool:
    """Whether the texture coordinates or normals of a mesh are in the form that the writer uses, and need not be kept."""
    if prim.value(name) is None or prim.value(f"{name}:indices") is None or "faceVertexCounts" not in builder.read_names.get(prim.path, ()):
        return False
    specs = [prim.spec.attributes[each] for each in (name, f"{name}:indices")]
    is_plain = set(specs[0].ListInfoKeys()) <= _OF_PLACES and set(specs[1].ListInfoKeys()) <= _OF_PLACES
    if not is_plain or specs[0].GetInfo("interpolation") != "faceVarying" or prim.types[name] != _TYPES[name][0]:
        return False
    if len(prim.value(f"{name}:indices")) != len(prim.value("faceVertexIndices")) or any(map(prim.is_animated, (name, f"{name}:indices"))):
        return False
    builder.mark_read(prim, name, f"{name}:indices")
    return True


# ---- subsets -----------------------------------------------------------------------------------------------------------------------


def read_subsets(mesh: Prim, shape: Id, builder: UsdBuilder) -> None:
    """Add the subsets of a mesh with materials that were read. Other subsets, and broken ones, stay extras."""
    found = [prim for prim in mesh.children if _is_bound(prim, builder)]
    if not found:
        return
    import numpy as np

    sizes = np.asarray(mesh.value("faceVertexCounts"), dtype=np.int64)
    counts = np.maximum(sizes - 2, 0)
    starts, is_plain = np.cumsum(counts) - counts, bool((sizes == 3).all())
    free = np.ones(len(sizes), dtype=bool)
    for prim in found:
        faces = np.asarray(prim.value("indices"), dtype=np.int64)
        why = _broken(faces, free)
        if why is not None:
            builder.warn(prim, codes.ASSET_UNREADABLE, f"subset '{prim.path}' {why}; it is kept as written")
            continue
        free[faces] = False
        ordered = np.sort(faces)
        triangles = ordered if is_plain else _triangles(counts[ordered], starts[ordered])
        _add_subset(prim, triangles, shape, builder, is_ours=is_plain and np.array_equal(ordered, faces))
    if mesh.value(words.FAMILY) == words.NON_OVERLAPPING and not free.all():
        builder.mark_read(mesh, words.FAMILY)


def _is_bound(prim: Prim, builder: UsdBuilder) -> bool:
    """Whether a prim binds some faces to a material that was read."""
    if prim.kind != "GeomSubset" or not prim.is_real or prim.value("familyName") != words.MATERIAL_BIND:
        return False
    if not prim.value("indices"):
        return False
    if prim.value("elementType") not in (None, words.FACE) or any(map(prim.is_animated, ("indices", "elementType", "familyName"))):
        return False
    targets, bound = prim.targets(BINDING), bound_to(prim, builder.scene)
    return bound is not None and targets == [bound.path] and bound.path in builder.materials


def _broken(faces: NDArray[Any], free: NDArray[Any]) -> str | None:
    import numpy as np

    if faces.min() < 0 or faces.max() >= len(free):
        return "has a face that the mesh does not have"
    return None if free[faces].all() and len(np.unique(faces)) == len(faces) else "has a face that shows a material already"


def _triangles(counts: NDArray[Any], starts: NDArray[Any]) -> NDArray[Any]:
    """The triangles of polygons, given by how many each has and the number of its first one."""
    import numpy as np

    before = np.cumsum(counts) - counts
    return np.repeat(starts - before, counts) + np.arange(int(counts.sum()))


def _add_subset(prim: Prim, triangles: NDArray[Any], shape: Id, builder: UsdBuilder, *, is_ours: bool) -> None:
    """The edge of a subset. Where its faces are no triangles, or in an order of the author's own, they stay beside it as well."""
    material = bound_material(prim, builder) if len(triangles) else None
    if material is None:
        return
    builder.mark_read(prim, "@type", "familyName", "elementType", *(["indices"] if is_ours else []))
    builder.edges[builder.new_id(prim, "subset")] = subset_edge(tuple(triangles.tolist()), shape, material)
