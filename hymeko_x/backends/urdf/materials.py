"""<material>, at robot level and in shapes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.ir.parts import Material
from hymeko_x.ir.values import numbers_text
from hymeko_x.xml.printing import Tag

if TYPE_CHECKING:
    from hymeko_x.backends.urdf.sheet import Sheet
    from hymeko_x.ir.mechanism import Id, ShapeView


def robot_material_tag(key: Id, sheet: Sheet) -> Tag:
    """The <material> of robot level that defines a material."""
    material = sheet.mechanism.vertex(key, Material)
    tag = Tag("material", {"name": material.name or key.name})
    _add_looks(tag, key, material, sheet)
    return tag


def add_shape_material(tag: Tag, view: ShapeView, sheet: Sheet) -> None:
    """Add a shape's material: its own colour without a name, or a name, with the definition where it belongs."""
    if view.shape.rgba is not None:
        tag.add("material", name="").add("color", rgba=numbers_text(view.shape.rgba))
    elif view.material is not None:
        material = sheet.mechanism.vertex(view.material, Material)
        child = tag.add("material", name=material.name or "")
        if sheet.defined_now(view.material):
            _add_looks(child, view.material, material, sheet)


def _add_looks(tag: Tag, key: Id, material: Material, sheet: Sheet) -> None:
    if material.rgba is not None:
        tag.add("color", rgba=numbers_text(material.rgba))
    texture = sheet.textures.get(key)
    if texture is not None:
        tag.add("texture", filename=texture)
