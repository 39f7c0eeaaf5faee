"""The files of a mechanism that came from MJCF, for MJCF again: they stay what and, where possible, where they are."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.assets.pack import Keep, keep_references, new_uri, package_hint
from hymeko_x.assets.shelf import read_file
from hymeko_x.formats.mjcf.files import mended, refused
from hymeko_x.formats.mjcf.tree import parse_text
from hymeko_x.formats.mjcf.words import NAME, below, joined, settings_of
from hymeko_x.ir.mechanism import ROOT, Extra, Id, Mechanism
from hymeko_x.ir.parts import Mesh, Texture
from hymeko_x.source import suffix_of
from hymeko_x.xml.text import escaped, unescaped

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.assets.shelf import Shelf
    from hymeko_x.diagnostics import Report
    from hymeko_x.formats.mjcf.codec import Settings
    from hymeko_x.source import Files

_FILE = re.compile(r'(?<=\s)(file\w*)="([^"]*)"')
_FOLDERS = re.compile(r'\s(?:meshdir|texturedir|assetdir|strippath)="[^"]*"')
_KEPT = ("asset", "deformable")


def pack_native(mechanism: Mechanism, shelf: Shelf, files: Files, report: Report) -> Mechanism:
    """The mechanism with every file copied below the output, or referred to from there.

    The folders that <compiler> names stay as long as no file has to move; else every path is written in full.
    """
    from hymeko_x.backends.mjcf.meshes import with_points_as_files

    packed = keep_references(mechanism, shelf, files, report, Keep.PACKAGES_AND_PATHS)
    packed = with_points_as_files(_with_mended_files(mechanism, packed, shelf, files, report), shelf)
    return place_extras(mechanism, packed, shelf, files, report, Keep.PACKAGES_AND_PATHS, is_native=True)


def place_extras(
    mechanism: Mechanism, packed: Mechanism, shelf: Shelf, files: Files, report: Report, keep: Keep, *, is_native: bool = False
) -> Mechanism:
    """The packed mechanism whose extras name files by their new paths; where it is for MuJoCo (native), such as MuJoCo reads."""
    settings = settings_in(mechanism)
    moved: dict[tuple[str, str], str] = {}
    for key, extra in _with_files(mechanism):
        for _, file in _FILE.findall(_text(extra)):
            folder = _folder(key, settings)
            uri = joined(folder, unescaped(file), settings)
            there = new_uri(uri, "assets", shelf, files, keep)
            if there is None:
                _report_missing(uri, mechanism, key, extra, report)
            elif is_native:
                there = _mended(uri, there, key, mechanism, shelf, files, report)
            moved[folder, file] = there or uri
    same = all(joined(folder, unescaped(file), settings) == uri for (folder, file), uri in moved.items())
    if same and packed.graph == mechanism.graph and _all_below(packed, settings):
        return packed
    return replace(packed, extras=_in_full(packed, moved, settings))


def _report_missing(uri: str, mechanism: Mechanism, key: Id, extra: Extra, report: Report) -> None:
    owner = f"{key}" if key != ROOT else f"<{parse_text(extra.text).tag}>"
    message = f"{owner}: '{uri}' was not found; the reference is kept"
    report.warn(codes.ASSET_NOT_FOUND, message, mechanism.origin(key), element=str(key), hint=package_hint(uri))


# ---- files that MuJoCo refuses -------------------------------------------------------------------------------------------------


def _with_mended_files(mechanism: Mechanism, packed: Mechanism, shelf: Shelf, files: Files, report: Report) -> Mechanism:
    """The packed mechanism with files that MuJoCo reads in the places of those that it refuses."""
    changed: dict[Id, Mesh | Texture] = {}
    for (key, part), (_, new) in zip(mechanism.assets(), packed.assets(), strict=True):
        if part.uri is not None and new.uri is not None:
            uri = _mended(part.uri, new.uri, key, mechanism, shelf, files, report)
            if uri != new.uri:
                changed[key] = replace(new, uri=uri)
    return packed.replace(vertices=changed)


def _mended(uri: str, there: str, key: Id, mechanism: Mechanism, shelf: Shelf, files: Files, report: Report) -> str:
    """The path of a file that MuJoCo reads, which is ``there`` where it reads that of ``uri``."""
    from hymeko_x.meshes.images import UnreadableImage
    from hymeko_x.meshes.submesh import Unreadable

    suffix = suffix_of(uri)
    found = read_file(files, uri) if suffix in (".png", ".stl") else None
    reason = None if found is None else refused(suffix, found[1])
    if found is None or reason is None:
        return there
    try:
        path = shelf.place_instead(there, *mended(suffix, found[1]))
    except (Unreadable, UnreadableImage) as error:
        message = f"{key}: '{uri}' cannot be read: {error}"
        report.warn(codes.ASSET_UNREADABLE, message, mechanism.origin(key), element=str(key))
        return there
    report.note(codes.ASSET_CONVERTED, f"{key} {reason}", mechanism.origin(key), element=str(key))
    return path


# ---- references in extras ------------------------------------------------------------------------------------------------------


def settings_in(mechanism: Mechanism) -> Settings:
    """The settings of the <compiler> elements."""
    compilers = [extra.text for extra in mechanism.extras.get(ROOT, ()) if extra.format == NAME and extra.text.startswith("<compiler")]
    return settings_of([parse_text(text).attributes for text in compilers])


def _with_files(mechanism: Mechanism) -> list[tuple[Id, Extra]]:
    """The extras that may name files: sections of the whole, and the sides of a texture."""
    found = [(ROOT, extra) for extra in mechanism.extras.get(ROOT, ()) if _names_files(extra)]
    for key, _ in mechanism.vertices(Texture):
        found += [(key, extra) for extra in mechanism.extras.get(key, ()) if extra.path.startswith("@file")]
    return found


def files_in_extras(mechanism: Mechanism) -> Iterator[tuple[Id, str]]:
    """The references of the files that extras name: height fields, skins, the sides of textures."""
    settings = settings_in(mechanism)
    for key, extra in _with_files(mechanism):
        yield from ((key, joined(_folder(key, settings), unescaped(file), settings)) for _, file in _FILE.findall(_text(extra)))


def _names_files(extra: Extra) -> bool:
    return extra.format == NAME and (extra.path in _KEPT or extra.text.startswith("<deformable"))


def tells_places(extra: Extra) -> bool:
    """Whether an extra names files, or the folders that they are in."""
    return extra.format == NAME and (_names_files(extra) or extra.path.startswith("@file") or extra.text.startswith("<compiler"))


def _text(extra: Extra) -> str:
    return f' {extra.path[1:]}="{escaped(extra.text)}"' if extra.path.startswith("@") else extra.text


def _folder(key: Id, settings: Settings) -> str:
    return settings.texture_folder if key.kind == "texture" else settings.mesh_folder


def _all_below(mechanism: Mechanism, settings: Settings) -> bool:
    """Whether every mesh and texture is in the folder that <compiler> names."""
    meshes = (below(settings.mesh_folder, mesh.uri) for _, mesh in mechanism.vertices(Mesh) if mesh.uri)
    textures = (below(settings.texture_folder, texture.uri) for _, texture in mechanism.vertices(Texture) if texture.uri)
    return all(uri is not None for uri in (*meshes, *textures))


def _in_full(mechanism: Mechanism, moved: dict[tuple[str, str], str], settings: Settings) -> dict[Id, tuple[Extra, ...]]:
    """The extras without the folders of <compiler>, and with the whole paths of files."""
    extras = dict(mechanism.extras)
    for key in {ROOT, *(key for key, _ in _with_files(mechanism))}:
        folder = _folder(key, settings)
        extras[key] = tuple(_full(extra, folder, moved) for extra in extras.get(key, ()))
    return extras


def _full(extra: Extra, folder: str, moved: dict[tuple[str, str], str]) -> Extra:
    if extra.format != NAME:
        return extra
    if extra.text.startswith("<compiler"):
        return replace(extra, text=_FOLDERS.sub("", extra.text))
    if extra.path.startswith("@file"):
        return replace(extra, text=moved.get((folder, escaped(extra.text)), extra.text))
    if not _names_files(extra):
        return extra
    return replace(extra, text=_FILE.sub(lambda found: f'{found[1]}="{escaped(moved.get((folder, found[2]), found[2]))}"', extra.text))
