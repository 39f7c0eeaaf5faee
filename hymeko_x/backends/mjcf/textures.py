"""Textures as MuJoCo takes them: PNG images, which lie flat or on the sides of a cube."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.assets.shelf import read_file
from hymeko_x.backends.mjcf.packing import Packing, warn
from hymeko_x.formats.mjcf import NAME
from hymeko_x.ir.mechanism import Extra, Id, end_of
from hymeko_x.ir.parts import Layer, Mesh, Plane, Texture
from hymeko_x.meshes.images import UnreadableImage, png_bytes
from hymeko_x.source import file_stem, suffix_of

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Mechanism, ShapeView

TEXTURES = "textures"
_KTX = b"\xabKTX"
"""The first bytes of images that are compressed for the graphics card; MuJoCo hands them to its renderer as they are."""
_WIDTH, _HEIGHT = slice(16, 20), slice(20, 24)
"""Where a PNG has its size. Source: PNG (Third Edition), W3C, chapter 11.2.1."""
_CUBE = Extra(NAME, "@type", "cube")


def pack_textures(run: Packing) -> None:
    """PNG and KTX are copied, other images are converted; a texture that is not there is left out, and its material keeps its colour."""
    solid = _on_solids(run.mechanism)
    lost = {key for key, texture in run.mechanism.vertices(Texture) if not _pack_texture(run, key, texture, solid=key in solid)}
    run.gone += lost
    run.gone += [key for key, _, arcs in run.mechanism.edges(Layer) if any(arc.target in lost for arc in arcs)]


def _pack_texture(run: Packing, key: Id, texture: Texture, *, solid: bool) -> bool:
    found = read_file(run.files, texture.uri or "")
    if found is None:
        warn(run, key, codes.ASSET_NOT_FOUND, f"'{texture.uri}' was not found; the texture is left out", texture.uri)
        return False
    path, data = found
    if data.startswith(_KTX):
        run.vertices[key] = replace(texture, uri=run.shelf.copy(TEXTURES, file_stem(texture.uri or ""), ".ktx", path, data))
        return True
    try:
        png = png_bytes(data)
    except UnreadableImage as error:
        warn(run, key, codes.ASSET_UNREADABLE, f"'{texture.uri}' cannot be read: {error}; the texture is left out")
        return False
    stem, same = file_stem(texture.uri or ""), png is data
    uri = run.shelf.copy(TEXTURES, stem, ".png", path, data) if same else run.shelf.place(TEXTURES, stem, ".png", png)
    run.vertices[key] = replace(texture, uri=uri)
    if solid and _is_square(png):
        run.attributes[key] = _CUBE
    return True


# ---- on solids -----------------------------------------------------------------------------------------------------------------


def _on_solids(mechanism: Mechanism) -> set[Id]:
    """The images that only shapes without places in an image show.

    Programs that read URDF and SDF show the whole image on each side of a box. So does MuJoCo with an image for a cube; a flat one it
    stretches along z, and lays on a mesh where its texture coordinates place it.
    """
    solid, flat = set[Id | None](), set[Id | None]()
    for view in mechanism.every_shape():
        subsets = mechanism.subsets.get(view.id, ())
        (flat if _has_places(mechanism, view) else solid).update((view.material, *[subset.material for subset in subsets]))
    layers = [(end_of(arcs, 1), end_of(arcs, -1), layer.use) for _, layer, arcs in mechanism.edges(Layer)]
    others = {texture for texture, material, use in layers if use != "rgb" or material in flat}
    return {texture for texture, material, _ in layers if texture is not None and material in solid} - others


def _has_places(mechanism: Mechanism, view: ShapeView) -> bool:
    """Whether the points of a shape may have places in an image. A plane, which may be endless, repeats a flat one."""
    mesh = mechanism.graph.vertices.get(view.mesh) if view.mesh is not None else None
    if not isinstance(mesh, Mesh):
        return isinstance(view.shape.geometry, Plane)
    return bool(mesh.texcoords) if mesh.uri is None else suffix_of(mesh.uri) != ".stl"


def _is_square(png: bytes) -> bool:
    """Whether the image fits the side of a cube: MuJoCo refuses any other."""
    return png[_WIDTH] == png[_HEIGHT]
