"""Strategies for mechanisms that URDF can represent, under the ids that its reader gives."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hypothesis import strategies as st

from hymeko_x.ir import parts
from hymeko_x.ir.graph import Hypergraph
from hymeko_x.ir.mechanism import Id, Mechanism, coupling_edge, joint_edge, layer_edge, shape_edge
from hymeko_x.ir.names import Names
from hymeko_x.ir.values import Pose, Written, plane_axes, pose_from_rpy, rotate_tensor, unit
from hymeko_x.source import file_stem

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import RobotEdge

_NAMES = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\ufffe\uffff", min_codepoint=32), min_size=1, max_size=6)
_NUMBERS = st.floats(-1e6, 1e6, allow_nan=False)
_LENGTHS = st.floats(0.0, 1e3)
_ANGLES = st.floats(-7.0, 7.0)
_VECTORS = st.tuples(_NUMBERS, _NUMBERS, _NUMBERS)
_POSES = st.one_of(
    st.just(Pose()), st.builds(Pose, _VECTORS), st.builds(pose_from_rpy, _VECTORS, st.tuples(_ANGLES, _ANGLES, _ANGLES).filter(any))
)
_COLOURS = st.tuples(*[st.floats(0.0, 1.0)] * 4)
_GEOMETRIES = st.one_of(
    st.builds(parts.Box, st.tuples(_LENGTHS, _LENGTHS, _LENGTHS)),
    st.builds(parts.Sphere, _LENGTHS),
    st.builds(parts.Cylinder, _LENGTHS, _LENGTHS),
    st.builds(parts.Capsule, _LENGTHS, _LENGTHS),
    st.just(parts.NoShape()),
    st.just(parts.MeshShape()),
)
_MESHES = st.builds(
    parts.Mesh, st.sampled_from(["package://p/a.stl", "m/a.stl", "b.dae"]), st.sampled_from([(1.0, 1.0, 1.0), (1.0, -2.0, 1.0)])
)
_LIMITS = st.builds(parts.Limits, _NUMBERS, _NUMBERS, _LENGTHS, _LENGTHS, st.none() | _LENGTHS, st.none() | _LENGTHS)
_DIRECTIONS = st.sampled_from([(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 2.0)]) | _VECTORS.filter(lambda v: max(map(abs, v)) > 1e-3)


@st.composite
def _inertials(draw: st.DrawFn) -> parts.Inertial:
    frame, tensor = draw(_POSES), draw(st.tuples(*[_NUMBERS] * 6))
    written = None if frame.written is None else parts.InertialWritten(frame, tensor)
    return parts.Inertial(draw(st.none() | _LENGTHS), frame.xyz, rotate_tensor(frame.quat, tensor), written)


@st.composite
def _joint(draw: st.DrawFn) -> parts.Joint:
    kind = draw(st.sampled_from(["fixed", "hinge", "turning", "slide", "free", "planar"]))
    if kind in ("fixed", "free"):
        return parts.Joint((parts.Dof(parts.DofKind.FREE),) if kind == "free" else ())
    vector = draw(_DIRECTIONS)
    axis = unit(vector)
    written = None if axis == vector else Written("axis", vector)
    if kind == "planar":
        x, y = plane_axes(axis)
        turn = parts.Dof(parts.DofKind.HINGE, axis, written=written)
        return parts.Joint((parts.Dof(parts.DofKind.SLIDE, x), parts.Dof(parts.DofKind.SLIDE, y), turn))
    dof = parts.Dof(
        parts.DofKind.SLIDE if kind == "slide" else parts.DofKind.HINGE,
        axis,
        draw(_LIMITS) if kind != "turning" else parts.Limits(velocity=draw(_LENGTHS), effort=draw(_LENGTHS)),
        draw(_LENGTHS),
        draw(_LENGTHS),
        safety=draw(st.none() | st.builds(parts.Safety, _NUMBERS, _NUMBERS, _NUMBERS, _NUMBERS)),
        calibration=draw(st.none() | st.builds(parts.Calibration, _NUMBERS, st.none() | _NUMBERS, st.none() | _NUMBERS)),
        written=written,
    )
    return parts.Joint((dof,))


@st.composite
def urdf_mechanisms(draw: st.DrawFn) -> Mechanism:
    """A mechanism with everything that URDF can represent, under the ids that its reader gives."""
    names = Names()
    vertices: dict[Id, parts.VertexPart] = {}
    edges: dict[Id, RobotEdge] = {}
    materials = _materials(draw, vertices, edges)
    bodies = [Id("body", name) for name in draw(st.lists(_NAMES, min_size=1, max_size=4, unique=True))]
    meshes: dict[parts.Mesh, Id] = {}
    for body in bodies:
        vertices[body] = parts.Body(draw(st.none() | _inertials()))
        for role in (parts.Role.VISUAL, parts.Role.COLLISION):
            for geometry in draw(st.lists(_GEOMETRIES, max_size=2)):
                key = names.take("shape", f"{body.name}/{role.value}")
                appearance = draw(st.none() | _COLOURS | st.sampled_from(materials)) if materials else draw(st.none() | _COLOURS)
                rgba, material = (None, appearance) if isinstance(appearance, Id) else (appearance, None)
                mesh = _mesh(draw(_MESHES), meshes, vertices, names) if geometry == parts.MeshShape() else None
                edges[key] = shape_edge(parts.Shape(geometry, role, draw(st.none() | _NAMES), rgba), body, draw(_POSES), mesh, material)
    found = _tree(draw, bodies, edges)
    return Mechanism(draw(_NAMES), Hypergraph(vertices, edges), layout=(*bodies, *found))


def _materials(draw: st.DrawFn, vertices: dict[Id, parts.VertexPart], edges: dict[Id, RobotEdge]) -> list[Id]:
    found = []
    for name in draw(st.lists(_NAMES, max_size=2, unique=True)):
        key = Id("material", name)
        vertices[key] = parts.Material(name, draw(_COLOURS))
        found.append(key)
    with_texture: bool = draw(st.booleans())
    if found and with_texture:
        texture = Id("texture", "t")
        vertices[texture] = parts.Texture("package://p/t.png")
        edges[Id("layer", found[0].name)] = layer_edge(texture, found[0])
    return found


def _mesh(mesh: parts.Mesh, known: dict[parts.Mesh, Id], vertices: dict[Id, parts.VertexPart], names: Names) -> Id:
    if mesh not in known:
        known[mesh] = names.take("mesh", file_stem(mesh.uri or ""))
        vertices[known[mesh]] = mesh
    return known[mesh]


def _tree(draw: st.DrawFn, bodies: list[Id], edges: dict[Id, RobotEdge]) -> list[Id]:
    found = []
    labels = draw(st.lists(_NAMES, min_size=len(bodies), max_size=len(bodies), unique=True))
    for number, child in enumerate(bodies[1:], 1):
        key = Id("joint", labels[number])
        edges[key] = joint_edge(draw(_joint()), draw(st.sampled_from(bodies[:number])), child, draw(_POSES))
        found.append(key)
    moving = [key for key in found if isinstance(joint := edges[key].data, parts.Joint) and len(joint.dofs) == 1]
    if len(moving) > 1:
        edges[Id("coupling", moving[0].name)] = coupling_edge(moving[0], ((moving[1], (draw(_NUMBERS), draw(_NUMBERS))),))
    return found
