"""References to values: ``r=a.v`` and ``r -> a.v`` have the value of the field ``v`` of the element ``a``, and so has a weight ``[a.v]``.

What leads to an element instead is a relation: ``r -> a`` in the block of ``b`` is ``@r { + b - a }`` there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.hymeko.nesting import OUTER, nest_edge, nest_key, prefix_of
from hymeko_x.ir import parts
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.language.expansion import ExpandedElement, Statement
from hymeko_x.language.syntax import ArcItem, Field, Node, Ref, is_list

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.frontends.hymeko.builder import HymekoBuilder
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.language.expansion import Expansion, Scope
    from hymeko_x.language.syntax import Item, Value

_Declared = list[tuple["Id", ExpandedElement]]


class _Holder(NamedTuple):
    """A field that holds a value, its full name, and where its own references are looked up."""

    name: str
    field: Field
    scope: Scope


def resolve_values(builder: HymekoBuilder, declared: _Declared, items: Iterable[Expansion]) -> _Declared:
    """The elements with the values that their references mean. References to elements in data become relations of the builder.

    Raises: Refusal (HX067) for values that lead back to themselves, HX040 for references of data that lead nowhere.
    """
    if not any(_has_references(key, element.node.items) for key, element in declared):
        return declared
    resolver = _Resolver(builder, declared, items)
    return [(key, resolver.resolved(key, element)) for key, element in declared]


def _has_references(key: Id, items: Iterable[Item]) -> bool:
    """Whether there is a reference that may mean a value."""
    for item in items:
        if isinstance(item, Field):
            if _may_refer(item.value):
                return True
        elif isinstance(item, ArcItem):
            if _may_refer(item.weight) or (item.role and key.kind == "datum"):
                return True
        elif isinstance(item, Node) and _has_references(key, item.items):
            return True
    return False


def _may_refer(value: Value | None) -> bool:
    if isinstance(value, Ref):
        return len(value.path) > 1
    return is_list(value) and any(isinstance(part, Ref) or _may_refer(part) for part in value if type(part) is not float)


class _Resolver:
    """The fields of all elements, by the name of the element."""

    def __init__(self, builder: HymekoBuilder, declared: _Declared, items: Iterable[Expansion]) -> None:
        self._builder = builder
        self._fields: dict[str, dict[str, _Holder]] = {}
        self._roots: dict[str, _Holder] = {}
        for key, element in declared:
            found = self._fields.setdefault(element.name, {})
            inner = element.scope.scopes.get(element.node.name, element.scope) if key.kind in OUTER else element.scope
            for item in element.node.items:
                if isinstance(item, Field) and item.value is not None:
                    found.setdefault(item.name, _Holder(f"{element.name}.{item.name}", item, inner))
        for statement in items:
            field = statement.item if isinstance(statement, Statement) else None
            if isinstance(statement, Statement) and isinstance(field, Field) and field.value is not None:
                self._roots[field.name] = _Holder(field.name, field, statement.scope)

    def resolved(self, key: Id, element: ExpandedElement) -> ExpandedElement:
        """The element with values in the place of references."""
        scope = element.scope.scopes.get(element.node.name, element.scope) if key.kind in OUTER else element.scope
        items = self._items(key, element.node.items, scope)
        return element if items is element.node.items else element._replace(node=element.node._replace(items=items))

    def _items(self, key: Id, items: tuple[Item, ...], scope: Scope) -> tuple[Item, ...]:
        if not _has_references(key, items):
            return items
        found = (self._item(key, item, scope) for item in items)
        return tuple(item for item in found if item is not None)

    def _item(self, key: Id, item: Item, scope: Scope) -> Item | None:
        """The item with values; None for one that is a relation of the builder."""
        match item:
            case Field(value=Ref() as ref) if len(ref.path) > 1:
                return self._reference(key, item, ref, scope)
            case ArcItem(role=role, weight=None) if role and key.kind == "datum" and not item.items:
                return self._reference(key, item, item.ref, scope)
            case Field(value=tuple() as value) if _may_refer(value):
                return item._replace(value=self._value(value, scope, item, ()))
            case ArcItem(weight=tuple() as weight) if _may_refer(weight):
                found = tuple([self._value(part, scope, item, ()) for part in weight])
                return item._replace(weight=found[0] if len(found) == 1 and is_list(found[0]) else found)
            case Node():
                return item._replace(items=self._items(key, item.items, scope))
        return item

    def _reference(self, key: Id, item: Field | ArcItem, ref: Ref, scope: Scope) -> Item | None:
        """A field with the value that it refers to; of plain data, where that is an element, a relation inside of it."""
        name = item.name if isinstance(item, Field) else item.role
        holder = self._find(ref, scope)
        if holder is not None:
            return Field(name, self._content(holder, item, ref, ()), "", item.line, item.column)
        if key.kind not in OUTER:
            return item
        target = self._builder.target(ref, scope, (), item)
        builder = self._builder
        edge = builder.reserve("relation", prefix_of(key) + name, item)
        builder.edges[edge] = Edge(parts.Relation(), (Arc(key, 1), Arc(target, -1)))
        nest = nest_key(key)
        inner = [arc.target for arc in builder.edges[nest].arcs[1:]] if nest in builder.edges else []
        if not inner:
            builder.reserve(nest.kind, nest.name, item)
        builder.edges[nest] = nest_edge(key, [*inner, edge])
        return None

    def _value(self, value: Value, scope: Scope, item: Field | ArcItem, active: tuple[str, ...]) -> Value:
        """A list with the values that the references in it mean."""
        if isinstance(value, Ref):
            holder = self._find(value, scope)
            if holder is None:
                hint = self._builder.near(value.path[-1], ())
                message = f"'{value.dotted}' is no value; expected a field, such as element.field"
                raise refuse(codes.UNDEFINED_REFERENCE, message, self._builder.reader.origin(item), hint=hint)
            return self._content(holder, item, value, active)
        if is_list(value):
            return tuple([part if type(part) is float else self._value(part, scope, item, active) for part in value])
        return value

    def _content(self, holder: _Holder, item: Field | ArcItem, ref: Ref, active: tuple[str, ...]) -> Value:
        """The value of a field, with those that it refers to. Raises: Refusal (HX067) when that leads back."""
        name = holder.name
        if name in active:
            way = " -> ".join([*active[active.index(name) :], name])
            message, hint = f"the value of '{name}' leads back to itself: {way}", "give one of them a value"
            raise refuse(codes.CIRCULAR_VALUE, message, self._builder.reader.origin(item), hint=hint)
        value = holder.field.value
        assert value is not None
        if isinstance(value, Ref) and len(value.path) == 1 and not value.direction:
            return value  # a word
        return self._value(value, holder.scope, holder.field, (*active, name)) if isinstance(value, Ref) or _may_refer(value) else value

    def _find(self, ref: Ref, scope: Scope) -> _Holder | None:
        """The field behind a path: of an element, of a block around, or of the root."""
        *way, last = ref.path
        if way:
            for name in (*scope.meanings(tuple(way)), ".".join(way)):
                if last in self._fields.get(name, ()):
                    return self._fields[name][last]
        else:
            here: Scope | None = scope
            while here is not None:
                found = self._fields.get(here.prefix.removesuffix("."), {}).get(last)
                if found is not None and here.prefix:
                    return found
                here = here.parent
        return next((self._roots[name] for name in (*scope.meanings(ref.path), ".".join(ref.path)) if name in self._roots), None)
