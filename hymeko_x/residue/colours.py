"""Meshes of several colours that the image shows as one mesh for each: these stand or fall together."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.ir.graph import Edge
from hymeko_x.ir.mechanism import Id, pose_weight
from hymeko_x.ir.names import Names
from hymeko_x.ir.parts import Mesh, MeshShape, Shape
from hymeko_x.residue.alike import is_alike
from hymeko_x.residue.arcs import ARCS
from hymeko_x.residue.parts import row_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from hymeko_x.ir.mechanism import Mechanism, RobotEdge
    from hymeko_x.ir.parts import VertexPart
    from hymeko_x.ir.values import Pose
    from hymeko_x.residue import Change, Residue, WholeElement


def pieces_of_meshes(image: Mechanism, residue: Residue) -> dict[Id, list[WholeElement]]:
    """The other pieces of each shape whose mesh the image has in several: they show meshes that only the image has.

    Pieces of two meshes on one body, in one place, are taken for pieces of both.
    """
    only_there = {removal.id for removal in residue.removals}
    waiting: dict[str, list[WholeElement]] = defaultdict(list)
    for removal in residue.removals:
        if isinstance(removal.part, Edge) and _mesh_of(removal.part) in only_there:
            waiting[row_of(removal.id)].append(removal)
    if not waiting:
        return {}
    changed = {change.element for change in residue.changes}
    known = {key: _mesh_of(edge) for key, edge in image.graph.edges.items() if key.kind == "shape"}
    firsts = [key for key, mesh in known.items() if mesh in changed or (mesh in only_there and key in changed)]
    gone = [key for key in changed if key.kind == "shape" and key not in image.graph.edges]
    places = {change.element: pose_weight(change.there[0]) for change in residue.changes if _is_of_arcs(change)}  # type: ignore[index]
    found: dict[Id, list[WholeElement]] = {}
    for key in (*firsts, *gone):
        pieces = [piece for piece in waiting.get(row_of(key), ()) if key not in only_there]
        found[key] = [piece for piece in pieces if key not in places or is_alike(_pose_of(piece), places[key])]
    return {key: pieces for key, pieces in found.items() if pieces}


def _mesh_of(edge: RobotEdge) -> Id | None:
    """The mesh that an edge shows, if it is a shape."""
    is_mesh = isinstance(edge.data, Shape) and isinstance(edge.data.geometry, MeshShape)
    return next((arc.target for arc in edge.arcs if arc.role == "mesh"), None) if is_mesh else None


def _pose_of(piece: WholeElement) -> Pose:
    assert isinstance(piece.part, Edge)
    return pose_weight(piece.part.arcs[0])


def _is_of_arcs(change: Change) -> bool:
    return change.path == ARCS and isinstance(change.there, tuple) and bool(change.there)


def _materials_there(residue: Residue) -> dict[Id, Id]:
    """The materials that shapes have in the image, where that is another one than in the source."""
    found: dict[Id, Id] = {}
    for change in residue.changes:
        if change.element.kind == "shape" and change.path[:1] == ARCS:
            ends = [arc.target for arc in change.there] if _is_of_arcs(change) else [change.there]  # type: ignore[attr-defined]
            for end in ends:
                if isinstance(end, Id) and end.kind == "material":
                    found[change.element] = end
    return found


def taken_apart(image: Mechanism, residue: Residue, pieces: Mapping[Id, Sequence[WholeElement]]) -> set[Id]:
    """The shapes of which a piece was edited, moved, coloured or removed by itself in the image."""
    assets, materials = {removal.id: removal.part for removal in residue.removals}, _materials_there(residue)
    apart: set[Id] = set()
    for key, others in pieces.items():
        first, now = image.graph.edges.get(key), [image.graph.edges.get(other.id) for other in others]
        parts = [part for part in (first, *now) if part is not None]
        if first is None:
            is_whole = not parts
        else:
            olds = [{materials[key]} if key in materials else set()]
            olds += [{arc.target for arc in other.part.arcs} for other in others if isinstance(other.part, Edge)]
            is_whole = len(parts) == len(olds) and all(_shows(image, *pair, first, assets) for pair in zip(parts, olds, strict=True))
        apart |= set() if is_whole else {key}
    return apart


def _shows(image: Mechanism, piece: RobotEdge, olds: set[Id], first: RobotEdge, assets: Mapping[Id, object]) -> bool:
    """Whether a piece is where the first one is, and what it has is what it had, or looks like that; ``olds`` are those that are known."""
    if not is_alike(piece.data, first.data) or not is_alike(pose_weight(piece.arcs[0]), pose_weight(first.arcs[0])):
        return False
    targets = [arc.target for arc in piece.arcs]
    return all(old in targets or any(_is_same(image, key, old, assets) for key in targets) for old in olds)


def _is_same(image: Mechanism, now: Id, old: Id, assets: Mapping[Id, object]) -> bool:
    return now.kind == old.kind and is_alike(image.graph.vertices.get(now), assets.get(old))


def with_first_pieces(
    image: Mechanism, vertices: dict[Id, VertexPart], edges: dict[Id, RobotEdge], residue: Residue, apart: Iterable[Id]
) -> None:
    """Give each shape that was taken apart its own piece of the mesh, as the image has it, where the mesh of that id is now the whole."""
    called = {own: there for there, own in residue.alignment.names}
    only_there = {removal.id for removal in residue.removals}
    free = Names((*vertices, *edges))
    known: dict[Id, Id] = {}
    for key in apart:
        edge = edges.get(key)
        for number, arc in enumerate(edge.arcs) if edge is not None else ():
            piece = image.graph.vertices.get(arc.target)
            if edge is None or arc.target in only_there or not isinstance(piece, Mesh):
                continue
            if arc.target not in known:
                known[arc.target] = free.take(*called.get(arc.target, arc.target))
                vertices[known[arc.target]] = piece
            edges[key] = edge = replace(edge, arcs=(*edge.arcs[:number], replace(arc, target=known[arc.target]), *edge.arcs[number + 1 :]))
    used = {arc.target for edge in edges.values() for arc in edge.arcs} if known else set()
    for mesh in known.keys() - used:
        del vertices[mesh]
