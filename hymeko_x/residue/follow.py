"""Following renames: an element that is gone, and a new one that says the same, where only one can be meant."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.ir.graph import Edge
from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.names import rename
from hymeko_x.ir.parts import Joint
from hymeko_x.residue.prints import print_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Mechanism, RobotEdge
    from hymeko_x.residue import Residue


def renamed_since(image: Mechanism, residue: Residue) -> dict[Id, Id]:
    """The old ids of renamed elements by their new ones; those for which the evidence is not unique are left out."""
    graph = image.graph
    known = dict(residue.known)
    missing = {key: mark for key, mark in known.items() if key not in graph}
    if not missing:
        return {}
    kinds = {key.kind for key in missing}
    strangers: dict[tuple[str, str], list[Id]] = defaultdict(list)
    for key in (*graph.vertices, *graph.edges):
        if key.kind in kinds and key not in known:
            strangers[key.kind, print_of(image, key)].append(key)
    lost: dict[tuple[str, str], list[Id]] = defaultdict(list)
    for key, mark in missing.items():
        lost[key.kind, mark].append(key)
    return {strangers[mark][0]: keys[0] for mark, keys in lost.items() if len(keys) == 1 and len(strangers[mark]) == 1}


def with_old_names(image: Mechanism, names: Mapping[Id, Id]) -> Mechanism:
    """The image under the old names; what is called after its body (``foot/visual``, or the same) follows it."""
    bodies = {new.name: old.name for new, old in names.items() if new.kind == "body"}
    there = {*image.graph.vertices, *image.graph.edges}
    followed: dict[Id, Id] = {}
    for key in there if bodies else ():
        body, stroke, rest = key.name.partition("/")
        old = Id(key.kind, f"{bodies[body]}{stroke}{rest}") if body in bodies else key
        if old not in there:
            followed[key] = old
    return rename(image, {**followed, **names})


def with_new_names(mechanism: Mechanism, names: Mapping[Id, Id]) -> Mechanism:
    """The restored mechanism with the new names, those of the dofs of joints included."""
    if not names:
        return mechanism
    back = {old: new for new, old in names.items()}
    dofs = {old.name: new.name for old, new in back.items() if old.kind == "joint"}
    edges = {key: _with_dof_names(edge, dofs) for key, edge in mechanism.graph.edges.items() if isinstance(edge.data, Joint)}
    return rename(mechanism.with_graph(mechanism.graph.replace(edges=edges)), back)


def _with_dof_names(edge: RobotEdge, names: Mapping[str, str]) -> RobotEdge:
    assert isinstance(edge.data, Joint)
    if not any(dof.name in names for dof in edge.data.dofs):
        return edge
    dofs = tuple(replace(dof, name=names.get(dof.name, dof.name)) if dof.name else dof for dof in edge.data.dofs)
    return Edge(replace(edge.data, dofs=dofs), edge.arcs)
