"""URDF text says everything that it claims to say, and every mechanism can be rewritten so that it can be said."""

from __future__ import annotations

from dataclasses import replace

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hymeko_x.backends.urdf import write
from hymeko_x.diagnostics import Report
from hymeko_x.frontends.urdf import read
from hymeko_x.frontends.urdf.draft import stem
from hymeko_x.ir import parts
from hymeko_x.ir.diff import Tolerance, diff
from hymeko_x.ir.graph import Hypergraph
from hymeko_x.ir.legalize import Options, legalize
from hymeko_x.ir.mechanism import Id, Mechanism, Names, RobotEdge, coupling_edge, joint_edge, layer_edge, shape_edge
from hymeko_x.ir.values import Pose, Written, plane_axes, pose, pose_from_rpy, rotate_tensor, unit
from hymeko_x.source import Source
from tests.strategies import mechanisms
from tests.urdf.samples import dump, load, said

NAMES = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\ufffe\uffff", min_codepoint=32), min_size=1, max_size=6)
NUMBERS = st.floats(-1e6, 1e6, allow_nan=False)
LENGTHS = st.floats(0.0, 1e3)
ANGLES = st.floats(-7.0, 7.0)
VECTORS = st.tuples(NUMBERS, NUMBERS, NUMBERS)
POSES = st.one_of(
    st.just(Pose()), st.builds(Pose, VECTORS), st.builds(pose_from_rpy, VECTORS, st.tuples(ANGLES, ANGLES, ANGLES).filter(any))
)
COLOURS = st.tuples(*[st.floats(0.0, 1.0)] * 4)
GEOMETRIES = st.one_of(
    st.builds(parts.Box, st.tuples(LENGTHS, LENGTHS, LENGTHS)),
    st.builds(parts.Sphere, LENGTHS),
    st.builds(parts.Cylinder, LENGTHS, LENGTHS),
    st.builds(parts.Capsule, LENGTHS, LENGTHS),
    st.just(parts.NoShape()),
    st.just(parts.MeshShape()),
)
MESHES = st.builds(
    parts.Mesh, st.sampled_from(["package://p/a.stl", "m/a.stl", "b.dae"]), st.sampled_from([(1.0, 1.0, 1.0), (1.0, -2.0, 1.0)])
)
LIMITS = st.builds(parts.Limits, NUMBERS, NUMBERS, LENGTHS, LENGTHS, st.none() | LENGTHS, st.none() | LENGTHS)
DIRECTIONS = st.sampled_from([(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 2.0)]) | VECTORS.filter(lambda v: max(map(abs, v)) > 1e-3)


@st.composite
def inertials(draw: st.DrawFn) -> parts.Inertial:
    frame, tensor = draw(POSES), draw(st.tuples(*[NUMBERS] * 6))
    written = None if frame.written is None else parts.InertialWritten(frame, tensor)
    return parts.Inertial(draw(st.none() | LENGTHS), frame.xyz, rotate_tensor(frame.quat, tensor), written)


@st.composite
def joints(draw: st.DrawFn) -> parts.Joint:
    kind = draw(st.sampled_from(["fixed", "hinge", "turning", "slide", "free", "planar"]))
    if kind in ("fixed", "free"):
        return parts.Joint((parts.Dof(parts.DofKind.FREE),) if kind == "free" else ())
    vector = draw(DIRECTIONS)
    axis = unit(vector)
    written = None if axis == vector else Written("axis", vector)
    if kind == "planar":
        x, y = plane_axes(axis)
        turn = parts.Dof(parts.DofKind.HINGE, axis, written=written)
        return parts.Joint((parts.Dof(parts.DofKind.SLIDE, x), parts.Dof(parts.DofKind.SLIDE, y), turn))
    dof = parts.Dof(
        parts.DofKind.SLIDE if kind == "slide" else parts.DofKind.HINGE,
        axis,
        draw(LIMITS) if kind != "turning" else parts.Limits(velocity=draw(LENGTHS), effort=draw(LENGTHS)),
        draw(LENGTHS),
        draw(LENGTHS),
        safety=draw(st.none() | st.builds(parts.Safety, NUMBERS, NUMBERS, NUMBERS, NUMBERS)),
        calibration=draw(st.none() | st.builds(parts.Calibration, NUMBERS, st.none() | NUMBERS, st.none() | NUMBERS)),
        written=written,
    )
    return parts.Joint((dof,))


@st.composite
def sayable(draw: st.DrawFn) -> Mechanism:
    """A mechanism with everything that URDF has a word for, under the ids that reading it gives."""
    names = Names()
    vertices: dict[Id, parts.VertexPart] = {}
    edges: dict[Id, RobotEdge] = {}
    materials = _materials(draw, vertices, edges)
    bodies = [Id("body", name) for name in draw(st.lists(NAMES, min_size=1, max_size=4, unique=True))]
    meshes: dict[parts.Mesh, Id] = {}
    for body in bodies:
        vertices[body] = parts.Body(draw(st.none() | inertials()))
        for role in (parts.Role.VISUAL, parts.Role.COLLISION):
            for geometry in draw(st.lists(GEOMETRIES, max_size=2)):
                key = names.take("shape", f"{body.name}/{role.value}")
                look = draw(st.none() | COLOURS | st.sampled_from(materials)) if materials else draw(st.none() | COLOURS)
                rgba, material = (None, look) if isinstance(look, Id) else (look, None)
                mesh = _mesh(draw(MESHES), meshes, vertices, names) if geometry == parts.MeshShape() else None
                edges[key] = shape_edge(parts.Shape(geometry, role, draw(st.none() | NAMES), rgba), body, draw(POSES), mesh, material)
    found = _joints(draw, bodies, edges)
    return Mechanism(draw(NAMES), Hypergraph(vertices, edges), layout=(*bodies, *found))


def _materials(draw: st.DrawFn, vertices: dict[Id, parts.VertexPart], edges: dict[Id, RobotEdge]) -> list[Id]:
    found = []
    for name in draw(st.lists(NAMES, max_size=2, unique=True)):
        key = Id("material", name)
        vertices[key] = parts.Material(name, draw(COLOURS))
        found.append(key)
    if found and draw(st.booleans()):
        texture = Id("texture", "t")
        vertices[texture] = parts.Texture("package://p/t.png")
        edges[Id("layer", found[0].name)] = layer_edge(texture, found[0])
    return found


def _mesh(mesh: parts.Mesh, known: dict[parts.Mesh, Id], vertices: dict[Id, parts.VertexPart], names: Names) -> Id:
    if mesh not in known:
        known[mesh] = names.take("mesh", stem(mesh.uri or ""))
        vertices[known[mesh]] = mesh
    return known[mesh]


def _joints(draw: st.DrawFn, bodies: list[Id], edges: dict[Id, RobotEdge]) -> list[Id]:
    found = []
    labels = draw(st.lists(NAMES, min_size=len(bodies), max_size=len(bodies), unique=True))
    for number, child in enumerate(bodies[1:], 1):
        key = Id("joint", labels[number])
        edges[key] = joint_edge(draw(joints()), draw(st.sampled_from(bodies[:number])), child, draw(POSES))
        found.append(key)
    moving = [key for key in found if isinstance(joint := edges[key].data, parts.Joint) and len(joint.dofs) == 1]
    if len(moving) > 1:
        edges[Id("coupling", moving[0].name)] = coupling_edge(moving[0], ((moving[1], (draw(NUMBERS), draw(NUMBERS))),))
    return found


@given(sayable())
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_what_urdf_has_a_word_for_comes_back_exactly(mechanism: Mechanism) -> None:
    text = dump(mechanism)
    assert diff(mechanism, load(text)) == ()
    assert load(text) == mechanism
    assert dump(load(text)) == text


@given(VECTORS, st.tuples(*[st.floats(-1.0, 1.0)] * 4).filter(lambda q: max(map(abs, q)) > 1e-2))
def test_a_rotation_that_was_not_written_as_rpy_comes_back_to_the_last_bits(
    xyz: tuple[float, float, float], quat: tuple[float, float, float, float]
) -> None:
    a, b = Id("body", "a"), Id("body", "b")
    edges = {Id("joint", "j"): joint_edge(parts.Joint(), a, b, replace(pose(xyz, quat), written=None))}
    mechanism = Mechanism("r", Hypergraph({a: parts.Body(), b: parts.Body()}, edges))
    assert diff(mechanism, load(dump(mechanism)), Tolerance(absolute=2e-14)) == ()


@given(mechanisms(), st.sampled_from([None, "fixed", "free"]))
@settings(max_examples=50, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_every_mechanism_can_be_written_after_legalising_and_the_text_is_well_formed(mechanism: Mechanism, base: str | None) -> None:
    own_words = replace(mechanism, extras={})  # the generated ones are not XML
    legal = legalize(own_words, "urdf", Options(base=base), Report())  # type: ignore[arg-type]
    text = write(legal, Report()).main
    assert not [message for message in said(text) if "HX005" in message]
    result = read(Source("r.urdf", text), Report())
    assert {key for key, _ in legal.vertices(parts.Body)} == {key for key, _ in result.vertices(parts.Body)}
    assert legalize(legal, "urdf", Options(base=base), Report()).graph == legal.graph  # type: ignore[arg-type]
