"""Meshes for USD, which holds their points itself: files are read, and keep their uri beside their points."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.assets.refer import Keep, keep_references
from hymeko_x.assets.shelf import read_file, suffix_of
from hymeko_x.ir.parts import Mesh, Texture

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.assets.shelf import Shelf
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.source import Files


def pack_for_usd(mechanism: Mechanism, shelf: Shelf, files: Files, report: Report) -> Mechanism:
    """The mechanism with the points of every mesh that can be read, in the axes and at the unit scale of its file."""
    changed: dict[Id, Mesh] = {}
    known: dict[str, Mesh] = {}
    for key, mesh in mechanism.vertices(Mesh):
        if mesh.uri is None or mesh.vertices:
            continue
        read = known.get(mesh.uri) or _read(mechanism, key, mesh, files, report)
        if read is not None:
            known[mesh.uri] = read
            changed[key] = replace(mesh, vertices=read.vertices, faces=read.faces)
    packed = _with_textures(mechanism, shelf, files, report)
    return packed.with_graph(packed.graph.replace(vertices=changed)) if changed else packed


def _read(mechanism: Mechanism, key: Id, mesh: Mesh, files: Files, report: Report) -> Mesh | None:
    from hymeko_x.assets.mesh import Unreadable, read_whole

    found = read_file(files, mesh.uri or "")
    if found is None:
        said = f"{key}: '{mesh.uri}' was not found; its shapes are places without geometry"
        report.warn(codes.ASSET_NOT_FOUND, said, mechanism.origin(key), element=str(key))
        return None
    path, data = found
    try:
        part = read_whole(data, suffix_of(path), _fetcher(files, mesh.uri or ""))
    except Unreadable as error:
        report.warn(codes.ASSET_UNREADABLE, f"{key}: '{mesh.uri}' cannot be read: {error}", mechanism.origin(key), element=str(key))
        return None
    return replace(mesh, vertices=tuple(part.points.ravel().tolist()), faces=tuple(part.faces.ravel().tolist()))


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
