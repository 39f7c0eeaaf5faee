"""The difference between a source and its native image."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.compare.leaves import TURN, leaves_between
from hymeko_x.ir.graph import Edge
from hymeko_x.ir.mechanism import ROOT, Id
from hymeko_x.ir.parts import Body
from hymeko_x.residue import Addition, Change, Removal, Residue
from hymeko_x.residue.align import align
from hymeko_x.residue.digests import Digests, digest, guard_of, shape_group
from hymeko_x.residue.sides import by_kind, moves, sides_between

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.compare.leaves import Leaf, Leaves
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.residue import Alignment, Run

NAMED = frozenset({"body", "joint", "frame", "material", "actuator", "sensor", "camera", "light", "tendon"})
"""Kinds of elements that people give names to."""


def residue_of(source: Mechanism, image: Mechanism) -> Residue:
    """What restores the source from its image. Linear but for sorting."""
    alignment, aligned = align(image, source)
    return residue_between(source, image, alignment, aligned, leaves_between(source, aligned))


def residue_between(source: Mechanism, image: Mechanism, alignment: Alignment, aligned: Mechanism, leaves: Mapping[Id, Leaves]) -> Residue:
    """The same where the alignment is known, the aligned image, and the leaves in which that and the source differ."""
    digests = Digests(aligned)
    changes = tuple(_changes(aligned, source, leaves, digests))
    additions = tuple(_additions(aligned, source))
    removals = tuple(_removals(aligned, source, digests))
    found = Residue(
        alignment,
        changes,
        additions,
        removals,
        sides_between(aligned, source),
        tuple(_order(aligned, source)),
        *_layout(aligned, source),
    )
    return replace(found, known=tuple(_known(image, found, Digests(image, digests))))


def _changes(image: Mechanism, source: Mechanism, leaves: Mapping[Id, Leaves], digests: Digests) -> Iterator[Change]:
    if image.name != source.name:
        yield Change(ROOT, ("name",), source.name, digest(image.name))
    for key, found in leaves.items():
        for leaf in found:
            yield Change(key, leaf.path, leaf.before, _guard(image, key, leaf, digests))


def _guard(image: Mechanism, key: Id, leaf: Leaf, digests: Digests) -> str:
    """The digest of the image's value there. A mass that follows from shapes holds only as long as the shapes do."""
    if leaf.path[-1] == TURN:
        return digest(leaf.after[0])  # type: ignore[index]
    if leaf.path[0] == "inertial" and leaf.before is None and isinstance(image.graph.vertices.get(key), Body):
        return digests.of_weight(key)
    return guard_of(leaf.after, leaf.default)


def _additions(image: Mechanism, source: Mechanism) -> Iterator[Addition]:
    for key, part in source.graph.vertices.items():
        if key not in image.graph.vertices:
            yield Addition(key, part)
    for key, edge in source.graph.edges.items():
        if key not in image.graph.edges:
            yield Addition(key, edge)


def _removals(image: Mechanism, source: Mechanism, digests: Digests) -> Iterator[Removal]:
    for key in image.graph.vertices:
        if key not in source.graph.vertices:
            yield Removal(key, digests.of(key), "")
    for key, edge in image.graph.edges.items():
        if key not in source.graph.edges:
            yield Removal(key, digests.of(key), shape_group(edge))


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


# ---- what an editor may rename -----------------------------------------------------------------------------------------------


def _known(image: Mechanism, residue: Residue, digests: Digests) -> Iterator[tuple[Id, str]]:
    """The elements of the image with names of their own that the residue speaks of, with their digests."""
    names = {new: old for old, new in residue.alignment.names}
    spoken = dict.fromkeys(names.get(key, key) for key in map(_named, _spoken_of(residue)) if key.kind in NAMED)
    yield from ((key, digests.of(key)) for key in spoken if key in image.graph)


def _named(key: Id) -> Id:
    """The element itself, or the body that it is called after."""
    if key.kind in NAMED:
        return key
    body, stroke, _ = key.name.partition("/")
    return Id("body", body) if stroke else key


def _spoken_of(residue: Residue) -> Iterator[Id]:
    alignment: Alignment = residue.alignment
    yield from (change.element for change in residue.changes)
    for addition in residue.additions:
        if isinstance(addition.part, Edge):
            yield from (arc.target for arc in addition.part.arcs)
    for fold in alignment.folds:
        yield from (*fold.chain, *fold.between)
    yield from (key for key, _ in alignment.frames)
    sides = residue.sides
    yield from (entry[0] for table in (sides.notations, sides.stereotypes, sides.extras) for entry in table)
