"""Materials as UsdPreviewSurface, with one image for the colour where there is one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pxr import Gf, Sdf

from hymeko_x.backends.usd.sheet import T, apply, connect, point, put
from hymeko_x.formats import usd as words
from hymeko_x.ir.mechanism import end_of
from hymeko_x.ir.parts import Layer, Material, Texture

if TYPE_CHECKING:
    from hymeko_x.backends.usd.sheet import UsdSheet, WrittenPrim
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.ir.parts import Rgba


def write_materials(sheet: UsdSheet) -> None:
    """Every material; one whose shader network was kept as it is gets that network back instead."""
    images = _images(sheet)
    for key, material in sheet.mechanism.vertices(Material):
        spec = sheet.add_prim(key, "materials", "Material", material.name)
        has_own = any(extra.format == words.FORMAT and extra.path for extra in sheet.mechanism.extras.get(key, ()))
        if not has_own:
            _write_surface(sheet, spec, material, images.get(key))


def _images(sheet: UsdSheet) -> dict[Id, tuple[Id, Texture]]:
    """The texture that colours each material."""
    found: dict[Id, tuple[Id, Texture]] = {}
    for _, layer, arcs in sheet.mechanism.edges(Layer):
        texture = end_of(arcs, 1)
        material = end_of(arcs, -1)
        part = sheet.mechanism.part(texture, Texture)
        if layer.use == "rgb" and texture is not None and material is not None and part is not None and part.uri:
            found.setdefault(material, (texture, part))
    return found


def _write_surface(sheet: UsdSheet, spec: Any, material: Material, image: tuple[Id, Texture] | None) -> None:
    shader = _shader(sheet, spec, "surface", "UsdPreviewSurface")
    put(shader, "outputs:surface", T.Token, None)
    connect(spec, "outputs:surface", T.Token, shader, "outputs:surface")
    if material.rgba is not None and image is None:
        put(shader, "inputs:diffuseColor", T.Color3f, Gf.Vec3f(*material.rgba[:3]))
    if material.rgba is not None:
        put(shader, "inputs:opacity", T.Float, material.rgba[3])
    for name, value in (("metallic", material.metallic), ("roughness", material.roughness)):
        if value is not None:
            put(shader, f"inputs:{name}", T.Float, value)
    if image is not None:
        _write_image(sheet, spec, shader, image[1], material.rgba or words.WHITE)


def _write_image(sheet: UsdSheet, spec: Any, shader: Any, texture: Texture, rgba: Rgba) -> None:
    """An image, which the colour of its material multiplies."""
    coordinates = _shader(sheet, spec, "coordinates", "UsdPrimvarReader_float2")
    put(coordinates, "inputs:varname", T.String, "st")
    put(coordinates, "outputs:result", T.Float2, None)
    image = _shader(sheet, spec, "image", "UsdUVTexture")
    put(image, "inputs:file", T.Asset, Sdf.AssetPath(texture.uri or ""))
    connect(image, "inputs:st", T.Float2, coordinates, "outputs:result")
    for name in words.WRAPS:
        put(image, name, T.Token, words.REPEAT)
    if rgba[:3] != words.WHITE[:3]:
        put(image, words.SCALE, T.Float4, Gf.Vec4f(*rgba[:3], 1.0))
    put(image, "outputs:rgb", T.Float3, None)
    connect(shader, "inputs:diffuseColor", T.Color3f, image, "outputs:rgb")


def _shader(sheet: UsdSheet, spec: Any, name: str, kind: str) -> Any:
    shader = sheet.define(spec.path.AppendChild(name), "Shader")
    put(shader, "info:id", T.Token, kind)
    return shader


def bind(sheet: UsdSheet, spec: WrittenPrim, material: Id) -> None:
    """Show a prim in a material."""
    apply(spec, "MaterialBindingAPI")
    point(spec, "material:binding", sheet.paths[material])
