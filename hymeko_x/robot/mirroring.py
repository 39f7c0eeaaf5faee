"""The mirror image of a robot on the plane y = 0 of its root, such as a left arm from a right one."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.ir.graph import Edge, Hypergraph
from hymeko_x.ir.mechanism import has_numbers, pose_weight
from hymeko_x.ir.parts import Body, Dof, DofKind, Drive, Joint, Loop, Mesh, Mount, Stance
from hymeko_x.ir.values import IDENTITY, Pose, compose, unit_quat
from hymeko_x.states import with_states

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from hymeko_x.ir.ids import Id
    from hymeko_x.ir.mechanism import Mechanism, RobotArc, RobotEdge
    from hymeko_x.ir.parts import Inertial, VertexPart
    from hymeko_x.ir.values import Vec3


def mirror(mechanism: Mechanism) -> Mechanism:
    """The mirror image; the same coordinates give mirrored poses. Shapes that are no meshes are symmetric."""
    vertices = {key: _vertex(part) for key, part in mechanism.graph.vertices.items()}
    edges = {key: _edge(edge, mechanism) for key, edge in mechanism.graph.edges.items()}
    image = replace(mechanism, graph=Hypergraph(vertices, edges))
    return with_states(image, mechanism, lambda word, key, numbers: (key, _state(word, key, numbers, mechanism)))


def _state(word: str, key: Id | None, numbers: tuple[float, ...], mechanism: Mechanism) -> tuple[float, ...]:
    """The numbers of a joint, or of a mocap body, in a named configuration."""
    if key is None:
        return _signed(numbers, _SIGNS[DofKind.FREE][:3] if word == "mpos" else _SIGNS[DofKind.BALL])
    if key not in mechanism.joints:
        return numbers
    kinds = [dof.kind for dof in mechanism.joints[key].joint.dofs]
    return _coordinates(kinds, numbers, _RATES if word == "qvel" else _SIGNS)


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


def _edge(edge: RobotEdge, mechanism: Mechanism) -> RobotEdge:
    data = edge.data
    if isinstance(data, Mount) and any(arc.target.kind == "camera" for arc in edge.arcs):
        return Edge(data, tuple([_upright(_arc(arc)) for arc in edge.arcs]))
    if isinstance(data, Stance | Drive):
        return Edge(data, tuple([_numbers(arc, data, mechanism) for arc in edge.arcs]))
    if isinstance(data, Joint | Loop):
        data = replace(data, dofs=tuple([_dof(dof) for dof in data.dofs]))
    return Edge(data, tuple([_arc(arc) for arc in edge.arcs]))


def _dof(dof: Dof) -> Dof:
    axis = _vector(dof.axis) if dof.kind is DofKind.SLIDE else _turn_axis(dof.axis)
    return replace(dof, axis=axis, anchor=_vector(dof.anchor), pitch=-dof.pitch + 0.0, written=None)


def _upright(arc: RobotArc) -> RobotArc:
    """The pose of a camera whose picture is mirrored left to right: its up stays up."""
    if arc.target.kind == "camera":
        return arc
    turned = compose(pose_weight(arc), Pose(quat=(0.0, 0.0, 0.0, 1.0)))
    return replace(arc, weight=None if turned == IDENTITY else turned)


def _numbers(arc: RobotArc, part: Stance | Drive, mechanism: Mechanism) -> RobotArc:
    """The coordinates of balls and free joints, and the directions in which an actuator pushes and turns."""
    if not has_numbers(arc.weight):
        return arc
    joint = mechanism.joints[arc.target].joint if arc.target in mechanism.joints else None
    if joint is None:
        return arc if isinstance(part, Stance) else replace(arc, weight=_signed(arc.weight, _RATES[DofKind.FREE]))
    kinds = [dof.kind for dof in joint.dofs]
    return replace(arc, weight=_coordinates(kinds, arc.weight, _SIGNS if isinstance(part, Stance) else _RATES))


def _coordinates(kinds: list[DofKind], numbers: tuple[float, ...], by_kind: Mapping[DofKind, tuple[int, ...]]) -> tuple[float, ...]:
    signs: list[int] = []
    for kind in kinds:
        signs += by_kind.get(kind, (1,))
    return _signed(numbers, signs)


def _signed(numbers: tuple[float, ...], signs: Sequence[int]) -> tuple[float, ...]:
    """The numbers with these signs; further ones stay."""
    return tuple([number * sign + 0.0 for number, sign in zip(numbers, signs, strict=False)]) + numbers[len(signs) :]


_SIGNS: Mapping[DofKind, tuple[int, ...]] = MappingProxyType({DofKind.BALL: (1, -1, 1, -1), DofKind.FREE: (1, -1, 1, 1, -1, 1, -1)})
"""By the kind of a dof, the signs of its coordinates in the mirror: positions, and quaternions (w, x, y, z)."""
_RATES: Mapping[DofKind, tuple[int, ...]] = MappingProxyType({DofKind.BALL: (-1, 1, -1), DofKind.FREE: (1, -1, 1, -1, 1, -1)})
"""The same for its velocities, and for the forces and torques along them."""


def _arc(arc: RobotArc) -> RobotArc:
    return replace(arc, weight=_pose(arc.weight)) if isinstance(arc.weight, Pose) else arc
