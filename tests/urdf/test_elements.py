"""Every standard element of URDF, and what it becomes."""

from __future__ import annotations

import math

import pytest

from hymeko_x.diagnostics import Origin
from hymeko_x.ir.graph import Arc
from hymeko_x.ir.mechanism import Id, coupling_edge, joint_edge, layer_edge, shape_edge
from hymeko_x.ir.parts import (
    Actuator,
    Body,
    Box,
    Calibration,
    Capsule,
    Cylinder,
    Dof,
    DofKind,
    Drive,
    Inertial,
    Joint,
    Limits,
    Material,
    Mesh,
    MeshShape,
    Role,
    Safety,
    Shape,
    Sphere,
    Texture,
)
from hymeko_x.ir.values import Pose, Written, pose_from_rpy
from tests.urdf.samples import LIMIT, TWO_LINKS, again, dump, joint, load, robot, visual

A, B, J = Id("body", "a"), Id("body", "b"), Id("joint", "j")


def test_a_link_is_a_body_at_its_line() -> None:
    mechanism = load(robot('<link name="a"/>'))
    assert mechanism.name == "r"
    assert dict(mechanism.graph.vertices) == {A: Body()}
    assert mechanism.origin(A) == Origin("robot.urdf", 2)


def test_an_inertial_has_mass_centre_and_tensor_about_it() -> None:
    mechanism = load(
        robot(
            '<link name="a"><inertial><origin xyz="1 2 3"/><mass value="0.5"/>'
            '<inertia ixx="1" ixy="0.1" ixz="0.2" iyy="2" iyz="0.3" izz="2.5"/></inertial></link>'
        )
    )
    assert mechanism.vertex(A, Body) == Body(Inertial(0.5, (1.0, 2.0, 3.0), (1.0, 2.0, 2.5, 0.1, 0.2, 0.3)))


@pytest.mark.parametrize(
    ("text", "geometry"),
    [
        ('<box size="1 2 3"/>', Box((1.0, 2.0, 3.0))),
        ('<sphere radius="0.5"/>', Sphere(0.5)),
        ('<cylinder radius="0.5" length="2"/>', Cylinder(0.5, 2.0)),
        ('<capsule radius="0.5" length="2"/>', Capsule(0.5, 2.0)),
    ],
)
@pytest.mark.parametrize(("tag", "role"), [("visual", Role.VISUAL), ("collision", Role.COLLISION)])
def test_a_visual_or_collision_is_a_shape_on_the_body(text: str, geometry: object, tag: str, role: Role) -> None:
    source = robot(visual(f'<origin xyz="1 2 3" rpy="0.1 0 0"/><geometry>{text}</geometry>', tag).replace(f"<{tag}>", f'<{tag} name="n">'))
    mechanism = load(source)
    pose = pose_from_rpy((1.0, 2.0, 3.0), (0.1, 0.0, 0.0))
    assert dict(mechanism.graph.edges) == {Id("shape", f"a/{tag}"): shape_edge(Shape(geometry, role, "n"), A, pose)}  # type: ignore[arg-type]
    assert text in again(source)


def test_shapes_are_named_by_their_place_and_may_share_a_name() -> None:
    sphere = '<geometry><sphere radius="1"/></geometry>'
    mechanism = load(robot(f'<link name="a"><visual name="n">{sphere}</visual><visual name="n">{sphere}</visual></link>'))
    shapes = {key.name: edge.data.name for key, edge in mechanism.graph.edges.items() if isinstance(edge.data, Shape)}
    assert shapes == {"a/visual": "n", "a/visual#2": "n"}
    assert dump(mechanism).count('<visual name="n">') == 2


def test_meshes_of_the_same_file_and_scale_are_one_vertex() -> None:
    mesh = '<geometry><mesh filename="package://p/m/arm.v2.stl"/></geometry>'
    other = '<geometry><mesh filename="package://p/m/arm.v2.stl" scale="2 2 2"/></geometry>'
    mechanism = load(robot(f'<link name="a"><visual>{mesh}</visual><visual>{other}</visual><collision>{mesh}</collision></link>'))
    arm, larger = Id("mesh", "arm.v2"), Id("mesh", "arm.v2#2")
    assert mechanism.vertex(arm, Mesh) == Mesh("package://p/m/arm.v2.stl")
    assert mechanism.vertex(larger, Mesh) == Mesh("package://p/m/arm.v2.stl", (2.0, 2.0, 2.0))
    assert [view.mesh for view in mechanism.shapes[A]] == [arm, larger, arm]
    assert all(view.shape.geometry == MeshShape() for view in mechanism.shapes[A])


def test_a_revolute_joint_is_a_hinge_with_limits() -> None:
    inside = (
        '<origin xyz="1 0 0" rpy="0 0 0.5"/><axis xyz="0 0 1"/><dynamics damping="0.1" friction="0.2"/>'
        '<limit lower="-1" upper="2" effort="3" velocity="4"/>'
        '<safety_controller k_velocity="5" k_position="6" soft_lower_limit="-0.5" soft_upper_limit="1.5"/>'
        '<calibration rising="0.25" reference_position="0.75"/>'
    )
    mechanism = load(robot(TWO_LINKS + joint(inside)))
    dof = Dof(
        DofKind.HINGE,
        (0.0, 0.0, 1.0),
        Limits(-1.0, 2.0, velocity=4.0, effort=3.0),
        0.1,
        0.2,
        safety=Safety(5.0, 6.0, -0.5, 1.5),
        calibration=Calibration(0.25, None, 0.75),
    )
    assert mechanism.graph.edges[J] == joint_edge(Joint((dof,)), A, B, pose_from_rpy((1.0, 0.0, 0.0), (0.0, 0.0, 0.5)))


@pytest.mark.parametrize(
    ("kind", "inside", "dofs"),
    [
        ("fixed", "", ()),
        ("continuous", "", (Dof(DofKind.HINGE),)),
        ("continuous", '<limit effort="3" velocity="4"/>', (Dof(DofKind.HINGE, limits=Limits(velocity=4.0, effort=3.0)),)),
        ("prismatic", LIMIT, (Dof(DofKind.SLIDE, limits=Limits(-1.0, 2.0, 4.0, 3.0)),)),
        ("floating", "", (Dof(DofKind.FREE),)),
        ("spherical", "", (Dof(DofKind.BALL),)),
        ("ball", "", (Dof(DofKind.BALL),)),
        (
            "planar",
            '<axis xyz="0 0 1"/>',
            (Dof(DofKind.SLIDE, (1.0, 0.0, 0.0)), Dof(DofKind.SLIDE, (0.0, 1.0, 0.0)), Dof(DofKind.HINGE, (0.0, 0.0, 1.0))),
        ),
    ],
)
def test_each_joint_type_has_its_dofs_and_is_written_again(kind: str, inside: str, dofs: tuple[Dof, ...]) -> None:
    source = robot(TWO_LINKS + joint(inside, kind))
    mechanism = load(source)
    assert mechanism.graph.edges[J] == joint_edge(Joint(dofs), A, B)
    assert f'<joint name="j" type="{kind}">' in dump(mechanism)


def test_the_plane_of_a_planar_joint_is_normal_to_its_axis() -> None:
    mechanism = load(robot(TWO_LINKS + joint('<axis xyz="0 2 0"/>', "planar")))
    x, y, turn = mechanism.joints[J].joint.dofs
    assert (turn.kind, turn.axis, turn.written) == (DofKind.HINGE, (0.0, 1.0, 0.0), Written("axis", (0.0, 2.0, 0.0)))
    assert x.axis == pytest.approx((1.0, 0.0, 0.0))
    assert y.axis == pytest.approx((0.0, 0.0, -1.0))
    assert '<axis xyz="0 2 0"/>' in dump(mechanism)


def test_a_missing_axis_is_x() -> None:
    assert load(robot(TWO_LINKS + joint(LIMIT))).joints[J].joint.dofs[0].axis == (1.0, 0.0, 0.0)


def test_mimic_is_a_coupling_with_offset_and_multiplier() -> None:
    body = (
        TWO_LINKS
        + '<link name="c"/>'
        + joint(LIMIT)
        + joint(LIMIT + '<mimic joint="j" multiplier="-2" offset="0.5"/>', name="k", child="c")
    )
    mechanism = load(robot(body))
    assert mechanism.graph.edges[Id("coupling", "k")] == coupling_edge(Id("joint", "k"), ((J, (0.5, -2.0)),))
    assert '<mimic joint="j" multiplier="-2" offset="0.5"/>' in dump(mechanism)


def test_mimic_without_numbers_follows_one_to_one() -> None:
    body = TWO_LINKS + '<link name="c"/>' + joint(LIMIT + '<mimic joint="k"/>') + joint(LIMIT, name="k", child="c")
    assert load(robot(body)).graph.edges[Id("coupling", "j")] == coupling_edge(J, ((Id("joint", "k"), (0.0, 1.0)),))


def test_a_multiplier_of_zero_is_zero() -> None:
    body = (
        TWO_LINKS + '<link name="c"/>' + joint(LIMIT) + joint(LIMIT + '<mimic joint="j" multiplier="0" offset="1"/>', name="k", child="c")
    )
    assert load(robot(body)).graph.edges[Id("coupling", "k")] == coupling_edge(Id("joint", "k"), ((J, (1.0, 0.0)),))


def test_a_named_material_is_one_vertex_for_all_that_use_it() -> None:
    shape = '<geometry><sphere radius="1"/></geometry><material name="red"/>'
    source = robot(f'<material name="red"><color rgba="1 0 0 0.5"/><texture filename="t/red.png"/></material>{visual(shape)}')
    mechanism = load(source)
    red, texture = Id("material", "red"), Id("texture", "red")
    assert mechanism.vertex(red, Material) == Material("red", (1.0, 0.0, 0.0, 0.5))
    assert mechanism.vertex(texture, Texture) == Texture("t/red.png")
    assert mechanism.graph.edges[Id("layer", "red")] == layer_edge(texture, red)
    assert mechanism.shapes[A][0].material == red


TRANSMISSION = (
    '<transmission name="t"><type>transmission_interface/SimpleTransmission</type>'
    '<joint name="j"><hardwareInterface>PositionJointInterface</hardwareInterface>'
    "<hardwareInterface>EffortJointInterface</hardwareInterface></joint>"
    '<actuator name="m"><mechanicalReduction>50</mechanicalReduction></actuator></transmission>'
)


def test_a_transmission_is_a_drive_from_its_actuator_to_its_joint() -> None:
    mechanism = load(robot(TWO_LINKS + joint(LIMIT) + TRANSMISSION))
    edge = mechanism.graph.edges[Id("drive", "t")]
    interfaces = (("hardwareInterface", "PositionJointInterface"), ("hardwareInterface", "EffortJointInterface"))
    assert edge.data == Drive("transmission_interface/SimpleTransmission", interfaces)
    assert edge.arcs == (Arc(Id("actuator", "m"), 1), Arc(J, -1, (50.0,)))
    assert mechanism.vertex(Id("actuator", "m"), Actuator) == Actuator("transmission")
    written = dump(mechanism).replace("\n", "").replace("  ", "")
    assert TRANSMISSION in written


def test_a_differential_keeps_each_reduction_and_role_on_its_own_arc() -> None:
    body = (
        f'{TWO_LINKS}<link name="c"/>{joint(LIMIT)}{joint(LIMIT, name="k", child="c")}<transmission name="t"><type>D</type>'
        '<joint name="j"><role>joint1</role><mechanicalReduction>2</mechanicalReduction><offset>0.0</offset></joint>'
        '<joint name="k"><role>joint2</role><mechanicalReduction>3</mechanicalReduction></joint>'
        '<actuator name="m"><role>actuator1</role><mechanicalReduction>50</mechanicalReduction></actuator></transmission>'
    )
    mechanism = load(robot(body))
    assert mechanism.graph.edges[Id("drive", "t")].arcs == (
        Arc(Id("actuator", "m"), 1, (50.0,), "actuator1"),
        Arc(J, -1, (2.0,), "joint1"),
        Arc(Id("joint", "k"), -1, (3.0,), "joint2"),
    )
    assert [(extra.path, extra.text) for extra in mechanism.extras[Id("drive", "t")]] == [("joint", "<offset>0.0</offset>")]
    assert load(dump(mechanism)) == mechanism


def test_the_pr2_way_of_writing_transmissions_is_kept() -> None:
    body = '<transmission name="t" type="pr2/Simple"><actuator name="m"/><joint name="j"/>'
    body += "<mechanicalReduction>6.25</mechanicalReduction></transmission>"
    text = again(robot(TWO_LINKS + joint(LIMIT) + body))
    assert '<transmission name="t" type="pr2/Simple">' in text
    assert "    <mechanicalReduction>6.25</mechanicalReduction>\n  </transmission>" in text


def test_the_author_of_version_1_1_may_write_quaternions() -> None:
    body = TWO_LINKS + joint('<origin xyz="0 0 1" quat_xyzw="0 0 1 1"/>', "fixed")
    newer, older = (load(robot(body, f' name="r" version="{version}"')).joints[J].parent_pose for version in ("1.1", "1.0"))
    assert newer.quat == pytest.approx((math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)))
    assert older == Pose((0.0, 0.0, 1.0))


def test_a_parameter_whose_name_is_no_word_of_xml_is_left_out() -> None:
    mechanism = load(robot(TWO_LINKS + joint(LIMIT) + TRANSMISSION))
    part = Actuator("transmission", (("a b", 1.0), ("c", 2.0)))
    text = dump(mechanism.replace(vertices={Id("actuator", "m"): part}))
    assert '<actuator name="m">\n      <c>2</c>\n      <mechanicalReduction>' in text
