"""Meshes that have no file: each is written as a Wavefront OBJ file beside the robot, with its materials in an MTL file."""

from __future__ import annotations

import posixpath
import re
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.ir.digits import number_text, numbers_text
from hymeko_x.ir.names import free_name
from hymeko_x.ir.parts import MESH_POINTS, Material, Mesh, Role

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism, ShapeView
    from hymeko_x.ir.parts import Rgba

FOLDER = "shapes"
_MATERIAL = "look"
_WHITE = (1.0, 1.0, 1.0, 1.0)


class _MtlMaterial(NamedTuple):
    """A material of an MTL file: its name there, its colour, the path of its image, and the triangles that show it (None = all)."""

    name: str
    rgba: Rgba | None
    image: str | None
    faces: tuple[int, ...] | None = None


def files_of_meshes(mechanism: Mechanism, within: str) -> dict[Id, str]:
    """The relative path, below the folder ``within``, of every mesh that has its points, made of the harmless characters of its name.

    Equal points share a file.
    """
    found: dict[Id, str] = {}
    taken: set[str] = set()
    known: dict[object, str] = {}
    shown = _shown(mechanism)
    for key, mesh in mechanism.vertices(Mesh):
        if mesh.uri is None and mesh.vertices:
            content = *(getattr(mesh, name) for name in MESH_POINTS), _subsets(mechanism, shown.get(key))
            if content in known:
                found[key] = known[content]
                continue
            stem = _harmless(key.name) or "mesh"
            name = free_name(stem, lambda name: name.lower() in taken, "_")
            taken.add(name.lower())
            found[key] = known[content] = f"{within}{FOLDER}/{name}.obj"
    return found


def _harmless(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9_-]+", "_", name).strip("_")


def _shown(mechanism: Mechanism) -> dict[Id, ShapeView]:
    """The first shape that shows each mesh; a collision shows nothing."""
    found: dict[Id, ShapeView] = {}
    for view in mechanism.every_shape():
        if view.mesh is not None and view.shape.role is not Role.COLLISION:
            found.setdefault(view.mesh, view)
    return found


def _subsets(mechanism: Mechanism, view: ShapeView | None) -> tuple[tuple[tuple[int, ...], Id], ...]:
    return () if view is None else tuple((subset.faces, subset.material) for subset in mechanism.subsets.get(view.id, ()))


def contents_of(mechanism: Mechanism, paths: Mapping[Id, str], images: Mapping[Id, str]) -> dict[str, bytes]:
    """The files of these meshes by relative path. ``images`` is the file of each material's image."""
    shown, imaged = _shown(mechanism), _imaged(mechanism, images)
    found: dict[str, bytes] = {}
    for key, path in paths.items():
        mesh = mechanism.vertex(key, Mesh)
        materials = _subset_materials(mechanism, mesh, shown.get(key), images) or _image(
            mesh, images[imaged[key]] if key in imaged else None
        )
        library = posixpath.splitext(path)[0] + ".mtl"
        if path not in found or (materials and library not in found):
            found[path] = obj_text(mesh, posixpath.basename(library), materials)
            found |= {library: _library(materials)} if materials else {}
    return found


def _imaged(mechanism: Mechanism, images: Mapping[Id, str]) -> dict[Id, Id]:
    """For each mesh the first material with an image that a shape of it has."""
    found: dict[Id, Id] = {}
    for view in mechanism.every_shape():
        if view.mesh is not None and view.material is not None and view.material in images:
            found.setdefault(view.mesh, view.material)
    return found


# ---- materials ---------------------------------------------------------------------------------------------------------------------


def _image(mesh: Mesh, image: str | None) -> tuple[_MtlMaterial, ...]:
    """The one material of a mesh that shows an image."""
    path = _path_to(image) if image is not None and mesh.texcoords else None
    return () if path is None else (_MtlMaterial(_MATERIAL, None, path),)


def _subset_materials(mechanism: Mechanism, mesh: Mesh, view: ShapeView | None, images: Mapping[Id, str]) -> tuple[_MtlMaterial, ...]:
    """The materials of the subsets of a mesh, first that of the other triangles; none where it has no subsets."""
    total = len(mesh.faces) // 3
    subsets = mechanism.subsets.get(view.id, ()) if view is not None else ()
    known = [(subset.material, subset.faces) for subset in subsets if subset.faces and min(subset.faces) >= 0 and max(subset.faces) < total]
    if view is None or not known:
        return ()
    taken = {face for _, faces in known for face in faces}
    rest = tuple([face for face in range(total) if face not in taken])
    names: set[str] = set()
    found = []
    for material, faces in [(view.material, rest), *known] if rest else known:
        part = mechanism.part(material, Material)
        stem = _harmless(material.name if material is not None else "") or _MATERIAL
        name = free_name(stem, names.__contains__, "_")
        names.add(name)
        own = view.shape.rgba if faces is rest else None
        rgba = own or (part.rgba if part is not None else None)
        image = images.get(material) if own is None and mesh.texcoords and material is not None else None
        found.append(_MtlMaterial(name, rgba, None if image is None else _path_to(image), faces))
    return tuple(found)


def _path_to(image: str) -> str | None:
    """The path of an image from the folder of the meshes; None where it is not named relative to the robot."""
    is_relative = not image.startswith("/") and ":" not in image and "\\" not in image
    return posixpath.relpath(image, FOLDER) if is_relative else None


# ---- texts ---------------------------------------------------------------------------------------------------------------------


def _library(materials: tuple[_MtlMaterial, ...]) -> bytes:
    """The MTL file; the colour of an image is its own, and an unknown material has none."""
    lines: list[str] = []
    for name, rgba, image, _ in materials:
        lines.append(f"newmtl {name}")
        colour = _WHITE if image is not None else rgba
        if colour is not None:
            lines.append(f"Kd {numbers_text(colour[:3])}")
            lines += [f"d {number_text(colour[3])}"] if colour[3] != 1.0 else []
        lines += [] if image is None else [f"map_Kd {image}"]
    return "\n".join([*lines, ""]).encode()


def obj_text(mesh: Mesh, library: str = "", materials: tuple[_MtlMaterial, ...] = ()) -> bytes:
    """The points and faces of a mesh in their order, unscaled, as Wavefront OBJ, with texture coordinates, normals and materials."""
    places, normals = mesh.texfaces or mesh.faces, mesh.normalfaces or mesh.faces
    has_places = bool(mesh.texcoords) and len(places) == len(mesh.faces)
    has_normals = bool(mesh.normals) and len(normals) == len(mesh.faces)
    words = [str(at + 1) for at in mesh.faces]
    if has_places:
        words = [f"{word}/{at + 1}" for word, at in zip(words, places, strict=True)]
    if has_normals:
        words = [f"{word}{'/' if has_places else '//'}{at + 1}" for word, at in zip(words, normals, strict=True)]
    lines = [f"mtllib {library}"] if materials else []
    lines += [f"v {numbers_text(mesh.vertices[at : at + 3])}" for at in range(0, len(mesh.vertices), 3)]
    if has_places:
        lines += [f"vt {numbers_text(mesh.texcoords[at : at + 2])}" for at in range(0, len(mesh.texcoords), 2)]
    if has_normals:
        lines += [f"vn {numbers_text(mesh.normals[at : at + 3])}" for at in range(0, len(mesh.normals), 3)]
    used = _uses(materials)
    for number, at in enumerate(range(0, len(words), 3)):
        lines += [f"usemtl {used[number]}"] if number in used else []
        lines.append(f"f {' '.join(words[at : at + 3])}")
    return "\n".join([*lines, ""]).encode()


def _uses(materials: tuple[_MtlMaterial, ...]) -> dict[int, str]:
    """The triangles before which another material begins, with its name."""
    if len(materials) == 1 and materials[0].faces is None:
        return {0: materials[0].name}
    owner = {face: material.name for material in materials for face in material.faces or ()}
    return {face: name for face, name in sorted(owner.items()) if owner.get(face - 1) != name}
