"""Originals: files of the source that the way home needs and that are not among the output's own, kept in a folder beside the output.

A file that nothing in the output uses (the mesh of no geom, a skin), and one that is something else there (converted, moved, points of a
stage), is copied as it is. On the way home it lies under its own reference again, so that the source comes back to the last bit.
"""

from __future__ import annotations

import posixpath
import re
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import formats
from hymeko_x.assets.companions import WITH_COMPANIONS, beside, companions_of
from hymeko_x.assets.shelf import read_file, safe_name
from hymeko_x.residue.digests import digests_text, with_edited_files
from hymeko_x.residue.stand_ins import is_copy
from hymeko_x.source import OriginalFiles, PackageFiles, PlacedFiles, suffix_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.source import Files, Package

_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*:/*")


def kept_name(uri: str) -> str:
    """The relative path of an original below the folder of originals: its reference, where this leads nowhere else on any system.

    Other references are made harmless, with a digest that tells them apart.
    """
    parts = [part for part in posixpath.normpath(uri.replace("\\", "/")).split("/") if part]
    safe = [safe_name(part) for part in parts]
    if parts == safe and not uri.startswith("/"):
        return "/".join(parts)
    from hashlib import sha256

    harmless = [safe_name(part) for part in _SCHEME.sub("", uri).replace("\\", "/").split("/") if part not in ("", ".", "..")] or ["file"]
    return "/".join(["elsewhere", sha256(uri.encode("utf-8", "surrogatepass")).hexdigest()[:8], *harmless])


def files_named(mechanism: Mechanism) -> Iterator[tuple[Id, str]]:
    """The reference of every file that the mechanism names, with the element: meshes, images, and files that only extras name."""
    yield from ((key, part.uri) for key, part in mechanism.assets() if part.uri is not None)
    row = formats.of_source(mechanism)
    if row is not None and row.files_in_extras is not None:
        yield from formats.loaded(row.files_in_extras)(mechanism)


def originals_of(
    mechanism: Mechanism, printed: Mechanism, aligned: Mechanism, package: Package, files: Files, *, missing_only: bool
) -> tuple[dict[str, str], str]:
    """The files to keep, by their names in the folder of originals: those that the aligned image of the package does not have as they are.

    With them come the digests of what the image has for them. ``printed`` has their references as they will be looked for. With
    ``missing_only`` without those for which the image has something else, which stands in for them.
    """
    found: dict[str, str] = {}
    contents = PackageFiles(package, files)
    references = list(files_named(mechanism))
    names = list(files_named(printed))
    shown = set(_shown(mechanism, aligned)) if missing_only else ()
    keys: list[Id] = []
    for (key, uri), (_, there) in zip(references, names if len(names) == len(references) else references, strict=True):
        path = files.find(uri)
        if key in shown and uri == getattr(mechanism.graph.vertices.get(key), "uri", None):
            continue
        if path is None:
            continue
        copy = _copy_of(mechanism, aligned, key, there, path, contents)
        along = dict(companions_of(uri, path, files)) if suffix_of(path) in WITH_COMPANIONS else {}
        if copy is None or any(package.copies.get(beside(copy, name)) != source for name, source in along.items()):
            home = kept_name(there)
            found.setdefault(home, path)
            keys.append(key)
            for name, source in along.items():
                found.setdefault(beside(home, name), source)
    return {name: path for name, path in found.items() if not name.startswith("../")}, digests_text(
        keys, mechanism, aligned, contents
    ) if keys else ""


def _shown(mechanism: Mechanism, aligned: Mechanism) -> Iterator[Id]:
    """The meshes and images that the aligned image has too, or that one of its shapes shows."""
    yield from aligned.graph.vertices
    yield from (view.mesh for view in mechanism.every_shape() if view.mesh is not None and view.id in aligned.graph)


def _copy_of(mechanism: Mechanism, aligned: Mechanism, key: Id, uri: str, path: str, contents: PackageFiles) -> str | None:
    """Where the package has the file of a reference as it is and it is found again: under the same reference, or as the same element's."""
    package = contents.package
    if package.copies.get(posixpath.normpath(uri)) == path:
        return posixpath.normpath(uri)
    part, image = mechanism.graph.vertices.get(key), aligned.graph.vertices.get(key)
    other = getattr(image, "uri", None)
    if other is None or uri != getattr(part, "uri", None) or not is_copy(mechanism, key, part, image):
        return None
    name = posixpath.normpath(other)
    is_same = package.copies.get(name) == path or (name in package.files and _holds(contents.behind, path, package.files[name]))
    return name if is_same else None


def with_originals(mechanism: Mechanism, originals: Mapping[str, str], files: Files, report: Report) -> Mechanism:
    """The mechanism that finds its files among the originals kept for it, given by their names, unless those of its image were edited."""
    if not originals:
        return mechanism
    mechanism = with_edited_files(mechanism, originals, files, report)
    places = {uri: originals[name] for _, uri in files_named(mechanism) if (name := kept_name(uri)) in originals}
    return replace(mechanism, originals=places) if places else mechanism


def _holds(files: Files, path: str, data: bytes) -> bool:
    try:
        return files.read(path) == data
    except OSError:
        return False


def files_of(mechanism: Mechanism, files: Files) -> Files:
    """The files of a mechanism, among them those that another file carried or kept for it."""
    files = OriginalFiles(mechanism.originals, files) if mechanism.originals else files
    return PlacedFiles(mechanism.places, files) if mechanism.places else files


def fetcher(mechanism: Mechanism, files: Files) -> Callable[[str], bytes | None]:
    """Gives the contents of a mechanism's files by their references."""
    return fetch_from(files_of(mechanism, files))


def fetch_from(files: Files) -> Callable[[str], bytes | None]:
    """Gives the content of a file by its uri, or None."""
    return lambda uri: (read_file(files, uri) or ("", None))[1]
