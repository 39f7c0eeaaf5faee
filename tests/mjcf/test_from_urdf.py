"""What converters get wrong on real URDFs, each in its own test."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

import mujoco
import numpy as np
import pytest
import trimesh

import hymeko_x as hx
from hymeko_x.rewrite import Options
from tests.mjcf.convert import convert_text, tensor_in_body, worst_pose_error

INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
LIMIT = '<limit lower="-1" upper="1" effort="10" velocity="1"/>'
STL = trimesh.creation.box((1.0, 2.0, 3.0)).export(file_type="stl")


def robot(*parts: str) -> str:
    return f'<robot name="r">{"".join(parts)}</robot>'


def link(name: str, content: str = INERTIAL) -> str:
    return f'<link name="{name}">{content}</link>'


def joint(name: str, parent: str, child: str, content: str = "", kind: str = "revolute") -> str:
    content = content + (LIMIT if kind in ("revolute", "prismatic") else "")
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{content}</joint>'


def visual(geometry: str, extra: str = "", name: str = "") -> str:
    given = f' name="{name}"' if name else ""
    return f"<visual{given}><geometry>{geometry}</geometry>{extra}</visual>"


def mesh(uri: str, scale: str = "") -> str:
    return f'<mesh filename="{uri}"' + (f' scale="{scale}"' if scale else "") + "/>"


def collision(geometry: str) -> str:
    return f"<collision><geometry>{geometry}</geometry></collision>"


# ---- inertia -------------------------------------------------------------------------------------------------------------------


def test_the_rotation_of_an_inertial_turns_its_tensor() -> None:
    turned = (
        '<inertial><origin xyz="0.1 0.2 0.3" rpy="0 0 1.5707963267948966"/><mass value="2"/>'
        '<inertia ixx="1" iyy="2" izz="2.5" ixy="0" ixz="0" iyz="0"/></inertial>'
    )
    model = convert_text(robot(link("a", turned))).model()
    assert tensor_in_body(model, 1) == pytest.approx(np.diag([2.0, 1.0, 2.5]), abs=1e-12)
    assert list(model.body_ipos[1]) == [0.1, 0.2, 0.3]


def test_products_of_inertia_and_the_inertial_of_the_root_are_kept() -> None:
    full = '<inertial><mass value="2"/><inertia ixx="1" iyy="2" izz="2.5" ixy="0.1" ixz="-0.2" iyz="0.3"/></inertial>'
    model = convert_text(robot(link("root", full), link("b"), joint("j", "root", "b", kind="fixed"))).model()
    assert model.body("root").mass[0] == 2.0
    assert tensor_in_body(model, 1) == pytest.approx(np.array([[1.0, 0.1, -0.2], [0.1, 2.0, 0.3], [-0.2, 0.3, 2.5]]), abs=1e-12)


def test_massless_links_in_the_middle_of_a_chain_get_the_least_inertia_and_that_is_reported() -> None:
    links = [link("a"), link("middle", ""), link("c")]
    done = convert_text(robot(*links, joint("1", "a", "middle"), joint("2", "middle", "c")))
    assert done.model().body("middle").mass[0] == 1e-10
    assert done.reported("HX103") == [
        "warning HX103 body 'middle': moves and has no mass; mass 1e-10 and inertia 1e-10 1e-10 1e-10 0 0 0 are written"
    ]


def test_a_massless_link_that_carries_a_fixed_mass_is_left_alone() -> None:
    done = convert_text(robot(link("a"), link("m", ""), link("c"), joint("1", "a", "m"), joint("2", "m", "c", kind="fixed")))
    assert (done.model().body("m").mass[0], done.reported("HX103")) == (0.0, [])


# ---- names and structure ---------------------------------------------------------------------------------------------------------


def test_names_with_dots_slashes_blanks_and_leading_digits_arrive() -> None:
    names = ["left/base", "link_1.0", "0_link", "two words", "ünï"]
    joints = [joint(f"{above} to {below}", above, below) for above, below in pairwise(names)]
    model = convert_text(robot(*map(link, names), *joints)).model()
    assert [model.body(i).name for i in range(1, model.nbody)] == names
    assert [model.joint(i).name for i in range(model.njnt)] == [f"{a} to {b}" for a, b in pairwise(names)]


def test_a_link_and_a_joint_may_share_a_name() -> None:
    model = convert_text(robot(link("a"), link("x"), joint("x", "a", "x"))).model()
    assert (model.body("x").id, model.joint("x").id) == (2, 0)


def test_a_root_link_called_world_is_the_world_and_its_shapes_stay() -> None:
    floor = link("world", collision('<box size="4 4 0.1"/>'))
    done = convert_text(robot(floor, link("arm"), joint("j", "world", "arm")))
    model = done.model()
    assert (model.nbody, model.body("arm").parentid[0], model.geom(0).bodyid[0]) == (2, 0, 0)
    assert done.reported("HX101", "HX102") == []


def test_fixed_links_stay_bodies_of_their_own(tmp_path: Path) -> None:
    origin = '<origin xyz="1 2 3" rpy="0.1 0.2 0.3"/>'
    text = robot(link("a"), link("b"), link("tool0", ""), joint("1", "a", "b", origin), joint("2", "b", "tool0", origin, "fixed"))
    path = tmp_path / "r.urdf"
    path.write_text(text)
    assert worst_pose_error(path, convert_text(text).model(), {}) < 1e-12


def test_a_prefix_for_xacro_in_a_plain_urdf_is_no_obstacle() -> None:
    text = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="a"/></robot>'
    assert convert_text(text).model().nbody == 2


def test_an_axis_that_is_not_of_unit_length_is_normalised(tmp_path: Path) -> None:
    text = robot(link("a"), link("b"), joint("1", "a", "b", '<axis xyz="0 0 1.0000001"/>'))
    path = tmp_path / "r.urdf"
    path.write_text(text)
    assert worst_pose_error(path, convert_text(text).model(), {}) < 1e-12


# ---- joints ----------------------------------------------------------------------------------------------------------------------


def test_numbers_arrive_to_the_last_digit() -> None:
    given = '<origin xyz="0.1234567890123456 1e-17 -0.3333333333333333"/><axis xyz="0 0 1"/><dynamics damping="0.12345678901234568"/>'
    model = convert_text(robot(link("a"), link("b"), joint("1", "a", "b", given))).model()
    assert list(model.body_pos[2]) == [0.1234567890123456, 1e-17, -0.3333333333333333]
    assert model.dof_damping[0] == 0.12345678901234568


def test_roll_pitch_and_yaw_come_back_without_a_record_of_them(tmp_path: Path) -> None:
    turned = '<origin xyz="0 0 1" rpy="0.3 0 -1.2"/><axis xyz="0 0 1"/>'
    (tmp_path / "arm.urdf").write_text(robot(link("a"), link("b"), joint("j", "a", "b", turned)))
    result = hx.convert(tmp_path / "arm.urdf", tmp_path / "arm.xml", keep="beside")
    assert 'euler="0.3 0 -1.2"' in result.package.main.decode()
    assert "velocity" in result.package.kept
    assert "turn" not in result.package.kept


def test_limits_damping_friction_and_effort_arrive() -> None:
    given = '<dynamics damping="0.5" friction="0.25"/>'
    model = convert_text(robot(link("a"), link("b"), joint("1", "a", "b", given))).model()
    assert (list(model.jnt_range[0]), list(model.jnt_actfrcrange[0])) == ([-1.0, 1.0], [-10.0, 10.0])
    assert (model.dof_damping[0], model.dof_frictionloss[0]) == (0.5, 0.25)


def test_a_continuous_joint_has_no_limits() -> None:
    model = convert_text(robot(link("a"), link("b"), joint("1", "a", "b", kind="continuous"))).model()
    assert not model.jnt_limited[0]


def test_missing_limits_do_not_lock_the_joint() -> None:
    bare = '<joint name="1" type="revolute"><parent link="a"/><child link="b"/><limit effort="1" velocity="1"/></joint>'
    done = convert_text(robot(link("a"), link("b"), bare))
    assert not done.model().jnt_limited[0]
    assert done.reported("HX101") == [
        "warning HX101 joint '1': both limits are 0, as where URDF leaves them out; it is written without position limits"
    ]


def test_mimic_is_an_equality_that_holds_in_simulation() -> None:
    mimic = '<axis xyz="0 0 1"/><mimic joint="1" multiplier="-2" offset="0.3"/>'
    links = [link("a"), link("b"), link("c")]
    text = robot(*links, joint("1", "a", "b", '<axis xyz="0 0 1"/>'), joint("2", "b", "c", mimic))
    model = convert_text(text).model()
    data = mujoco.MjData(model)
    data.qpos[:] = (0.25, 0.3 - 2.0 * 0.25)
    mujoco.mj_forward(model, data)
    assert (data.ne, abs(float(data.efc_pos[0])) < 1e-12) == (1, True)


@pytest.mark.parametrize("leader", ["fixed", "nobody"])
@pytest.mark.unread("HX040")
def test_mimic_of_a_fixed_or_absent_joint_compiles_without_an_equality(leader: str) -> None:
    links = [link("a"), link("b"), link("c")]
    mimic = f'<mimic joint="{leader}" multiplier="2"/>'
    done = convert_text(robot(*links, joint("fixed", "a", "b", kind="fixed"), joint("2", "b", "c", mimic)))
    assert done.model().neq == 0


def test_a_planar_joint_is_two_slides_and_a_hinge_about_its_normal() -> None:
    model = convert_text(robot(link("a"), link("b"), joint("p", "a", "b", '<axis xyz="0 0 1"/>', "planar"))).model()
    data = mujoco.MjData(model)
    data.qpos[:] = (1.0, 2.0, math.pi / 2.0)
    mujoco.mj_kinematics(model, data)
    assert list(data.xpos[2]) == pytest.approx([1.0, 2.0, 0.0])
    assert data.xmat[2].reshape(3, 3)[:, 0] == pytest.approx([0.0, 1.0, 0.0])


def test_a_floating_joint_inside_the_tree_moves_freely() -> None:
    text = robot(link("a"), link("b"), joint("f", "a", "b", '<origin xyz="0 0 1"/>', "floating"))
    model = convert_text(text).model()
    data = mujoco.MjData(model)
    data.qpos[:] = (1.0, 2.0, 3.0, math.cos(0.5), 0.0, 0.0, math.sin(0.5))
    mujoco.mj_kinematics(model, data)
    assert list(data.xpos[2]) == pytest.approx([1.0, 2.0, 4.0])
    assert list(data.xquat[2]) == pytest.approx([math.cos(0.5), 0.0, 0.0, math.sin(0.5)])


def test_a_floating_base_is_free_and_its_links_keep_their_names() -> None:
    done = convert_text(robot(link("a"), link("b"), joint("1", "a", "b")), options=Options(base="free"))
    model = done.model()
    assert (model.nq, model.jnt_type[0], model.body("a").parentid[0]) == (8, mujoco.mjtJoint.mjJNT_FREE, 0)


def test_transmissions_are_what_their_interfaces_name_unless_others_are_asked_for() -> None:
    transmission = (
        '<transmission name="t"><type>transmission_interface/SimpleTransmission</type>'
        '<joint name="1"><hardwareInterface>EffortJointInterface</hardwareInterface></joint>'
        '<actuator name="m"><mechanicalReduction>50</mechanicalReduction></actuator></transmission>'
    )
    text = robot(link("a"), link("b"), joint("1", "a", "b"), transmission)
    model = convert_text(text).model()
    assert (model.actuator("m").gear[0], list(model.actuator_ctrlrange[0])) == (50.0, [-0.2, 0.2])
    assert convert_text(text, options=Options("fixed", "none")).model().nu == 0
    model = convert_text(text, options=Options("fixed", "position")).model()
    assert (model.nu, list(model.actuator_ctrlrange[0]), model.actuator_gainprm[0, 0]) == (1, [-1.0, 1.0], 400.0)


# ---- shapes ----------------------------------------------------------------------------------------------------------------------


def test_shapes_have_half_sizes_and_the_classes_of_their_role() -> None:
    content = INERTIAL + visual('<cylinder radius="0.1" length="1"/>') + collision('<box size="1 2 3"/>')
    model = convert_text(robot(link("a", content))).model()
    assert (list(model.geom_size[0, :2]), list(model.geom_size[1])) == ([0.1, 0.5], [0.5, 1.0, 1.5])
    assert (list(model.geom_contype), list(model.geom_group)) == ([0, 1], [2, 3])
    assert model.body("a").mass[0] == 1.0


def test_a_box_of_size_zero_compiles_and_that_is_reported() -> None:
    done = convert_text(robot(link("a", visual('<box size="0 0 0"/>'))))
    assert done.model().ngeom == 1
    assert done.reported("HX101") == ["warning HX101 shape 'a/visual' has the size [0.0 0.0 0.0]; [1e-06 1e-06 1e-06] is written"]


def test_the_second_visual_of_a_name_goes_without() -> None:
    model = convert_text(robot(link("a", visual('<sphere radius="1"/>', name="v") * 2))).model()
    assert [model.geom(i).name for i in range(2)] == ["v", ""]


def test_materials_are_shared_and_unnamed_ones_are_the_shapes_own_colour() -> None:
    named = '<material name="red"><color rgba="1 0 0 1"/></material>'
    unnamed = '<material name=""><color rgba="0 1 0 0.5"/></material>'
    sphere = '<sphere radius="1"/>'
    shapes = visual(sphere, named) + visual(sphere, '<material name="red"/>') + visual(sphere, unnamed)
    model = convert_text(robot(link("a", shapes))).model()
    assert (model.nmat, list(model.mat_rgba[0])) == (1, [1.0, 0.0, 0.0, 1.0])
    assert list(model.geom_matid) == [0, 0, -1]
    assert list(model.geom_rgba[2]) == [0.0, 1.0, 0.0, 0.5]


@pytest.mark.parametrize(("scale", "factors"), [("2", (2.0, 2.0, 2.0)), ("-1 1 1", (-1.0, 1.0, 1.0)), ("0.001 0.001 0.001", (0.001,) * 3)])
@pytest.mark.unread("HX020")
def test_meshes_keep_their_scale_and_mirror(scale: str, factors: tuple[float, ...]) -> None:
    done = convert_text(robot(link("a", visual(mesh("package://p/a.stl", scale)))), {"package://p/a.stl": STL})
    model = done.model()
    assert list(model.mesh_scale[0]) == list(factors)
    assert done.assets == {"meshes/a.stl": STL}


def test_a_mesh_that_is_not_there_leaves_out_its_shapes_and_says_so() -> None:
    missing = mesh("package://p/gone.stl")
    done = convert_text(robot(link("a", visual(missing) + collision(missing))))
    assert done.model().ngeom == 0
    assert done.reported("HX201") == [
        "warning HX201 mesh 'gone': 'package://p/gone.stl' was not found; "
        "left out: visual 'a/visual' of body 'a', collision 'a/collision' of body 'a'"
    ]


def test_a_texture_that_is_not_there_leaves_the_colour() -> None:
    material = '<material name="m"><color rgba="1 0 0 1"/><texture filename="package://p/gone.png"/></material>'
    done = convert_text(robot(link("a", visual('<sphere radius="1"/>', material))))
    model = done.model()
    assert (model.ntex, list(model.mat_rgba[0])) == (0, [1.0, 0.0, 0.0, 1.0])
    assert done.reported("HX201") == ["warning HX201 texture 'gone': 'package://p/gone.png' was not found; the texture is left out"]


def test_the_mujoco_extension_of_a_urdf_is_not_obeyed() -> None:
    extension = '<mujoco><compiler fusestatic="true" discardvisual="true" meshdir="/nowhere"/></mujoco>'
    text = robot(extension, link("a", visual(mesh("a.stl"))), link("b", ""), joint("1", "a", "b", kind="fixed"))
    model = convert_text(text, {"a.stl": STL}).model()
    assert (model.nbody, model.ngeom) == (3, 1)
