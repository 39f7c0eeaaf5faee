"""The difference between a source and its native image."""

from __future__ import annotations

from pathlib import PurePath
from typing import TYPE_CHECKING

from msgspec import NODEFAULT
from msgspec.structs import replace

from hymeko_x.compare.leaves import TURN, leaves_between
from hymeko_x.ir.graph import Edge
from hymeko_x.ir.mechanism import ROOT, Id
from hymeko_x.residue import Change, Residue, WholeElement
from hymeko_x.residue.align import align
from hymeko_x.residue.landmarks import NAMED, landmarks_of
from hymeko_x.residue.sides import by_kind, moves, sides_between

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from hymeko_x.compare.leaves import Leaf, Leaves
    from hymeko_x.ir.mechanism import Mechanism, RobotEdge
    from hymeko_x.ir.parts import VertexPart
    from hymeko_x.residue import Alignment, Run


def residue_of(source: Mechanism, image: Mechanism) -> Residue:
    """What restores the source from its image. Linear but for sorting."""
    alignment, aligned = align(image, source)
    return residue_between(source, image, alignment, aligned, leaves_between(source, aligned))


def residue_between(source: Mechanism, image: Mechanism, alignment: Alignment, aligned: Mechanism, leaves: Mapping[Id, Leaves]) -> Residue:
    """The same where the alignment is known, the aligned image, and the leaves in which that and the source differ."""
    there, here = aligned.graph, source.graph
    changes = tuple(_changes(aligned, source, leaves))
    removals = tuple(_only_in(there.vertices, here.vertices)) + tuple(_only_in(there.edges, here.edges))
    found = Residue(
        source.source._replace(file=PurePath(source.source.file).name),
        alignment,
        changes,
        tuple(_only_in(here.vertices, there.vertices)) + tuple(_only_in(here.edges, there.edges)),
        removals,
        tuple(_weights(aligned, changes, removals)),
        sides_between(aligned, source),
        tuple(_order(aligned, source)),
        *_layout(aligned, source),
    )
    return replace(found, landmarks=landmarks_of(image, _spoken_of(image, found)))


def _changes(image: Mechanism, source: Mechanism, leaves: Mapping[Id, Leaves]) -> Iterator[Change]:
    if image.name != source.name:
        yield Change(ROOT, ("name",), source.name, image.name)
    for key, found in leaves.items():
        for leaf in found:
            yield Change(key, leaf.path, leaf.before, _there(leaf))


def _there(leaf: Leaf) -> object:
    """The image's value; NODEFAULT for the default, which a field has in a format that cannot represent it."""
    if leaf.path[-1] == TURN:
        return leaf.after[0]  # type: ignore[index]
    return NODEFAULT if leaf.default is not NODEFAULT and leaf.after == leaf.default else leaf.after


def _only_in(mine: Mapping[Id, VertexPart | RobotEdge], theirs: Mapping[Id, object]) -> Iterator[WholeElement]:
    return (WholeElement(key, part) for key, part in mine.items() if key not in theirs)


def _weights(image: Mechanism, changes: Iterable[Change], removals: Iterable[WholeElement]) -> Iterator[WholeElement]:
    """The shapes of bodies of which only the image states the mass, but for those that only the image has."""
    gone = {key for key, _ in removals}
    for change in changes:
        if change.path == ("inertial",) and change.value is None and change.element.kind == "body":
            yield from (
                WholeElement(view.id, image.graph.edges[view.id]) for view in image.shapes.get(change.element, ()) if view.id not in gone
            )


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


def _spoken_of(image: Mechanism, residue: Residue) -> Iterator[Id]:
    """The elements of the image with names of their own that the residue speaks of."""
    names = {new: old for old, new in residue.alignment.names}
    spoken = dict.fromkeys(names.get(key, key) for key in map(_named, _elements_in(residue)))
    return (key for key in spoken if key.kind in NAMED and key in image.graph)


def _named(key: Id) -> Id:
    """The element itself, or the body that it is called after."""
    if key.kind in NAMED:
        return key
    body, stroke, _ = key.name.partition("/")
    return Id("body", body) if stroke else key


def _elements_in(residue: Residue) -> Iterator[Id]:
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
