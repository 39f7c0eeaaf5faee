"""HyMeKo text to mechanism: parse, expand, infer the kind of each element, and read it.

The kind of an element is given by its type. Untyped elements follow the root: in a ``robot`` nodes are bodies and edges are
joints, in a ``graph`` they are plain; in an untyped root their kind follows from their place in the edges (kinds.py).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, Refusal, refuse
from hymeko_x.formats.hymeko import AXES, FOREIGN, RESERVED, ROOT_NAME, SETTINGS, attached_key
from hymeko_x.formats.hymeko.nesting import OUTER
from hymeko_x.frontends.hymeko.block import Block, is_written, read_written, read_written_block
from hymeko_x.frontends.hymeko.bodies import is_base_arc, read_body, read_fixed
from hymeko_x.frontends.hymeko.builder import HymekoBuilder, without_implied
from hymeko_x.frontends.hymeko.changes import change_element
from hymeko_x.frontends.hymeko.comments import standing_comment, with_all_comments
from hymeko_x.frontends.hymeko.extras import read_extra, read_foreign, with_namespaces
from hymeko_x.frontends.hymeko.heritage import with_heritage
from hymeko_x.frontends.hymeko.implied import imply_actuators
from hymeko_x.frontends.hymeko.instances import changes_in, declare_instance, frames_on_bodies, place_instance, read_instances
from hymeko_x.frontends.hymeko.joints import read_joint, unit_axis
from hymeko_x.frontends.hymeko.kinds import infer_kinds
from hymeko_x.frontends.hymeko.lumped import remove_folded
from hymeko_x.frontends.hymeko.nesting import declare_inside
from hymeko_x.frontends.hymeko.parts import has_attached, read_part
from hymeko_x.frontends.hymeko.published import with_named_fields
from hymeko_x.frontends.hymeko.references import resolve_values
from hymeko_x.frontends.hymeko.sharing import with_followers
from hymeko_x.frontends.hymeko.values import ValueReader, read_digits, read_units
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import ROOT, WORLD, Extra, Id, Provenance
from hymeko_x.ir.provenance import take_provenance
from hymeko_x.language.classes import with_classes
from hymeko_x.language.comments import comments_in, without_comments
from hymeko_x.language.errors import with_excerpt
from hymeko_x.language.expansion import Amendment, Expanded, ExpandedElement, Instance, Statement, expand
from hymeko_x.language.markup import is_foreign
from hymeko_x.language.parser import parse
from hymeko_x.language.printer import print_item
from hymeko_x.language.syntax import Comment, Field, QuotedName, is_field
from hymeko_x.language.templates import decode, standard_templates
from hymeko_x.source import Reading

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.frontends.hymeko.instances import Imported
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.language.syntax import ArcItem, Node
    from hymeko_x.source import Source

MAX_BYTES = 2**28

_WITH_SHAPES = frozenset({"body", "world"})
_FIRST = _WITH_SHAPES | {"spring", "damper"}  # shapes have no declaration of their own, and joints take up springs and dampers


def read(source: Source, report: Report) -> Reading:
    """The mechanism that a HyMeKo text describes.

    Raises: Refusal with the place in the text: HX060 syntax, HX061 types, HX062 values, HX063 templates, HX064 expressions, HX067 values
    in a circle, HX023 duplicate names, HX040 references, HX045 joints without ends; HX007 for a text that is too large.
    """
    if len(source.data) > MAX_BYTES:
        raise refuse(codes.TOO_LARGE, f"the text has {len(source.data)} bytes, at most {MAX_BYTES} are read", Origin(source.name))
    text = decode(source.data, source.name)

    def fetch(path: str) -> bytes | None:
        found = source.files.find(path)
        try:
            return None if found is None else source.files.read(found)
        except OSError:
            return None

    try:
        document = parse(text, source.name)
        expanded = expand(with_classes(document, {*standard_templates(), *RESERVED}), source.name, fetch)
        builder = HymekoBuilder(reader=ValueReader(source.name, report), prototypes=expanded.prototypes, root=expanded.root)
        found = _read_expanded(expanded, builder, read_instances(builder, expanded, source.parts))
        return Reading(with_all_comments(found, document))
    except Refusal as refusal:
        raise with_excerpt(refusal, text, source.name) from refusal


def _read_expanded(expanded: Expanded, builder: HymekoBuilder, instances: dict[int, Imported]) -> Mechanism:
    elements = [item for item in expanded.items if isinstance(item, ExpandedElement)]
    for element in elements:
        if _is_units(element.node):
            builder.reader.units = read_units(element.node, builder.reader)
            builder.reader.digits = read_digits(element.node, builder.reader)
    elements = [element for element in elements if not _is_about_the_whole(element.node)]
    kinds = infer_kinds(expanded, elements)
    if kinds and OUTER.issuperset(kinds) and "robot" not in expanded.types:
        expanded, elements = _as_graph(expanded)
        kinds = infer_kinds(expanded, elements)
    expanded, kinds = with_followers(expanded, elements, kinds, builder.reader)
    _read_root(builder, expanded, kinds, instances)
    builder.source = take_provenance(builder.notations, FOREIGN, Provenance("hymeko", file=builder.reader.file))
    declared = _declare(builder, expanded, kinds, instances)
    imply_actuators(builder, declared)
    declared = resolve_values(builder, declared, expanded.items)
    for key, element in sorted(declared, key=lambda pair: pair[0].kind not in _FIRST):
        _read_element(builder, key, element)
    remove_folded(builder)
    _place_instances(builder, expanded, instances)
    if expanded.root and expanded.root != expanded.name:
        builder.note(ROOT, ROOT_NAME, expanded.root)
    found = with_namespaces(without_implied(builder.build(expanded.name, builder.source), builder.implied))
    if not instances:
        return found
    return with_heritage(replace(found, places=builder.places, stored=builder.stored), tuple(instances.values()))


def _as_graph(expanded: Expanded) -> tuple[Expanded, list[ExpandedElement]]:
    """The text of a graph and its elements, with units as a vertex like any other: the numbers of plain data have none."""
    items = tuple(_datum(item) if isinstance(item, ExpandedElement) and _is_units(item.node) else item for item in expanded.items)
    elements = [item for item in items if isinstance(item, ExpandedElement) and not _is_about_the_whole(item.node)]
    return expanded._replace(items=items, types=("graph", *expanded.types)), elements


def _datum(element: ExpandedElement) -> ExpandedElement:
    """An element as a vertex of data, whatever its name and its fields mean elsewhere."""
    node = element.node._replace(name=QuotedName(element.node.name), items=(Field("kind", "datum"), *element.node.items))
    return element._replace(node=node, types=("datum",))


def _place_instances(builder: HymekoBuilder, expanded: Expanded, instances: dict[int, Imported]) -> None:
    """Apply the changes of elements of imported robots, and put the robots where they belong."""
    within = [change for imported in instances.values() for change in changes_in(imported)]
    for change in (*within, *(item for item in expanded.items if isinstance(item, Amendment))):
        change_element(builder, change)
    owners = frames_on_bodies(builder) if instances else {}
    for imported in instances.values():
        place_instance(builder, imported, owners)


def _read_element(builder: HymekoBuilder, key: Id, element: ExpandedElement) -> None:
    if key.kind in ("body", "joint"):
        element = element._replace(node=with_named_fields(element.node, builder.prototypes, inherits=element.has_prototype))
    if key.kind in _WITH_SHAPES:
        read_body(builder, key, element)
    elif key.kind == "joint" and not element.node.edge and _preset(element, "kind") != "joint":
        read_fixed(builder, key, element)
    elif key.kind == "joint":
        read_joint(builder, key, element, _preset(element, "moves"))
    elif key.kind == "shape":
        raise builder.reader.refuse(element.node, "a shape stands in the block of its body")
    else:
        read_part(builder, key, element)


def _preset(element: ExpandedElement, name: str) -> str | None:
    return next((str(item.value) for item in element.node.items if is_field(item, (name,)) and isinstance(item.value, str)), None)


def _read_root(builder: HymekoBuilder, expanded: Expanded, kinds: list[str], instances: dict[int, Imported]) -> None:
    """Settings in the root: the prefix of files, notations and extras of the whole, each extra with its place among the elements."""
    place = 0
    remaining = iter(kinds)
    for item in expanded.items:
        if isinstance(item, ExpandedElement) and _is_about_the_whole(item.node):
            node = item.node if is_foreign(item.node) else without_comments(item.node)
            for comment in () if node is item.node else comments_in(item.node.items):
                extra = standing_comment(comment, place)
                builder.add_extras(ROOT, extra)
                place += not extra.path
            place += _read_root_block(builder, node, place)
        elif isinstance(item, ExpandedElement):
            place += 1 + _has_attached(next(remaining), item.node)
        elif isinstance(item, Instance):
            place += len(instances[id(item)].robot.layout)
        elif isinstance(item, Amendment):
            continue
        elif isinstance(item.item, Field):
            place += _read_setting(builder, item.item, place)
        else:
            extra = _loose_extra(builder, item.item, place, is_robot="robot" in expanded.types)
            builder.add_extras(ROOT, extra)
            place += not extra.path
    for path, comments in (("preceding", expanded.preceding), ("following", expanded.following)):
        builder.add_extras(ROOT, *(Extra("comment", path, comment.text, number) for number, comment in enumerate(comments)))


def _is_units(node: Node) -> bool:
    return node.name == "units" and not isinstance(node.name, QuotedName) and not node.edge and not node.stereotypes


def _is_about_the_whole(node: Node) -> bool:
    return _is_units(node) or is_written(node) or (is_foreign(node) and not node.stereotypes)


def _read_root_block(builder: HymekoBuilder, node: Node, place: int) -> int:
    """Read a block of the root; returns how many places it takes, which for that of a format are the elements in it."""
    if _is_units(node):
        return 0
    if is_written(node):
        builder.notations.setdefault(ROOT, {}).update(read_written_block(node, builder.reader))
        return 0
    found = read_foreign(node, builder.reader, at_root=True, place=place)
    builder.add_extras(ROOT, *found)
    return sum(not extra.path for extra in found)


def _is_setting(field: Field) -> bool:
    """Whether a field of the root is about the whole; any other one is a vertex."""
    return is_field(field, SETTINGS)


def _read_setting(builder: HymekoBuilder, field: Field, place: int) -> int:
    """Read a field of the root; returns how many places it takes."""
    if not _is_setting(field):
        return 1
    if field.name == "files":
        builder.files = builder.reader.text(field.value, field)
    elif field.name == "written":
        builder.notations.setdefault(ROOT, {}).update(read_written(field, builder.reader))
    elif field.name in FOREIGN or field.name == "extra":
        extra = read_extra(field, builder.reader)
        builder.add_extras(ROOT, extra if extra.path else replace(extra, index=place))
        return not extra.path
    return 0


def _loose_extra(builder: HymekoBuilder, item: ArcItem | Comment, place: int, *, is_robot: bool) -> Extra:
    """A comment, or an arc that stands in no edge (as in graphs of the published examples), as it is.

    Raises: Refusal (HX062) for such an arc in a robot, where it is a mistake.
    """
    if isinstance(item, Comment):
        return standing_comment(item, place)
    reader = builder.reader
    message = f"the arc to '{item.ref.dotted}' stands in no edge"
    hint = f"as one name it is written in backticks: `{item.role}{item.ref.direction}{item.ref.dotted}`" if item.role else ""
    if is_robot:
        raise reader.refuse(item, message, hint=hint)
    reader.report.warn(codes.UNKNOWN_TYPE, f"{message}; it is kept as it is", reader.origin(item), hint=hint)
    return Extra("hymeko", "", print_item(item), place)


def _declare(
    builder: HymekoBuilder, expanded: Expanded, kinds: list[str], instances: dict[int, Imported]
) -> list[tuple[Id, ExpandedElement]]:
    """Every element's id, before anything is read, so that references may look ahead."""
    declared: list[tuple[Id, ExpandedElement]] = []
    remaining = iter(kinds)
    for element in expanded.items:
        if isinstance(element, Instance):
            declare_instance(builder, instances[id(element)])
        elif isinstance(element, Statement):
            if isinstance(element.item, Field) and not _is_setting(element.item):
                _read_datum(builder, element.item)
        elif isinstance(element, ExpandedElement) and not _is_about_the_whole(element.node):
            declared += _declared(builder, expanded, element, next(remaining))
    return declared


def _declared(builder: HymekoBuilder, expanded: Expanded, element: ExpandedElement, kind: str) -> list[tuple[Id, ExpandedElement]]:
    """The ids of an element: its own, behind that of a fixed body the one of its joint, behind that of data those inside of it."""
    if kind == "axis":
        builder.directions[element.name] = _direction(builder, element)
        return []
    if kind == "world":
        builder.vertices[WORLD] = parts.World()
        builder.layout.append(WORLD)
        return [(WORLD, element)]
    key = builder.declare(kind, element)
    if kind in OUTER:
        return declare_inside(builder, expanded, key, element)
    edge = attached_key(key)
    if edge is None or not _has_attached(kind, element.node):
        return [(key, element)]
    builder.layout.append(builder.reserve(*edge, element.node))
    return [(key, element), *([(edge, element)] if kind == "body" else [])]


def _has_attached(kind: str, node: Node) -> bool:
    """Whether a vertex's block holds the arcs of the edge that attaches it."""
    return any(map(is_base_arc, node.items)) if kind == "body" else has_attached(kind, node)


def _read_datum(builder: HymekoBuilder, field: Field) -> None:
    """A field of the root that is no setting: a vertex of its own, with the field's value if there is one."""
    key = builder.reserve("datum", field.name, field)
    builder.vertices[key] = parts.Datum() if field.value is None else parts.Datum((("value", builder.reader.parameter(field)),))
    builder.layout.append(key)


def _direction(builder: HymekoBuilder, element: ExpandedElement) -> tuple[float, float, float]:
    item = Block(element.node.items, builder.reader).take("direction", "axis", "ax")
    if item is not None:
        return unit_axis(builder, item)[0]
    if element.name not in AXES:
        message = f"axis '{element.name}' needs 'direction': only {', '.join(AXES)} have one by their name"
        raise builder.reader.refuse(element.node, message)
    return AXES[element.name]
