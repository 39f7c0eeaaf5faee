"""Companions: files that a mesh file refers to by paths from its own folder: libraries of materials, images, buffers."""

from __future__ import annotations

import json
import os
import posixpath
import re
from typing import TYPE_CHECKING
from urllib.parse import unquote

from hymeko_x.assets.shelf import read_file
from hymeko_x.source import suffix_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from hymeko_x.assets.shelf import Shelf
    from hymeko_x.source import Files

_LIBRARY = re.compile(rb"mtllib[ \t]+(.+?)[ \t]*\r?$", re.MULTILINE)  # a word to search for, since files may be large
_MAP = re.compile(rb"^[ \t]*(?:map_\w+|bump|disp|decal|refl|norm)[ \t]+(.+?)[ \t]*\r?$", re.MULTILINE | re.IGNORECASE)
_OPTION = re.compile(r"-\w+(?:[ \t]+(?:on|off|[-+.\d][-+.\deE]*|[rgbmlz]\b))*[ \t]+")
_IMAGE = re.compile(rb"<init_from>\s*(?:<ref>)?\s*([^<]+?)\s*<")
_GLB_HEADER = 20
_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+:")


WITH_COMPANIONS = (".obj", ".mtl", ".dae", ".gltf", ".glb")
"""The types of files that may refer to others."""


def copy_companions(uri: str, new: str, path: str, shelf: Shelf, files: Files) -> None:
    """Copy what the mesh file of a reference refers to beside its copy ``new``, under the same relative paths."""
    if shelf.mode == "reference" or path.endswith("]"):
        return
    for name, there in companions_of(uri, path, files):
        place = beside(new, name)
        if not place.startswith("../"):
            shelf.copy_as(place, there)


def folder_with_room(folder: str, uri: str, path: str, shelf: Shelf, files: Files) -> str:
    """The folder of an output, or one below it, in which all that a mesh file refers to finds its place."""
    companions = () if shelf.within else tuple(companions_of(uri, path, files))
    found, number = folder, 1
    while any(_is_occupied(beside(f"{found}/{posixpath.basename(path)}", name), there, shelf, files) for name, there in companions):
        number += 1
        found = f"{folder}/{number}"
    return found


def variant(uri: str, path: str, other: str | None, files: Files) -> str:
    """What tells a mesh file from one with the same bytes at another place: a digest of its companions where these differ, else nothing."""
    if other is None or other == path or suffix_of(path) not in WITH_COMPANIONS:
        return ""
    own, others = ({name: files.read(there) for name, there in companions_of(*at, files)} for at in ((uri, path), (other, other)))
    if own == others:
        return ""
    from hashlib import sha256  # 3 ms that most conversions need not wait for

    return sha256(b"\0".join(part for name in sorted(own) for part in (name.encode(), own[name]))).hexdigest()


def _is_occupied(place: str, source: str, shelf: Shelf, files: Files) -> bool:
    """Whether another file, with other content, is copied to this place."""
    other = shelf.copies.get(place, source)
    return other != source and files.read(other) != files.read(source)


def companions_of(uri: str, path: str, files: Files) -> Iterator[tuple[str, str]]:
    """The files that the mesh file of a reference, found at a path, refers to: by their paths from its folder, and where they are."""
    waiting = list(named_in(path, files))
    seen = set()
    while waiting:
        name = waiting.pop()
        there = files.find(posixpath.join(posixpath.dirname(uri), name)) or files.find(os.path.abspath(beside(path, name)))
        if there is None or name in seen:
            continue
        seen.add(name)
        yield name, there
        for further in named_in(there, files):  # some programs look beside the library, others beside the mesh
            waiting += [further, posixpath.join(posixpath.dirname(name), further)]


def beside(path: str, name: str) -> str:
    """The path of a file that is named from the folder of another one."""
    return posixpath.normpath(posixpath.join(posixpath.dirname(path), name))


def companion_reader(files: Files, *uris: str) -> Callable[[str], bytes]:
    """Gives the content of a companion by its name: of the first that is beside one of these references to the mesh file.

    Raises: FileNotFoundError, when it is called, for a companion that is beside none.
    """

    def fetch(name: str) -> bytes:
        for uri in uris:
            found = read_file(files, posixpath.join(posixpath.dirname(uri.replace("\\", "/")), name.replace("\\", "/")))
            if found is not None:
                return found[1]
        raise FileNotFoundError(name)

    return fetch


def named_in(path: str, files: Files) -> Iterator[str]:
    """The relative paths that a mesh file, or a library of materials, has for other files."""
    suffix = suffix_of(path)
    if suffix not in WITH_COMPANIONS:
        return
    try:
        data = files.read(path)
    except OSError:
        return
    for name in dict.fromkeys(_names(data, suffix)):
        plain = name.replace("\\", "/")
        if plain and not _SCHEME.match(plain) and not plain.startswith("/"):
            yield plain


def _names(data: bytes, suffix: str) -> Iterator[str]:
    if suffix == ".obj":
        yield from (_text(found) for found in _LIBRARY.findall(data))
    elif suffix == ".mtl":
        yield from (_OPTION.sub("", _text(found)) for found in _MAP.findall(data))
    elif suffix == ".dae":
        yield from (unquote(_text(found)).removeprefix("file://./") for found in _IMAGE.findall(data))
    else:
        yield from _of_scene(data[_GLB_HEADER:] if suffix == ".glb" else data)


def _of_scene(data: bytes) -> Iterator[str]:
    """The files of a glTF document, whose binary form has its text first."""
    try:
        found, _ = json.JSONDecoder().raw_decode(data.decode("utf-8", "replace").lstrip("\ufeff \t\r\n"))
    except (ValueError, RecursionError):
        return
    for kind in ("buffers", "images"):
        rows = found.get(kind) if isinstance(found, dict) else None
        for row in rows if isinstance(rows, list) else ():
            uri = row.get("uri") if isinstance(row, dict) else None
            if isinstance(uri, str) and not uri.startswith("data:"):
                yield unquote(uri)


def _text(name: bytes) -> str:
    return name.decode("utf-8", "replace")
