"""HyMeKo text to mechanism: parse, expand, find out what each element is, and read it.

An element is what its type says. Untyped elements follow the root: in a ``robot`` nodes are bodies and edges are joints,
in a ``graph`` they are plain; in an untyped root they are what their place in the edges makes them (infer.py).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeGuard, cast

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, Refusal, refuse
from hymeko_x.formats.hymeko import ALIASES, ATTACHED, AXES, FOREIGN, NAMED_AFTER_ID, PARTS, SETTINGS, TARGETS
from hymeko_x.formats.hymeko.attached import TEXTURE, attached_edge, attached_key
from hymeko_x.frontends.hymeko.block import Block, Context, is_written, read_units, read_written, read_written_block
from hymeko_x.frontends.hymeko.bodies import build_uri, is_base_arc, read_body, read_fixed
from hymeko_x.frontends.hymeko.build import Build
from hymeko_x.frontends.hymeko.foreign import is_foreign, read_extra, read_foreign
from hymeko_x.frontends.hymeko.infer import infer_kinds
from hymeko_x.frontends.hymeko.joints import read_dofs, read_joint, read_limits, unit_axis
from hymeko_x.ir import parts
from hymeko_x.ir.graph import Arc
from hymeko_x.ir.mechanism import ROOT, WORLD, Extra, Id, Provenance
from hymeko_x.ir.notations import take_provenance
from hymeko_x.language.errors import with_excerpt
from hymeko_x.language.expansion import Element, Expanded, expand
from hymeko_x.language.foreign import SECTION_COMMENT
from hymeko_x.language.parser import parse
from hymeko_x.language.printer import print_item
from hymeko_x.language.syntax import ArcItem, Comment, Field, Node, QuotedName, Ref

if TYPE_CHECKING:
    from collections.abc import Container

    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism, RobotArc
    from hymeko_x.language.syntax import Item
    from hymeko_x.source import Source

MAX_BYTES = 2**28

_EDGE_KINDS = frozenset(TARGETS)
_WITH_SHAPES = frozenset({"body", "world"})  # read first: their shapes have no declaration of their own


def read(source: Source, report: Report) -> Mechanism:
    """The mechanism that a HyMeKo text describes.

    Raises: Refusal with the place in the text: HX060 syntax, HX061 types, HX062 values, HX063 templates, HX064 expressions,
    HX023 duplicate names, HX040 references, HX045 joints without ends; HX007 for a text that is too large.
    """
    if len(source.data) > MAX_BYTES:
        raise refuse(codes.TOO_LARGE, f"the text has {len(source.data)} bytes, at most {MAX_BYTES} are read", Origin(source.name))
    try:
        text = source.data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise refuse(codes.SYNTAX, f"byte {error.start} is not UTF-8", Origin(source.name)) from error

    def fetch(path: str) -> bytes | None:
        found = source.files.find(path)
        try:
            return None if found is None else source.files.read(found)
        except OSError:
            return None

    try:
        return build(expand(parse(text, source.name), source.name, fetch), source.name, report)
    except Refusal as refusal:
        raise with_excerpt(refusal, text, source.name) from refusal


def build(expanded: Expanded, file: str, report: Report) -> Mechanism:
    """The mechanism of an expanded text."""
    build = Build(_context(expanded, file, report))
    elements = [item for item in expanded.items if isinstance(item, Element) and not _is_about_the_whole(item.node)]
    kinds = infer_kinds(expanded, elements)
    _read_settings(build, expanded, kinds)
    build.source = take_provenance(build.notations, FOREIGN, Provenance("hymeko", file=file))
    declared = _declare(build, expanded, kinds)
    for key, element in sorted(declared, key=lambda pair: pair[0].kind not in _WITH_SHAPES):
        _read_element(build, key, element)
    if expanded.root and expanded.root != expanded.name:
        build.notations.setdefault(ROOT, {})["hymeko.root"] = expanded.root
    return build.build(expanded.name, build.source)


# ---- settings and statements of the root -------------------------------------------------------------------------------------


def _context(expanded: Expanded, file: str, report: Report) -> Context:
    context = Context(file, report)
    for item in expanded.items:
        if isinstance(item, Element) and _is_units(item.node):
            context.units = read_units(item.node, context)
    return context


def _is_units(node: Node) -> bool:
    return node.name == "units" and not isinstance(node.name, QuotedName) and not node.edge and not node.stereotypes


def _read_settings(build: Build, expanded: Expanded, kinds: list[str]) -> None:
    """Fields that stand in the root itself: the prefix of files, and what a format said about the whole mechanism."""
    place = 0
    remaining = iter(kinds)
    for item in expanded.items:
        if isinstance(item, Element) and _is_about_the_whole(item.node):
            place += _read_block(build, item.node, place)
        elif isinstance(item, Element):
            place += 1 + _has_attached(next(remaining), item.node)
        elif isinstance(item.item, Field):
            place += _read_setting(build, item.item, place)
        else:
            extra = _loose_extra(build, item.item, place, is_robot="robot" in expanded.types)
            _keep(build, extra)
            place += not extra.path
    for number, comment in enumerate(expanded.preceding):
        _keep(build, Extra("comment", "preceding", comment.text, number))
    for number, comment in enumerate(expanded.following):
        _keep(build, Extra("comment", "following", comment.text, number))


def _is_about_the_whole(node: Node) -> bool:
    return _is_units(node) or is_written(node) or (is_foreign(node) and not node.stereotypes)


def _read_block(build: Build, node: Node, place: int) -> int:
    """A block in the root: returns how many places it takes, which for that of a format are the elements in it."""
    if _is_units(node):
        return 0
    if is_written(node):
        build.notations.setdefault(ROOT, {}).update(read_written_block(node, build.context))
        return 0
    found = read_foreign(node, build.context, at_root=True, place=place)
    for extra in found:
        _keep(build, extra)
    return sum(not extra.path for extra in found)


def _keep(build: Build, extra: Extra) -> None:
    build.add_extras(ROOT, extra)


def _loose_extra(build: Build, item: ArcItem | Comment, place: int, *, is_robot: bool) -> Extra:
    """A comment, or an arc that stands in no edge (as in graphs of the published examples), as it is.

    Raises: Refusal (HX062) for such an arc in a robot, where it is a mistake.
    """
    if isinstance(item, Comment):
        section = SECTION_COMMENT.fullmatch(item.text)
        return Extra("comment", section[1], section[2], place) if section else Extra("comment", "", item.text, place)
    message = f"the arc to '{item.ref.dotted}' stands in no edge"
    hint = f"as one name it is written in backticks: `{item.role}{item.ref.direction}{item.ref.dotted}`" if item.role else ""
    if is_robot:
        raise build.context.refuse(item, message, hint=hint)
    build.context.report.warn(codes.UNKNOWN_TYPE, f"{message}; it is kept as it is", build.context.origin(item), hint=hint)
    return Extra("hymeko", "", print_item(item), place)


def _is_setting(field: Field) -> bool:
    """Whether a field of the root says something about the whole; any other one is a vertex."""
    return field.name in SETTINGS and not isinstance(field.name, QuotedName)


def _read_setting(build: Build, field: Field, place: int) -> int:
    """Read one; returns how many places at top level it takes."""
    if not _is_setting(field):
        return 1
    if field.name == "files":
        build.files = build.context.text(field.value, field)
    elif field.name == "written":
        build.notations.setdefault(ROOT, {}).update(read_written(field, build.context))
    elif field.name in FOREIGN or field.name == "extra":
        extra = read_extra(field, build.context)
        _keep(build, extra if extra.path else replace(extra, index=place))
        return 0 if extra.path else 1
    return 0


def _read_loose(build: Build, field: Field) -> None:
    """A field of the root that is none of the settings: a vertex of its own when it is bare, else data of the root."""
    if field.value is None:
        key = build.reserve("datum", field.name, field)
        build.vertices[key] = parts.Datum()
        build.layout.append(key)
        return
    value = build.context.parameter(field)
    key = build.reserve("datum", field.name, field)
    build.vertices[key] = parts.Datum((("value", value),))
    build.layout.append(key)


# ---- elements ----------------------------------------------------------------------------------------------------------------


def _declare(build: Build, expanded: Expanded, kinds: list[str]) -> list[tuple[Id, Element]]:
    """Every element's id, before anything is read, so that references may look ahead."""
    declared: list[tuple[Id, Element]] = []
    remaining = iter(kinds)
    for element in expanded.items:
        if not isinstance(element, Element):
            if isinstance(element.item, Field) and not _is_setting(element.item):
                _read_loose(build, element.item)
            continue
        if _is_about_the_whole(element.node):
            continue
        kind = next(remaining)
        if kind == "axis":
            build.directions[element.name] = _direction(build, element)
            continue
        if kind == "world":
            build.vertices[WORLD] = parts.World()
            build.layout.append(WORLD)
            declared.append((WORLD, element))
            continue
        key = build.declare(kind, element)
        declared.append((key, element))
        _declare_attached(build, key, element)
        if kind == "body" and _has_attached(kind, element.node):
            declared.append((Id("joint", key.name), element))
    return declared


def _declare_attached(build: Build, key: Id, element: Element) -> None:
    """The edge that the arcs in a vertex's block stand for takes the place behind it."""
    edge = attached_key(key)
    if edge is not None and _has_attached(key.kind, element.node):
        build.layout.append(build.reserve(*edge, element.node))


def _has_attached(kind: str, node: Node) -> bool:
    """Whether a vertex's block says the edge that puts it to use."""
    if kind == "body":
        return any(map(is_base_arc, node.items))
    return kind in ATTACHED and any(isinstance(item, ArcItem) or _is_texture(kind, item) for item in node.items)


def _is_texture(kind: str, item: Item) -> bool:
    return kind == "material" and _is_field(item, (TEXTURE,))


def _direction(build: Build, element: Element) -> tuple[float, float, float]:
    block = Block(element.node.items, build.context)
    item = block.take("direction", "axis", "ax")
    if item is not None:
        return unit_axis(build, item)[0]
    if element.name not in AXES:
        raise build.context.refuse(element.node, f"axis '{element.name}' needs 'direction': only {', '.join(AXES)} have one by their name")
    return AXES[element.name]


def _read_element(build: Build, key: Id, element: Element) -> None:
    if key.kind in ("body", "world"):
        read_body(build, key, _without(element, "kind"))
    elif key.kind == "joint" and not element.node.edge and _preset(element, "kind") != "joint":
        read_fixed(build, key, element)
    elif key.kind == "joint":
        moves = _preset(element, "moves")
        read_joint(build, key, element, moves)
    elif key.kind == "shape":
        raise build.context.refuse(element.node, "a shape stands in the block of its body")
    else:
        _read_part(build, key, element)


def _is_field(item: Item, names: Container[str]) -> TypeGuard[Field]:
    """Whether it is a field of one of these names, unquoted."""
    return isinstance(item, Field) and item.name in names and not isinstance(item.name, QuotedName)


def _preset(element: Element, name: str) -> str | None:
    for item in element.node.items:
        if _is_field(item, (name,)) and isinstance(item.value, str):
            return str(item.value)
    return None


def _without(element: Element, name: str) -> Element:
    items = tuple(item for item in element.node.items if not _is_field(item, (name,)))
    return element._replace(node=element.node._replace(items=items))


def _read_part(build: Build, key: Id, element: Element) -> None:
    """A vertex or edge that its words describe completely (formats/hymeko.py)."""
    words = PARTS[key.kind]
    arcs = _attached_arcs(build, key, element)
    block = Block(_renamed(element.node.items, key.kind), build.context, open=words.open)
    block.take("kind")
    values = block.take_words(words.words)
    if key.kind in NAMED_AFTER_ID:
        if not block.unnamed:
            values.setdefault("name", key.name)
        block.unnamed = False
    if isinstance(uri := values.get("uri"), str):
        values["uri"] = build_uri(build, uri)
    if key.kind == "tendon":
        values["limits"] = read_limits(block, "length")
    if key.kind == "loop":
        values["dofs"] = read_dofs(build, block, element.scope)
    if words.open:
        values["parameters"] = (*block.take_rest(build.context.parameter), *_nested_parameters(build, block))
    try:
        part = words.part(**values)
    except TypeError as error:
        missing = ", ".join(f"'{word.word}'" for word in words.words if word.attribute not in values)
        raise build.context.refuse(element.node, f"{key} needs {missing}") from error
    if key.kind in _EDGE_KINDS:
        arcs = tuple(_arc(build, key, arc, element) for arc in block.arcs)
        block.arcs = []
        build.add_edge(key, part, arcs)
    else:
        build.vertices[key] = part
        edge = attached_key(key)
        if arcs and edge is not None:
            build.edges[edge] = attached_edge(key, arcs)
            block.arcs = []
            block.take(TEXTURE)
    block.rest(str(key))
    build.keep(key, block)


def _attached_arcs(build: Build, key: Id, element: Element) -> tuple[RobotArc, ...]:
    """The arcs in a vertex's block, of the edge that puts it to use."""
    edge = attached_key(key)
    if edge is None:
        return ()
    found: list[RobotArc] = []
    for item in element.node.items:
        if isinstance(item, ArcItem):
            found.append(build.arc(edge.kind, item, element.scope))
        elif _is_texture(key.kind, item) and isinstance(item, Field):
            if not isinstance(item.value, Ref):
                raise build.context.refuse(item, "'texture' takes a reference: texture=grid")
            found.append(Arc(build.target(item.value, element.scope, ("texture",), item), 1))
    return tuple(found)


def _arc(build: Build, key: Id, item: object, element: Element) -> RobotArc:
    return build.arc(key.kind, cast("ArcItem", item), element.scope)


def _renamed(items: tuple[Item, ...], kind: str) -> tuple[Item, ...]:
    """The items with published synonyms of fields replaced by our words."""
    aliases = ALIASES.get(kind)
    if not aliases:
        return items
    return tuple(item._replace(name=aliases[item.name]) if _is_field(item, aliases) else item for item in items)


def _nested_parameters(build: Build, block: Block) -> list[tuple[str, float | str | tuple[float, ...]]]:
    """Fields of nested nodes as parameters with dotted names; arcs of a vertex are left to be reported."""
    found: list[tuple[str, float | str | tuple[float, ...]]] = []
    stack = [(node.name, node) for node in reversed(block.nodes)]
    block.nodes = []
    while stack:
        path, node = stack.pop()
        for item in node.items:
            if isinstance(item, Field):
                found.append((f"{path}.{item.name}", build.context.parameter(item)))
            elif isinstance(item, Node):
                stack.append((f"{path}.{item.name}", item))
    return found
