"""The builder of mechanisms: collects vertices, edges and side tables while a frontend reads, or while a rule adds elements."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from msgspec import Struct, field
from msgspec.structs import replace

from hymeko_x.ir.graph import Hypergraph
from hymeko_x.ir.mechanism import Mechanism, layer_edge
from hymeko_x.ir.names import Names

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.diagnostics import Origin
    from hymeko_x.ir.mechanism import Extra, Id, Provenance, RobotEdge
    from hymeko_x.ir.notations import Notation
    from hymeko_x.ir.parts import Material, Texture, VertexPart

T = TypeVar("T")


class Builder(Struct, kw_only=True):
    """Vertices, edges and side tables so far, as a :class:`Mechanism` has them. Frontends add their own state in subclasses.

    A rule that adds elements to a mechanism starts with ``Builder(names=names_in_use(mechanism))`` and ends with :meth:`added_to`.
    """

    names: Names = field(default_factory=Names)
    vertices: dict[Id, VertexPart] = field(default_factory=dict)
    edges: dict[Id, RobotEdge] = field(default_factory=dict)
    extras: dict[Id, list[Extra]] = field(default_factory=dict)
    origins: dict[Id, Origin] = field(default_factory=dict)
    notations: dict[Id, dict[str, str]] = field(default_factory=dict)
    stereotypes: dict[Id, tuple[str, ...]] = field(default_factory=dict)
    layout: list[Id] = field(default_factory=list)

    def fresh(self, kind: str, name: str, origin: Origin) -> Id:
        """A free id for an element that stands there: this name, with a number behind it when it is taken."""
        key = self.names.take(kind, name)
        self.origins[key] = origin
        return key

    def note(self, key: Id, notation: Notation[T], value: T) -> None:
        """Keep how the author wrote something of an element."""
        self.notations.setdefault(key, {})[notation.name] = notation.write(value)

    def noted(self, key: Id, notation: Notation[T]) -> T | None:
        """The value of a notation, or None."""
        text = self.notations.get(key, {}).get(notation.name)
        return None if text is None else notation.read(text)

    def add_extras(self, key: Id, *extras: Extra) -> None:
        """Keep texts of an element that the IR cannot represent."""
        if extras:
            self.extras.setdefault(key, []).extend(extras)

    def add_material(self, material: Material, texture: Texture | None = None, mark: str = "#") -> Id:
        """A new material, whose name is that of its id, and the texture that it has; the mark stands before a number in the name."""
        key = self.names.take("material", material.name or "material", mark)
        self.vertices[key] = replace(material, name=key.name)
        if texture is not None:
            self.add_texture(texture, key)
        return key

    def add_texture(self, texture: Texture, material: Id) -> None:
        """A new texture on a material."""
        key = self.names.take("texture", material.name)
        self.vertices[key] = texture
        self.edges[self.names.take("layer", material.name)] = layer_edge(key, material)

    def build(self, name: str, source: Provenance) -> Mechanism:
        """The mechanism of everything collected."""
        return Mechanism(
            name=name,
            graph=Hypergraph(self.vertices, self.edges),
            extras={key: tuple(found) for key, found in self.extras.items() if found},
            origins=self.origins,
            notations=self.notations,
            stereotypes=self.stereotypes,
            layout=tuple(self.layout),
            source=source,
        )

    def added_to(self, mechanism: Mechanism, without: Iterable[Id] = ()) -> Mechanism:
        """A mechanism with the new vertices and edges, which replace those of the same ids, and without some elements."""
        return mechanism.replace(vertices=self.vertices, edges=self.edges, without=without)
