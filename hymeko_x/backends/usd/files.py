"""Meshes for USD, which holds their points itself: files are read, and keep their uri beside their points."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from msgspec import field
from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.assets.companions import companion_reader
from hymeko_x.assets.pack import Keep, keep_references
from hymeko_x.assets.shelf import read_file
from hymeko_x.formats import mesh_reader
from hymeko_x.ir.builder import Builder
from hymeko_x.ir.mechanism import shape_edge, subset_edge
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.parts import Layer, Material, Mesh, Role, Texture
from hymeko_x.meshes.submesh import LoadedMesh
from hymeko_x.source import file_stem, suffix_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from hymeko_x.assets.shelf import Shelf
    from hymeko_x.diagnostics import Code, Report
    from hymeko_x.formats import MeshReader
    from hymeko_x.ir.mechanism import Id, Mechanism, ShapeView
    from hymeko_x.ir.parts import Rgba
    from hymeko_x.meshes.submesh import Appearance, ColouredMesh, Submesh
    from hymeko_x.source import Files


_FEW_TURNED = 0.1
"""The share of triangles whose normals may point to the other side without a note: folds of thin parts often do."""


class _Use(NamedTuple):
    """What shapes need of a mesh: whether one is seen, and whether one shows an image that it does not have from the file."""

    is_shown: bool
    is_mapped: bool


class _Packing(Builder, kw_only=True):
    """One run: its input, and the elements that it adds to the mechanism. ``known`` are the files that were read, by uri and use."""

    mechanism: Mechanism
    shelf: Shelf
    files: Files
    report: Report
    known: dict[tuple[str, _Use], ColouredMesh] = field(default_factory=dict)
    materials: dict[tuple[Rgba | None, bytes | None], Id | None] = field(default_factory=dict)


def pack_for_usd(mechanism: Mechanism, shelf: Shelf, files: Files, report: Report) -> Mechanism:
    """The mechanism with the points of every mesh that can be read, in the axes and at the unit scale of its file.

    What a file shows in several colours or images becomes a subset for each of them. What came from a format whose engine reads mesh files
    in its own way, without colours, gets the points and triangles that this engine reads.
    """
    run = _Packing(names=names_in_use(mechanism), mechanism=mechanism, shelf=shelf, files=files, report=report)
    users, own_reader = mechanism.shapes_by_mesh(), mesh_reader(mechanism)
    textured = {arc.target for _, _, arcs in mechanism.edges(Layer) for arc in arcs if arc.sign < 0}
    for key, mesh in mechanism.vertices(Mesh):
        if mesh.uri is None or mesh.vertices:
            continue
        views = users.get(key, [])
        use = _Use(any(view.shape.role is not Role.COLLISION for view in views), any(view.material in textured for view in views))
        painted = run.known.get((mesh.uri, use)) or _read(run, key, mesh, own_reader, use)
        if painted is not None:
            run.known[mesh.uri, use] = painted
            _pack(run, key, mesh, painted, views, use)
    packed = _with_textures(mechanism, shelf, files, report)
    return run.added_to(packed) if run.vertices else packed


def _pack(run: _Packing, key: Id, mesh: Mesh, painted: ColouredMesh, views: list[ShapeView], use: _Use) -> None:
    """The mesh, and for the eye the colours of the file, which count where it has some, as in RViz."""
    from hymeko_x.meshes.submesh import Submesh

    part, appearances = painted
    seen = [view for view in views if view.shape.role is Role.VISUAL]
    run.vertices[key] = LoadedMesh(mesh.uri, mesh.scale, mesh.name, loaded=part if use.is_shown else Submesh(part.points, part.faces))
    if use.is_shown:
        _note_turned_normals(run, key, mesh, part)
    shown = [(appearance, _material(run, key, appearance), rows) for appearance, rows in appearances] if seen else []
    for view in seen:
        if len(shown) == 1 and len(shown[0][2]) == len(part.faces):
            _show_all(run, view, shown[0][1])
        elif view.id not in run.mechanism.subsets:
            _show_parts(run, view, shown)


def _note_turned_normals(run: _Packing, key: Id, mesh: Mesh, part: Submesh) -> None:
    """Report a file whose normals contradict more than a few of its triangles."""
    from hymeko_x.meshes.measures import turned_triangles

    turned = turned_triangles(part)
    if turned > _FEW_TURNED * len(part.faces):
        message = f"{key}: the normals in '{mesh.uri}' contradict {turned} of its {len(part.faces)} triangles; both are written as they are"
        run.report.note(codes.NORMALS_TURNED, message, run.mechanism.origin(key), element=str(key))


def _show_all(run: _Packing, view: ShapeView, material: Id | None) -> None:
    if material is not None:
        run.edges[view.id] = shape_edge(replace(view.shape, rgba=None), view.body, view.pose, view.mesh, material)


def _show_parts(run: _Packing, view: ShapeView, shown: list[tuple[Appearance, Id | None, NDArray[np.intp]]]) -> None:
    """Subsets of the shape; triangles without an appearance in the file have that of the shape."""
    for appearance, material, rows in shown:
        if material is not None and len(rows):
            run.edges[run.names.take("subset", appearance.name or material.name)] = subset_edge(tuple(rows.tolist()), view.id, material)


def _material(run: _Packing, mesh: Id, appearance: Appearance) -> Id | None:
    """The material of an appearance; equal colours and equal images share one."""
    if appearance.rgba is None and appearance.image is None:
        return None
    if (appearance.rgba, appearance.image) not in run.materials:
        run.materials[appearance.rgba, appearance.image] = _own_material(run, mesh, appearance)
    return run.materials[appearance.rgba, appearance.image]


def _own_material(run: _Packing, mesh: Id, appearance: Appearance) -> Id | None:
    """The material of an appearance, with its image beside the output; None where the image cannot be read."""
    uri = None if appearance.image is None else _placed_image(run, mesh, appearance, appearance.image)
    if appearance.image is not None and uri is None:
        return None
    return run.add_material(Material(appearance.name, appearance.rgba), None if uri is None else Texture(uri))


def _placed_image(run: _Packing, mesh: Id, appearance: Appearance, image: bytes) -> str | None:
    from hymeko_x.meshes.images import UnreadableImage, shown_image

    try:
        data, suffix = shown_image(image)
    except UnreadableImage as error:
        _warn(run, mesh, codes.ASSET_UNREADABLE, f"its image '{appearance.file or appearance.name}' cannot be read: {error}")
        return None
    return run.shelf.place("textures", file_stem(appearance.file) or appearance.name or mesh.name, suffix, data)


def _read(run: _Packing, key: Id, mesh: Mesh, own_reader: MeshReader | None, use: _Use) -> ColouredMesh | None:
    """The triangles of a file, with its own appearances where they are seen, unless an engine reads it in its own way."""
    from hymeko_x.meshes.reader import read_colours, read_mapped, read_whole
    from hymeko_x.meshes.submesh import ColouredMesh, Unreadable

    found = read_file(run.files, mesh.uri or "")
    if found is None:
        _warn(run, key, codes.ASSET_NOT_FOUND, f"'{mesh.uri}' was not found; its shapes are places without geometry")
        return None
    path, data = found
    fetch = companion_reader(run.files, mesh.uri or "")

    def miss(image: str) -> None:
        _warn(run, key, codes.ASSET_NOT_FOUND, f"its image '{image}' was not found; it is shown without")

    try:
        own = None if own_reader is None else own_reader(data, suffix_of(path))
        if own is not None:
            return ColouredMesh(own)
        if not use.is_shown:
            return ColouredMesh(read_whole(data, suffix_of(path), fetch))
        painted = read_colours(data, suffix_of(path), fetch, miss=miss)
        return ColouredMesh(read_mapped(data, suffix_of(path), fetch)) if use.is_mapped and not painted.appearances else painted
    except Unreadable as error:
        _warn(run, key, codes.ASSET_UNREADABLE, f"'{mesh.uri}' cannot be read: {error}")
        return None


def _warn(run: _Packing, key: Id, code: Code, words: str) -> None:
    run.report.warn(code, f"{key}: {words}", run.mechanism.origin(key), element=str(key))


def _with_textures(mechanism: Mechanism, shelf: Shelf, files: Files, report: Report) -> Mechanism:
    """Textures beside the stage, by relative paths; meshes keep theirs, which are only remembered."""
    textures = [key for key, _ in mechanism.vertices(Texture)]
    if not textures:
        return mechanism
    meshes = [key for key, _ in mechanism.vertices(Mesh)]
    bare = mechanism.replace(without=meshes)
    moved = keep_references(bare, shelf, files, report, Keep.NOTHING)
    new = {key: moved.graph.vertices[key] for key in textures}
    return mechanism.replace(vertices=new)
