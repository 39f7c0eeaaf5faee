"""The mirror image of a robot on the plane y = 0 of its root, such as a left arm from a right one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.ir.graph import Edge, Hypergraph
from hymeko_x.ir.parts import Body, Dof, DofKind, Joint, Loop, Mesh
from hymeko_x.ir.values import Pose, unit_quat

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.ir.mechanism import Mechanism, RobotArc, RobotEdge
    from hymeko_x.ir.parts import Inertial, VertexPart
    from hymeko_x.ir.values import Vec3


def mirror(mechanism: Mechanism) -> Mechanism:
    """The mirror image; the same coordinates give mirrored poses. Shapes that are no meshes are symmetric."""
    vertices = {key: _vertex(part) for key, part in mechanism.graph.vertices.items()}
    edges = {key: _edge(edge) for key, edge in mechanism.graph.edges.items()}
    return replace(mechanism, graph=Hypergraph(vertices, edges))


def swapped(words: tuple[str, str]) -> Callable[[str], str]:
    """Changes each of two words in a name into the other one."""
    first, second = words

    def change(name: str) -> str:
        return "".join(piece.replace(second, first) if number % 2 == 0 else second for number, piece in _pieces(name, first))

    return change


def _pieces(name: str, word: str) -> list[tuple[int, str]]:
    pieces = name.split(word)
    woven = [item for piece in pieces for item in (piece, word)][:-1]
    return list(enumerate(woven))


def _vector(vector: Vec3) -> Vec3:
    return (vector[0], -vector[1] + 0.0, vector[2])


def _turn_axis(axis: Vec3) -> Vec3:
    """The axis about which a mirrored rotation turns by the same angle."""
    return (-axis[0] + 0.0, axis[1], -axis[2] + 0.0)


def _pose(pose: Pose) -> Pose:
    w, x, y, z = pose.quat
    return Pose(_vector(pose.xyz), unit_quat((w, -x, y, -z)))


def _vertex(part: VertexPart) -> VertexPart:
    if isinstance(part, Body) and part.inertial is not None:
        return replace(part, inertial=_inertial(part.inertial))
    if isinstance(part, Mesh):
        return replace(part, scale=(part.scale[0], -part.scale[1], part.scale[2]))
    return part


def _inertial(inertial: Inertial) -> Inertial:
    tensor = inertial.tensor
    if tensor is not None:
        xx, yy, zz, xy, xz, yz = tensor
        tensor = (xx, yy, zz, -xy + 0.0, xz, -yz + 0.0)
    return replace(inertial, com=_vector(inertial.com), tensor=tensor, written=None)


def _edge(edge: RobotEdge) -> RobotEdge:
    data = edge.data
    if isinstance(data, Joint | Loop):
        data = replace(data, dofs=tuple([_dof(dof) for dof in data.dofs]))
    return Edge(data, tuple([_arc(arc) for arc in edge.arcs]))


def _dof(dof: Dof) -> Dof:
    axis = _vector(dof.axis) if dof.kind is DofKind.SLIDE else _turn_axis(dof.axis)
    return replace(dof, axis=axis, anchor=_vector(dof.anchor), pitch=-dof.pitch + 0.0, written=None)


def _arc(arc: RobotArc) -> RobotArc:
    return replace(arc, weight=_pose(arc.weight)) if isinstance(arc.weight, Pose) else arc
