"""Materials: UsdPreviewSurface with constant inputs and one colour texture; every other shader network stays an extra."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pxr import UsdShade

from hymeko_x.formats.usd import single
from hymeko_x.frontends.usd.bindings import bound_to
from hymeko_x.frontends.usd.prims import BINDING
from hymeko_x.ir.mechanism import layer_edge
from hymeko_x.ir.parts import Material, Texture

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.draft import Draft
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.ir.mechanism import Id

PREVIEW = "UsdPreviewSurface"
TEXTURE = "UsdUVTexture"
_COORDINATES = "UsdPrimvarReader_float2"
_TYPED = ("inputs:diffuseColor", "inputs:opacity", "inputs:metallic", "inputs:roughness")


def read_material(prim: Prim, draft: Draft) -> None:
    """The vertex of a material; its network is typed only where nothing of it would be left over."""
    key = draft.own(prim, "material")
    draft.materials[prim.path] = key
    surface = UsdShade.Material(prim.composed).ComputeSurfaceSource()[0]
    shader = surface.GetPrim() if surface else None
    if shader is None or surface.GetShaderId() != PREVIEW:
        draft.vertices[key] = Material(draft.part_name(prim))
        draft.take(prim, "@type")
        return
    draft.vertices[key] = _looks(draft.part_name(prim), shader)
    draft.take(prim, "@type")
    if _is_plain(prim.composed, shader):
        _take_network(prim, shader, key, draft)


def bound_material(prim: Prim, draft: Draft) -> Id | None:
    """The material that a shape shows; a binding of its own is typed, one of a prim above stays there as well."""
    bound = bound_to(prim, draft.scene)
    key = draft.materials.get(bound.path) if bound is not None else None
    if key is not None and prim.targets(BINDING) and not prim.composed.GetRelationship(BINDING).GetMetadata("bindMaterialAs"):
        draft.take(prim, BINDING)
        taken = draft.taken.get(prim.path, ())
        if all(name in taken for name in prim.properties if name.startswith(f"{BINDING}:")):
            draft.take(prim, "@MaterialBindingAPI")
    return key


def _looks(name: str, shader: Any) -> Material:
    colour, opacity = _constant(shader, "diffuseColor"), _constant(shader, "opacity")
    rgba = None
    if colour is not None:
        r, g, b = (single(float(value)) for value in colour)
        rgba = (r, g, b, single(float(opacity)) if opacity is not None else 1.0)
    metallic, roughness = _constant(shader, "metallic"), _constant(shader, "roughness")
    return Material(
        name,
        rgba,
        metallic=None if metallic is None else single(float(metallic)),
        roughness=None if roughness is None else single(float(roughness)),
    )


def _constant(shader: Any, name: str) -> Any:
    """The constant value of an input; None where it is not said or comes from another shader."""
    found = UsdShade.Shader(shader).GetInput(name)
    if not found or found.HasConnectedSource():
        return None
    return found.Get() if found.GetAttr().HasAuthoredValue() else None


# ---- networks that are typed in full -------------------------------------------------------------------------------------------


def _is_plain(prim: Any, shader: Any) -> bool:
    """Whether the network is one preview surface below its material, at most with one image for its colour."""
    below = [child for child in prim.GetChildren() if child != shader]
    if shader.GetParent() != prim or any(child.GetTypeName() != "Shader" or child.GetChildren() for child in (*below, shader)):
        return False
    inputs = {str(name) for name in shader.GetAuthoredPropertyNames() if str(name).startswith("inputs:")}
    kinds = sorted(str(UsdShade.Shader(child).GetShaderId()) for child in below)
    return inputs <= set(_TYPED) and kinds in ([], sorted([TEXTURE, _COORDINATES])) and (not below or _image(below) is not None)


def _image(below: list[Any]) -> str | None:
    for child in below:
        asset = child.GetAttribute("inputs:file").Get() if child.GetAttribute("inputs:file") else None
        if asset is not None and asset.path:
            return str(asset.path)
    return None


def _take_network(prim: Prim, shader: Any, key: Id, draft: Draft) -> None:
    """Everything below the material is typed, or follows from what is."""
    draft.take(prim, "outputs:surface")
    image = _image([child for child in prim.composed.GetChildren() if child != shader])
    for child in prim.children:
        if child.is_real:
            draft.take(child, "@type", "@spec", *child.properties)
    if image is not None:
        texture = draft.own(prim, "texture", key.name)
        draft.vertices[texture] = Texture(image)
        draft.edges[draft.own(prim, "layer", key.name)] = layer_edge(texture, key)
