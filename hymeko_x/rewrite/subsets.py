"""Meshes that show several materials, for formats in which a shape shows one, or a file has its materials itself."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

from msgspec import Struct, field
from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.ir.mechanism import shape_edge
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.parts import Material, Mesh, MeshShape, Role, Shape

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge, ShapeView, SubsetView
    from hymeko_x.ir.names import Names
    from hymeko_x.rewrite.context import Context

    _Table = tuple[NDArray[Any], NDArray[Any]]
    """The corners of triangles (n x 3), and the table that they are rows of."""


def split_subsets(mechanism: Mechanism, context: Context) -> Mechanism:
    """What of a mesh shows a material of its own becomes a shape and a mesh for the eye; what collides stays whole."""
    if not mechanism.subsets:
        return mechanism
    split = _Splitting(mechanism, names_in_use(mechanism))
    views = {view.id: view for view in mechanism.every_shape()}
    users = Counter(view.mesh for view in views.values())
    gone = [subset.id for subsets in mechanism.subsets.values() for subset in subsets]
    for key, subsets in mechanism.subsets.items():
        view = views.get(key)
        pieces = [] if view is None or view.shape.role is Role.COLLISION else list(_pieces(mechanism, view, subsets))
        if view is None or view.mesh is None or not pieces:
            message = f"{key} shows other materials on triangles that are not there to be seen; they are left out"
            context.report.note(codes.NOT_REPRESENTED, message, mechanism.origin(key), element=str(key))
            continue
        split.show(view, view.mesh, pieces)
        users[view.mesh] -= view.shape.role is Role.VISUAL
        gone += [] if users[view.mesh] else [view.mesh]
        message = f"{key} shows {len(pieces)} materials; a visual of its own is written for each"
        context.report.note(codes.REWRITTEN, message, mechanism.origin(key), element=str(key))
    return mechanism.replace(vertices=split.meshes, edges=split.edges, without=gone)


_Piece = tuple["Id | None", tuple[int, ...]]
"""Some triangles of a mesh, and the material that they show; None for that of the shape."""


def _pieces(mechanism: Mechanism, view: ShapeView, subsets: tuple[SubsetView, ...]) -> Iterator[_Piece]:
    """The triangles of a mesh by material, first what shows that of the shape; nothing where the mesh does not hold them itself."""
    mesh = mechanism.part(view.mesh, Mesh)
    if mesh is None or not isinstance(view.shape.geometry, MeshShape):
        return
    count = len(mesh.faces) // 3 if mesh.uri is None and _are_rows(mesh.faces, mesh.vertices, 3) else 0
    rest = dict.fromkeys(range(count))
    known = [subset for subset in subsets if isinstance(mechanism.graph.vertices.get(subset.material), Material)]
    taken = [(subset.material, tuple([face for face in subset.faces if rest.pop(face, count) is None])) for subset in known]
    if any(faces for _, faces in taken):
        yield from ((material, faces) for material, faces in ((None, tuple(rest)), *taken) if faces)


def _are_rows(rows: tuple[int, ...], table: tuple[float, ...], width: int) -> bool:
    """Whether the corners of triangles are rows of a table."""
    is_whole = len(rows) % 3 == 0 and len(table) % width == 0
    return is_whole and bool(rows) and min(rows) >= 0 and max(rows) < len(table) // width


class _Splitting(Struct):
    """The shapes and meshes of the pieces; equal pieces of a mesh share one."""

    mechanism: Mechanism
    names: Names
    meshes: dict[Id, Mesh] = field(default_factory=dict)
    edges: dict[Id, RobotEdge] = field(default_factory=dict)
    known: dict[tuple[Id, tuple[int, ...]], Id] = field(default_factory=dict)
    tables: dict[Id, list[_Table | None]] = field(default_factory=dict)

    def show(self, view: ShapeView, mesh: Id, pieces: list[_Piece]) -> None:
        """A shape for each piece. The first one is the shape itself, unless that collides and stays whole."""
        if view.shape.role is Role.BOTH:
            whole = replace(view.shape, role=Role.COLLISION)
            self.edges[view.id] = shape_edge(whole, view.body, view.pose, mesh, view.material)
        for material, faces in pieces:
            is_first = view.id not in self.edges
            name, rgba = view.shape.name if is_first else None, view.shape.rgba if material is None else None
            key = view.id if is_first else self.names.take("shape", f"{view.body.name}/visual")
            part = self._part(mesh, material, faces)
            shape = Shape(view.shape.geometry, Role.VISUAL, name, rgba)
            self.edges[key] = shape_edge(shape, view.body, view.pose, part, material or view.material)

    def _part(self, mesh: Id, material: Id | None, faces: tuple[int, ...]) -> Id:
        if (mesh, faces) not in self.known:
            key = self.names.take("mesh", f"{mesh.name}_{material.name if material is not None else 'rest'}")
            self.known[mesh, faces] = key
            self.meshes[key] = self._cut(mesh, faces)
        return self.known[mesh, faces]

    def _cut(self, key: Id, faces: tuple[int, ...]) -> Mesh:
        """Some triangles of a mesh, with the points, texture coordinates and normals that they are of."""
        mesh = self.mechanism.vertex(key, Mesh)
        if key not in self.tables:
            self.tables[key] = _tables(mesh)
        points, places, normals = [((), ()) if table is None else _of(*table, faces) for table in self.tables[key]]
        return Mesh(None, mesh.scale, None, *points, *places, *normals)


def _tables(mesh: Mesh) -> list[_Table | None]:
    """The points of a mesh, and its texture coordinates and normals, each None where it has no sound ones."""
    import numpy as np

    found: list[_Table | None] = [(np.asarray(mesh.faces).reshape(-1, 3), np.asarray(mesh.vertices).reshape(-1, 3))]
    for rows, numbers, width in ((mesh.texfaces, mesh.texcoords, 2), (mesh.normalfaces, mesh.normals, 3)):
        at = rows or mesh.faces
        is_sound = len(at) == len(mesh.faces) and _are_rows(at, numbers, width)
        found.append((np.asarray(at).reshape(-1, 3), np.asarray(numbers).reshape(-1, width)) if is_sound else None)
    return found


def _of(rows: NDArray[Any], table: NDArray[Any], faces: tuple[int, ...]) -> tuple[tuple[float, ...], tuple[int, ...]]:
    """The part of a table that the corners of some triangles are of, and its rows at these corners."""
    import numpy as np

    used, index = np.unique(rows[list(faces)], return_inverse=True)
    return tuple(table[used].ravel().tolist()), tuple(index.ravel().tolist())


def part_meshes_by_looks(mechanism: Mechanism, _context: Context) -> Mechanism:
    """A mesh that two shapes show in different materials becomes a mesh for each, since the file of a mesh has its materials."""
    if not mechanism.subsets:
        return mechanism
    names = names_in_use(mechanism)
    pieces: dict[Id, dict[object, Id]] = {}
    meshes: dict[Id, Mesh] = {}
    edges: dict[Id, RobotEdge] = {}
    for view in mechanism.every_shape():
        mesh = mechanism.part(view.mesh, Mesh)
        if view.mesh is None or mesh is None or mesh.uri is not None or view.shape.role is not Role.VISUAL:
            continue
        own = tuple((subset.faces, subset.material) for subset in mechanism.subsets.get(view.id, ()))
        known = pieces.setdefault(view.mesh, {})
        if own not in known:
            known[own] = names.take("mesh", view.mesh.name) if known else view.mesh
        if known[own] != view.mesh:
            meshes[known[own]] = mesh
            edges[view.id] = shape_edge(view.shape, view.body, view.pose, known[own], view.material)
    return mechanism.replace(vertices=meshes, edges=edges) if edges else mechanism
