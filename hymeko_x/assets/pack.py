"""Between rewriting and printing: every mesh and texture gets the path under which the output refers to it.

What lies beside the output is returned as bytes or as the path to copy from; the mechanism that comes back names it by
relative paths with forward slashes. File names are built here from what is harmless in the source's names, so that
no output ever leads out of its folder.
"""

from __future__ import annotations

import posixpath
import re
from contextlib import suppress
from enum import Enum
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from msgspec import field
from msgspec.structs import replace

from hymeko_x import codes, formats
from hymeko_x.assets.companions import copy_companions, folder_with_room, variant
from hymeko_x.assets.resolve import is_of_nameless_package
from hymeko_x.assets.shelf import read_file
from hymeko_x.ir.builder import Builder
from hymeko_x.ir.mechanism import subset_edge
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.parts import Mesh, Role, Texture
from hymeko_x.source import file_stem, find_stand_in, suffix_of

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Set

    from hymeko_x.assets.shelf import Shelf
    from hymeko_x.diagnostics import Report
    from hymeko_x.formats import Assets, Format
    from hymeko_x.ir.mechanism import Extra, Id, Mechanism
    from hymeko_x.ir.parts import Material
    from hymeko_x.ir.provenance import StoredLook, StoredMesh
    from hymeko_x.source import Files


def pack(
    mechanism: Mechanism,
    format: Format,
    files: Files,
    shelf: Shelf,
    report: Report,
    *,
    layout: FolderLayout | None = None,
) -> tuple[Mechanism, dict[str, bytes], dict[str, str]]:
    """The mechanism with its files' new paths, the new files by relative path, and the copies by relative path.

    With a ``layout`` copies go to its folders, wherever they are in the source. A file that is not there is a warning. For MJCF its shapes
    are left out, since MuJoCo reads no model with a missing file; in the other formats the reference stays as it is.
    """
    if format.pack is None:
        read = mechanism if format.is_exact else _with_meshes_of_source(mechanism, files, report)
        row = formats.of_source(mechanism)
        keep, models = layout.keep if layout else Keep.of(format, shelf.mode), format.has_models or row is None or not row.has_models
        packed = keep_references(read, shelf, files, report, keep, layout, models=models)
        if format.is_exact and row is not None and row.place_extras is not None:
            packed = formats.loaded(row.place_extras)(mechanism, packed, shelf, files, report, Keep.of(format, shelf.mode))
    else:
        packed = formats.loaded(format.pack)(mechanism, shelf, files, report)
    return packed, shelf.files, shelf.copies


# ---- formats that refer to files by uri and take any type of them -----------------------------------------------------


_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+:")
_PACKAGE = re.compile(r"(package|model):", re.IGNORECASE)
_MODEL = re.compile(r"model:", re.IGNORECASE)
_PACKAGE_START = re.compile(r"(package|model)://", re.IGNORECASE)
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
    def of(format: Format, mode: Assets) -> Keep:
        """Which references stay in files of this format."""
        if mode == "reference":
            return Keep.PACKAGES
        return Keep.PACKAGES_AND_PATHS if format.keeps_package_uris else Keep.NOTHING


class FolderLayout(NamedTuple):
    """The folders of an output that programs find by the name of a package: which references stay, and where textures go."""

    keep: Keep
    textures: str = "textures"


ROS_PACKAGE = FolderLayout(Keep.PACKAGES)
GAZEBO_MODEL = FolderLayout(Keep.NOTHING, "materials/textures")


def keep_references(
    mechanism: Mechanism,
    shelf: Shelf,
    files: Files,
    report: Report,
    keep: Keep,
    layout: FolderLayout | None = None,
    *,
    models: bool = True,
) -> Mechanism:
    """The mechanism with every uri kept or rewritten; a file that is not there keeps its uri, with a warning.

    Files that meshes refer to go along. ``models``: whether the target's programs find ``model://NAME``.
    """
    folders = _FOLDERS if layout is None else {**_FOLDERS, Texture: layout.textures}
    changed: dict[Id, Mesh | Texture] = {}
    for key, part in mechanism.assets():
        if part.uri is None:
            continue
        uri = new_uri(part.uri, folders[type(part)], shelf, files, keep, models=models)
        if uri is None:
            report.warn(
                codes.ASSET_NOT_FOUND,
                f"{key}: '{part.uri}' was not found; the reference is kept",
                mechanism.origin(key),
                element=str(key),
                hint=package_hint(part.uri),
            )
            continue
        if uri != part.uri:
            changed[key] = replace(part, uri=uri)
        place = place_of(uri)
        if isinstance(part, Mesh) and place in shelf.copies:
            copy_companions(part.uri, place, shelf.copies[place], shelf, files)
    return mechanism.replace(vertices=changed)


def with_prefix(mechanism: Mechanism, prefix: str, paths: Set[str]) -> Mechanism:
    """The mechanism with this prefix before the paths of files that are put beside the output."""
    changed: dict[Id, Mesh | Texture] = {
        key: replace(part, uri=f"{prefix}/{part.uri}") for key, part in mechanism.assets() if part.uri in paths
    }
    return mechanism.replace(vertices=changed)


def unloaded(mechanism: Mechanism) -> Mechanism:
    """The mechanism without the triangles of its mesh files, which only the writer needs."""
    plain = {key: Mesh(mesh.uri, mesh.scale, mesh.name) for key, mesh in mechanism.vertices(Mesh) if type(mesh) is not Mesh}
    return mechanism.replace(vertices=plain)


def new_uri(uri: str, folder: str, shelf: Shelf, files: Files, keep: Keep, *, models: bool = True) -> str | None:
    """The uri to write, or None when there is no such file. A package's that stays is not looked for, but for an archive.

    Where only a stand-in is left of a package's file, this goes into a folder of the package's name, in which the uri finds it.
    """
    is_named = is_of_package(uri)
    is_kept = keep is not Keep.NOTHING and is_named and (models or _MODEL.match(uri) is None)
    if _REMOTE.match(uri) or (is_kept and _stays(uri, shelf, files)):
        return uri
    path = files.find(uri)
    if path is None:
        return None
    if shelf.mode == "reference":
        return shelf.way_to(path, uri)
    place = place_of(uri)
    if (is_kept or (keep is Keep.PACKAGES_AND_PATHS and not is_named)) and _is_below(place) and shelf.copy_as(place, path):
        return place if ".." in uri.split("/") and not is_named else uri  # the folder that it leaves again may not be there
    found = read_file(files, uri)
    if found is None:
        return None
    place = folder_with_room(folder, uri, path, shelf, files)
    return shelf.copy(place, file_stem(uri), suffix_of(path), *found, lambda earlier: variant(uri, path, earlier, files))


def _stays(uri: str, shelf: Shelf, files: Files) -> bool:
    """Whether the file of a package is where its uri finds it from the output as well."""
    if shelf.mode == "pack":
        return False
    is_away = shelf.is_from_archive or find_stand_in(files, uri) is not None
    return not is_away or shelf.around.find(uri) is not None


def place_of(uri: str) -> str:
    """The path below the output at which a reference finds its file: that of a package is in a folder of its name."""
    return posixpath.normpath(_PACKAGE_START.sub("", uri) if is_of_package(uri) else uri)


def is_of_package(uri: str) -> bool:
    """Whether the uri names a package, and means the same from everywhere."""
    return _PACKAGE.match(uri) is not None and not is_of_nameless_package(uri)


def _is_below(uri: str) -> bool:
    """Whether the uri is a relative path that stays below its folder, on every system."""
    parts = uri.split("/")
    return not (uri.startswith("/") or "\\" in uri or ".." in parts or _SCHEME.match(uri) or (len(uri) > 1 and uri[1] == ":"))


def package_hint(uri: str) -> str:
    """How the user can tell where the package of a uri is; empty for a uri without one."""
    if is_of_nameless_package(uri):
        return "its package has no name: the file is looked for in the folder of the robot and in those above; --package =DIR adds one"
    match = re.match(r"(?:package|model):/*([^/]+)", uri, re.IGNORECASE)
    return f"--package {match[1]}=DIR tells where the package is" if match else ""


def _with_meshes_of_source(mechanism: Mechanism, files: Files, report: Report) -> Mechanism:
    """The mechanism with the points of files that the engine of its source reads as another solid than other programs do."""
    row = formats.of_source(mechanism)
    stored = {key: (mesh, mesh.uri) for key, mesh in mechanism.vertices(Mesh) if mesh.uri is not None}
    if row is None or row.read_otherwise is None or not stored:
        return mechanism
    from hymeko_x.meshes.submesh import Unreadable, listed

    changed: dict[Id, Mesh] = {}
    read = formats.loaded(row.read_otherwise)
    for key, (mesh, uri) in stored.items():
        found = read_file(files, uri)
        if found is None:
            continue
        with suppress(Unreadable):
            other = read(found[1], suffix_of(found[0]))
            if other is not None:
                changed[key] = replace(listed(other[0]), scale=mesh.scale, name=mesh.name)
                report.note(codes.ASSET_CONVERTED, f"{key} {other[1]}", mechanism.origin(key), element=str(key))
    return mechanism.replace(vertices=changed)


# ---- meshes whose files are missing -----------------------------------------------------------------------------------


class _Standing(Builder):
    """What stands in for files; equal looks share a material."""

    known: dict[tuple[Material, Texture | None], Id] = field(default_factory=dict)

    def show(self, shape: Id, look: StoredLook) -> None:
        """Let a shape look in places as its file does."""
        if (look.material, look.texture) not in self.known:
            self.known[look.material, look.texture] = self.add_material(look.material, look.texture)
        material = self.known[look.material, look.texture]
        self.edges[self.names.take("subset", material.name)] = subset_edge(look.faces, shape, material)


def with_stand_ins(mechanism: Mechanism, format: Format, files: Files, report: Report) -> Mechanism:
    """The mechanism with what the file that was read has in the places of meshes and images whose files are missing.

    An exact format keeps the reference.
    """
    if not mechanism.stored or format.is_exact:
        return mechanism
    missing = [key for key, part in mechanism.assets() if key in mechanism.stored and part.uri is not None and files.find(part.uri) is None]
    for key in missing:
        stored, uri = mechanism.stored[key], getattr(mechanism.graph.vertices[key], "uri", None)
        other = stored if isinstance(stored, Texture) else stored.mesh
        instead = "the points that the source has of it" if other.uri is None else f"'{other.uri}', which the source has in its place"
        message = f"{key}: '{uri}' was not found; it becomes {instead}"
        report.note(codes.ASSET_NOT_FOUND, message, mechanism.origin(key), element=str(key))
    return standing(mechanism, missing)


def standing(mechanism: Mechanism, keys: Collection[Id]) -> Mechanism:
    """The mechanism in which these meshes and images are those that the file that was read has in their places."""
    if not keys:
        return mechanism
    made = _Standing(names=names_in_use(mechanism))
    found: dict[Id, StoredMesh] = {}
    for key in keys:
        stored, part = mechanism.stored[key], mechanism.graph.vertices[key]
        if not isinstance(stored, Texture):
            found[key] = stored
        made.vertices[key] = replace(stored if isinstance(stored, Texture) else stored.mesh, name=getattr(part, "name", None))
    for view in mechanism.every_shape():
        if view.mesh in found and view.shape.role is Role.VISUAL and view.id not in mechanism.subsets:
            for look in found[view.mesh].looks:
                made.show(view.id, look)
    rest = {key: stored for key, stored in mechanism.stored.items() if key not in keys}
    return replace(made.added_to(mechanism), extras=_unplaced(mechanism.extras, found), stored=rest)


def _unplaced(extras: Mapping[Id, tuple[Extra, ...]], meshes: Iterable[Id]) -> dict[Id, tuple[Extra, ...]]:
    """The extras without those by which the points of these meshes, which already are in their places, would be moved again."""
    bare = {key: tuple([extra for extra in extras.get(key, ()) if not formats.is_placing(extra)]) for key in meshes}
    return {key: found for key, found in {**extras, **bare}.items() if found}
