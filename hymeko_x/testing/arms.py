"""A strategy for whole robots that every format can represent, so that the verifier can compare them in all formats."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hypothesis import strategies as st

from hymeko_x.ir import parts
from hymeko_x.ir.graph import Hypergraph
from hymeko_x.ir.mechanism import WORLD, Id, Mechanism, coupling_edge, joint_edge, shape_edge
from hymeko_x.ir.values import Pose, Z, pose, quat_about, rotate_tensor, unit

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import RobotEdge

_NAMES = ("base", "upper arm", "fore_arm", "рука", "a/b", "Tool0", "x.y", "3rd")
_LENGTHS = st.integers(1, 40).map(lambda number: number / 20)
_PLACES = st.tuples(*[st.integers(-40, 40).map(lambda number: number / 20)] * 3)
_DIRECTIONS = st.sampled_from([(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.6, 0.8), (1.0, 2.0, -3.0)]).map(unit)
_ROTATIONS = st.builds(quat_about, _DIRECTIONS, st.integers(-31, 31).map(lambda number: number / 10))
POSES = st.just(Pose()) | st.builds(Pose, _PLACES) | st.builds(pose, _PLACES, _ROTATIONS)
_GEOMETRIES = st.one_of(
    st.tuples(_LENGTHS, _LENGTHS, _LENGTHS).map(lambda size: parts.Box((size[0], size[1] + 2.0, size[2] + 4.0))),
    st.builds(parts.Sphere, _LENGTHS),
    st.builds(parts.Cylinder, _LENGTHS, _LENGTHS),
)


@st.composite
def arms(draw: st.DrawFn) -> Mechanism:
    """A robot on the world: one tree of bodies with mass, hinges, slides and fixed joints with limits, a follower, shapes.

    All of it is physical (MuJoCo refuses anything else), and no two moments or sides of a box are equal, so that each rotation
    of them is another robot.
    """
    bodies = [Id("body", name) for name in _NAMES[: draw(st.integers(2, 5))]]
    edges: dict[Id, RobotEdge] = {Id("joint", "mount"): joint_edge(parts.Joint(), WORLD, bodies[0], Pose())}
    for number, child in enumerate(bodies[1:]):
        joint = draw(_joints()) if number else draw(_moving())
        edges[Id("joint", f"to {child.name}")] = joint_edge(joint, draw(st.sampled_from(bodies[: number + 1])), child, draw(POSES))
    moving = [key for key, edge in edges.items() if isinstance(edge.data, parts.Joint) and edge.data.dofs]
    if len(moving) > 1 and draw(st.booleans()):
        factors = (draw(st.integers(-8, 8)) / 8, draw(st.sampled_from([-2.0, -1.0, 0.5, 1.5])))
        edges[Id("coupling", moving[1].name)] = coupling_edge(moving[1], ((moving[0], factors),))
    for body in bodies:
        for role in (parts.Role.VISUAL, parts.Role.COLLISION):
            if draw(st.booleans()):
                edges[Id("shape", f"{body.name}/{role.value}")] = shape_edge(parts.Shape(draw(_GEOMETRIES), role), body, draw(POSES))
    vertices: dict[Id, parts.VertexPart] = {WORLD: parts.World()}
    vertices |= {body: parts.Body(draw(_inertials())) for body in bodies}
    return Mechanism("arm", Hypergraph(vertices, edges), layout=tuple(bodies))


@st.composite
def _inertials(draw: st.DrawFn) -> parts.Inertial:
    a, b = draw(_LENGTHS), draw(_LENGTHS)
    tensor = (a + 1.0, a + b + 1.25, b + 1.5 + a / 2, 0.0, 0.0, 0.0)
    return parts.Inertial(draw(_LENGTHS), draw(_PLACES), rotate_tensor(draw(_ROTATIONS), tensor))


def _joints() -> st.SearchStrategy[parts.Joint]:
    return st.just(parts.Joint()) | _moving()


@st.composite
def _moving(draw: st.DrawFn) -> parts.Joint:
    kind = draw(st.sampled_from([parts.DofKind.HINGE, parts.DofKind.SLIDE]))
    limits = parts.Limits(-draw(_LENGTHS), draw(_LENGTHS), draw(_LENGTHS), draw(_LENGTHS))
    return parts.Joint((parts.Dof(kind, draw(_DIRECTIONS | st.just(Z)), limits, draw(_LENGTHS), draw(_LENGTHS)),))
