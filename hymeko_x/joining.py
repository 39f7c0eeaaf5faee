"""A mechanism that becomes a part of another one: every element with another name, and what was on its world on a body."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import formats
from hymeko_x.ir.graph import Hypergraph
from hymeko_x.ir.mechanism import ROOT, WORLD, Id, pose_weight
from hymeko_x.ir.names import rename, with_dof_names
from hymeko_x.ir.parts import DofKind, Joint, Material, Mesh, Shape, Texture
from hymeko_x.ir.values import IDENTITY, Pose, compose
from hymeko_x.rewrite.references import with_references
from hymeko_x.states import with_states

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from hymeko_x.ir.mechanism import Extra, Mechanism, RobotArc, RobotEdge
    from hymeko_x.ir.parts import EdgePart, VertexPart


# ---- names ---------------------------------------------------------------------------------------------------------------------


def with_names(mechanism: Mechanism, change: Callable[[str], str], *, is_part: bool = True) -> Mechanism:
    """The mechanism with every name changed, also those in its extras; the world stays the world.

    Of one that becomes a part of a robot, the extras that a robot has once are left out.
    """
    graph = mechanism.graph
    vertices = {key: _named(part, change) for key, part in graph.vertices.items()}
    edges = {
        key: replace(edge, data=_edge_named(edge.data, change), arcs=_arcs(edge, graph.edges, change)) for key, edge in graph.edges.items()
    }
    pairs = ((key, Id(key.kind, change(key.name))) for table in (vertices, edges) for key in table if key != WORLD)
    names = {old: new for old, new in pairs if old != new}
    renamed = with_references(rename(replace(mechanism, graph=Hypergraph(vertices, edges)), names), names, in_extras=False)
    extras = {key: tuple(_extras(found, change, is_of_whole=is_part and key == ROOT)) for key, found in renamed.extras.items()}
    return replace(renamed, extras={key: found for key, found in extras.items() if found})


def _named(part: VertexPart, change: Callable[[str], str]) -> VertexPart:
    return replace(part, name=change(part.name)) if isinstance(part, Material | Mesh | Texture) and part.name else part


def _edge_named(part: EdgePart, change: Callable[[str], str]) -> EdgePart:
    if isinstance(part, Shape) and part.name:
        return replace(part, name=change(part.name))
    return with_dof_names(part, change) if isinstance(part, Joint) else part


def _arcs(edge: RobotEdge, edges: Mapping[Id, RobotEdge], change: Callable[[str], str]) -> tuple[RobotArc, ...]:
    """The arcs; roles that are names of dofs change as well."""
    if not any(arc.role for arc in edge.arcs):
        return edge.arcs
    return tuple([replace(arc, role=change(arc.role)) if _is_dof(arc, edges) else arc for arc in edge.arcs])


def _is_dof(arc: RobotArc, edges: Mapping[Id, RobotEdge]) -> bool:
    joint = edges[arc.target].data if arc.role and arc.target in edges else None
    return isinstance(joint, Joint) and any(dof.name == arc.role for dof in joint.dofs)


def _extras(found: Iterable[Extra], change: Callable[[str], str], *, is_of_whole: bool) -> Iterator[Extra]:
    """The extras with changed names where their format says how. Of those of the whole, only elements of XML come along."""
    for extra in found:
        row = next((row for row in formats.FORMATS if row.name == extra.format and row.names_in), None)
        if row is not None and row.names_in is not None:
            changed = formats.loaded(row.names_in)(extra, lambda _kind, name: change(name), is_of_whole=is_of_whole)
            yield from () if changed is None else (changed,)
        elif not is_of_whole or extra.text.startswith("<"):
            yield extra


# ---- the world ---------------------------------------------------------------------------------------------------------------


def on_body(arc: RobotArc, body: Id, frame: Pose) -> RobotArc:
    """The arc to the world as one to the body, where the world is at ``frame``."""
    moves = isinstance(arc.weight, Pose) or (arc.weight is None and arc.sign >= 0)
    weight = compose(frame, pose_weight(arc)) if moves else arc.weight
    return replace(arc, target=body, weight=None if weight == IDENTITY else weight)


def held(part: EdgePart, body: Id, dofs: Joint | None = None) -> EdgePart:
    """A joint to the world as one to the body: with these dofs if there are some, else a free one is fixed, but for one in the world.

    What is no joint stays as it is.
    """
    if not isinstance(part, Joint) or (body == WORLD and dofs is None):
        return part
    if dofs is not None:
        return dofs
    return Joint() if any(dof.kind is DofKind.FREE for dof in part.dofs) else part


# ---- what floats in the world --------------------------------------------------------------------------------------------------


def shifted(part: Mechanism, frame: Pose) -> Mechanism:
    """The part with named configurations in which what is free is seen from a world that is at the frame."""
    return with_states(part, part, lambda word, key, numbers: (key, moved_state(word, numbers, frame) if is_free(part, key) else numbers))


def is_free(mechanism: Mechanism, key: Id | None) -> bool:
    """Whether an element is a free joint."""
    view = mechanism.joints.get(key) if key is not None else None
    return view is not None and [dof.kind for dof in view.joint.dofs] == [DofKind.FREE]


def moved_state(word: str, numbers: tuple[float, ...], frame: Pose) -> tuple[float, ...]:
    """The coordinates of a free joint from a world that is at the frame."""
    if word != "qpos":
        return numbers
    x, y, z, *quat = numbers
    there = compose(frame, Pose.from_quat((quat[0], quat[1], quat[2], quat[3]), (x, y, z)))
    return (*there.xyz, *there.quat)
