"""Meshes that hold their points, against the files that were written of them: which of them are the same."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from hymeko_x.ir.parts import Mesh
from hymeko_x.ir.provenance import StoredMesh
from hymeko_x.source import suffix_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.ir.mechanism import Id, Mechanism

    Fetch = Callable[[str], bytes | None]
    """The content of a file by its uri; None where there is none."""


def meshes_as_files(mechanism: Mechanism, image: Mechanism, fetch: Fetch) -> Mechanism:
    """The mechanism with the image's reference in the place of points of its own that the image's file has, to the last one.

    Same are points, texture coordinates and normals in single precision, and triangles, in their order.
    """
    changed: dict[Id, Mesh] = {}
    for key, mesh in mechanism.vertices(Mesh):
        other = image.graph.vertices.get(key)
        if mesh.vertices and isinstance(other, Mesh) and other.uri is not None and not other.vertices and _is_in(mesh, other.uri, fetch):
            changed[key] = replace(mesh.without_points(), uri=other.uri)
    return mechanism.replace(vertices=changed)


def without_points(mechanism: Mechanism, others: Mechanism) -> Mechanism:
    """The mechanism without the points of meshes that have become files in the other one: on the way home they are read from there."""
    bare = {
        key: mesh.without_points()
        for key, mesh in mechanism.vertices(Mesh)
        if mesh.uri is None and mesh.vertices and others.vertex(key, Mesh).uri is not None
    }
    return mechanism.replace(vertices=bare)


def with_points_of_files(mechanism: Mechanism, fetch: Fetch) -> Mechanism:
    """The restored mechanism with the points of meshes that hold them themselves, from the files that stood for them."""
    waiting = {
        key: (mesh, stored.mesh.uri)
        for key, stored in mechanism.stored.items()
        if isinstance(stored, StoredMesh) and stored.mesh.uri is not None
        for mesh in [mechanism.graph.vertices.get(key)]
        if isinstance(mesh, Mesh) and mesh.uri is None and not mesh.vertices
    }
    if not waiting:
        return mechanism
    from hymeko_x.meshes.submesh import Unreadable, listed
    from hymeko_x.meshes.tables import read_mesh

    changed: dict[Id, Mesh] = {}
    for key, (mesh, uri) in waiting.items():
        changed[key] = replace(mesh, uri=uri)
        with suppress(Unreadable):
            part = read_mesh(fetch(uri) or b"", suffix_of(uri))
            if part is not None:
                changed[key] = replace(listed(part), scale=mesh.scale, name=mesh.name)
    others = {key: found for key, found in mechanism.stored.items() if key not in changed}
    return replace(mechanism.replace(vertices=changed), stored=others)


def _is_in(mesh: Mesh, uri: str, fetch: Fetch) -> bool:
    """Whether a file has the points and triangles of a mesh."""
    from hymeko_x.meshes.submesh import Unreadable
    from hymeko_x.meshes.tables import read_mesh

    data = fetch(uri)
    if data is None:
        return False
    try:
        part = read_mesh(data, suffix_of(uri))
    except Unreadable:
        return False
    if part is None:
        return False
    return (
        _are_equal(mesh.vertices, part.points)
        and _are_equal(mesh.faces, part.faces)
        and _has_table(mesh.texcoords, mesh.texfaces or mesh.faces, part.uv, part.corners, part.faces)
        and _has_table(mesh.normals, mesh.normalfaces or mesh.faces, part.normals, part.normal_corners, part.faces)
    )


def _has_table(numbers: tuple[float, ...], rows: tuple[int, ...], table: Any, corners: Any, faces: Any) -> bool:
    """Whether a file has the texture coordinates or the normals of a mesh, if the mesh has some."""
    if not numbers:
        return True
    return table is not None and _are_equal(numbers, table) and _are_equal(rows, faces if corners is None else corners)


def _are_equal(numbers: tuple[float, ...], table: Any) -> bool:
    """Whether a flat list is a table, in single precision."""
    import numpy as np

    if len(numbers) != table.size:
        return False
    kind = np.int64 if table.dtype.kind == "i" else np.float32
    with np.errstate(over="ignore"):
        return bool(np.array_equal(np.asarray(numbers).astype(kind), table.ravel().astype(kind)))
