"""Materials: global by name, defined at robot level or inside a visual, or a colour without a name.

A colour in a visual's unnamed material is the shape's own colour. A second definition of a name with another appearance is
a material of its own, since readers disagree: urdfdom keeps the first one, MuJoCo the one inside each visual.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats.urdf import notations
from hymeko_x.formats.urdf.notations import Defined
from hymeko_x.frontends.urdf.builder import MaterialDefinition, take_numbers
from hymeko_x.ir.mechanism import Id, layer_edge
from hymeko_x.ir.parts import Material, Texture
from hymeko_x.source import file_stem

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.frontends.urdf.builder import UrdfBuilder
    from hymeko_x.ir.parts import Rgba
    from hymeko_x.xml.tree import XmlNode

Appearance = tuple["Rgba | None", "str | None"]
"""The colour and the texture file of a <material>."""


def read_robot_material(root: XmlNode, node: XmlNode, builder: UrdfBuilder) -> None:
    """Add a material of robot level; one without a name, or one that is defined again alike, stays as it was written."""
    name = node.attributes.get("name")
    if not name:
        message = "a <material> of robot level has no name, so that no visual can refer to it; it is kept as written"
        builder.warn(codes.BAD_NAME, node, message)
        root.leave(node)
        return
    node.owner = Id("material", name)
    definition = _resolve(node, name, _read_appearance(node, builder), builder)
    if definition.at_robot:
        message = f"the material '{name}' is defined twice at robot level, in the same way; the second one is kept as written"
        builder.report.warn(codes.DUPLICATE_NAME, message, node.origin, element=str(definition.id))
        root.leave(node)
        return
    definition.at_robot = True
    node.take("name")
    node.owner = definition.id
    builder.close(node)


def read_shape_material(shape: XmlNode, builder: UrdfBuilder) -> tuple[Rgba | None, Id | None]:
    """The colour of a shape's unnamed material, or the id of its named one."""
    node = shape.take_child("material")
    if node is None:
        return None, None
    name = node.attributes.get("name")
    if name:
        node.take("name")
        return None, _use(node, name, builder)
    return _read_unnamed(shape, node, builder)


def _use(node: XmlNode, name: str, builder: UrdfBuilder) -> Id:
    appearance = _read_appearance(node, builder)
    definition = _resolve(node, name, appearance, builder)
    definition.uses += 1
    definition.inline += appearance != (None, None)
    definition.first_use = definition.first_use or node.origin
    return definition.id


def _read_unnamed(shape: XmlNode, node: XmlNode, builder: UrdfBuilder) -> tuple[Rgba | None, Id | None]:
    rgba, texture = _read_appearance(node, builder)
    if (rgba, texture) == (None, None):
        shape.leave(node)
        return None, None
    if node.take("name") is None:
        message = f"{shape.subject}: <material> has no name; the appearance is the shape's own (urdfdom drops such a visual)"
        builder.warn(codes.BAD_NAME, node, message)
    if texture is None:
        return rgba, None
    key = builder.names.take("material", str(shape.owner and shape.owner.name))
    _add(MaterialDefinition(key, rgba, texture, first_use=node.origin), None, builder)
    return None, key


def _read_appearance(node: XmlNode, builder: UrdfBuilder) -> Appearance:
    rgba = texture = None
    color = node.take_child("color")
    if color is not None:
        rgba = take_numbers(color, "rgba", 4, builder, instead="no colour is used")
        if rgba is None and "rgba" not in color.attributes:
            node.leave(color)
    image = node.take_child("texture")
    if image is not None:
        texture = image.take("filename")
        if not texture:
            node.leave(image)
    if rgba is None:
        return None, texture or None
    r, g, b, a = rgba
    return (r, g, b, a), texture or None


def _resolve(node: XmlNode, name: str, appearance: Appearance, builder: UrdfBuilder) -> MaterialDefinition:
    """The definition of this name with this appearance: the first one if it has none, a new one if it has another."""
    variants = builder.materials.setdefault(name, [])
    if not variants:
        variants.append(MaterialDefinition(_material_id(name, node, builder)))
    first = variants[0]
    if appearance == (None, None):
        return first
    if first.is_empty:
        first.rgba, first.texture = appearance
        return first
    same = next((definition for definition in variants if (definition.rgba, definition.texture) == appearance), None)
    if same is not None:
        return same
    other = MaterialDefinition(_material_id(name, node, builder), *appearance)
    variants.append(other)
    builder.report.warn(
        codes.MATERIAL_REDEFINED,
        f"the material '{name}' is defined again with another appearance (before: {builder.origins[first.id]}); "
        f"both are kept, this one as '{other.id.name}'",
        node.origin,
        element=str(other.id),
    )
    return other


def _material_id(name: str, node: XmlNode, builder: UrdfBuilder) -> Id:
    key = builder.names.take("material", name)
    builder.origins[key] = node.origin
    return key


# ---- at the end --------------------------------------------------------------------------------------------------------------


def finish_materials(builder: UrdfBuilder) -> None:
    """Add the materials, and note where most of them are defined and which ones elsewhere."""
    for name, variants in builder.materials.items():
        for definition in variants:
            _add(definition, name, builder)
            if definition.is_empty and not definition.at_robot:
                message = f"the material '{name}' is not defined anywhere; it has no appearance (urdfdom shows a default grey)"
                builder.report.warn(codes.UNDEFINED_REFERENCE, message, definition.first_use, element=str(definition.id))
    _note_places(builder)


def _add(definition: MaterialDefinition, name: str | None, builder: UrdfBuilder) -> None:
    builder.vertices[definition.id] = Material(name, definition.rgba)
    if definition.texture is None:
        return
    texture = builder.textures.get(definition.texture)
    if texture is None:
        texture = builder.names.take("texture", file_stem(definition.texture) or "texture")
        builder.textures[definition.texture] = texture
        builder.vertices[texture] = Texture(definition.texture)
    builder.edges[builder.names.take("layer", definition.id.name)] = layer_edge(texture, definition.id)


def _note_places(builder: UrdfBuilder) -> None:
    """Where each material is defined: of the places that suit it, the one that suits most."""
    places = dict(_places(builder))
    votes = Counter(place for suiting in places.values() for place in suiting)
    for key, suiting in places.items():
        builder.choose(key, notations.DEFINED, max(suiting, key=lambda place: votes[place]))


def _places(builder: UrdfBuilder) -> Iterator[tuple[Id, tuple[Defined, ...]]]:
    for variants in builder.materials.values():
        for number, definition in enumerate(variants):
            if number == 0 and not definition.is_empty:
                yield definition.id, _suiting(definition)
            elif definition.at_robot:
                builder.note(definition.id, notations.DEFINED, Defined.ROBOT)


def _suiting(definition: MaterialDefinition) -> tuple[Defined, ...]:
    """The places that write at least the definitions that the file has."""
    if definition.at_robot:
        return (Defined.BOTH,) if definition.inline else (Defined.ROBOT, Defined.BOTH) if not definition.uses else (Defined.ROBOT,)
    if definition.inline > 1:
        return (Defined.INLINE,)
    return (Defined.INLINE, Defined.FIRST) if definition.uses == 1 else (Defined.FIRST,)
