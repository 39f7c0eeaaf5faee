"""<material>, at robot level and in shapes."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from hymeko_x.formats.urdf.notations import DEFINED, Defined
from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.parts import Layer, Material, Texture
from hymeko_x.xml.printing import Tag

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism, ShapeView


class Materials:
    """The materials of a mechanism, and where each is defined: ``usual`` where its author chose no other place."""

    def __init__(self, mechanism: Mechanism, usual: Defined) -> None:
        self._mechanism = mechanism
        self._usual = usual
        self._defined_before: set[Id] = set()

    @cached_property
    def textures(self) -> Mapping[Id, str]:
        """The file of each material's texture."""
        vertices = self._mechanism.graph.vertices
        found: dict[Id, str] = {}
        for _, _, arcs in self._mechanism.edges(Layer):
            image = next((vertices[arc.target] for arc in arcs if arc.sign > 0), None)
            if isinstance(image, Texture) and image.uri is not None:
                found.update({arc.target: image.uri for arc in arcs if arc.sign < 0})
        return found

    @cached_property
    def _first_of_name(self) -> Mapping[str, Id]:
        """For each material name the material that it means: the one with that id, else the first one."""
        found: dict[str, Id] = {}
        for key, material in self._mechanism.vertices(Material):
            if material.name is not None and (material.name not in found or key.name == material.name):
                found[material.name] = key
        return found

    @cached_property
    def definitions(self) -> Mapping[Id, Defined | None]:
        """Where each material is defined; None where it is only referred to."""
        return {key: self._definition(key, material) for key, material in self._mechanism.vertices(Material)}

    def _definition(self, key: Id, material: Material) -> Defined | None:
        own = self._mechanism.notation(key, DEFINED)
        if material.name is None:
            return Defined.INLINE
        if material.rgba is None and key not in self.textures:
            return own
        if self._first_of_name[material.name] != key:
            return own or Defined.INLINE
        return self._usual if own is None else own

    def robot_tag(self, key: Id) -> Tag:
        """The <material> of robot level that defines a material."""
        material = self._mechanism.vertex(key, Material)
        tag = Tag("material", {"name": material.name or key.name})
        self._add_appearance(tag, key, material)
        return tag

    def add_to_shape(self, tag: Tag, view: ShapeView) -> None:
        """Add a shape's material: its own colour without a name, or a name, with the definition where it belongs."""
        if view.shape.rgba is not None:
            tag.add("material", name="").add("color", rgba=numbers_text(view.shape.rgba))
        elif view.material is not None:
            material = self._mechanism.vertex(view.material, Material)
            child = tag.add("material", name=material.name or "")
            if self._is_defined_now(view.material):
                self._add_appearance(child, view.material, material)

    def _is_defined_now(self, key: Id) -> bool:
        """Whether a shape that uses the material has to define it; asked once for each shape, in printing order."""
        place = self.definitions[key]
        first = key not in self._defined_before
        self._defined_before.add(key)
        return place in (Defined.INLINE, Defined.BOTH) or (place is Defined.FIRST and first)

    def _add_appearance(self, tag: Tag, key: Id, material: Material) -> None:
        if material.rgba is not None:
            tag.add("color", rgba=numbers_text(material.rgba))
        if key in self.textures:
            tag.add("texture", filename=self.textures[key])
