"""Meshes for USD, which holds their points itself: files are read, and keep their uri beside their points."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.assets.part import FilledMesh
from hymeko_x.assets.refer import Keep, keep_references
from hymeko_x.assets.shelf import read_file, stem_of, suffix_of
from hymeko_x.ir.legalize_native import is_native
from hymeko_x.ir.mechanism import shape_edge
from hymeko_x.ir.parts import Material, Mesh, Role, Texture
from hymeko_x.ir.rename import names_in_use

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.assets.part import Part
    from hymeko_x.assets.shelf import Shelf
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Id, Mechanism, Names, RobotEdge, ShapeView
    from hymeko_x.ir.parts import Rgba, VertexPart
    from hymeko_x.source import Files


@dataclass(slots=True)
class _Packing:
    """One run: what it reads from, and what it adds to the mechanism. ``known`` are the files that were read, by uri."""

    mechanism: Mechanism
    names: Names
    vertices: dict[Id, VertexPart] = field(default_factory=dict)
    edges: dict[Id, RobotEdge] = field(default_factory=dict)
    known: dict[str, tuple[Part, ...]] = field(default_factory=dict)
    materials: dict[Rgba, Id] = field(default_factory=dict)


def pack_for_usd(mechanism: Mechanism, shelf: Shelf, files: Files, report: Report) -> Mechanism:
    """The mechanism with the points of every mesh that can be read, in the axes and at the unit scale of its file.

    What a file shows in several colours becomes a mesh for each of them; MuJoCo ignores the colours of files, and so do we in
    what came from there.
    """
    run = _Packing(mechanism, names_in_use(mechanism))
    users, are_coloured = _users(mechanism), not is_native(mechanism)
    for key, mesh in mechanism.vertices(Mesh):
        if mesh.uri is None or mesh.vertices:
            continue
        parts = run.known.get(mesh.uri) or _read(mechanism, key, mesh, files, report)
        if parts is not None:
            run.known[mesh.uri] = parts
            _pack(run, key, mesh, parts if are_coloured else (_merged(parts),), users.get(key, []))
    packed = _with_textures(mechanism, shelf, files, report)
    return packed.with_graph(packed.graph.replace(vertices=run.vertices, edges=run.edges)) if run.vertices else packed


def _users(mechanism: Mechanism) -> dict[Id, list[ShapeView]]:
    """The shapes of each mesh."""
    found: dict[Id, list[ShapeView]] = {}
    for views in mechanism.shapes.values():
        for view in views:
            if view.mesh is not None:
                found.setdefault(view.mesh, []).append(view)
    return found


def _pack(run: _Packing, key: Id, mesh: Mesh, parts: tuple[Part, ...], views: list[ShapeView]) -> None:
    """The mesh as a whole, and for the eye one for each colour; colours of the file count where it has some, as in RViz."""
    seen = [view for view in views if view.shape.role is Role.VISUAL]
    if len(parts) == 1 or len(seen) < len(views) or not views:
        run.vertices[key] = FilledMesh(mesh.uri, mesh.scale, mesh.name, part=_merged(parts))
    if not seen or not any(part.look for part in parts):
        return
    pieces = [(key if len(parts) == 1 else _own_mesh(run, mesh, part), _material(run, part)) for part in parts]
    for view in seen:
        for number, (piece, material) in enumerate(pieces):
            shape = view.shape if material is None else replace(view.shape, rgba=None)
            shape = shape if number == 0 else replace(shape, name=None)
            place = view.id if number == 0 else run.names.take("shape", view.id.name)
            run.edges[place] = shape_edge(shape, view.body, view.pose, piece, material or view.material)


def _merged(parts: tuple[Part, ...]) -> Part:
    from hymeko_x.assets.mesh import put_together

    if len(parts) > 1:
        return put_together([(part.points, part.faces) for part in parts])
    return replace(parts[0], look=None) if parts[0].look else parts[0]


def _own_mesh(run: _Packing, mesh: Mesh, part: Part) -> Id:
    """What a file shows in one colour, as a mesh of its own."""
    key = run.names.take("mesh", f"{stem_of(mesh.uri or '')}_{part.look.name if part.look else 'plain'}")
    run.vertices[key] = FilledMesh(None, mesh.scale, part=part)
    return key


def _material(run: _Packing, part: Part) -> Id | None:
    """The material of a part; equal colours share one."""
    if part.look is None or part.look.rgba is None:
        return None
    known = run.materials.get(part.look.rgba)
    if known is None:
        known = run.materials[part.look.rgba] = run.names.take("material", part.look.name or "material")
        run.vertices[known] = Material(known.name, part.look.rgba)
    return known


def _read(mechanism: Mechanism, key: Id, mesh: Mesh, files: Files, report: Report) -> tuple[Part, ...] | None:
    from hymeko_x.assets.colours import read_colours
    from hymeko_x.assets.part import Unreadable

    found = read_file(files, mesh.uri or "")
    if found is None:
        said = f"{key}: '{mesh.uri}' was not found; its shapes are places without geometry"
        report.warn(codes.ASSET_NOT_FOUND, said, mechanism.origin(key), element=str(key))
        return None
    path, data = found
    try:
        return read_colours(data, suffix_of(path), _fetcher(files, mesh.uri or ""))
    except Unreadable as error:
        report.warn(codes.ASSET_UNREADABLE, f"{key}: '{mesh.uri}' cannot be read: {error}", mechanism.origin(key), element=str(key))
        return None


def _fetcher(files: Files, uri: str) -> Callable[[str], bytes]:
    folder = uri.replace("\\", "/").rpartition("/")[0]

    def fetch(name: str) -> bytes:
        found = read_file(files, f"{folder}/{name}" if folder else name)
        if found is None:
            raise FileNotFoundError(name)
        return found[1]

    return fetch


def _with_textures(mechanism: Mechanism, shelf: Shelf, files: Files, report: Report) -> Mechanism:
    """Textures beside the stage, by relative paths; meshes keep theirs, which are only remembered."""
    textures = {key: part for key, part in mechanism.graph.vertices.items() if isinstance(part, Texture)}
    if not textures:
        return mechanism
    meshes = [key for key, _ in mechanism.vertices(Mesh)]
    bare = mechanism.with_graph(mechanism.graph.replace(without=meshes))
    moved = keep_references(bare, shelf, files, report, Keep.NOTHING)
    new = {key: moved.graph.vertices[key] for key in textures}
    return mechanism.with_graph(mechanism.graph.replace(vertices=new))
