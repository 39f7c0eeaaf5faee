"""Formats that refer to files by uri and take any type of them: URDF, xacro, HyMeKo text."""

from __future__ import annotations

import posixpath
import re
from enum import Enum
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.assets.shelf import Shelf, read_file, suffix_of
from hymeko_x.ir.mechanism import file_stem
from hymeko_x.ir.parts import Mesh, Texture

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.diagnostics import Report
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.source import Files

_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+:")
_PACKAGE = re.compile(r"(package|model):", re.IGNORECASE)
_REMOTE = re.compile(r"(https?|ftp):", re.IGNORECASE)
_FOLDERS: Mapping[type, str] = MappingProxyType({Mesh: "meshes", Texture: "textures"})


class Keep(Enum):
    """Which references stay as their author wrote them."""

    NOTHING = "nothing"
    PACKAGES = "packages"
    """``package://`` and ``model://``, which mean the same from everywhere."""
    PACKAGES_AND_PATHS = "packages and paths"
    """Those, and relative paths below the source: their files are copied to the same place below the output."""

    @staticmethod
    def of(format: Format, mode: Literal["copy", "reference"]) -> Keep:
        """Which references stay in files of this format."""
        if mode == "reference":
            return Keep.PACKAGES
        return Keep.PACKAGES_AND_PATHS if format.keeps_package_uris else Keep.NOTHING


def keep_references(mechanism: Mechanism, shelf: Shelf, files: Files, report: Report, keep: Keep) -> Mechanism:
    """The mechanism with every uri kept or rewritten; a file that is not there keeps its uri, with a warning."""
    changed: dict[Id, Mesh | Texture] = {}
    for key, part in mechanism.assets():
        if part.uri is None:
            continue
        uri = new_uri(part.uri, _FOLDERS[type(part)], shelf, files, keep)
        if uri is None:
            report.warn(
                codes.ASSET_NOT_FOUND,
                f"{key}: '{part.uri}' was not found; the reference is kept",
                mechanism.origin(key),
                element=str(key),
                hint=_hint(part.uri),
            )
        elif uri != part.uri:
            changed[key] = replace(part, uri=uri)
    return mechanism.with_graph(mechanism.graph.replace(vertices=changed)) if changed else mechanism


def new_uri(uri: str, folder: str, shelf: Shelf, files: Files, keep: Keep) -> str | None:
    """The uri to write, or None when there is no such file. What is kept because it is a package's is not looked for."""
    if _REMOTE.match(uri) or (keep is not Keep.NOTHING and is_of_package(uri)):
        return uri
    path = files.find(uri)
    if path is None:
        return None
    if shelf.mode == "reference":
        return shelf.way_to(path, uri)
    plain = posixpath.normpath(uri)
    if keep is Keep.PACKAGES_AND_PATHS and _is_below(uri) and shelf.copy_as(plain, path):
        return uri
    found = read_file(files, uri)
    return None if found is None else shelf.copy(folder, file_stem(uri), suffix_of(path), *found)


def is_of_package(uri: str) -> bool:
    """Whether the uri names a package, and means the same from everywhere."""
    return _PACKAGE.match(uri) is not None


def _is_below(uri: str) -> bool:
    """Whether the uri is a relative path that stays below its folder, on every system."""
    parts = uri.split("/")
    return not (uri.startswith("/") or "\\" in uri or ".." in parts or _SCHEME.match(uri) or (len(uri) > 1 and uri[1] == ":"))


def _hint(uri: str) -> str:
    match = re.match(r"(?:package|model):/*([^/]+)", uri, re.IGNORECASE)
    return f"--package {match[1]}=DIR tells where the package is" if match else ""
