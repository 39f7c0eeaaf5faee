"""The ledger is empty exactly when nothing is lost: it stays so within a format's words, and says what is none of them."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

import hymeko_x as hx
from hymeko_x import formats, pipeline
from hymeko_x.compare import ledger
from hymeko_x.compare.diff import diff
from hymeko_x.compare.relevance import relevant
from hymeko_x.diagnostics import Report
from hymeko_x.ir import parts
from hymeko_x.ir.graph import Hypergraph
from hymeko_x.ir.mechanism import WORLD, Extra, Id, Mechanism, RobotEdge, joint_edge, shape_edge
from hymeko_x.ir.parts import Rgba
from hymeko_x.ir.values import Pose, Quat, Vec3, X, Y, Z, compose, inverse, rotate, scaled
from hymeko_x.residue import Alignment
from hymeko_x.residue.realign import alignment_differences
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Package, PackageFiles, Source

FEW = settings(max_examples=settings.default.max_examples // 10, deadline=None, suppress_health_check=list(HealthCheck))
FORMATS = ("hymeko", "urdf", "mjcf", "usd", "usdc")
LAYOUTS = ("usd", "usdc", "usd layered", "usdc layered", "usd nested")

_EIGHTHS = st.integers(-80, 80).map(lambda number: number / 8)
_SIZES = st.integers(1, 80).map(lambda number: number / 8)
_PLACES = st.tuples(_EIGHTHS, _EIGHTHS, _EIGHTHS)
_TURNS = st.sampled_from([(1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), (0.5, 0.5, 0.5, 0.5), (0.5, -0.5, 0.5, -0.5)])
_POSES = st.builds(Pose, _PLACES, _TURNS)
_ANGLES = st.integers(-12, 12).map(lambda number: math.radians(15 * number))
_NAMES = st.lists(st.sampled_from(["base", "arm 1", "рука", "a/b", "Hand", "x.y", "tip", "3rd"]), min_size=1, max_size=4, unique=True)
_GEOMETRIES = st.one_of(
    st.builds(parts.Box, st.tuples(_SIZES, _SIZES, _SIZES)), st.builds(parts.Sphere, _SIZES), st.builds(parts.Cylinder, _SIZES, _SIZES)
)


@st.composite
def plain_robots(draw: st.DrawFn, way: str) -> Mechanism:
    """A robot of which a format says everything, in numbers that single precision and degrees hold exactly.

    Its base is joined to the world where the format always says how, else open; what the format gives no name to is called
    as reading calls it.
    """
    rooted = way.startswith(("mjcf", "usd"))
    names = draw(_NAMES)
    bodies = [Id("body", name) for name in names]
    edges: dict[Id, RobotEdge] = {}
    if rooted:
        floats = draw(st.booleans())
        name = {("mjcf", False): names[0], ("usd", True): f"{names[0]}_free"}.get(
            (way[:3] if way.startswith("usd") else way, floats), "base joint"
        )
        dofs = (parts.Dof(parts.DofKind.FREE, Z if way == "mjcf" else X),) if floats else ()
        edges[Id("joint", name)] = joint_edge(parts.Joint(dofs), WORLD, bodies[0], draw(_POSES))
    for number, child in enumerate(bodies[1:], 1):
        joint = draw(_joints())
        name = child.name if way == "mjcf" and not joint.dofs else f"to {child.name}"
        edges[Id("joint", name)] = joint_edge(joint, draw(st.sampled_from(bodies[:number])), child, draw(_POSES))
    for body in bodies:
        for role, name in ((parts.Role.VISUAL, "look"), (parts.Role.COLLISION, "hull")):
            if draw(st.booleans()):
                shape = parts.Shape(draw(_GEOMETRIES), role, f"{name} of {body.name}", density=0.0 if way == "mjcf" else None)
                key = Id("shape", f"{name} of {body.name}" if way.startswith("usd") else f"{body.name}/{role.value}")
                edges[key] = shape_edge(shape, body, draw(_POSES))
    world = {WORLD: parts.World()} if rooted else {}
    return Mechanism("r", Hypergraph({**world, **{body: parts.Body(draw(_inertials())) for body in bodies}}, edges), layout=tuple(bodies))


@st.composite
def _joints(draw: st.DrawFn) -> parts.Joint:
    kind = draw(st.sampled_from([None, parts.DofKind.HINGE, parts.DofKind.SLIDE]))
    if kind is None:
        return parts.Joint()
    values = _ANGLES if kind is parts.DofKind.HINGE else _EIGHTHS
    low, high = sorted(draw(st.lists(values, min_size=2, max_size=2, unique=True)))
    return parts.Joint((parts.Dof(kind, draw(st.sampled_from([X, Y, Z])), parts.Limits(low, high), draw(_SIZES), draw(_SIZES)),))


@st.composite
def _inertials(draw: st.DrawFn) -> parts.Inertial:
    a, b = draw(_SIZES), draw(_SIZES)
    return parts.Inertial(draw(_SIZES), draw(_PLACES), (a, b, a + b - 0.125, 0.0, 0.0, 0.0))


def _converted(mechanism: Mechanism, way: str) -> pipeline.Result:
    """The mechanism by one way out, which the format and the layout name."""
    format, _, layout = way.partition(" ")
    options = Options(layout="layered" if layout == "layered" else None, nested=layout == "nested" or None)
    return pipeline.convert(mechanism, formats.by_name(format), options, NoFiles(), Report())


def _bare(package: Package, way: str) -> Mechanism:
    """What the stages of a package say themselves."""
    format = formats.by_name(way.partition(" ")[0])
    files = PackageFiles(package, NoFiles())
    return replace(pipeline.reader(format)(Source(f"r.{format.name}", package.main, files), Report()).mechanism, extras={})


@pytest.mark.parametrize("way", [*[way for way in FORMATS if way not in LAYOUTS], *LAYOUTS])
@FEW
@given(data=st.data())
def test_what_a_format_can_say_is_not_in_the_ledger_and_comes_back_without_what_a_stage_carries(way: str, data: st.DataObject) -> None:
    robot = data.draw(plain_robots(way))
    result = _converted(robot, way)
    assert list(map(str, result.losses or ())) == []
    if way in LAYOUTS:
        assert [str(found) for found in diff(robot, _bare(result.package, way), ledger.TOLERANCE)] == []


def _on_a_dof(**changed: object) -> Callable[[Mechanism], tuple[Mechanism, Id] | None]:
    """Change the first dof that moves along one axis."""

    def change(robot: Mechanism) -> tuple[Mechanism, Id] | None:
        for key, view in robot.joints.items():
            if view.joint.dofs and view.joint.dofs[0].kind is not parts.DofKind.FREE:
                edge = robot.graph.edges[key]
                joint = parts.Joint((replace(view.joint.dofs[0], **changed),))  # type: ignore[arg-type]
                return robot.replace(edges={key: replace(edge, data=joint)}), key
        return None

    return change


def _on_a_free_joint(axis: Vec3) -> Callable[[Mechanism], tuple[Mechanism, Id] | None]:
    """Say an axis of the first free joint."""

    def change(robot: Mechanism) -> tuple[Mechanism, Id] | None:
        for key, view in robot.joints.items():
            if view.joint.dofs and view.joint.dofs[0].kind is parts.DofKind.FREE:
                edge = replace(robot.graph.edges[key], data=parts.Joint((parts.Dof(parts.DofKind.FREE, axis),)))
                return robot.replace(edges={key: edge}), key
        return None

    return change


def _on_a_shape(**changed: object) -> Callable[[Mechanism], tuple[Mechanism, Id] | None]:
    """Change the first shape that touches."""

    def change(robot: Mechanism) -> tuple[Mechanism, Id] | None:
        for views in robot.shapes.values():
            for view in views:
                if view.shape.role is parts.Role.COLLISION:
                    edge = replace(robot.graph.edges[view.id], data=replace(view.shape, **changed))  # type: ignore[arg-type]
                    return robot.replace(edges={view.id: edge}), view.id
        return None

    return change


def _extra(robot: Mechanism) -> tuple[Mechanism, Id] | None:
    key = next(key for key in robot.graph.vertices if key.kind == "body")
    return replace(robot, extras={key: (Extra("odd format", "a", "b"),)}), key


_LIMITED = parts.Limits(-1.0, 1.0, velocity=2.0)
_SAFETY = _on_a_dof(safety=parts.Safety(1.0, 2.0, -1.0, 1.0))
_CALIBRATION = _on_a_dof(calibration=parts.Calibration(1.0))
_IN_URDF = [_on_a_dof(**{name: 0.5}) for name in ("armature", "stiffness", "spring_ref")]
NOT_REPORTED = {
    "urdf": [*_IN_URDF, _on_a_shape(friction=(0.5,)), _on_a_shape(mass=0.5), _extra],
    "mjcf": [_on_a_dof(limits=_LIMITED), _on_a_free_joint(Y), _SAFETY, _CALIBRATION, _extra],
    "usd": [_SAFETY, _CALIBRATION, _on_a_free_joint(Y), _on_a_shape(density=0.5), _extra],
}
"""Of each format, changes of a single field for which it has no word."""
NOT_REPORTED |= {"usdc": NOT_REPORTED["usd"], "hymeko": []}


@pytest.mark.parametrize("way", [way for way in FORMATS if NOT_REPORTED[way]])
@FEW
@given(data=st.data())
def test_what_a_format_cannot_say_is_in_the_ledger_at_its_element(way: str, data: st.DataObject) -> None:
    changed = data.draw(st.sampled_from(NOT_REPORTED[way]))(data.draw(plain_robots(way)))
    assume(changed is not None)
    robot, element = changed
    assert {loss.element for loss in _converted(robot, way).losses or ()} == {str(element)}


# ---- what is no loss -------------------------------------------------------------------------------------------------------------


def _in_other_frames(robot: Mechanism) -> tuple[Mechanism, Id] | None:
    """Describe the first joint in another frame on both bodies, whose origin is on the axis of a hinge, or anywhere for a slide."""
    for key, view in robot.joints.items():
        if view.joint.dofs and view.joint.dofs[0].kind is not parts.DofKind.FREE:
            dof = view.joint.dofs[0]
            frame = Pose(scaled(dof.axis, 0.5) if dof.kind is parts.DofKind.HINGE else (0.5, 1.0, -0.25), (0.5, 0.5, 0.5, 0.5))
            turned = parts.Joint((replace(dof, axis=rotate(inverse(frame).quat, dof.axis)),))
            above, below = (compose(each, frame) for each in (view.parent_pose, view.child_pose))
            return robot.replace(edges={key: joint_edge(turned, view.parent, view.child, above, below)}), key
    return None


def _with_a_bare_world(robot: Mechanism) -> tuple[Mechanism, Id]:
    return robot.replace(vertices={WORLD: parts.World()}), WORLD


NO_LOSS = {
    "urdf": [_with_a_bare_world],
    "mjcf": [_on_a_free_joint(X), _in_other_frames],
    "usd": [_on_a_free_joint(X), _on_a_shape(name=None)],
}
"""What says the same in other words."""


@pytest.mark.parametrize("way", NO_LOSS)
@FEW
@given(data=st.data())
def test_what_says_the_same_is_no_loss(way: str, data: st.DataObject) -> None:
    changed = data.draw(st.sampled_from(NO_LOSS[way]))(data.draw(plain_robots(way)))
    assume(changed is not None)
    assert list(map(str, _converted(changed[0], way).losses or ())) == []


@pytest.mark.parametrize(
    ("above", "below", "axis"),
    [
        ((0.0, 0.0, 0.001), (0.0, 0.0, 0.0), Z),
        ((0.0, 0.0, 0.0), (0.001, 0.0, 0.0), Z),
        ((0.001, 0.0, 0.0), (0.001, 0.0, 0.0), Z),
        ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.6, 0.8)),
    ],
)
def test_a_joint_that_moves_otherwise_is_a_loss(above: Vec3, below: Vec3, axis: Vec3) -> None:
    """Another frame on one of the bodies only, another line for its axis, another direction."""
    ends = Id("body", "a"), Id("body", "b")
    bodies = dict.fromkeys(ends, parts.Body())
    before, after = (
        Mechanism("r", Hypergraph(bodies, {Id("joint", "j"): joint_edge(parts.Joint((dof,)), *ends, Pose(first), Pose(second))}))
        for dof, first, second in (
            (parts.Dof(parts.DofKind.HINGE, Z), (0.0,) * 3, (0.0,) * 3),
            (parts.Dof(parts.DofKind.HINGE, axis), above, below),
        )
    )
    found = diff(before, after, ledger.TOLERANCE)
    assert found
    assert tuple(relevant(found, before, after, ledger.TOLERANCE)) == found


def test_a_reference_that_is_in_the_frames_is_a_loss_and_the_frames_are_none() -> None:
    """Both move the body alike at all coordinates; a simulation starts elsewhere."""
    along, up = parts.Dof(parts.DofKind.SLIDE, X), parts.Dof(parts.DofKind.SLIDE, Z)
    ends = Id("body", "a"), Id("body", "b")
    before, after = (
        Mechanism("r", Hypergraph(dict.fromkeys(ends, parts.Body()), {Id("joint", "j"): joint_edge(parts.Joint(dofs), *ends, Pose(place))}))
        for dofs, place in (
            ((replace(along, anchor=(0.0, 0.0, -1.25)), replace(up, ref=1.25)), (0.0, 0.0, 1.25)),
            ((along, up), (0.0, 0.0, 0.0)),
        )
    )
    found = diff(before, after, ledger.TOLERANCE)
    assert {difference.field for difference in found} == {"dofs[0].anchor", "dofs[1].ref", "[0].weight"}
    assert [difference.field for difference in relevant(found, before, after, ledger.TOLERANCE)] == ["dofs[1].ref"]


@pytest.mark.parametrize(("turn", "told"), [((0.0, 0.0, 0.0, 1.0), []), ((1.0, 0.0, 0.0, 0.0), ["scale"])])
def test_a_mesh_that_is_mirrored_along_another_axis_and_turned_is_where_it_was(turn: Quat, told: list[str]) -> None:
    mesh, shape = Id("mesh", "arm"), Id("shape", "a/visual")
    seen = parts.Shape(parts.MeshShape(), parts.Role.VISUAL)
    before, after = (
        Mechanism(
            "r",
            Hypergraph(
                {Id("body", "a"): parts.Body(), mesh: parts.Mesh("arm.stl", scale)}, {shape: shape_edge(seen, Id("body", "a"), pose, mesh)}
            ),
        )
        for scale, pose in (((1.0, -1.0, 1.0), Pose((0.1, 0.2, 0.3))), ((-1.0, 1.0, 1.0), Pose((0.1, 0.2, 0.3), turn)))
    )
    found = diff(before, after)
    assert [difference.field for difference in relevant(found, before, after, ledger.TOLERANCE)] == told


def _told(before: Mechanism, after: Mechanism, alignment: Alignment) -> list[tuple[str, str]]:
    return [(loss.element, loss.field) for loss in ledger.losses_between(before, after, alignment_differences(alignment), formats.MJCF)]


def test_what_a_format_says_of_an_element_that_is_new_is_told_with_the_element() -> None:
    key = Id("texture", "steel")
    after = Mechanism("r", Hypergraph({key: parts.Texture("steel.png")}), {key: (Extra("mjcf", "@type", "2d"),)})
    assert _told(Mechanism("r"), after, Alignment()) == [(str(key), "")]
    assert _told(Mechanism("r", after.graph), after, Alignment()) == [(str(key), "mjcf @type")]


def test_a_mesh_that_the_file_holds_has_lost_its_uri_and_nothing_else() -> None:
    key, held = Id("mesh", "hip"), parts.Mesh(vertices=(0.0,) * 9, faces=(0, 1, 2))
    after = Mechanism("r", Hypergraph({key: held}))
    assert _told(Mechanism("r", Hypergraph({key: parts.Mesh("hip.stl")})), after, Alignment(((Id("mesh", "visual"), key),))) == [
        (str(key), "uri")
    ]
    there = replace(held, vertices=(1.0,) * 9)
    assert _told(Mechanism("r", Hypergraph({key: there})), after, Alignment()) == [(str(key), "vertices")]
    named = Mechanism("r", Hypergraph({key: replace(held, name="hip")}))
    assert _told(named, after, Alignment()) == [(str(key), "name")]


@pytest.mark.parametrize(("uri", "told"), [("a/hip.stl", ["uri"]), ("a/thigh.stl", ["name", "uri"]), (None, ["name"])])
def test_a_mesh_that_is_called_after_its_file_has_no_name_to_lose(uri: str | None, told: list[str]) -> None:
    key, other = Id("mesh", "hip#2"), Id("mesh", "visual")
    before, after = (Mechanism("r", Hypergraph({key: parts.Mesh(each, vertices=(0.0,) * 9)})) for each in (uri, None))
    assert [field for _, field in _told(before, after, Alignment(((other, key),)))] == told


@pytest.mark.parametrize(
    ("material", "own", "told"),
    [
        ('<color rgba="1 0 0 1"/>', None, []),
        ('<color rgba="1 0 0 1"/>', (0.0, 1.0, 0.0, 1.0), ["[1]", "rgba"]),
        ('<color rgba="1 0 0 1"/><texture filename="red.png"/>', None, ["[1]", "rgba"]),
    ],
    ids=["the same", "another colour", "an image"],
)
def test_a_shape_with_the_colour_that_its_material_gave_it_lost_nothing(material: str, own: Rgba | None, told: list[str]) -> None:
    shape = f'<visual><geometry><sphere radius="1"/></geometry><material name="red">{material}</material></visual>'
    before = hx.loads(f'<robot name="r"><link name="a">{shape}</link></robot>', "urdf").mechanism
    (view,) = before.every_shape()
    edge = before.graph.edges[view.id]
    coloured = replace(edge, data=replace(view.shape, rgba=own or (1.0, 0.0, 0.0, 1.0)), arcs=edge.arcs[:1])
    after = before.replace(edges={view.id: coloured})
    assert sorted(found.field for found in relevant(diff(before, after), before, after, ledger.TOLERANCE)) == told


@pytest.mark.parametrize(
    ("text", "lost"),
    [
        ('<site name="tool"/>', []),
        ('<site name="tool" size="0.03"/>', ["frame 'tool'"]),
        ('<camera name="tool"/>', ["camera 'tool'", "mount 'tool'"]),
        ('<light name="tool"/>', ["light 'tool'", "mount 'tool'"]),
        ('<site name="tool" pos="0 0 1"/>', ["frame 'tool'", "mount 'tool'"]),
    ],
)
def test_a_body_stands_for_the_frame_of_its_name_alone_which_has_its_size_to_lose(text: str, lost: list[str]) -> None:
    body = f'<mujoco><worldbody><body name="tool"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>{text}</body></worldbody></mujoco>'
    robot = hx.loads(body, "mjcf").mechanism
    losses = pipeline.convert(robot, formats.URDF, Options(), NoFiles(), Report()).losses
    assert [str(loss.element) for loss in losses or ()] == lost
