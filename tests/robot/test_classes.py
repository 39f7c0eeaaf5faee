"""Default classes of MJCF, unnamed elements, and names in extras of the whole, in robots that are taken apart and put together."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

import hymeko_x as hx
from tests.robot.robots import check_same_model

CLASSED = """<mujoco model="classed"><default><tendon rgba="1 0 0 1"/><geom condim="4"/><joint limited="true" range="-50 50"/>
<default class="leg"><geom type="capsule" size=".05" fromto="0 0 0 .2 0 0" material="red"/></default>
<default class="toe"><geom type="sphere" size=".03" material="blue" friction="2"/></default>
<default class="held"><equality solref=".01 .5"/></default><default class="wall"><geom material="grey"/></default></default>
<asset><material name="red" rgba="1 0 0 1"/><material name="blue" rgba="0 0 1 1"/><material name="grey" rgba=".5 .5 .5 1"/>
<texture type="skybox" builtin="gradient" width="8" height="48"/><hfield name="hills" nrow="4" ncol="4" size="3 3 1 .1"/></asset>
<worldbody><geom type="plane" size="1 1 .1" contype="2"/><geom name="ground" type="hfield" hfield="hills" class="wall"/>
<camera name="watch" pos="1 0 1" mode="targetbody" target="aim"/>
<body name="trunk" pos="0 0 1" childclass="leg"><joint name="slide" type="slide"/><geom/><geom fromto="0 0 0 0 .1 0"/>
<body name="aim" pos="0 0 .1"><geom class="toe"/></body>
<body name="toe" pos=".2 0 0" childclass="toe"><geom/><site name="tip"/></body>
<body name="shin" pos=".2 0 0"><joint name="knee" axis="0 1 0"/><geom/><site name="sole"/></body></body></worldbody>
<tendon><fixed name="both"><joint joint="knee" coef="1"/><joint joint="slide" coef="2"/></fixed>
<spatial name="rope"><site site="tip"/><site site="sole"/></spatial></tendon>
<equality><tendon class="held" tendon1="both" tendon2="rope"/></equality>
<sensor><touch name="felt" site="sole"/></sensor></mujoco>"""


def classed() -> hx.Robot:
    return hx.loads(CLASSED, "mjcf")


def attached_by_mujoco(*prefixes: str) -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    for prefix in prefixes:
        spec.attach(mujoco.MjSpec.from_string(CLASSED), frame=spec.worldbody.add_frame(), prefix=prefix)
    return spec.compile()


def test_a_scene_of_three_is_the_one_that_mujoco_composes() -> None:
    """Geoms without names in the world, tendons and equalities with classes, and height fields."""
    whole = hx.compose([classed()] * 3, names=("a", "b", "c")).to_mujoco()
    model = attached_by_mujoco("a/", "b/", "c/")
    assert sorted(whole.geom_contype) == sorted(model.geom_contype)
    assert np.count_nonzero(whole.geom_contype == 2) == 3
    assert (whole.nhfield, whole.neq, whole.ntendon, whole.njnt) == (3, 3, 6, 6)
    np.testing.assert_array_equal(whole.eq_solref, model.eq_solref)
    np.testing.assert_array_equal(whole.tendon_rgba[1::2], model.tendon_rgba[1::2])  # a fixed one is not drawn, and has no colour in a file
    np.testing.assert_array_equal(whole.jnt_limited, model.jnt_limited)


def test_a_part_has_the_classes_of_its_elements_although_they_name_materials_that_it_does_not_use() -> None:
    part = classed().subtree("toe").to_mujoco()
    assert (part.ngeom, part.geom_friction[0, 0], part.geom_condim[0]) == (1, 2, 4)
    assert part.mat_rgba[part.geom_matid[0]].tolist() == [0, 0, 1, 1]


def test_a_removed_body_takes_along_its_sites_with_their_sensors_and_tendons() -> None:
    with classed().edit() as e:
        e.remove(e.bodies["shin"])
    model = e.robot.to_mujoco()
    assert (model.nsensor, model.nsite, model.ntendon, model.neq) == (0, 1, 0, 0)
    assert ([*e.robot.frames], [*e.robot.sensors]) == (["tip"], [])


def test_merged_bodies_keep_what_their_classes_gave_them_and_cameras_their_target() -> None:
    robot = classed().merge_fixed_joints()
    assert [*robot.bodies] == ["trunk", "aim", "shin"]
    whole, model = classed().to_mujoco(), robot.to_mujoco()
    toe = mujoco.mjtGeom.mjGEOM_SPHERE
    assert sorted(whole.geom_friction[whole.geom_type == toe, 0]) == sorted(model.geom_friction[model.geom_type == toe, 0]) == [2, 2]
    assert model.cam_targetbodyid[0] == model.body("aim").id
    assert robot.mass == pytest.approx(classed().mass)


@pytest.mark.unread("HX104")
def test_a_plane_that_is_left_out_takes_its_contact_pairs_along() -> None:
    text = """<mujoco><worldbody><body name="a"><joint name="j"/><geom name="ball" size=".1"/><site name="s"/></body>
      <geom name="floor" type="plane" size="0 0 1"/></worldbody><contact><pair geom1="ball" geom2="floor"/></contact></mujoco>"""
    robot = hx.loads(text, "mjcf")
    assert robot.to_mujoco().npair == 1
    assert robot.attach(robot, at="s", prefix="on/").to_mujoco().npair == 1


def test_elements_without_names_are_those_of_one_robot() -> None:
    """Written and read again, a scene is what it was; nothing of it has the settings of another element."""
    scene = hx.compose([classed(), classed()], names=("one", "two"))
    check_same_model(hx.loads(hx.dumps(scene, "mjcf"), "mjcf").to_mujoco(), scene.to_mujoco())
