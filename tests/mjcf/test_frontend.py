"""MJCF in: what an element becomes."""

from __future__ import annotations

import math

import mujoco
import pytest
from mjmodels import read_text

from hymeko_x.diagnostics import Refusal
from hymeko_x.ir.mechanism import WORLD, Id, pose_weight
from hymeko_x.ir.parts import Actuator, Body, Box, Capsule, DofKind, Ellipsoid, Geometry, Loop, MeshShape, Plane, Role, Shape
from hymeko_x.ir.values import Written, compose, inverse, pose_from_rpy


def in_world(content: str, head: str = "") -> str:
    return f"<mujoco>{head}<worldbody>{content}</worldbody></mujoco>"


def refused(text: str) -> str:
    with pytest.raises(Refusal) as caught:
        read_text(text)
    return str(caught.value).splitlines()[0]


def test_degrees_become_radians_in_mujocos_own_arithmetic() -> None:
    robot = read_text(in_world('<body><joint name="j" range="-30 90" ref="15"/><geom size="1"/></body>'))
    dof = robot.joints[Id("joint", "j")].joint.dofs[0]
    assert (dof.limits.lower, dof.limits.upper, dof.ref) == (-30 * (math.pi / 180), 90 * (math.pi / 180), 15 * (math.pi / 180))


def test_slides_are_in_metres_whatever_the_angles_are_in() -> None:
    robot = read_text(in_world('<body><joint name="j" type="slide" range="-30 90"/><geom size="1"/></body>'))
    assert robot.joints[Id("joint", "j")].joint.dofs[0].limits.upper == 90.0


def test_all_joints_of_a_body_are_one_edge_with_ordered_dofs() -> None:
    robot = read_text(in_world('<body name="b"><joint name="x" type="slide"/><joint name="r" pos="1 2 3"/><geom size="1"/></body>'))
    view = robot.parent_joint[Id("body", "b")]
    assert [(dof.name, dof.kind) for dof in view.joint.dofs] == [("x", DofKind.SLIDE), ("r", DofKind.HINGE)]
    assert view.joint.dofs[1].anchor == (1.0, 2.0, 3.0)
    assert view.parent == WORLD


def test_a_body_without_joints_is_fixed() -> None:
    robot = read_text(in_world('<body name="b" pos="1 0 0"><geom size="1"/></body>'))
    view = robot.parent_joint[Id("body", "b")]
    assert view.joint.dofs == ()
    assert view.parent_pose.xyz == (1.0, 0.0, 0.0)


def test_the_element_wins_over_its_class_and_its_class_over_the_childclass() -> None:
    head = """<default><joint damping="1"/><default class="a"><joint damping="2" armature="2"/></default>
        <default class="b"><joint armature="3" frictionloss="3"/></default></default>"""
    robot = read_text(in_world('<body childclass="a"><joint name="j" class="b" frictionloss="4"/><geom size="1"/></body>', head))
    dof = robot.joints[Id("joint", "j")].joint.dofs[0]
    assert (dof.damping, dof.armature, dof.friction) == (1.0, 3.0, 4.0)


def test_actuators_of_all_kinds_share_what_they_have_in_common_in_a_class() -> None:
    head = """<default><position ctrllimited="true" kp="10"/><motor ctrlrange="-3 3" gear="7"/>
        <default class="a"><position kp="5"/><default class="b"><general ctrlrange="-1 1"/></default></default></default>"""
    body = '<worldbody><body><joint name="j"/><geom size="1"/></body></worldbody>'
    text = f"""<mujoco>{head}{body}<actuator><position joint="j" name="p"/><position joint="j" name="q" class="a"/>
        <position joint="j" name="r" class="b"/><motor joint="j" name="m"/></actuator></mujoco>"""
    robot = read_text(text)
    model = mujoco.MjModel.from_xml_string(text)
    found = {key.name: dict(actuator.parameters) for key, actuator in robot.vertices(Actuator)}
    for name, attributes in found.items():
        number = model.actuator(name).id
        assert attributes["ctrlrange"] == tuple(model.actuator_ctrlrange[number])
        assert attributes.get("kp", 1.0) == model.actuator_gainprm[number, 0]
        assert model.actuator_gear[number, 0] == 7.0


def test_a_nested_class_begins_with_what_its_parent_has() -> None:
    head = '<default><default class="a"><joint damping="2"/><default class="b"><joint armature="3"/></default></default></default>'
    robot = read_text(in_world('<body><joint name="j" class="b"/><geom size="1"/></body>', head))
    dof = robot.joints[Id("joint", "j")].joint.dofs[0]
    assert (dof.damping, dof.armature) == (2.0, 3.0)


def test_an_own_orientation_replaces_that_of_the_class_whatever_its_kind() -> None:
    head = '<default><geom euler="90 0 0"/></default>'
    robot = read_text(in_world('<geom size="1" quat="1 0 0 0"/><geom size="1"/>', head))
    own, inherited = robot.shapes[WORLD]
    assert own.pose.quat == (1.0, 0.0, 0.0, 0.0)
    assert inherited.pose.quat == pytest.approx((math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0))


@pytest.mark.parametrize(
    ("head", "orientation", "quat"),
    [
        ("", 'euler="10 20 30"', (0.9437144, 0.1276794, 0.1448781, 0.2685358)),
        ('<compiler eulerseq="XYZ"/>', 'euler="10 20 30"', (0.9515485, 0.0381346, 0.1893079, 0.2392983)),
        ("", 'axisangle="0 0 2 90"', (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))),
        ("", 'xyaxes="0 1 0 -1 0 0"', (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))),
        ("", 'zaxis="0 0 -1"', (0.0, 1.0, 0.0, 0.0)),
        ("", 'quat="2 0 0 2"', (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))),
        ('<compiler angle="radian"/>', 'euler="0 0 1.5"', (math.cos(0.75), 0.0, 0.0, math.sin(0.75))),
    ],
)
def test_every_notation_of_an_orientation(head: str, orientation: str, quat: tuple[float, ...]) -> None:
    robot = read_text(in_world(f'<body name="b" {orientation}/>', head))
    assert robot.parent_joint[Id("body", "b")].parent_pose.quat == pytest.approx(quat, abs=1e-7)


def test_angles_about_fixed_axes_are_roll_pitch_and_yaw() -> None:
    robot = read_text(in_world('<body name="b" euler=".1 .2 .3"/>', '<compiler angle="radian" eulerseq="XYZ"/>'))
    assert robot.parent_joint[Id("body", "b")].parent_pose == pose_from_rpy((0.0, 0.0, 0.0), (0.1, 0.2, 0.3))
    assert robot.parent_joint[Id("body", "b")].parent_pose.written == Written("rpy", (0.1, 0.2, 0.3))


@pytest.mark.parametrize(("word", "whole"), [("box", Box((0.08, 0.08, 2.0))), ("ellipsoid", Ellipsoid((0.04, 0.04, 1.0)))])
def test_between_two_points_boxes_and_ellipsoids_are_square_across(word: str, whole: Geometry) -> None:
    robot = read_text(in_world(f'<geom type="{word}" size=".04 .025 .3" fromto="0 0 0 0 0 2"/>'))
    assert [shape.geometry for _, shape, _ in robot.edges(Shape)] == [whole]


def test_fromto_is_midway_and_its_z_axis_leads_from_the_second_point_to_the_first() -> None:
    robot = read_text(in_world('<geom type="capsule" size=".1" fromto="0 0 0 0 0 1"/>'))
    (view,) = robot.shapes[WORLD]
    assert view.shape.geometry == Capsule(0.1, 1.0)
    assert view.pose.xyz == (0.0, 0.0, 0.5)
    assert view.pose.quat == (0.0, 1.0, 0.0, 0.0)


def test_a_frame_moves_what_is_in_it_and_gives_it_a_class() -> None:
    head = '<default><default class="a"><geom rgba="1 0 0 1"/></default></default>'
    robot = read_text(in_world('<frame pos="1 0 0" euler="0 0 90" childclass="a"><geom size="1" pos="1 0 0"/></frame>', head))
    (view,) = robot.shapes[WORLD]
    assert view.pose.xyz == pytest.approx((1.0, 1.0, 0.0))
    assert view.shape.rgba == (1.0, 0.0, 0.0, 1.0)


def test_geoms_that_touch_nothing_are_for_the_eye_and_hidden_ones_for_contact() -> None:
    robot = read_text(in_world('<geom size="1"/><geom size="1" contype="0" conaffinity="0"/><geom size="1" group="3"/>'))
    assert [view.shape.role for view in robot.shapes[WORLD]] == [Role.BOTH, Role.VISUAL, Role.COLLISION]


def test_a_plane_and_a_mesh() -> None:
    head = '<asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>'
    robot = read_text(in_world('<geom type="plane" size="1 2 .1"/><geom type="mesh" mesh="m"/>', head))
    plane, mesh = robot.shapes[WORLD]
    assert plane.shape.geometry == Plane((1.0, 2.0))
    assert (mesh.shape.geometry, mesh.mesh) == (MeshShape(), Id("mesh", "m"))


def test_a_diagonal_inertia_in_turned_axes_is_a_full_tensor_about_the_centre_of_mass() -> None:
    robot = read_text(in_world('<body name="b"><inertial pos="0 0 1" mass="2" diaginertia="1 2 3" euler="0 0 90"/></body>'))
    inertial = robot.vertex(Id("body", "b"), Body).inertial
    assert inertial is not None
    assert inertial.tensor == pytest.approx((2.0, 1.0, 3.0, 0.0, 0.0, 0.0))


def test_the_anchor_of_a_connect_is_the_same_point_seen_from_both_bodies() -> None:
    bodies = '<body name="a" pos="1 0 0"><geom size="1"/></body><body name="b" pos="0 0 2"><geom size="1"/></body>'
    text = f'<mujoco><worldbody>{bodies}</worldbody><equality><connect body1="a" body2="b" anchor="0 0 1"/></equality></mujoco>'
    (_, loop, arcs) = next(iter(read_text(text).edges(Loop)))
    assert loop.kind == "connect"
    assert [arc.weight.xyz for arc in arcs if arc.weight] == [(0.0, 0.0, 1.0), (1.0, 0.0, -1.0)]  # type: ignore[union-attr]


# ---- what MuJoCo refuses -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (in_world('<body quat="1 0 0 0" euler="0 0 0"/>'), "robot.xml:1: error[HX047]: <body> has more than one orientation: quat, euler"),
        (in_world('<body pos="1 2"/>'), "robot.xml:1: error[HX020]: <body pos> is '1 2', expected 3 numbers"),
        (in_world('<body nmae="b"/>'), "robot.xml:1: error[HX027]: <body> has no attribute 'nmae'"),
        (in_world("<bodi/>"), "robot.xml:1: error[HX027]: <worldbody> has no <bodi>"),
        (
            in_world('<body><joint limited="true"/></body>'),
            "robot.xml:1: error[HX020]: <joint range> is missing, expected a lower and a greater number, since limited is true",
        ),
        (
            in_world('<body name="b"/><body name="b"/>'),
            "robot.xml:1: error[HX023]: body 'b' is defined twice; the first one: robot.xml:1",
        ),
        (in_world('<body childclass="x"/>'), "robot.xml:1: error[HX040]: <body> has the class 'x', which is not defined"),
        (
            in_world("<body><joint type='ball'/><joint/></body>"),
            "robot.xml:1: error[HX027]: a ball joint is followed by another rotation in the same body",
        ),
        (
            in_world("<body><body><freejoint/></body></body>"),
            "robot.xml:1: error[HX027]: a free joint cannot stand here: its body is not a child of the world",
        ),
        (
            in_world("", '<compiler coordinate="global"/>'),
            'robot.xml:1: error[HX027]: <compiler coordinate="global"> was removed in MuJoCo 2.3.4',
        ),
        (in_world("<composite/>"), "robot.xml:1: error[HX027]: <worldbody> has no <composite>"),
        (
            in_world('<body><inertial pos="0 0 0" mass="1" fullinertia="1 1 1 0 0 0" quat="1 0 0 0"/></body>'),
            "robot.xml:1: error[HX020]: <inertial fullinertia> is '1 1 1 0 0 0', expected no orientation and no diaginertia beside it",
        ),
        (in_world('<geom type="mesh" mesh="m"/>'), "robot.xml:1: error[HX040]: <geom> refers to the mesh 'm', which is not there"),
        (in_world('<geom type="box" size="1"/>'), "robot.xml:1: error[HX020]: <geom size> is '1', expected 3 numbers for a box"),
    ],
)
def test_what_mujoco_refuses_is_refused_with_its_place(text: str, message: str) -> None:
    assert refused(text) == message


def test_a_message_names_the_line_of_the_element() -> None:
    assert refused("<mujoco>\n<worldbody>\n<body pos='x'/>\n</worldbody>\n</mujoco>").startswith("robot.xml:3: ")


def test_the_anchor_of_a_weld_goes_where_its_relative_pose_says() -> None:
    """MuJoCo's residual is zero exactly where the two frames of our closure meet."""
    text = (
        '<mujoco><worldbody><body name="a"><freejoint/><geom size=".1"/></body>'
        '<body name="b"><freejoint/><geom size=".1"/></body></worldbody>'
        '<equality><weld name="w" body1="a" body2="b" relpose="0.5 0 0 1 -.3 0 0" anchor="0 -2 0"/></equality></mujoco>'
    )
    first, second = (pose_weight(arc) for arc in read_text(text).graph.edges[Id("loop", "w")].arcs)
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    placed = compose(first, inverse(second))
    data.qpos[7:] = [*placed.xyz, *placed.quat]
    mujoco.mj_forward(model, data)
    assert abs(data.efc_pos[: model.neq * 6]).max() < 1e-12
