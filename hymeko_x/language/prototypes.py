"""Prototypes: vertices and edges that others have as their type, in the text itself and in the meta-models that it imports.

``link1 : primitives.Link {}`` has the fields of the vertex ``Link``, and those of the types that it has itself. What such a type means for
a robot follows from its name (:data:`MEANINGS`), where that is a word of the standard vocabulary or of the published meta-models.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.language.syntax import ArcItem, Field, Item, Node, Ref

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

MEANINGS: Mapping[str, str] = MappingProxyType(
    {
        "fixedjoint": "fixed",
        "revjoint": "revolute",
        "revolutejoint": "revolute",
        "rotationaljoint": "revolute",
        "contijoint": "continuous",
        "continuousjoint": "continuous",
        "prismaticjoint": "prismatic",
        "jointedge": "joint",
        "joint": "joint",
        "link": "link",
    }
)
"""The type of the standard vocabulary that a prototype means, by its name in small letters without ``_``."""


def meaning_of(name: str) -> str | None:
    """The type of the standard vocabulary that the name of a prototype means, if there is one."""
    return MEANINGS.get(name.lower().replace("_", ""))


class Prototype(NamedTuple):
    """A vertex, an edge or a field that others may refer to, with its path: that of an imported text begins with the file's name."""

    path: tuple[str, ...]
    item: Node | Field


class Prototypes:
    """The vertices, edges and fields of a text and of those that it imports, found by the end of their path."""

    def __init__(self, texts: Iterable[tuple[str, tuple[Item, ...]]], short: Mapping[str, tuple[str, ...]]) -> None:
        """``texts`` are the items of each text with its name ("" is the text itself); ``short`` the names that stand for paths."""
        self._texts = tuple(texts)
        self._short = short
        self._index: dict[str, list[Prototype]] | None = None

    def find(self, path: tuple[str, ...]) -> Prototype | None:
        """The first element whose path ends so; else the first one whose path has these steps, as the published texts leave some out."""
        if path and path[0] in self._short:
            path = (*self._short[path[0]], *path[1:])
        if not path:
            return None
        if self._index is None:
            self._index = self._indexed()
        named = self._index.get(path[-1], ())
        exact = (found for found in named if found.path[-len(path) :] == path)
        return next(exact, None) or next((found for found in named if _is_within(path, found.path)), None)

    def _indexed(self) -> dict[str, list[Prototype]]:
        """Every named item by its name; those of the text itself first, and in each text the outer ones first."""
        index: dict[str, list[Prototype]] = {}
        for name, items in self._texts:
            level: list[tuple[tuple[str, ...], tuple[Item, ...]]] = [((name,) if name else (), items)]
            while level:
                inner: list[tuple[tuple[str, ...], tuple[Item, ...]]] = []
                for path, block in level:
                    for item in block:
                        if isinstance(item, Node | Field) and not (isinstance(item, Node) and item.parameters is not None):
                            found = Prototype((*path, item.name), item)
                            index.setdefault(item.name, []).append(found)
                            if isinstance(item, Node):
                                inner.append((found.path, item.items))
                level = inner
        return index

    def fields_of(self, node: Node) -> tuple[Item, ...]:
        """The fields that a prototype hands on: those with a value, an arc to a value or to a group of values being such a field."""
        found: list[Item] = []
        for item in node.items:
            if isinstance(item, Field) and item.value is not None:
                found.append(item)
            elif isinstance(item, ArcItem) and (named := self.named(item)) is not None:
                found.append(named)
        return tuple(found)

    def named(self, arc: ArcItem) -> Item | None:
        """``limit -> joint_limit`` as the field or the group of fields that it leads to; None where it leads to neither."""
        role = role_of(arc)
        prototype = self.find(arc.ref.path) if role else None
        found = None if prototype is None else prototype.item
        if isinstance(found, Field) and found.value is not None and not isinstance(found.value, Ref):
            return Field(role, found.value, "", arc.line, arc.column)
        if isinstance(found, Node) and not found.edge and any(isinstance(item, Field) and item.value is not None for item in found.items):
            fields = tuple(item for item in found.items if isinstance(item, Field) and item.value is not None)
            return Node(role, fields, line=arc.line, column=arc.column)
        return None


def _is_within(path: tuple[str, ...], whole: tuple[str, ...]) -> bool:
    """Whether the steps of a path are steps of another one, in order."""
    steps = iter(whole)
    return all(step in steps for step in path)


def role_of(arc: ArcItem) -> str:
    """The role of an arc, which older texts write as its weight: ``["limit"] -> joint_limit``."""
    if arc.role or arc.weight is None or len(arc.weight) != 1 or not isinstance(arc.weight[0], str):
        return arc.role
    return arc.weight[0]
