"""<asset>: meshes, textures and materials; height fields, skins and models are kept as extras."""

from __future__ import annotations

import posixpath
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.mjcf.notations import LAYERS
from hymeko_x.formats.mjcf.places import MATERIAL, MESH
from hymeko_x.formats.mjcf.words import joined
from hymeko_x.frontends.mjcf.expand import folder_from
from hymeko_x.ir.mechanism import Id, layer_edge
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import Material, Mesh, Texture
from hymeko_x.source import file_stem

if TYPE_CHECKING:
    from hymeko_x.frontends.mjcf.builder import MjcfBuilder
    from hymeko_x.xml.tree import XmlNode


def read_assets(sections: list[XmlNode], builder: MjcfBuilder) -> None:
    """Textures first, since materials refer to them."""
    for section in sections:
        for element in section.detach("texture"):
            read_texture(element, builder)
    for section in sections:
        for element in section.detach("mesh"):
            read_mesh(element, builder)
    for section in sections:
        for element in section.detach("material"):
            read_material(element, builder)
        for element in section.children:
            builder.keep_at_root(element, "asset")


def _uri(element: XmlNode, file: str, folder: str, builder: MjcfBuilder) -> str:
    """The path of a file from the main file: in the folder of <compiler>, else beside the main file, else beside the included one."""
    uri = joined(folder, file, builder.settings)
    if folder or element.file == builder.file or builder.files.find(uri) is not None:
        return uri
    beside = posixpath.join(folder_from(builder.file, element.file), uri)
    return uri if builder.files.find(beside) is None else beside


def read_mesh(element: XmlNode, builder: MjcfBuilder) -> None:
    """A mesh: a file below <compiler meshdir>, or inline data."""
    file = element.take("file")
    uri = None if file is None else _uri(element, file, builder.settings.mesh_folder, builder)
    name = element.take("name") or None
    stem = file_stem(uri or "")
    if not (name or stem):
        raise refuse(codes.BAD_NAME, "<mesh> needs a name or a file", element.origin)
    key = builder.names.take("mesh", name or stem)
    builder.origins[key] = element.origin
    builder.register(element, "mesh", name or stem, key)
    base = builder.base(element, key)
    found = builder.values(element, MESH, base, key)
    faces = tuple(map(int, found["face"]))
    _check_mesh(element, uri, len(found["vertex"]), faces)
    builder.vertices[key] = Mesh(uri, found["scale"], None if name in (stem, key.name) else name, found["vertex"], faces)
    builder.keep(element, key)
    if key in builder.extras or key in builder.notations or key in builder.stereotypes:
        builder.show(key)


def _check_mesh(element: XmlNode, uri: str | None, count: int, faces: tuple[int, ...]) -> None:
    """What MuJoCo refuses in inline data."""
    made = uri is not None or "builtin" in element.attributes or any(child.tag == "plugin" for child in element.children)
    if count % 3 or len(faces) % 3:
        word = "vertex" if count % 3 else "face"
        raise refuse(
            codes.BAD_NUMBER, f"<mesh {word}> has {count if count % 3 else len(faces)} numbers, expected three for each", element.origin
        )
    if not made and count < 12:
        raise refuse(codes.BAD_NUMBER, f"<mesh vertex> has {count // 3} points, expected at least 4 where there is no file", element.origin)
    if count and faces and not (min(faces) >= 0 and max(faces) < count // 3):
        raise refuse(codes.BAD_NUMBER, f"<mesh face> refers to a point that is not there; there are {count // 3}", element.origin)


def read_texture(element: XmlNode, builder: MjcfBuilder) -> None:
    """An image, or a pattern whose description stays with it."""
    file = element.take("file")
    uri = None if file is None else _uri(element, file, builder.settings.texture_folder, builder)
    name = element.take("name") or None
    stem = file_stem(uri or "")
    if not (name or stem) and element.attributes.get("type") != "skybox":
        raise refuse(codes.BAD_NAME, "<texture> needs a name or a file, unless it is a skybox", element.origin)
    key = builder.names.take("texture", name or stem or "texture")
    builder.origins[key] = element.origin
    builder.register(element, "texture", name or stem or _skybox(element), key)
    builder.base(element, key)
    builder.vertices[key] = Texture(uri, None if name == key.name else name)
    if not (name or stem):
        builder.note(key, UNNAMED, True)
    builder.keep(element, key)
    builder.show(key)


def _skybox(element: XmlNode) -> str:
    """Textures may be nameless; none of them is referred to, and there may be several."""
    return f"\0{element.file}:{element.line}:{id(element)}"


def read_material(element: XmlNode, builder: MjcfBuilder) -> None:
    """A material with the textures on it."""
    key = builder.own(element, "material", "material")
    base = builder.base(element, key)
    found = builder.values(element, MATERIAL, base, key)
    texture = found.pop("texture")
    rgba = found.pop("rgba") or None
    builder.vertices[key] = Material(None if builder.noted(key, UNNAMED) else key.name, rgba, **found)
    builder.show(key)
    if texture:
        _put(element, texture, key, "rgb", builder)
    elif len([child for child in element.children if child.tag == "layer"]) == 1:
        builder.note(key, LAYERS, True)
    for layer in element.detach("layer"):
        _put(layer, layer.attributes.get("texture", ""), key, layer.attributes.get("role", "rgb"), builder)
    builder.keep(element, key)


def _put(element: XmlNode, texture: str, material: Id, use: str, builder: MjcfBuilder) -> None:
    edge = builder.names.take("layer", material.name)
    builder.edges[edge] = layer_edge(builder.find(element, "texture", texture), material, use)
    builder.show(edge)
