"""The materials of appearances in mesh files: those of the robot that look alike, or new ones."""

from __future__ import annotations

from collections import defaultdict
from contextlib import suppress
from typing import TYPE_CHECKING

from hymeko_x.assets.shelf import read_file
from hymeko_x.backends.mjcf.textures import TEXTURES
from hymeko_x.ir.parts import Layer, Material, Texture
from hymeko_x.meshes.images import UnreadableImage, png_bytes
from hymeko_x.source import file_stem

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.packing import Packing
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.ir.parts import Mesh, Rgba
    from hymeko_x.meshes.submesh import Appearance

_WHITE = (1.0, 1.0, 1.0, 1.0)
"""The colour of a material with an image alone."""


def material_of(run: Packing, found: Appearance | None, mesh: Mesh) -> Id | None:
    """The material of an appearance in a file; equal ones share it."""
    if found is None or (found.rgba is None and found.image is None):
        return None
    known = run.materials.get((found.rgba, found.image))
    if known is not None:
        return known
    png = None if found.image is None else png_bytes(found.image)
    key = _of_robot(run, found.rgba or (_WHITE if png else None), png)
    if key is None:
        key = run.add_material(Material(meaning_of(found) or file_stem(mesh.uri or ""), found.rgba), mark="_")
        if png is not None:
            run.add_texture(Texture(run.shelf.place(TEXTURES, key.name, ".png", png)), key)
    run.materials[found.rgba, found.image] = key
    return key


def _of_robot(run: Packing, rgba: Rgba | None, png: bytes | None) -> Id | None:
    """The first material of the robot itself that is this colour, with this image or without one, and nothing else."""
    if run.plain is None:
        run.plain = _plain_materials(run.mechanism)
    white: list[Id] = run.plain.get(None, []) if png is not None and rgba == _WHITE else []
    for key in [*run.plain.get(rgba, []), *white]:
        layers = [edge for _, edge, _ in run.mechanism.graph.edges_at(key) if isinstance(edge.data, Layer)]
        images = [_image_of(run, arc.target) for edge in layers for arc in edge.arcs if arc.target != key] if png else layers
        if images == ([] if png is None else [png]):
            return key
    return None


def _plain_materials(mechanism: Mechanism) -> dict[Rgba | None, list[Id]]:
    """The materials of a robot that have a colour or images alone, by colour."""
    found: dict[Rgba | None, list[Id]] = defaultdict(list)
    for key, part in mechanism.vertices(Material):
        if part == Material(part.name, part.rgba):
            found[part.rgba].append(key)
    return found


def _image_of(run: Packing, texture: Id) -> bytes | None:
    """The image of a texture as a PNG; None for one that is not there."""
    part = run.mechanism.part(texture, Texture)
    found = None if part is None else read_file(run.files, part.uri or "")
    with suppress(UnreadableImage):
        return None if found is None else png_bytes(found[1])
    return None


def meaning_of(found: Appearance) -> str:
    """The name of an appearance, else that of its image or colour; empty where it has none of them."""
    from hymeko_x.meshes.colours import name_of_colour

    return found.name or file_stem(found.file) or ("" if found.rgba is None else name_of_colour(found.rgba))
