"""Forms of the texts that the language's authors publish: arcs as fields, and values that are left open."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.language.prototypes import role_of
from hymeko_x.language.syntax import ArcItem, Field, Item, Node, Query, Value, is_list

if TYPE_CHECKING:
    from hymeko_x.language.prototypes import Prototypes

_FIELDS = frozenset({"limit", "color", "origin", "rpy"})
"""Roles of arcs that stand for a field: ``limit -> joint_limit``."""


def with_named_fields(node: Node, prototypes: Prototypes | None, *, inherits: bool) -> Node:
    """The node of a body or a joint with fields in the place of arcs that lead to values.

    One that ``inherits`` its fields from a vertex is without those that are left open there.
    """
    if prototypes is None or not any(map(_is_published, node.items)):
        return node
    found: list[Item] = []
    for item in node.items:
        if inherits and isinstance(item, Field) and _is_open(item.value):
            continue
        if isinstance(item, ArcItem):
            role = role_of(item)
            item = item if role == item.role else item._replace(role=role, weight=None)
            named = prototypes.named(item) if role in _FIELDS else None
            found.append(item if named is None else named)
        else:
            found.append(item)
    given = {item.name for item in found if isinstance(item, Field)}
    return node._replace(items=tuple(item for item in _last_ones(found) if not (isinstance(item, Node) and item.name in given & _FIELDS)))


def _is_published(item: Item) -> bool:
    if isinstance(item, Field):
        return _is_open(item.value)
    return isinstance(item, ArcItem) and (
        item.role in _FIELDS or (item.weight is not None and len(item.weight) == 1 and isinstance(item.weight[0], str))
    )


def _is_open(value: Value | None) -> bool:
    return isinstance(value, Query) or (is_list(value) and any(_is_open(part) for part in value if type(part) is not float))


def _last_ones(items: list[Item]) -> list[Item]:
    """The items with the last one of several groups of one name: an element's own limit follows that of its type."""
    last = {item.name: place for place, item in enumerate(items) if isinstance(item, Node) and item.name in _FIELDS}
    return [item for place, item in enumerate(items) if not (isinstance(item, Node) and item.name in last) or last[item.name] == place]
