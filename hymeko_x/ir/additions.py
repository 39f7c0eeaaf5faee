"""What is added to a mechanism on its way to a target: new elements under names that are free in it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from hymeko_x.ir.mechanism import layer_edge

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, RobotEdge
    from hymeko_x.ir.names import Names
    from hymeko_x.ir.parts import Material, Texture, VertexPart


@dataclass(slots=True)
class Additions:
    """New vertices and edges, also in place of some that are there."""

    names: Names
    vertices: dict[Id, VertexPart] = field(default_factory=dict)
    edges: dict[Id, RobotEdge] = field(default_factory=dict)

    def add_material(self, material: Material, texture: Texture | None = None) -> Id:
        """A new material, which is called as its id is, and the texture that it shows."""
        key = self.names.take("material", material.name or "material")
        self.vertices[key] = replace(material, name=key.name)
        if texture is not None:
            self.add_texture(texture, key)
        return key

    def add_texture(self, texture: Texture, material: Id) -> None:
        """A new texture that a material shows."""
        key = self.names.take("texture", material.name)
        self.vertices[key] = texture
        self.edges[self.names.take("layer", material.name)] = layer_edge(key, material)
