"""Digests of whole elements that do not depend on anybody's name: by them a renamed element is found again."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import formats
from hymeko_x.ir.parts import Body, Joint, Shape
from hymeko_x.residue.paths import canonical, canonical_without_name, digest, digest_of_texts

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Extra, Id, Mechanism, RobotEdge

_SIGNS = {1: "1.0", -1: "-1.0", 0: "0.0"}


def print_of(mechanism: Mechanism, key: Id) -> str:
    """The digest of an element with what it is on, or of a body with what is on it."""
    return Prints(mechanism).of(key)


def weight_print(mechanism: Mechanism, body: Id) -> str:
    """The digest of everything that a body's mass may follow from."""
    return Prints(mechanism).of_weight(body)


class Prints:
    """The digests of the elements of a mechanism; what several of them are made from is put into words once.

    ``alike`` are those of a mechanism that shares most of its parts with this one and lives as long.
    """

    def __init__(self, mechanism: Mechanism, alike: Prints | None = None) -> None:
        self._mechanism = mechanism
        self._texts: dict[int, str] = {} if alike is None else alike._texts

    def of(self, key: Id) -> str:
        """The digest of an element with what it is on, or of a body with what is on it."""
        edge = self._mechanism.graph.edges.get(key)
        if edge is not None:
            return digest_of_texts(self._edge(edge))
        part = self._mechanism.graph.vertices[key]
        if not isinstance(part, Body):
            return digest_of_texts([self.nameless(part)])
        above = self._mechanism.parent_joint.get(key)
        joint = () if above is None else (self.nameless(above.joint), self.text(above.parent_pose), self.text(above.child_pose))
        return digest_of_texts([self.text(part), *joint, *self.shapes(key)])

    def of_weight(self, body: Id) -> str:
        """The digest of everything that a body's mass may follow from."""
        return digest_of_texts([self.text(self._mechanism.graph.vertices[body]), *self.shapes(body)])

    def text(self, value: object) -> str:
        """The canonical text of a value that the mechanism holds."""
        found = self._texts.get(id(value))
        if found is None:
            found = self._texts[id(value)] = canonical(value)
        return found

    def nameless(self, part: object) -> str:
        """The canonical text of a part of the mechanism, without the names that it may carry."""
        if isinstance(part, Joint):
            named = any(dof.name is not None for dof in part.dofs)
            return f"Joint(({','.join(map(canonical_without_name, part.dofs))}))" if named else self.text(part)
        return self.text(part) if getattr(part, "name", None) is None else canonical_without_name(part)

    def shapes(self, body: Id) -> list[str]:
        """The texts of the shapes on a body."""
        return [text for view in self._mechanism.shapes.get(body, ()) for text in (self.nameless(view.shape), self.text(view.pose))]

    def _edge(self, edge: RobotEdge) -> list[str]:
        texts = [self.nameless(edge.data)]
        for arc in edge.arcs:
            texts += [_SIGNS[arc.sign], repr(arc.role), repr(arc.target.kind), self.text(arc.weight)]
        return texts


def print_of_extra(extra: Extra) -> str:
    """The digest of an extra, without what elements inherit from it and have in a field, where an edit would be seen."""
    inherited = next((row.inherited for row in formats.FORMATS if row.name == extra.format), None)
    text = extra.text if extra.path or inherited is None else formats.loaded(inherited)(extra.text)
    return digest(extra.format, extra.path, text)


def shape_group(edge: RobotEdge) -> str:
    """What a shape belongs to: all shapes of one name on one body stand or fall together. Empty for other edges."""
    if not isinstance(edge.data, Shape):
        return ""
    body = next((arc.target.name for arc in edge.arcs if arc.sign > 0), "")
    return digest(body, edge.data.name)
