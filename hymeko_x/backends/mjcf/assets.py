"""<asset>: textures, materials and meshes, then what is written as it is."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.sheet import tag_of
from hymeko_x.formats.mjcf.mesh_order import mesh_order
from hymeko_x.formats.mjcf.notations import LAYERS
from hymeko_x.formats.mjcf.places import MATERIAL, MESH
from hymeko_x.formats.mjcf.words import below
from hymeko_x.ir.graph import Arc
from hymeko_x.ir.mechanism import end_of
from hymeko_x.ir.parts import Layer, Material, Mesh, Texture
from hymeko_x.xml.printing import Tag

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.sheet import MjcfSheet
    from hymeko_x.ir.mechanism import Id

_PLAIN_MATERIAL = (MATERIAL[-1], *MATERIAL[:-1])
"""With its texture first, as one reads it."""


def write_assets(sheet: MjcfSheet) -> None:
    """Every texture, material and mesh, in this order; nothing where there is none."""
    mechanism = sheet.mechanism
    layers = _layers(sheet)
    tags: list[Tag | str] = [_texture(sheet, key, texture) for key, texture in mechanism.vertices(Texture)]
    tags += [_material(sheet, key, material, layers.get(key, [])) for key, material in mechanism.vertices(Material)]
    tags += [_mesh(sheet, key, mesh) for key, mesh in _in_order(sheet, list(mechanism.vertices(Mesh)))]
    tags += [line for _, line in sheet.lines_in("asset")]
    if tags:
        sheet.section("asset").children += tags


def _in_order(sheet: MjcfSheet, meshes: list[tuple[Id, Mesh]]) -> list[tuple[Id, Mesh]]:
    """The meshes in the order of their file in MJCF."""
    if not sheet.from_mjcf:
        return meshes
    parts = dict(meshes)
    return [(key, parts[key]) for key in mesh_order(sheet.mechanism)]


def _file(uri: str | None, folder: str) -> str | None:
    """The file as it is called in the folder that <compiler> names."""
    return None if uri is None else below(folder, uri) or uri


def _texture(sheet: MjcfSheet, key: Id, texture: Texture) -> Tag:
    """An image. Without a type it would be one for the six sides of a cube, which packing makes some of those on solids."""
    attributes = {
        "name": sheet.name(key),
        "class": sheet.own_class(key),
        **({} if sheet.from_mjcf else {"type": "2d"}),
        "file": _file(texture.uri, sheet.settings.texture_folder),
        **sheet.kept_attributes(key),
    }
    return tag_of("texture", attributes, sheet.inside(key))


def _mesh(sheet: MjcfSheet, key: Id, mesh: Mesh) -> Tag:
    own_class = sheet.own_class(key)
    values = {"scale": mesh.scale, "vertex": mesh.vertices, "face": tuple(map(float, mesh.faces))}
    found = sheet.attributes(values, MESH, sheet.base("mesh", own_class), sheet.notations(key), {})
    if mesh.faces and "face" in found:
        found["face"] = " ".join(map(str, mesh.faces))
    attributes = {
        "name": sheet.name(key),
        "class": own_class,
        "file": _file(mesh.uri, sheet.settings.mesh_folder),
        **found,
        **sheet.kept_attributes(key),
    }
    return tag_of("mesh", attributes, sheet.inside(key))


def _material(sheet: MjcfSheet, key: Id, material: Material, layers: list[tuple[str, str]]) -> Tag:
    """A material; its colour texture is an attribute, several textures are <layer> elements."""
    own_class = sheet.own_class(key)
    simple = layers[0][1] if len(layers) == 1 and layers[0][0] == "rgb" and not sheet.note(key, LAYERS) else None
    values = {
        "rgba": material.rgba or (),
        "specular": material.specular,
        "shininess": material.shininess,
        "reflectance": material.reflectance,
        "emission": material.emission,
        "metallic": material.metallic,
        "roughness": material.roughness,
        "texture": simple,
    }
    groups = MATERIAL if sheet.from_mjcf else _PLAIN_MATERIAL
    found = sheet.attributes(values, groups, sheet.base("material", own_class), sheet.notations(key), {})
    inside = [] if simple is not None else [Tag("layer", {"role": use, "texture": texture}) for use, texture in layers]
    return tag_of(
        "material", {"name": sheet.name(key), "class": own_class, **found, **sheet.kept_attributes(key)}, [*inside, *sheet.inside(key)]
    )


def _layers(sheet: MjcfSheet) -> dict[Id, list[tuple[str, str]]]:
    """For each material its textures with their use; a layer that lacks one of both is left out."""
    found: dict[Id, list[tuple[str, str]]] = {}
    for _, layer, arcs in sheet.mechanism.edges(Layer):
        texture = end_of(arcs, 1)
        material = end_of(arcs, -1)
        if material is not None and texture is not None and texture in sheet.mechanism.graph.vertices:
            found.setdefault(material, []).append((layer.use, sheet.reference(Arc(texture))))
    return found
