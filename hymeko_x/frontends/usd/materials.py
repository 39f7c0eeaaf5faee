"""Materials: UsdPreviewSurface with constant inputs and one colour texture; every other shader network becomes an extra."""

from __future__ import annotations

import posixpath
from typing import TYPE_CHECKING, Any

from pxr import Gf, Sdf, UsdShade

from hymeko_x.formats import usd as words
from hymeko_x.formats.usd import single
from hymeko_x.frontends.usd.prims import BINDING
from hymeko_x.ir.mechanism import layer_edge
from hymeko_x.ir.parts import Material, Texture

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.builder import UsdBuilder
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.frontends.usd.stage import OpenStage
    from hymeko_x.ir.mechanism import Id

PREVIEW = "UsdPreviewSurface"
TEXTURE = "UsdUVTexture"
_COORDINATES = "UsdPrimvarReader_float2"
_TYPED = ("inputs:diffuseColor", "inputs:opacity", "inputs:metallic", "inputs:roughness")
_OF_IMAGE = frozenset(("info:id", "inputs:file", "inputs:st", "outputs:rgb", *words.WRAPS))
_OF_COORDINATES = frozenset(("info:id", "inputs:varname", "outputs:result"))


def read_material(prim: Prim, builder: UsdBuilder) -> None:
    """The vertex of a material; its network is typed only where nothing of it would be left over."""
    key = builder.new_id(prim, "material")
    builder.materials[prim.path] = key
    surface = UsdShade.Material(prim.composed).ComputeSurfaceSource()[0]
    shader = surface.GetPrim() if surface else None
    if shader is None or surface.GetShaderId() != PREVIEW:
        builder.vertices[key] = Material(builder.part_name(prim))
        builder.mark_read(prim, "@type")
        return
    builder.vertices[key] = _material(builder.part_name(prim), shader)
    builder.mark_read(prim, "@type")
    if _is_plain(prim.composed, shader):
        _take_network(prim, builder)
    authored = _image(shader)
    if authored is not None:
        image = _seen_from(builder.scene.folder, authored)
        texture = builder.new_id(prim, "texture", key.name)
        builder.vertices[texture] = Texture(image)
        builder.edges[builder.new_id(prim, "layer", key.name)] = layer_edge(texture, key)


def bound_material(prim: Prim, builder: UsdBuilder) -> Id | None:
    """The material that a shape shows; a binding of its own is typed, one of a prim above stays there as well."""
    bound = bound_to(prim, builder.scene)
    key = builder.materials.get(bound.path) if bound is not None else None
    if key is not None and prim.targets(BINDING) and not prim.composed.GetRelationship(BINDING).GetMetadata("bindMaterialAs"):
        builder.mark_read(prim, BINDING)
        taken = builder.read_names.get(prim.path, ())
        if all(name in taken for name in prim.properties if name.startswith(f"{BINDING}:")):
            builder.mark_read(prim, "@MaterialBindingAPI")
    return key


def _material(name: str, shader: Any) -> Material:
    colour, opacity = _colour(shader), _constant(shader, "opacity", _NUMBERS)
    rgba = None
    if colour is not None:
        r, g, b = (single(float(value)) for value in colour)
        rgba = (r, g, b, single(float(opacity)) if opacity is not None else 1.0)
    metallic, roughness = _constant(shader, "metallic", _NUMBERS), _constant(shader, "roughness", _NUMBERS)
    return Material(
        name,
        rgba,
        metallic=None if metallic is None else single(float(metallic)),
        roughness=None if roughness is None else single(float(roughness)),
    )


def _colour(shader: Any) -> Any:
    """Red, green and blue of a surface, or by which they multiply those of its image; None where they are not given."""
    image = _image(shader)
    scale = None if image is None else image.GetPrim().GetAttribute(words.SCALE)
    if not scale:
        return _constant(shader, "diffuseColor", _COLOURS)
    factors = scale.Get() if scale.HasAuthoredValue() else None
    return factors[:3] if isinstance(factors, _FACTORS) else None


_NUMBERS = (float, int)
_COLOURS = (Gf.Vec3f, Gf.Vec3d, Gf.Vec3h)
_FACTORS = (Gf.Vec4f, Gf.Vec4d, Gf.Vec4h)


def _constant(shader: Any, name: str, kinds: tuple[type, ...]) -> Any:
    """The constant value of an input; None where there is none of these types, or it comes from another shader."""
    found = UsdShade.Shader(shader).GetInput(name)
    if not found or found.HasConnectedSource():
        return None
    value = found.Get() if found.GetAttr().HasAuthoredValue() else None
    return value if isinstance(value, kinds) else None


# ---- networks that are typed in full -------------------------------------------------------------------------------------------


def _is_plain(prim: Any, shader: Any) -> bool:
    """Whether the network is one preview surface below its material, at most with one image for its colour, as we write it."""
    below = [child for child in prim.GetChildren() if child != shader]
    if shader.GetParent() != prim or any(child.GetTypeName() != "Shader" or child.GetChildren() for child in (*below, shader)):
        return False
    inputs = {str(name) for name in shader.GetAuthoredPropertyNames() if str(name).startswith("inputs:")}
    kinds = {str(UsdShade.Shader(child).GetShaderId()): child for child in below}
    if not inputs <= set(_TYPED) or len(kinds) != len(below):
        return False
    return not below or (kinds.keys() == {TEXTURE, _COORDINATES} and _is_plain_image(kinds[TEXTURE], kinds[_COORDINATES], shader))


def _is_plain_image(image: Any, coordinates: Any, shader: Any) -> bool:
    """Whether an image is repeated, and has no attributes beyond those that the writer sets."""
    authored = [{str(name) for name in child.GetAuthoredPropertyNames()} for child in (image, coordinates)]
    is_repeated = all(image.GetAttribute(name).Get() == words.REPEAT for name in words.WRAPS)
    is_ours = authored[0] - {words.SCALE} == _OF_IMAGE and authored[1] == _OF_COORDINATES and is_repeated
    return is_ours and coordinates.GetAttribute("inputs:varname").Get() == "st" and _image(shader) is not None


def _image(shader: Any) -> Any | None:
    """The attribute with the file of the image that colours a surface."""
    found = UsdShade.Shader(shader).GetInput("diffuseColor")
    source = found.GetConnectedSource() if found else None
    image = source[0].GetPrim() if source else None
    if not image or UsdShade.Shader(image).GetShaderId() != TEXTURE:
        return None
    asset = image.GetAttribute("inputs:file")
    return asset if isinstance(asset.Get(), Sdf.AssetPath) and asset.Get().path else None


def _seen_from(folder: str, image: Any) -> str:
    """The path of an image seen from the stage's own folder: the layer that names it may lie elsewhere."""
    path = str(image.Get().path)
    if path.startswith("/") or ":" in path:
        return posixpath.normpath(path[len(folder) + 1 :]) if path.startswith(f"{folder}/") else path
    layer = image.GetPropertyStack()[0].layer.identifier.replace("\\", "/")
    there = posixpath.normpath(posixpath.join(posixpath.dirname(layer), path))
    return posixpath.relpath(there, folder) if there.startswith(posixpath.dirname(folder)) else path


def _take_network(prim: Prim, builder: UsdBuilder) -> None:
    """Everything below the material is typed, or follows from typed values."""
    builder.mark_read(prim, "outputs:surface")
    for child in prim.children:
        if child.is_real:
            builder.mark_read(child, "@type", "@spec", *child.properties)


# ---- bindings ----------------------------------------------------------------------------------------------------------------------


def bound_to(prim: Prim, scene: OpenStage, purpose: str = "") -> Prim | None:
    """The prim of the material that a prim is bound to for a purpose (empty: for all), None without one.

    USD computes it by all rules of inheritance, strength and collections.
    """
    if not prim.is_bound:
        return None
    bound = UsdShade.MaterialBindingAPI(prim.composed).ComputeBoundMaterial(purpose or UsdShade.Tokens.allPurpose)[0]
    return scene.prims.get(str(bound.GetPath())) if bound else None
