"""<asset>."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.native.sheet import section_lines
from hymeko_x.formats.mjcf.places import MATERIAL, MESH
from hymeko_x.formats.mjcf.words import below
from hymeko_x.ir.graph import Arc
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.parts import Layer, Material, Mesh, Texture

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.native.sheet import Sheet
    from hymeko_x.backends.mjcf.text import Attributes
    from hymeko_x.ir.mechanism import Id


def write_assets(sheet: Sheet) -> None:
    """Textures, materials, meshes, then what goes along as it is."""
    mechanism = sheet.mechanism
    textures = list(mechanism.vertices(Texture))
    materials = list(mechanism.vertices(Material))
    meshes = _in_order(list(mechanism.vertices(Mesh)), mechanism.notation(ROOT, "meshes"))
    rest = section_lines(sheet, "asset")
    if not (textures or materials or meshes or rest):
        return
    sheet.text.section("asset")
    for key, texture in textures:
        sheet.element("texture", _texture(sheet, key, texture), sheet.inside(key))
    layers = _layers(sheet)
    for key, material in materials:
        _write_material(sheet, key, material, layers.get(key, []))
    for key, mesh in meshes:
        sheet.element("mesh", _mesh(sheet, key, mesh), sheet.inside(key))
    for _, line in rest:
        sheet.text.raw(line)
    sheet.text.close()


def _in_order(meshes: list[tuple[Id, Mesh]], places: str | None) -> list[tuple[Id, Mesh]]:
    """The meshes in the order of their file: by name, or as was noted while there are as many as there were."""
    by_name = sorted(meshes, key=lambda item: item[0].name)
    if places is None:
        return by_name
    order = [int(place) for place in places.split() if place.isdigit()]
    return [by_name[place] for place in order] if sorted(order) == list(range(len(meshes))) else by_name


def _file(sheet: Sheet, uri: str | None, folder: str) -> str | None:
    """The file as it is called in the folder that <compiler> names."""
    if uri is None:
        return None
    return below(folder, uri) or uri


def _texture(sheet: Sheet, key: Id, texture: Texture) -> Attributes:
    return {
        "name": sheet.name(key),
        "class": sheet.own_class(key),
        "file": _file(sheet, texture.uri, sheet.settings.texture_folder),
        **sheet.said(key),
    }


def _mesh(sheet: Sheet, key: Id, mesh: Mesh) -> Attributes:
    own_class = sheet.own_class(key)
    base = sheet.base("mesh", own_class)
    values = {"scale": mesh.scale, "vertex": mesh.vertices, "face": tuple(map(float, mesh.faces))}
    found = sheet.attributes(values, MESH, base, sheet.notes(key), {})
    if mesh.faces and "face" in found:
        found["face"] = " ".join(map(str, mesh.faces))
    return {
        "name": sheet.name(key),
        "class": own_class,
        "file": _file(sheet, mesh.uri, sheet.settings.mesh_folder),
        **found,
        **sheet.said(key),
    }


def _write_material(sheet: Sheet, key: Id, material: Material, layers: list[tuple[str, str]]) -> None:
    own_class = sheet.own_class(key)
    base = sheet.base("material", own_class)
    simple = layers[0][1] if len(layers) == 1 and layers[0][0] == "rgb" and not sheet.notes(key).get("layers") else None
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
    found = sheet.attributes(values, MATERIAL, base, sheet.notes(key), {})
    attributes: Attributes = {"name": sheet.name(key), "class": own_class, **found, **sheet.said(key)}
    rest = [] if simple is not None else layers
    inside = [f'<layer role="{use}" texture="{texture}"/>' for use, texture in rest]
    sheet.element("material", attributes, [*inside, *sheet.inside(key)])


def _layers(sheet: Sheet) -> dict[Id, list[tuple[str, str]]]:
    found: dict[Id, list[tuple[str, str]]] = {}
    for _, layer, arcs in sheet.mechanism.edges(Layer):
        texture = next(arc.target for arc in arcs if arc.sign > 0)
        material = next(arc.target for arc in arcs if arc.sign < 0)
        found.setdefault(material, []).append((layer.use, sheet.reference(Arc(texture))))
    return found
