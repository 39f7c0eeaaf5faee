"""Digests of what an output has in the places of originals: what has another one on the way home was edited, and the edit counts.

They are a text in the folder of originals: one line for a file of the output by its path, or for points that the output itself holds by the
name of the mesh.
"""

from __future__ import annotations

import posixpath
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.assets.pack import standing
from hymeko_x.assets.shelf import read_file
from hymeko_x.ir.parts import Mesh, Texture
from hymeko_x.ir.provenance import StoredMesh
from hymeko_x.source import DIGESTS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Id, Mechanism, ShapeView
    from hymeko_x.source import Files, PackageFiles

_ABOUT = """# SHA-256 of what the output has in the places of the files in this folder: of files by their paths, of points that it holds
# itself by the names of their meshes. What has another digest on the way home was edited: it counts, and the file here does not.
"""
_PART = "part of a file: "


def digests_text(keys: Iterable[Id], mechanism: Mechanism, aligned: Mechanism, contents: PackageFiles) -> str:
    """The digests of what the aligned image of a package has for these elements and for parts of them; empty where that is nothing."""
    new = {key for key, _ in aligned.assets() if key not in mechanism.graph.vertices}
    users = aligned.shapes_by_mesh()
    shared = {_place(view) for key in new for view in users.get(key, ())}
    found: dict[str, str] = {}
    for key in (*keys, *new):
        is_part = key in new or any(_place(view) in shared for view in users.get(key, ()))
        found |= {_PART * is_part + name: digest for name, digest in _line(key, aligned.graph.vertices.get(key), contents)}
    return _ABOUT + "".join(f"{digest}  {name}\n" for name, digest in sorted(found.items())) if found else ""


def _place(view: ShapeView) -> tuple[object, ...]:
    """Where a shape is: the shapes of the parts of one file share it."""
    return view.body, view.pose, view.shape.role


def _line(key: Id, part: object, contents: PackageFiles) -> Iterator[tuple[str, str]]:
    """The name and the digest of what an element of the image has; nothing where it is outside of the package."""
    if isinstance(part, Mesh) and part.vertices:
        yield str(key), _digest_of_points(part)
    elif isinstance(part, Mesh | Texture) and part.uri is not None:
        name = contents.find(part.uri)
        if name is not None and (name in contents.package.files or name in contents.package.copies):
            yield posixpath.normpath(part.uri), _sha256(contents.read(name))


def _digest_of_points(mesh: Mesh) -> str:
    """The digest of points, triangles, texture coordinates, and normals if there are some, in single precision."""
    import numpy as np

    tables = (mesh.vertices, mesh.faces, mesh.texcoords, mesh.texfaces, *((mesh.normals, mesh.normalfaces) if mesh.normals else ()))
    numbers = (np.asarray(rows, np.float32).tobytes() for rows in tables)
    return _sha256(b"|".join(numbers))


def _sha256(data: bytes) -> str:
    from hashlib import sha256

    return sha256(data).hexdigest()


def with_edited_files(mechanism: Mechanism, originals: Mapping[str, str], files: Files, report: Report) -> Mechanism:
    """The restored mechanism, in which edited files and points of its image count and not the originals that are kept for them."""
    digests = _read(originals, files)
    edited = {key: name for key, part in mechanism.assets() for name in _edited(key, part, mechanism, digests, files)} if digests else {}
    _report_parts(digests, files, report)
    if not edited:
        return mechanism
    for key, name in edited.items():
        kept = getattr(mechanism.graph.vertices[key], "uri", None)
        of = "its points were" if name == str(key) else f"'{name}' was"
        message = f"{key}: {of} edited since the file was written; the edit counts, and the original '{kept}' does not"
        report.warn(codes.RESIDUE_SUPERSEDED, message, mechanism.origin(key), element=str(key))
    return standing(_with_copies_stored(mechanism, edited), edited)


def _report_parts(digests: Mapping[str, str], files: Files, report: Report) -> None:
    """Warn of edited files that are parts of an original, in which no part can be edited alone."""
    for name, digest in digests.items():
        found = read_file(files, name.removeprefix(_PART)) if name.startswith(_PART) else None
        if found is not None and _sha256(found[1]) != digest:
            words = "was edited since the file was written; it is a part of an original, which is kept whole and has no such edit"
            report.warn(codes.RESIDUE_SUPERSEDED, f"'{name.removeprefix(_PART)}' {words}")


def _with_copies_stored(mechanism: Mechanism, edited: Iterable[Id]) -> Mechanism:
    """The mechanism in which copies among the edited files are no longer the files of their references."""
    stored = dict(mechanism.stored)
    for key in edited:
        part = mechanism.graph.vertices[key]
        if key not in stored and isinstance(part, Mesh | Texture):
            copy = replace(part, uri=mechanism.places[part.uri or ""])
            stored[key] = StoredMesh(copy) if isinstance(copy, Mesh) else copy
    return replace(mechanism, stored=stored)


def _uri(stored: StoredMesh | Texture) -> str:
    """The file of what the image has; empty where it has points."""
    return (stored.uri if isinstance(stored, Texture) else stored.mesh.uri) or ""


def _read(originals: Mapping[str, str], files: Files) -> dict[str, str]:
    """The digests by name that are kept; none where they cannot be read."""
    try:
        text = files.read(originals[DIGESTS]).decode("utf-8", "replace") if DIGESTS in originals else ""
    except OSError:
        return {}
    rows = (line.partition("  ") for line in text.splitlines() if not line.startswith("#"))
    return {name: digest for digest, _, name in rows}


def _edited(key: Id, part: object, mechanism: Mechanism, digests: Mapping[str, str], files: Files) -> Iterator[str]:
    """The name under which what the image has for an element has another digest."""
    stored = mechanism.stored.get(key)
    if isinstance(stored, StoredMesh) and stored.mesh.vertices:
        if digests.get(str(key), now := _digest_of_points(stored.mesh)) != now:
            yield str(key)
        return
    uri = mechanism.places.get(getattr(part, "uri", "")) if stored is None else _uri(stored)
    name = posixpath.normpath(uri or "")
    found = read_file(files, uri) if uri and name in digests else None
    if found is not None and _sha256(found[1]) != digests[name]:
        yield name
