"""Meshes that have no file: each is written as a Wavefront OBJ file beside the URDF file, with its image in an MTL file."""

from __future__ import annotations

import posixpath
import re
from itertools import count
from typing import TYPE_CHECKING

from hymeko_x.ir.legalize import WITHIN
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.parts import Mesh
from hymeko_x.ir.values import numbers_text

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism

FOLDER = "shapes"
_LOOK = "look"


def files_of_meshes(mechanism: Mechanism) -> dict[Id, str]:
    """The relative path of every mesh that carries its points, made of what is harmless in its name. Equal points share a file."""
    within = mechanism.notation(ROOT, WITHIN) or ""
    found: dict[Id, str] = {}
    taken: set[str] = set()
    known: dict[tuple[tuple[float, ...], ...], str] = {}
    for key, mesh in mechanism.vertices(Mesh):
        if mesh.uri is None and mesh.vertices:
            content = mesh.vertices, mesh.faces, mesh.texcoords, mesh.texfaces
            if content in known:
                found[key] = known[content]
                continue
            stem = re.sub(r"[^A-Za-z0-9_-]+", "_", key.name).strip("_") or "mesh"
            name = next(name for name in _numbered(stem) if name.lower() not in taken)
            taken.add(name.lower())
            found[key] = known[content] = f"{within}{FOLDER}/{name}.obj"
    return found


def _numbered(stem: str) -> Iterator[str]:
    yield stem
    yield from (f"{stem}_{number}" for number in count(2))


def contents_of(mechanism: Mechanism, paths: Mapping[Id, str], images: Mapping[Id, str]) -> dict[str, bytes]:
    """The files of these meshes by relative path. ``images`` is the file of each material's image."""
    shown: dict[Id, Id] = {}
    for views in mechanism.shapes.values():
        for view in views:
            if view.mesh is not None and view.material is not None and view.material in images:
                shown.setdefault(view.mesh, view.material)
    found: dict[str, bytes] = {}
    for key, path in paths.items():
        mesh = mechanism.vertex(key, Mesh)
        image = _way_to(images[shown[key]]) if mesh.texcoords and key in shown else None
        library = posixpath.splitext(path)[0] + ".mtl"
        if path not in found or (image is not None and library not in found):
            found[path] = obj_text(mesh, posixpath.basename(library) if image is not None else None)
            found |= {} if image is None else {library: f"newmtl {_LOOK}\nKd 1 1 1\nmap_Kd {image}\n".encode()}
    return found


def _way_to(image: str) -> str | None:
    """The path of an image from the folder of the meshes; None where it is not named relative to the URDF file."""
    is_relative = not image.startswith("/") and ":" not in image and "\\" not in image
    return posixpath.relpath(image, FOLDER) if is_relative else None


def obj_text(mesh: Mesh, library: str | None = None) -> bytes:
    """The points and faces of a mesh, unscaled, as Wavefront OBJ, with its texture coordinates, and its image in a library."""
    rows = mesh.texfaces or mesh.faces
    has_places = bool(mesh.texcoords) and len(rows) == len(mesh.faces)
    words = [f"{a + 1}/{b + 1}" for a, b in zip(mesh.faces, rows, strict=True)] if has_places else [str(a + 1) for a in mesh.faces]
    lines = [] if library is None else [f"mtllib {library}"]
    lines += [f"v {numbers_text(mesh.vertices[at : at + 3])}" for at in range(0, len(mesh.vertices), 3)]
    if has_places:
        lines += [f"vt {numbers_text(mesh.texcoords[at : at + 2])}" for at in range(0, len(mesh.texcoords), 2)]
    lines += [] if library is None else [f"usemtl {_LOOK}"]
    lines += [f"f {' '.join(words[at : at + 3])}" for at in range(0, len(words), 3)]
    return "\n".join([*lines, ""]).encode()
