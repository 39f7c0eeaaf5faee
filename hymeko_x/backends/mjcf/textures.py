"""Textures as MuJoCo takes them: PNG images."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.assets.shelf import read_file
from hymeko_x.backends.mjcf.packing import Packing, warn
from hymeko_x.ir.parts import Layer, Texture
from hymeko_x.meshes.images import UnreadableImage, png_bytes
from hymeko_x.source import file_stem

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id

TEXTURES = "textures"
_KTX = b"\xabKTX"
"""The first bytes of images that are compressed for the graphics card; MuJoCo hands them to its renderer as they are."""


def pack_textures(run: Packing) -> None:
    """PNG and KTX are copied, other images are converted; a texture that is not there is left out, and its material keeps its colour."""
    lost = {key for key, texture in run.mechanism.vertices(Texture) if not _pack_texture(run, key, texture)}
    run.gone += lost
    run.gone += [key for key, _, arcs in run.mechanism.edges(Layer) if any(arc.target in lost for arc in arcs)]


def _pack_texture(run: Packing, key: Id, texture: Texture) -> bool:
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
    return True
