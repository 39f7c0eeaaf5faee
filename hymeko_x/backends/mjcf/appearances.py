"""The materials of appearances in mesh files: those of the robot that look alike, or new ones."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from hymeko_x.assets.shelf import read_file
from hymeko_x.backends.mjcf.textures import TEXTURES
from hymeko_x.ir.parts import Layer, Material, Texture
from hymeko_x.meshes.images import UnreadableImage, png_bytes
from hymeko_x.source import file_stem

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.packing import Packing
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.ir.parts import Mesh
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
    key = run.looks.get((found.rgba or (png and _WHITE), png))
    if key is None:
        key = run.add_material(Material(meaning_of(found) or file_stem(mesh.uri or ""), found.rgba), mark="_")
        if png is not None:
            run.add_texture(Texture(run.shelf.place(TEXTURES, key.name, ".png", png)), key)
    run.materials[found.rgba, found.image] = key
    return key


def looks_of_robot(run: Packing) -> dict[tuple[object, bytes | None], Id]:
    """The materials of the robot itself that are a colour, or an image, and nothing else; the first of those that look alike."""
    found: dict[tuple[object, bytes | None], Id] = {}
    for key, part in run.mechanism.vertices(Material):
        layers = [edge for _, edge, _ in run.mechanism.graph.edges_at(key) if isinstance(edge.data, Layer)]
        if part != Material(part.name, part.rgba) or len(layers) > 1:
            continue
        image = next((_image_of(run, arc.target) for edge in layers for arc in edge.arcs if arc.target != key), None)
        if image is not None or not layers:
            found.setdefault((part.rgba or (image and _WHITE), image), key)
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
