"""The difference between a source and its native image, behind the bridge."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.compare.leaves import TURN, leaves_between
from hymeko_x.ir.fields import identical
from hymeko_x.ir.graph import Edge
from hymeko_x.ir.mechanism import ROOT, Id
from hymeko_x.ir.parts import Body
from hymeko_x.ir.provenance import kept_notations
from hymeko_x.residue import Addition, Change, Removal, Residue, Sides
from hymeko_x.residue.align import aligned
from hymeko_x.residue.order import by_kind, moves
from hymeko_x.residue.paths import digest, guard_of
from hymeko_x.residue.prints import Prints, print_of_extra, shape_group

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.compare.leaves import Leaf, Leaves
    from hymeko_x.ir.mechanism import Extra, Mechanism
    from hymeko_x.residue import Bridge, Run

    Notations = Mapping[Id, Mapping[str, str]]

_NAMED = frozenset({"body", "joint", "frame", "material", "actuator", "sensor", "camera", "light", "tendon"})
"""Kinds of elements that people give names to."""


def residue_of(source: Mechanism, image: Mechanism) -> Residue:
    """What restores the source from its image. Linear but for sorting."""
    bridge, crossed = aligned(image, source)
    return residue_behind(source, image, bridge, crossed, leaves_between(source, crossed))


def residue_behind(source: Mechanism, image: Mechanism, bridge: Bridge, crossed: Mechanism, apart: Mapping[Id, Leaves]) -> Residue:
    """The same where the bridge is known, the image behind it, and in which leaves that and the source are apart."""
    prints = Prints(crossed)
    changes = tuple(_changes(crossed, source, apart, prints))
    additions = tuple(_additions(crossed, source))
    removals = tuple(_removals(crossed, source, prints))
    found = Residue(
        bridge,
        changes,
        additions,
        removals,
        sides_between(crossed, source),
        tuple(_order(crossed, source)),
        *_layout(crossed, source),
    )
    return replace(found, known=tuple(_known(image, found, Prints(image, prints))))


def _changes(image: Mechanism, source: Mechanism, apart: Mapping[Id, Leaves], prints: Prints) -> Iterator[Change]:
    if image.name != source.name:
        yield Change(ROOT, ("name",), source.name, digest(image.name))
    for key, leaves in apart.items():
        for leaf in leaves:
            yield Change(key, leaf.path, leaf.before, _guard(image, key, leaf, prints))


def _guard(image: Mechanism, key: Id, leaf: Leaf, prints: Prints) -> str:
    """What the image said there. A mass that follows from shapes holds only as long as the shapes do."""
    if leaf.path[-1] == TURN:
        return digest(leaf.after[0])  # type: ignore[index]
    if leaf.path[0] == "inertial" and leaf.before is None and isinstance(image.graph.vertices.get(key), Body):
        return prints.of_weight(key)
    return guard_of(leaf.after, leaf.default)


def _additions(image: Mechanism, source: Mechanism) -> Iterator[Addition]:
    for key, part in source.graph.vertices.items():
        if key not in image.graph.vertices:
            yield Addition(key, part)
    for key, edge in source.graph.edges.items():
        if key not in image.graph.edges:
            yield Addition(key, edge)


def _removals(image: Mechanism, source: Mechanism, prints: Prints) -> Iterator[Removal]:
    for key in image.graph.vertices:
        if key not in source.graph.vertices:
            yield Removal(key, prints.of(key), "")
    for key, edge in image.graph.edges.items():
        if key not in source.graph.edges:
            yield Removal(key, prints.of(key), shape_group(edge))


# ---- order -----------------------------------------------------------------------------------------------------------------


def _order(image: Mechanism, source: Mechanism) -> Iterator[Run]:
    """The moves that bring the elements of each kind into the source's order, what is added standing last."""
    for mine, theirs in ((image.graph.vertices, source.graph.vertices), (image.graph.edges, source.graph.edges)):
        have = by_kind([*(key for key in mine if key in theirs), *(key for key in theirs if key not in mine)])
        for kind, want in by_kind(theirs).items():
            yield from moves(have[kind], want)


def _layout(image: Mechanism, source: Mechanism) -> tuple[tuple[Id, ...] | None, tuple[Id, ...]]:
    """The source's layout and the elements without a place in it, if the image has another one."""
    if image.layout == source.layout:
        return None, ()
    placed = set(source.layout)
    there = (key for key in image.layout if key in source.graph)
    return source.layout, tuple(key for key in there if key not in placed)


# ---- side tables -------------------------------------------------------------------------------------------------------------


def sides_between(image: Mechanism, source: Mechanism) -> Sides:
    """What stands beside the graph."""
    written, noted = kept_notations(source), kept_notations(image)
    used = {name for table in written.values() for name in table}
    forgotten = {name for table in noted.values() for name in table} - used
    extras = tuple(_extras(image, source))
    return Sides(
        tuple(_notations(noted, written, forgotten)),
        tuple(sorted(forgotten)),
        tuple(_stereotypes(image, source)) if source.stereotypes else (),
        bool(image.stereotypes) and not source.stereotypes,
        tuple((key, extra) for key, extra, new in extras if new),
        tuple((key, print_of_extra(extra)) for key, extra, new in extras if not new),
    )


def _notations(image: Notations, source: Notations, forgotten: set[str]) -> Iterator[tuple[Id, str, str | None]]:
    for key, table in source.items():
        mine = image.get(key, {})
        yield from ((key, name, text) for name, text in table.items() if mine.get(name) != text)
    for key, table in image.items():
        theirs = source.get(key, {})
        yield from ((key, name, None) for name in table if name not in theirs and name not in forgotten)


def _stereotypes(image: Mechanism, source: Mechanism) -> Iterator[tuple[Id, tuple[str, ...]]]:
    for key in dict.fromkeys([*source.stereotypes, *image.stereotypes]):
        if image.stereotypes.get(key, ()) != source.stereotypes.get(key, ()):
            yield key, source.stereotypes.get(key, ())


def _extras(image: Mechanism, source: Mechanism) -> Iterator[tuple[Id, Extra, bool]]:
    """The extras to add (True) and to take away (False): those that differ, or all where the order would."""
    for key in dict.fromkeys([*source.extras, *image.extras]):
        mine, theirs = image.extras.get(key, ()), source.extras.get(key, ())
        if identical(mine, theirs):
            continue
        kept = [extra for extra in mine if any(identical(extra, other) for other in theirs)] if len(mine) < 100 else []
        if not identical(tuple(kept), theirs[: len(kept)]):
            kept = []
        rest = list(kept)
        for extra in mine:
            if rest and rest[0] is extra:
                rest.pop(0)
            else:
                yield key, extra, False
        yield from ((key, extra, True) for extra in theirs[len(kept) :])


# ---- what an editor may rename -----------------------------------------------------------------------------------------------


def _known(image: Mechanism, residue: Residue, prints: Prints) -> Iterator[tuple[Id, str]]:
    """The elements of the image with names of their own that the residue speaks of, with their digests."""
    names = {new: old for old, new in residue.bridge.names}
    spoken = dict.fromkeys(names.get(key, key) for key in map(_named, _spoken_of(residue)) if key.kind in _NAMED)
    yield from ((key, prints.of(key)) for key in spoken if key in image.graph)


def _named(key: Id) -> Id:
    """The element itself, or the body that it is called after."""
    if key.kind in _NAMED:
        return key
    body, stroke, _ = key.name.partition("/")
    return Id("body", body) if stroke else key


def _spoken_of(residue: Residue) -> Iterator[Id]:
    bridge: Bridge = residue.bridge
    yield from (change.element for change in residue.changes)
    for addition in residue.additions:
        if isinstance(addition.part, Edge):
            yield from (arc.target for arc in addition.part.arcs)
    for fold in bridge.folds:
        yield from (*fold.chain, *fold.between)
    yield from (key for key, _ in bridge.frames)
    sides = residue.sides
    yield from (entry[0] for table in (sides.notations, sides.stereotypes, sides.extras) for entry in table)
