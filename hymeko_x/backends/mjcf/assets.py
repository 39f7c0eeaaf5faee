"""<asset>: textures, materials and meshes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.text import Attributes, Text, number, numbers
from hymeko_x.formats import mjcf as words
from hymeko_x.ir.parts import Layer, Material, Mesh, Texture

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.names import Printed
    from hymeko_x.ir.mechanism import Id, Mechanism

_NO_SCALE = (1.0, 1.0, 1.0)


def write_assets(text: Text, mechanism: Mechanism, names: Printed) -> None:
    """Every texture, material and mesh, in this order; nothing where there is none."""
    textures = list(mechanism.vertices(Texture))
    materials = list(mechanism.vertices(Material))
    meshes = list(mechanism.vertices(Mesh))
    if not (textures or materials or meshes):
        return
    text.section("asset")
    for key, texture in textures:
        text.leaf("texture", {"name": names.of(key), "type": "2d", "file": texture.uri})
    layers = _layers(mechanism)
    for key, material in materials:
        write_material(text, names.of(key), material, [(use, names.of(texture)) for use, texture in layers.get(key, ())])
    for key, mesh in meshes:
        text.leaf("mesh", _mesh_attributes(mechanism, key, mesh, names))
    text.close()


def write_material(text: Text, name: str, material: Material, layers: list[tuple[str, str]]) -> None:
    """A material; its colour texture is an attribute, several textures are <layer> elements."""
    simple = len(layers) == 1 and layers[0][0] == "rgb"
    attributes: Attributes = {
        "name": name,
        "texture": layers[0][1] if simple else None,
        "rgba": None if material.rgba is None else numbers(*material.rgba),
        "specular": number(material.specular),
        "shininess": number(material.shininess),
        "reflectance": number(material.reflectance),
        "emission": number(material.emission),
        "metallic": number(material.metallic),
        "roughness": number(material.roughness),
    }
    if simple or not layers:
        text.leaf("material", attributes)
        return
    text.open("material", attributes)
    for use, texture in layers:
        text.leaf("layer", {"role": use, "texture": texture})
    text.close()


def _mesh_attributes(mechanism: Mechanism, key: Id, mesh: Mesh, names: Printed) -> Attributes:
    said = {
        extra.path.removeprefix("@"): extra.text
        for extra in mechanism.extras.get(key, ())
        if extra.format == words.NAME and extra.path.startswith("@")
    }
    return {
        "name": names.of(key),
        "file": mesh.uri,
        "scale": None if mesh.scale == _NO_SCALE else numbers(*mesh.scale),
        "vertex": numbers(*mesh.vertices) if mesh.vertices else None,
        "face": " ".join(map(str, mesh.faces)) if mesh.faces else None,
        **said,
    }


def _layers(mechanism: Mechanism) -> dict[Id, list[tuple[str, Id]]]:
    """For each material its textures with their use; a layer that lacks one of both says nothing."""
    found: dict[Id, list[tuple[str, Id]]] = {}
    for _, layer, arcs in mechanism.edges(Layer):
        texture = next((arc.target for arc in arcs if arc.sign > 0), None)
        material = next((arc.target for arc in arcs if arc.sign < 0), None)
        if material is not None and texture is not None and texture in mechanism.graph.vertices:
            found.setdefault(material, []).append((layer.use, texture))
    return found
