"""What other converters get wrong on real URDF files, one sentence each."""

from __future__ import annotations

import inspect
import sys

import pytest

from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.parts import Body, Box, Inertial, InertialWritten, Mesh, NoShape, Shape
from hymeko_x.ir.values import Written, pose_from_rpy, rotate_tensor
from tests.urdf.samples import LIMIT, TWO_LINKS, again, dump, joint, load, reported, robot, tags, visual

A, J = Id("body", "a"), Id("joint", "j")
SPHERE = '<geometry><sphere radius="1"/></geometry>'


def test_the_rpy_of_an_inertial_turns_the_tensor_and_is_written_again() -> None:
    inside = '<origin xyz="0 0 1" rpy="0.1 0.2 0.3"/><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="2.5"/>'
    mechanism = load(robot(f'<link name="a"><inertial>{inside}</inertial></link>'))
    frame = pose_from_rpy((0.0, 0.0, 1.0), (0.1, 0.2, 0.3))
    own = (1.0, 2.0, 2.5, 0.0, 0.0, 0.0)
    inertial = mechanism.vertex(A, Body).inertial
    assert inertial == Inertial(1.0, (0.0, 0.0, 1.0), rotate_tensor(frame.quat, own))
    assert inertial.written == InertialWritten(frame, own)
    written = dump(mechanism)
    assert '<origin xyz="0 0 1" rpy="0.1 0.2 0.3"/>' in written
    assert '<inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="2.5"/>' in written


def test_a_tensor_that_was_changed_is_not_written_in_its_old_axes() -> None:
    inside = '<origin xyz="0 0 1" rpy="0.1 0.2 0.3"/><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="2.5"/>'
    mechanism = load(robot(f'<link name="a"><inertial>{inside}</inertial></link>'))
    inertial = mechanism.vertex(A, Body).inertial
    assert inertial is not None
    changed = Body(Inertial(1.0, inertial.com, (3.0, 3.0, 3.0, 0.0, 0.0, 0.0), inertial.written))
    written = dump(mechanism.replace(vertices={A: changed}))
    assert 'rpy="0 0 0"' in written
    assert '<inertia ixx="3" ixy="0" ixz="0" iyy="3" iyz="0" izz="3"/>' in written


def test_off_diagonal_inertia_and_the_inertial_of_the_root_are_kept() -> None:
    tensor = '<inertia ixx="1" ixy="0.01" ixz="-0.02" iyy="2" iyz="0.03" izz="2.5"/>'
    source = robot(f'<link name="a"><inertial><mass value="7"/>{tensor}</inertial></link><link name="b"/>{joint(LIMIT)}')
    assert load(source).vertex(A, Body) == Body(Inertial(7.0, tensor=(1.0, 2.0, 2.5, 0.01, -0.02, 0.03)))
    assert tensor in again(source)


@pytest.mark.parametrize("name", ["a.b", "a/b", "a b", "7dof", "world", "a:b", " a", "a#2", "sĥerical", "${ns}a", "&lt;a&gt;&amp;&quot;"])
@pytest.mark.unread("HX024")
def test_any_string_is_a_name_and_comes_back_as_it_is(name: str) -> None:
    source = robot(f'<link name="{name}"/><link name="b"/>{joint(LIMIT, parent=name)}', f' name="{name}"')
    mechanism = load(source)
    assert load(dump(mechanism)) == mechanism
    assert f'<robot name="{name.replace("&gt;", ">")}">' in dump(mechanism).replace("&gt;", ">")
    assert f'<parent link="{name.replace("&gt;", ">")}"/>' in dump(mechanism).replace("&gt;", ">")


def test_a_link_called_world_is_a_link_like_any_other() -> None:
    mechanism = load(robot(f'<link name="world"/><link name="b"/>{joint("", "fixed", parent="world")}'))
    assert mechanism.joints[J].parent == Id("body", "world")


def test_a_link_and_a_joint_may_share_a_name() -> None:
    source = robot(TWO_LINKS + joint(LIMIT, name="a"))
    assert reported(source) == []
    assert set(load(source).graph.edges) == {Id("joint", "a")}


@pytest.mark.unread("HX040")
def test_mimic_of_an_absent_joint_is_kept_as_it_was() -> None:
    source = robot(TWO_LINKS + joint(LIMIT + '<mimic joint="gone" multiplier="2.0"/>'))
    assert '<mimic joint="gone" multiplier="2.0"/>' in again(source)
    assert [extra.text for extra in load(source).extras[J]] == ['<mimic joint="gone" multiplier="2.0"/>']


@pytest.mark.unread("HX040")
def test_mimic_of_a_fixed_joint_is_kept_as_it_was() -> None:
    body = TWO_LINKS + '<link name="c"/>' + joint(LIMIT + '<mimic joint="k"/>') + joint("", "fixed", name="k", child="c")
    assert '<mimic joint="k"/>' in again(robot(body))
    assert [extra.text for extra in load(robot(body)).extras[J]] == ['<mimic joint="k"/>']


@pytest.mark.unread("HX040")
def test_a_fixed_joint_that_mimics_keeps_its_mimic() -> None:
    body = TWO_LINKS + '<link name="c"/>' + joint('<mimic joint="k" offset="0.0"/>', "fixed") + joint(LIMIT, name="k", child="c")
    assert '<mimic joint="k" offset="0.0"/>' in again(robot(body))


def test_xmlns_xacro_in_a_plain_urdf_is_kept_and_says_nothing() -> None:
    source = robot('<link name="a"/>', ' name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"')
    assert reported(source) == []
    assert '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">' in again(source)


@pytest.mark.unread("HX020")
def test_a_mesh_scale_of_one_number_scales_alike_in_all_directions() -> None:
    mechanism = load(robot(visual('<geometry><mesh filename="m.stl" scale="0.001"/></geometry>')))
    assert mechanism.vertex(Id("mesh", "m"), Mesh).scale == (0.001, 0.001, 0.001)
    assert 'scale="0.001 0.001 0.001"' in dump(mechanism)


def test_a_negative_mesh_scale_mirrors() -> None:
    source = robot(visual('<geometry><mesh filename="m.stl" scale="1 -1 1"/></geometry>'))
    assert load(source).vertex(Id("mesh", "m"), Mesh).scale == (1.0, -1.0, 1.0)
    assert 'scale="1 -1 1"' in again(source)


def test_uris_of_meshes_and_textures_are_kept_letter_by_letter() -> None:
    inside = (
        '<geometry><mesh filename="package://p q/m/a b.dae"/></geometry>'
        '<material name="m"><texture filename="package://p/t.png"/></material>'
    )
    written = again(robot(visual(inside)))
    assert 'filename="package://p q/m/a b.dae"' in written
    assert 'filename="package://p/t.png"' in written


@pytest.mark.parametrize("name", ["", ' name=""'])
@pytest.mark.unread("HX022", "HX042")
def test_the_colour_of_an_unnamed_material_is_the_colour_of_the_shape(name: str) -> None:
    material = f'<material{name}><color rgba="0.1 0.2 0.3 1"/></material>'
    mechanism = load(robot(visual(SPHERE + material) + visual(SPHERE + material.replace("0.1", "0.5")).replace('"a"', '"b"')))
    colours = [edge.data.rgba for edge in mechanism.graph.edges.values() if isinstance(edge.data, Shape)]
    assert colours == [(0.1, 0.2, 0.3, 1.0), (0.5, 0.2, 0.3, 1.0)]
    assert dump(mechanism).count('<material name="">') == 2


def test_an_unnamed_material_with_a_texture_is_written_again() -> None:
    source = robot(visual(SPHERE + '<material name=""><color rgba="1 1 1 1"/><texture filename="t.png"/></material>'))
    assert tags(again(source)) - tags(source) == tags(source) - tags(again(source)) == {}


def test_a_box_without_any_size_stays_a_box() -> None:
    source = robot(visual('<geometry><box size="0 0 0"/></geometry>'))
    assert load(source).shapes[A][0].shape.geometry == Box((0.0, 0.0, 0.0))
    assert '<box size="0 0 0"/>' in again(source)


def test_fixed_joints_keep_their_names_and_links_without_mass_stay() -> None:
    source = robot(f'{TWO_LINKS}<link name="c"/>{joint("", "fixed", name="mount")}{joint(LIMIT, parent="b", child="c")}')
    mechanism = load(source)
    assert mechanism.vertex(Id("body", "b"), Body) == Body(None)
    assert '<joint name="mount" type="fixed">' in dump(mechanism)
    assert load(dump(mechanism)) == mechanism


def test_missing_mass_and_a_mass_of_zero_are_different_things() -> None:
    zero = load(
        robot('<link name="a"><inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>')
    )
    assert zero.vertex(A, Body).inertial == Inertial(0.0, tensor=(0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    assert load(robot('<link name="a"/>')).vertex(A, Body).inertial is None


@pytest.mark.parametrize(
    "number", ["0.1", "1e-300", "3.141592653589793", "-0.00035999999999999997", "123456789.12345679", "5e-324", "0.30000000000000004"]
)
def test_numbers_come_back_to_the_last_digit(number: str) -> None:
    source = robot(TWO_LINKS + joint(f'<origin xyz="{number} 0 0" rpy="{number} 1.5707963267948966 0"/>', "fixed"))
    assert load(again(source)) == load(source)
    assert f'<origin xyz="{number} 0 0" rpy="{number} 1.5707963267948966 0"/>' in again(source)


def test_an_axis_that_is_not_quite_unit_is_normalised_and_written_as_it_was() -> None:
    source = robot(TWO_LINKS + joint(f'<axis xyz="0 0.70710678 0.70710678"/>{LIMIT}'))
    dof = load(source).joints[J].joint.dofs[0]
    assert dof.axis == pytest.approx((0.0, 0.5**0.5, 0.5**0.5), abs=1e-15)
    assert dof.written == Written("axis", (0.0, 0.70710678, 0.70710678))
    assert '<axis xyz="0 0.70710678 0.70710678"/>' in again(source)


@pytest.mark.unread("HX026")
def test_a_zero_axis_is_read_as_x_and_written_as_it_was() -> None:
    source = robot(TWO_LINKS + joint(f'<axis xyz="0 0 0"/>{LIMIT}'))
    assert load(source).joints[J].joint.dofs[0].axis == (1.0, 0.0, 0.0)
    assert '<axis xyz="0 0 0"/>' in again(source)


@pytest.mark.unread("HX044")
def test_a_joint_without_limits_is_unlimited_and_written_so_that_urdfdom_accepts_it() -> None:
    source = robot(TWO_LINKS + joint("", "prismatic"))
    limit = '<limit lower="-1e9" upper="1e9" effort="1e9" velocity="1e9"/>'
    assert load(source).joints[J].joint.dofs[0].limits.lower is None
    assert limit in again(source)
    assert load(again(source)) == load(source)


def test_a_limit_without_bounds_is_zero_as_the_standard_says() -> None:
    limits = load(robot(TWO_LINKS + joint('<limit effort="1" velocity="1"/>'))).joints[J].joint.dofs[0].limits
    assert (limits.lower, limits.upper) == (0.0, 0.0)


def test_the_limits_of_a_continuous_joint_are_kept_and_mean_nothing() -> None:
    source = robot(TWO_LINKS + joint('<limit lower="-1" upper="1" effort="2" velocity="3"/>', "continuous"))
    limits = load(source).joints[J].joint.dofs[0].limits
    assert (limits.lower, limits.upper, limits.effort, limits.velocity) == (None, None, 2.0, 3.0)
    assert tags(again(source))["robot/joint/limit@lower"] == 1


@pytest.mark.unread("HX045")
def test_an_empty_geometry_stays_empty() -> None:
    source = robot(visual("<geometry/>"))
    assert load(source).shapes[A][0].shape.geometry == NoShape()
    assert "<geometry/>" in again(source)


def test_a_namespace_as_the_default_changes_nothing() -> None:
    plain = load(robot('<link name="a"><foo/></link>'))
    with_space = load(robot('<link name="a"><foo/></link>', ' name="r" xmlns="http://drake.mit.edu"'))
    assert with_space.graph == plain.graph
    assert again(robot('<link name="a"><foo/></link>', ' name="r" xmlns="http://drake.mit.edu"')).count("xmlns") == 1


def test_a_chain_of_ten_thousand_links_needs_no_recursion() -> None:
    count = 10_000
    links = "".join(f'<link name="l{number}"/>' for number in range(count))
    joints = "".join(joint(LIMIT, name=f"j{number}", parent=f"l{number - 1}", child=f"l{number}") for number in range(1, count))
    before = sys.getrecursionlimit()
    depth = len(inspect.stack())
    sys.setrecursionlimit(depth + 60)
    try:
        text = again(robot(links + joints))
    finally:
        sys.setrecursionlimit(before)
    assert text.count("<link name=") == count
    assert text.count("<joint ") == count - 1
