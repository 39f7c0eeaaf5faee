"""Meshes and textures as MuJoCo takes them: binary STL, OBJ or MSH, one mesh per appearance, with a volume; PNG images."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.assets.companions import companion_reader
from hymeko_x.assets.shelf import Shelf, read_file
from hymeko_x.backends.mjcf.appearances import material_of, meaning_of
from hymeko_x.backends.mjcf.mesh_names import name_meshes
from hymeko_x.backends.mjcf.packing import Packing, warn
from hymeko_x.backends.mjcf.textures import pack_textures
from hymeko_x.formats.mjcf import MOST_STL_FACES, NAME
from hymeko_x.formats.mjcf.files import refused
from hymeko_x.formats.mjcf.words import from_mjcf
from hymeko_x.ir.mechanism import Extra, Id, shape_edge
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.parts import Mesh, Role
from hymeko_x.memory import remembered
from hymeko_x.source import file_stem, suffix_of

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Code, Report
    from hymeko_x.ir.mechanism import Mechanism, ShapeView
    from hymeko_x.meshes.submesh import Submesh
    from hymeko_x.source import Files

_MESHES = "meshes"
_LEAST_VOLUME = 1e-13
"""m^3; MuJoCo refuses solid meshes below 1e-15, which it computes in single precision."""
_FLAT = 1e-7
"""A mesh is flat when its least extent is this part of its largest one; a hull needs a volume."""
_THICKNESS = 1e-4
"""The part of its largest extent that a flat collision mesh gets as its thickness."""
_FEWEST_POINTS = 4
_GROUP = re.compile(rb"^[og][ \t].*$", re.MULTILINE)
_FACE = re.compile(rb"^f[ \t]", re.MULTILINE)
_SHELL = Extra(NAME, "@inertia", "shell")


_File = tuple[str, bytes]
"""A file as it was found: its path and its content."""


class _Piece(Struct, frozen=True):
    """What one mesh vertex becomes: a mesh of a single appearance, and the material of that, if the file has it."""

    mesh: Id
    material: Id | None


def pack_for_mujoco(mechanism: Mechanism, shelf: Shelf, files: Files, report: Report) -> Mechanism:
    """The mechanism with meshes and textures that MuJoCo reads; shapes whose mesh cannot be read are left out."""
    if from_mjcf(mechanism):
        from hymeko_x.backends.mjcf.references import pack_native

        return pack_native(mechanism, shelf, files, report)
    if not any(mechanism.assets()):
        return mechanism
    run = Packing(names=names_in_use(mechanism), mechanism=mechanism, shelf=shelf, files=files, report=report)
    pack_textures(run)
    _pack_meshes(run)
    extras = {**mechanism.extras, **{key: (*mechanism.extras.get(key, ()), extra) for key, extra in run.attributes.items()}}
    return name_meshes(replace(run.added_to(mechanism, run.gone), extras=extras), mechanism)


# ---- meshes --------------------------------------------------------------------------------------------------------------------


def _pack_meshes(run: Packing) -> None:
    """Every mesh once to be shown and once for contact, as far as the two differ."""
    users = run.mechanism.shapes_by_mesh()
    for key, mesh in run.mechanism.vertices(Mesh):
        if mesh.uri is not None:
            _pack_mesh(run, key, mesh, users.get(key, []))
        elif mesh.vertices:
            _pack_inline(run, key, mesh, users.get(key, []))
        else:
            _leave_out(run, key, users.get(key, []), codes.ASSET_NOT_FOUND, "it names no file")
    _share_pieces(run)


def _share_pieces(run: Packing) -> None:
    """A piece of a file that is the same as another mesh is not declared beside it."""
    known: dict[object, Id] = {}
    same: dict[Id, Id] = {}
    meshes = [(key, part) for key, part in run.vertices.items() if isinstance(part, Mesh) and part.uri is not None]
    for key, part in sorted(meshes, key=lambda item: item[0] not in run.mechanism.graph.vertices):
        first = known.setdefault((replace(part, name=None), run.attributes.get(key)), key)
        if first != key and key not in run.mechanism.graph.vertices:
            same[key] = first
    for key in same:
        del run.vertices[key]
        run.attributes.pop(key, None)
    for key, edge in run.edges.items() if same else ():
        arcs = tuple([replace(arc, target=same.get(arc.target, arc.target)) for arc in edge.arcs])
        run.edges[key] = replace(edge, arcs=arcs)


def _pack_inline(run: Packing, key: Id, mesh: Mesh, users: list[ShapeView]) -> None:
    """Data that the mechanism holds stays in the text if there is little of it; else, or if MuJoCo would refuse it, it becomes a file."""
    from hymeko_x.backends.mjcf.meshes import mesh_file, stays_inline
    from hymeko_x.meshes.reader import inline_part
    from hymeko_x.meshes.submesh import Unreadable

    solid = any(view.shape.role is not Role.VISUAL for view in users)
    try:
        part = inline_part(mesh)
        _check_surface(part)
        reason = _refusal(part, ".obj", b"", solid=solid)
        if reason is not None:
            _report_converted(run, key, reason)
            _write_mesh(run, key, mesh.without_points(), part, key.name, solid=solid)
        elif stays_inline(part) or (run.shelf.mode == "reference" and part.has_points_alone):  # then the main file stands alone
            _add_mesh(run, key, mesh, part)
        else:
            suffix, data = mesh_file(part)
            _add_mesh(run, key, replace(mesh.without_points(), uri=run.shelf.place(_MESHES, key.name, suffix, data)), part)
    except Unreadable as error:
        _leave_out(run, key, users, codes.ASSET_UNREADABLE, f"its data cannot be used: {error}")


def _pack_mesh(run: Packing, key: Id, mesh: Mesh, users: list[ShapeView]) -> None:
    from hymeko_x.meshes.reader import read_parts
    from hymeko_x.meshes.submesh import Unreadable

    found = read_file(run.files, mesh.uri or "")
    if found is None:
        _leave_out(run, key, users, codes.ASSET_NOT_FOUND, f"'{mesh.uri}' was not found")
        return
    if not all(mesh.scale):
        _leave_out(run, key, users, codes.ASSET_UNREADABLE, f"'{mesh.uri}' is scaled to nothing")
        return
    path, data = found
    if suffix_of(path) == ".msh":
        run.vertices[key] = replace(mesh, uri=run.shelf.copy(_MESHES, file_stem(path), ".msh", path, data))
        return
    seen = [view for view in users if view.shape.role is Role.VISUAL]
    felt = [view for view in users if view.shape.role is not Role.VISUAL]
    try:
        parts = read_parts(data, suffix_of(path), companion_reader(run.files, path, mesh.uri or ""))
        hull = _pack_hull(run, key, mesh, parts, found) if felt else None
        pieces = _pack_appearances(run, key, mesh, parts, found, hull) if seen or not users else []
    except Unreadable as error:
        _leave_out(run, key, users, codes.ASSET_UNREADABLE, f"'{mesh.uri}' cannot be read: {error}")
        return
    for view in felt:
        _use(run, view, hull, view.material)
    for view in seen:
        _show(run, view, pieces)
    if key not in run.vertices:
        run.gone.append(key)


def _use(run: Packing, view: ShapeView, mesh: Id | None, material: Id | None) -> None:
    if (mesh, material) != (view.mesh, view.material):
        run.edges[view.id] = shape_edge(view.shape, view.body, view.pose, mesh, material)


def _show(run: Packing, view: ShapeView, pieces: list[_Piece]) -> None:
    """A visual becomes one per appearance; those of the file count where it has some, as in RViz, else the shape's own."""
    for number, piece in enumerate(pieces):
        shape = view.shape if piece.material is None else replace(view.shape, rgba=None)
        shape = shape if number == 0 else replace(shape, name=None)
        edge = shape_edge(shape, view.body, view.pose, piece.mesh, piece.material or view.material)
        key = view.id if number == 0 else run.names.take("shape", view.id.name)
        if edge != run.mechanism.graph.edges.get(key):
            run.edges[key] = edge


# ---- one file --------------------------------------------------------------------------------------------------------------------


def _pack_appearances(run: Packing, key: Id, mesh: Mesh, parts: tuple[Submesh, ...], file: _File, hull: Id | None) -> list[_Piece]:
    """The meshes that show a file, one per appearance. The file itself where MuJoCo reads it and it has one appearance.

    Raises: Unreadable.
    """
    if len(parts) > 1:
        _report_converted(run, key, f"has {len(parts)} appearances; each one becomes a mesh of its own")
        return [_own_mesh(run, mesh, part) for part in _with_surface(run, key, parts)]
    part = parts[0]
    material = material_of(run, part.appearance, mesh)
    is_altered = _is_flat(part) or len(part.points) < _FEWEST_POINTS  # then the mesh for contact is not also the one to show
    if hull == key and not is_altered:
        return [_Piece(key, material)]
    target = key if hull is None else run.names.take("mesh", f"{key.name}_visual")
    _store(run, target, key, mesh, part, file, solid=False)
    return [_Piece(target, material)]


def _own_mesh(run: Packing, mesh: Mesh, part: Submesh) -> _Piece:
    """A part of a file as a mesh of its own."""
    meaning = "" if part.appearance is None else meaning_of(part.appearance)
    name = "_".join(filter(None, (file_stem(mesh.uri or ""), meaning)))
    key = run.names.take("mesh", name)
    _write_mesh(run, key, mesh, part, name, solid=False)
    return _Piece(key, material_of(run, part.appearance, mesh))


def _pack_hull(run: Packing, key: Id, mesh: Mesh, parts: tuple[Submesh, ...], file: _File) -> Id:
    """The mesh for contact: all of the file, with a volume.

    Raises: Unreadable.
    """
    from hymeko_x.meshes.reader import merged

    if len(parts) > 1:  # then it is not also the mesh to show
        parts = tuple(map(_without_appearance, parts))
    _store(run, key, key, mesh, merged(parts), file, solid=True)
    return key


@remembered
def _without_appearance(part: Submesh) -> Submesh:
    from hymeko_x.meshes.submesh import Submesh

    return Submesh(part.points, part.faces)


def _store(run: Packing, target: Id, key: Id, mesh: Mesh, part: Submesh, file: _File, *, solid: bool) -> None:
    """The file as it is where MuJoCo takes it, else converted; with a note of the reason."""
    _check_surface(part)
    path, data = file
    suffix = suffix_of(path)
    reason = _refusal(part, suffix, data, solid=solid)
    if reason is None:
        uri = run.shelf.copy(_MESHES, file_stem(mesh.uri or path), suffix, path, data)
        _add_mesh(run, target, replace(mesh, uri=uri), part)
        return
    _report_converted(run, key, reason)
    _write_mesh(run, target, mesh, part, file_stem(mesh.uri or path), solid=solid, stl=suffix == ".stl")


def _check_surface(part: Submesh) -> None:
    """Raises: Unreadable for a mesh that has no surface at all, which nothing can repair."""
    from hymeko_x.meshes.submesh import Unreadable

    if _is_line(part):
        raise Unreadable("all of its points lie on a line")


def _with_surface(run: Packing, key: Id, parts: tuple[Submesh, ...]) -> list[Submesh]:
    """The parts that there is something to see of.

    Raises: Unreadable when there are none.
    """
    from hymeko_x.meshes.submesh import Unreadable

    seen: list[Submesh] = []
    lines: list[str] = []
    for part in parts:
        if _is_line(part):
            lines.append(f"'{part.appearance.name if part.appearance else ''}'")
        else:
            seen.append(part)
    if not seen:
        raise Unreadable("all of its parts lie on lines")
    if lines:
        _report_converted(run, key, f"shows {', '.join(lines)} on a line, where nothing is seen; that is left out")
    return seen


def _refusal(part: Submesh, suffix: str, data: bytes, *, solid: bool) -> str | None:
    """Why MuJoCo would not take the file as it is, or None when it would."""
    if suffix not in (".stl", ".obj"):
        return f"is a {suffix[1:].upper()} file, which MuJoCo does not read"
    if solid and _is_flat(part):
        return f"is flat, and a hull needs a volume: it gets a thickness of {_THICKNESS:g} of its size"
    if len(part.points) < _FEWEST_POINTS:
        return f"has {len(part.points)} points, and MuJoCo needs {_FEWEST_POINTS}: one of them is written twice"
    if suffix == ".obj" and (objects := _objects_in(data)) > 1:
        return f"has {objects} objects, and MuJoCo keeps the first of them"
    return refused(suffix, data)


@remembered
def _objects_in(obj: bytes) -> int:
    """How many objects or groups of an OBJ file have faces."""
    return sum(_FACE.search(group) is not None for group in _GROUP.split(obj))


def _write_mesh(run: Packing, key: Id, mesh: Mesh, part: Submesh, stem: str, *, solid: bool, stl: bool = False) -> None:
    """A converted file: STL stays STL where that is enough, all else becomes OBJ, which may hold a point twice."""
    import numpy as np

    from hymeko_x.meshes.measures import thickened
    from hymeko_x.meshes.obj import obj_bytes
    from hymeko_x.meshes.stl import stl_bytes

    is_short = len(part.points) < _FEWEST_POINTS
    if is_short and not solid and len(part.faces):
        part = replace(part, points=np.resize(part.points, (_FEWEST_POINTS, 3)))
    elif is_short or (solid and _is_flat(part)):
        part = thickened(part, _THICKNESS)
    if stl and not is_short and len(part.faces) <= MOST_STL_FACES:
        uri = run.shelf.place(_MESHES, stem, ".stl", stl_bytes(part))
    else:
        uri = run.shelf.place(_MESHES, stem, ".obj", obj_bytes(part))
    _add_mesh(run, key, replace(mesh, uri=uri), part)


def _add_mesh(run: Packing, key: Id, mesh: Mesh, part: Submesh) -> None:
    run.vertices[key] = mesh
    if _is_sheet(part, mesh):
        run.attributes[key] = _SHELL


# ---- geometry --------------------------------------------------------------------------------------------------------------------


def _is_flat(part: Submesh) -> bool:
    from hymeko_x.meshes.measures import extents

    low, _, high = extents(part)
    return low <= _FLAT * high


def _is_line(part: Submesh) -> bool:
    from hymeko_x.meshes.measures import extents

    _, middle, high = extents(part)
    return middle <= _FLAT * high


def _is_sheet(part: Submesh, mesh: Mesh) -> bool:
    """Whether MuJoCo would find no volume, so that the mesh has to be declared a surface."""
    from hymeko_x.meshes.measures import volume_of_sheets

    x, y, z = mesh.scale
    return volume_of_sheets(part) * abs(x * y * z) < _LEAST_VOLUME


# ---- diagnostics -----------------------------------------------------------------------------------------------------------------------


def _report_converted(run: Packing, key: Id, message: str) -> None:
    run.report.note(codes.ASSET_CONVERTED, f"{key} {message}", run.mechanism.origin(key), element=str(key))


def _leave_out(run: Packing, key: Id, users: list[ShapeView], code: Code, message: str) -> None:
    """The mesh and every shape of it; the warning names them."""
    kinds = ", ".join(f"{view.shape.role.value} '{view.shape.name or view.id.name}' of {view.body}" for view in users)
    uri = run.mechanism.vertex(key, Mesh).uri
    warn(run, key, code, f"{message}; left out: {kinds or 'nothing that is shown'}", uri)
    run.gone += [key, *(view.id for view in users)]
