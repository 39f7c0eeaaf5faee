"""Meshes of several colours that the image shows as one mesh for each: these stand or fall together."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.ir.graph import Edge
from hymeko_x.ir.mechanism import pose_weight
from hymeko_x.ir.names import Names
from hymeko_x.ir.parts import Mesh, MeshShape, Shape
from hymeko_x.residue.alike import is_alike
from hymeko_x.residue.arcs import ARCS
from hymeko_x.residue.parts import row_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge
    from hymeko_x.ir.parts import VertexPart
    from hymeko_x.residue import Change, Element, Residue


def pieces_of_meshes(residue: Residue) -> dict[Id, list[Element]]:
    """The other pieces of each shape whose mesh the image has in several: each shows a mesh and a material that only the image has."""
    only_there = {removal.id for removal in residue.removals}
    waiting: dict[str, list[Element]] = defaultdict(list)
    for removal in residue.removals:
        if isinstance(removal.part, Edge) and _is_piece(removal.part) and {arc.target for arc in removal.part.arcs[1:]} <= only_there:
            waiting[row_of(removal.id)].append(removal)
    found: dict[Id, list[Element]] = {}
    for change in residue.changes if waiting else ():
        pieces = waiting.get(row_of(change.element))
        if pieces and _gains_material(change, only_there):
            place = pose_weight(change.there[0])  # type: ignore[index]
            found[change.element] = [piece for piece in pieces if is_alike(pose_weight(piece.part.arcs[0]), place)]  # type: ignore[union-attr]
    return {key: pieces for key, pieces in found.items() if pieces}


def _is_piece(edge: RobotEdge) -> bool:
    """Whether an edge is the shape of a mesh in a material."""
    is_mesh = isinstance(edge.data, Shape) and isinstance(edge.data.geometry, MeshShape)
    return is_mesh and {arc.role for arc in edge.arcs[1:]} == {"mesh", "material"}


def _gains_material(change: Change, only_there: set[Id]) -> bool:
    """Whether a change is that of a shape which has a mesh in the source, and a material that only the image has."""
    if change.path != ARCS or not isinstance(change.there, tuple) or not isinstance(change.value, tuple):
        return False
    is_mesh = any(arc.role == "mesh" for arc in change.value) and not any(arc.role == "material" for arc in change.value)
    return is_mesh and any(arc.role == "material" and arc.target in only_there for arc in change.there)


def taken_apart(image: Mechanism, residue: Residue, pieces: Mapping[Id, Sequence[Element]]) -> set[Id]:
    """The shapes of which a piece was edited, moved, coloured or removed by itself in the image."""
    then = {change.element: change.there for change in residue.changes if change.path == ARCS and change.element in pieces}
    assets = {removal.id: removal.part for removal in residue.removals}
    apart: set[Id] = set()
    for key, others in pieces.items():
        first, now = image.graph.edges.get(key), [image.graph.edges.get(other.id) for other in others]
        parts = [part for part in (first, *now) if part is not None]
        if first is None:
            is_whole = not parts
        else:
            olds = [then[key], *(other.part.arcs for other in others if isinstance(other.part, Edge))]
            is_whole = len(parts) == len(olds) and all(_shows(image, *pair, first, assets) for pair in zip(parts, olds, strict=True))
        apart |= set() if is_whole else {key}
    return apart


def _shows(image: Mechanism, piece: RobotEdge, then: object, first: RobotEdge, assets: Mapping[Id, object]) -> bool:
    """Whether a piece is where the first one is, on the body and of the mesh that it had, in a material that looks like it did."""
    assert isinstance(then, tuple)
    if not is_alike(piece.data, first.data) or not is_alike(pose_weight(piece.arcs[0]), pose_weight(first.arcs[0])):
        return False
    pairs = [(arc.target, old.target) for arc, old in zip(piece.arcs, then, strict=False)]
    return len(piece.arcs) == len(then) and all(
        now == old or is_alike(image.graph.vertices.get(now), assets.get(old)) for now, old in pairs
    )


def with_first_pieces(
    image: Mechanism, vertices: dict[Id, VertexPart], edges: dict[Id, RobotEdge], residue: Residue, apart: Iterable[Id]
) -> None:
    """Give each shape that was taken apart its own piece of the mesh, as the image has it: the mesh of the source is the whole."""
    called = {own: there for there, own in residue.alignment.names}
    free = Names((*vertices, *edges))
    known: dict[Id, Id] = {}
    for key in apart:
        edge = edges.get(key)
        for number, arc in enumerate(edge.arcs) if edge is not None else ():
            piece = image.graph.vertices.get(arc.target)
            if edge is None or arc.role != "mesh" or not isinstance(piece, Mesh):
                continue
            if arc.target not in known:
                known[arc.target] = free.take(*called.get(arc.target, arc.target))
                vertices[known[arc.target]] = piece
            edges[key] = edge = replace(edge, arcs=(*edge.arcs[:number], replace(arc, target=known[arc.target]), *edge.arcs[number + 1 :]))
    used = {arc.target for edge in edges.values() for arc in edge.arcs} if known else set()
    for mesh in known.keys() - used:
        del vertices[mesh]
