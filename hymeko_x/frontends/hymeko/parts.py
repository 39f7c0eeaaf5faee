"""Vertices and edges that their fields represent completely: everything but bodies, shapes and joints (formats/hymeko)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from msgspec.structs import fields

from hymeko_x.formats.hymeko import ALIASES, ATTACHED, LUMPED_UNITS, NAMED_AFTER_ID, PARTS, TARGETS, TEXTURE, attached_edge, attached_key
from hymeko_x.formats.hymeko.nesting import OUTER
from hymeko_x.formats.hymeko.references import attached_kinds
from hymeko_x.frontends.hymeko.block import Block
from hymeko_x.frontends.hymeko.joints import read_dofs, read_limits
from hymeko_x.frontends.hymeko.lumped import set_domain
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.language.syntax import ArcItem, Field, Node, Ref, is_field

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.frontends.hymeko.builder import HymekoBuilder
    from hymeko_x.frontends.hymeko.values import ParameterValue
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.ir.parts import DataValue
    from hymeko_x.language.expansion import ExpandedElement
    from hymeko_x.language.syntax import Item


def read_part(builder: HymekoBuilder, key: Id, element: ExpandedElement) -> None:
    """Add a vertex or an edge, and the edge whose arcs stand in a vertex's block.

    Raises: Refusal (HX062) for a part without a field that it needs, HX040 for references.
    """
    words = PARTS[key.kind]
    block = Block(_renamed(element.node.items, key.kind), builder.reader, open=words.open)
    block.take("kind")
    values = block.take_words(words.words)
    attached = _attached_arcs(builder, key, element, str(values.get("kind", "")))
    if key.kind in NAMED_AFTER_ID:
        if not block.unnamed:
            values.setdefault("name", key.name)
        block.unnamed = False
    if isinstance(uri := values.get("uri"), str):
        values["uri"] = builder.full_uri(uri)
    if key.kind == "tendon":
        values["limits"] = read_limits(block, "length")
    if key.kind == "loop":
        values["dofs"] = read_dofs(builder, block, element.scope)
        values.setdefault("kind", "joint" if values["dofs"] else "connect")
    if key.kind in LUMPED_UNITS:
        set_domain(builder, key.kind, element, values)
    if words.open:
        values["parameters"] = _parameters(builder, key.kind, block)
    part = _made(builder, key, element, values)
    if key.kind in TARGETS:
        builder.edges[key] = Edge(part, tuple(builder.arc(key.kind, arc, element.scope) for arc in block.arcs))
        block.arcs = []
    else:
        builder.vertices[key] = part
        edge = attached_key(key)
        if attached and edge is not None:
            builder.edges[edge] = attached_edge(key, attached)
            block.arcs = []
            block.take(TEXTURE)
    block.rest(str(key))
    builder.keep(key, block)


def _parameters(builder: HymekoBuilder, kind: str, block: Block) -> tuple[tuple[str, DataValue], ...]:
    """The parameters in an open block: those of plain data have values of any shape, all others are flat."""
    if kind in OUTER:
        return tuple((name, value) for name, value in block.take_rest(builder.reader.datum))
    return (*block.take_rest(builder.reader.parameter), *_nested_parameters(builder, block))


def _made(builder: HymekoBuilder, key: Id, element: ExpandedElement, values: Mapping[str, Any]) -> Any:
    """The part of these values. Raises: Refusal (HX062) when it needs others."""
    words = PARTS[key.kind]
    try:
        return words.part(**values)
    except TypeError as error:
        required = {found.name for found in fields(words.part) if found.required}
        missing = ", ".join(f"'{word.word}'" for word in words.words if word.attribute in required - values.keys())
        raise builder.reader.refuse(element.node, f"{key} needs {missing}") from error


def _renamed(items: tuple[Item, ...], kind: str) -> tuple[Item, ...]:
    """The items with published synonyms of fields replaced by our words."""
    aliases = ALIASES.get(kind)
    if not aliases:
        return items
    return tuple(item._replace(name=aliases[item.name]) if is_field(item, aliases) else item for item in items)


def _nested_parameters(builder: HymekoBuilder, block: Block) -> list[tuple[str, ParameterValue]]:
    """Fields of nested nodes as parameters with dotted names; nested vertices and edges, which are more, are left to be reported."""
    found: list[tuple[str, ParameterValue]] = []
    stack = [(node.name, node) for node in reversed(block.nodes) if _has_only_fields(node)]
    block.nodes = [node for node in block.nodes if not _has_only_fields(node)]
    while stack:
        path, node = stack.pop()
        for item in node.items:
            if isinstance(item, Field):
                found.append((f"{path}.{item.name}", builder.reader.parameter(item)))
            elif isinstance(item, Node):
                stack.append((f"{path}.{item.name}", item))
    return found


def _has_only_fields(node: Node) -> bool:
    """Whether a node is nothing but a group of fields, and of such groups."""
    stack = [node]
    while stack:
        group = stack.pop()
        if group.edge or group.stereotypes or not group.items or not all(isinstance(item, Field | Node) for item in group.items):
            return False
        stack.extend(item for item in group.items if isinstance(item, Node))
    return True


def has_attached(kind: str, node: Node) -> bool:
    """Whether the block of a vertex, which is no body, holds the arcs of the edge that attaches it."""
    return kind in ATTACHED and any(isinstance(item, ArcItem) or _is_texture(kind, item) for item in node.items)


def _is_texture(kind: str, item: Item) -> bool:
    return kind == "material" and is_field(item, (TEXTURE,))


def _attached_arcs(builder: HymekoBuilder, key: Id, element: ExpandedElement, type: str) -> tuple[RobotArc, ...]:
    """The arcs in the block of a vertex, of this type where its kind has types."""
    edge = attached_key(key)
    arcs: list[RobotArc] = []
    if edge is None:
        return ()
    for item in element.node.items:
        if isinstance(item, ArcItem):
            arcs.append(builder.arc(edge.kind, item, element.scope, attached_kinds(key.kind, type)))
        elif _is_texture(key.kind, item) and isinstance(item, Field):
            if not isinstance(item.value, Ref):
                raise builder.reader.refuse(item, "'texture' takes a reference: texture=grid")
            arcs.append(Arc(builder.target(item.value, element.scope, ("texture",), item), 1))
    return tuple(arcs)
