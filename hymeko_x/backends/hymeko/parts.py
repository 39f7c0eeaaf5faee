"""Vertices and edges that their fields represent completely: everything but bodies, shapes and joints (formats/hymeko)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import NODEFAULT

from hymeko_x.backends.hymeko.sheet import defaults_of
from hymeko_x.backends.hymeko.values import value_of
from hymeko_x.formats.hymeko import (
    ATTACHED,
    LIMIT_WORDS,
    NAMED_AFTER_ID,
    PARTS,
    TEXTURE,
    FieldWord,
    attached_edge,
    attached_key,
)
from hymeko_x.formats.hymeko.nesting import BLOCK_SETTINGS
from hymeko_x.formats.hymeko.references import attached_kinds
from hymeko_x.ir import parts
from hymeko_x.ir.graph import Arc
from hymeko_x.language.syntax import Field, Item, QuotedName

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from hymeko_x.backends.hymeko.sheet import HymekoSheet
    from hymeko_x.backends.hymeko.values import Angles
    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc

_SPANS = frozenset({"limit", "limits", "range"}) | {word.word for word in LIMIT_WORDS}


def part_items(sheet: HymekoSheet, key: Id, part: parts.VertexPart | parts.EdgePart, arcs: tuple[RobotArc, ...]) -> list[Item]:
    """The block of an element that its words describe completely."""
    words = PARTS[key.kind]
    items: list[Item] = [sheet.arc(key.kind, arc) for arc in arcs] or _attached_items(sheet, key, part)
    fields = word_fields(part, words.words, sheet.angles)
    if isinstance(part, parts.Mesh | parts.Texture) and part.uri is not None:
        fields = [item._replace(value=sheet.short_uri(part.uri)) if item.name == "file" else item for item in fields]
    items.extend(_named(fields, key) if key.kind in NAMED_AFTER_ID else fields)
    if isinstance(part, parts.Tendon):
        items.extend(limit_items(part.limits, sheet.angles, "length"))
    if words.open:
        taken = {word.word for word in words.words} | BLOCK_SETTINGS | _SPANS
        items.extend(
            Field(QuotedName(name) if name in taken else name, value_of(value))
            for name, value in part.parameters  # type: ignore[union-attr]
        )
    return items


def _attached_items(sheet: HymekoSheet, key: Id, part: parts.VertexPart | parts.EdgePart) -> list[Item]:
    """The arcs of the edge that attaches a vertex, and the texture of a material."""
    arcs = sheet.attached.get(key, ())
    if key.kind == "material":
        return [Field(TEXTURE, sheet.ref(arc.target, ("texture",))) for arc in arcs]
    kind = part.kind if isinstance(part, parts.Sensor) else ""
    return [sheet.arc(ATTACHED[key.kind], arc, attached_kinds(key.kind, kind)) for arc in arcs]


def _named(items: list[Field], key: Id) -> list[Field]:
    """The fields with ``unnamed`` where there is no name, and without a name that is the id."""
    names = [item for item in items if item.name == "name"]
    if not names:
        return [Field("unnamed"), *items]
    return [item for item in items if item is not names[0] or names[0].value != value_of(key.name)]


def word_fields(part: object, words: Iterable[FieldWord], angles: Angles, motion: str = "") -> list[Field]:
    """A field for every attribute that differs from its default; ``motion`` is what the dimension of that name stands for."""
    defaults = defaults_of(type(part))
    found: list[Field] = []
    for word in words:
        value = getattr(part, word.attribute)
        if value == defaults.get(word.attribute, NODEFAULT):
            continue
        dimension = motion if word.dimension == "motion" else word.dimension
        if word.form == "rgba" and value[3] == 1.0:
            value = value[:3]
        if word.form == "numbers" and len(value) == 1:
            value = value[0]
        found.append(Field(word.word, angles.value(value) if dimension == "angle" else value_of(value)))
    return found


def limit_items(limits: parts.Limits, angles: Angles, motion: str) -> list[Field]:
    """``limit [lower upper]`` where there are both, and a field for every other bound."""
    if limits.lower is None or limits.upper is None:
        return word_fields(limits, LIMIT_WORDS, angles, motion)
    span = (limits.lower, limits.upper)
    bounds = angles.values(span) if motion == "angle" else span
    return [Field("limit", bounds), *word_fields(limits, LIMIT_WORDS[2:], angles, motion)]


def attached_arcs(mechanism: Mechanism) -> Mapping[Id, tuple[RobotArc, ...]]:
    """By vertex the arcs that stand in its block: of an edge that follows it and has nothing but these arcs."""
    marked = {*mechanism.extras, *mechanism.notations, *mechanism.stereotypes}
    follower = dict(zip(mechanism.layout, mechanism.layout[1:], strict=False))
    placed = set(mechanism.layout)
    found: dict[Id, tuple[RobotArc, ...]] = {}
    for vertex in mechanism.graph.vertices:
        key = attached_key(vertex)
        edge = mechanism.graph.edges.get(key) if key is not None else None
        if key is None or edge is None or key in marked or key in mechanism.graph.incidence:
            continue
        near = follower.get(vertex) == key if vertex in placed else key not in placed
        arcs = tuple(arc for arc in edge.arcs if arc.target != vertex)
        sound = bool(arcs) and _reads_back(vertex, arcs)
        if near and sound and edge == attached_edge(vertex, arcs):
            found[vertex] = arcs
    return found


def _reads_back(vertex: Id, arcs: tuple[RobotArc, ...]) -> bool:
    """Whether these arcs can stand in the vertex's block: a material names one texture, a body the one that it is fixed to."""
    if vertex.kind == "material":
        return arcs == (Arc(arcs[0].target, 1),)
    return vertex.kind != "body" or (len(arcs) == 1 and arcs[0].sign > 0 and not arcs[0].role)
