"""Nested graphs: the vertices and edges in the blocks of data and relations, and the edges that tell what stands where."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.hymeko.nesting import BLOCK_SETTINGS, OUTER, nest_edge, nest_key, prefix_of
from hymeko_x.frontends.hymeko.block import is_written
from hymeko_x.frontends.hymeko.kinds import typed_kind
from hymeko_x.language.expansion import Expanded, ExpandedElement, Scope, Statement
from hymeko_x.language.machine import MAX_DEPTH
from hymeko_x.language.markup import is_foreign
from hymeko_x.language.syntax import Field, Node, QuotedName

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Refusal
    from hymeko_x.frontends.hymeko.builder import HymekoBuilder
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.language.expansion import Expansion
    from hymeko_x.language.syntax import Item


def declare_inside(builder: HymekoBuilder, expanded: Expanded, key: Id, element: ExpandedElement) -> list[tuple[Id, ExpandedElement]]:
    """The element without what stands inside of it, and all of that, with their ids; the edges that tell so are added.

    Raises: Refusal (HX062) for anything inside of data that is no data.
    """
    found: list[tuple[Id, ExpandedElement]] = []
    stack = [(key, element, 0)]
    while stack:
        outer, element, depth = stack.pop()
        if depth > MAX_DEPTH:
            raise _endless(builder, element)
        items = [item for item in element.node.items if _is_inside(outer, item)]
        if not items:
            found.append((outer, element))
            continue
        own = tuple(item for item in element.node.items if not _is_inside(outer, item))
        found.append((outer, element._replace(node=element.node._replace(items=own))))
        scope = element.scope.scopes.setdefault(element.node.name, Scope(prefix_of(outer), element.scope))
        inner = [_inner(builder, expanded, item, scope) for item in expanded.inside(items, scope)]
        nest = nest_key(outer)
        builder.reserve(nest.kind, nest.name, element.node)
        keys = [builder.reserve(kind, found.name, found.node) for kind, found in inner]
        builder.edges[nest] = nest_edge(outer, keys)
        stack.extend(reversed([(key, element, depth + 1) for key, (_, element) in zip(keys, inner, strict=True)]))
    return found


def _endless(builder: HymekoBuilder, element: ExpandedElement) -> Refusal:
    message = f"'{element.node.name}' is nested more than {MAX_DEPTH} levels deep"
    origin = builder.reader.origin(element.node)
    return refuse(codes.BAD_TEMPLATE, message, origin, hint="a block that holds a copy of itself never ends")


def _is_inside(outer: Id, item: Item) -> bool:
    """Whether an item of a block is an element inside of it: a node, and in that of a vertex a name alone."""
    if isinstance(item, Node):
        return not is_foreign(item) and not is_written(item)
    if outer.kind != "datum" or not isinstance(item, Field) or item.value is not None or item.type:
        return False
    return isinstance(item.name, QuotedName) or item.name not in BLOCK_SETTINGS


def _inner(builder: HymekoBuilder, expanded: Expanded, item: Expansion, scope: Scope) -> tuple[str, ExpandedElement]:
    """The kind of an element inside of data, and the element."""
    if isinstance(item, Statement) and isinstance(item.item, Field):
        field = item.item
        scope.elements.add(field.name)
        return "datum", ExpandedElement(scope.full(field.name), Node(field.name, line=field.line, column=field.column), (), scope)
    if not isinstance(item, ExpandedElement):
        node = item.item if isinstance(item, Statement) else item.node
        raise builder.reader.refuse(node, "data holds data and relations, no robots of other files")
    kind = "" if item.has_prototype else typed_kind(item)
    if kind == "joint" and "graph" in expanded.types:
        kind = "relation"
    kind = kind or ("relation" if item.node.edge else "datum")
    if kind not in OUTER:
        hint = "it stands in the root, or in an assembly"
        raise builder.reader.refuse(item.node, f"'{item.node.name}' is a {kind}, and data holds data and relations", hint=hint)
    return kind, item
