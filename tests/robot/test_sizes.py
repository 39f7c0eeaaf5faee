"""Robots of another size move as their originals do, where gravity has grown as much."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

import hymeko_x as hx

CABLES = """<mujoco>
  <worldbody>
    <body name="a" pos="0 0 1">
      <joint name="turn" axis="0 1 0"/>
      <geom type="capsule" size=".1 .2" pos="0 0 .2"/>
      <site name="low" pos=".1 0 .3"/>
      <body name="b" pos="0 0 .5">
        <joint name="slide" type="slide" axis="1 0 0" stiffness="3" springref=".1"/>
        <geom size=".1"/>
        <site name="high" pos="0 .1 .1"/>
        <body name="c" pos="0 .1 .2">
          <joint name="push" type="slide" axis="0 0 1"/>
          <geom type="box" size=".1 .05 .03" pos="0 0 .1"/>
        </body>
      </body>
    </body>
  </worldbody>
  <tendon>{tendon}</tendon>
</mujoco>"""
TENDONS = {
    "path": '<spatial name="t" stiffness="100" damping="3" armature=".2" springlength=".1 .2">'
    '<site site="low"/><site site="high"/></spatial>',
    "mixed": '<fixed name="t" stiffness="20" damping="2" armature=".1" range="-.01 .01" limited="true" springlength=".1">'
    '<joint joint="turn" coef=".5"/><joint joint="slide" coef="2"/></fixed>',
    "slides": '<fixed name="t" stiffness="20" damping="2" range="-.01 .01" limited="true">'
    '<joint joint="push" coef="1"/><joint joint="slide" coef="2"/></fixed>',
}


@pytest.mark.parametrize("size", [2.0, 0.3])
@pytest.mark.parametrize("tendon", TENDONS)
def test_a_scaled_robot_with_tendons_moves_as_its_original(tendon: str, size: float) -> None:
    robot = hx.loads(CABLES.format(tendon=TENDONS[tendon]), "mjcf")
    small, big = robot.to_mujoco(), robot.scaled(size).to_mujoco()
    big.opt.gravity[:] *= size
    lengths = np.array((1, size, size))
    q, v = np.array((0.3, 0.2, -0.1)), np.array((1.0, -0.5, 0.25))
    before, after = mujoco.MjData(small), mujoco.MjData(big)
    before.qpos, before.qvel, after.qpos, after.qvel = q, v, q * lengths, v * lengths
    mujoco.mj_forward(small, before)
    mujoco.mj_forward(big, after)
    assert after.qfrc_passive * lengths / size**5 == pytest.approx(before.qfrc_passive, rel=1e-9)
    assert after.qacc_smooth / lengths == pytest.approx(before.qacc_smooth, rel=1e-9)
    assert after.nefc == before.nefc


def test_keyframes_grow_with_their_robot() -> None:
    text = """<mujoco><worldbody><body><freejoint/><geom size=".1"/><body><joint type="slide"/><geom size=".1"/></body></body>
      <body mocap="true"><geom size=".1"/></body></worldbody>
      <keyframe><key qpos="1 2 3 1 0 0 0 .5" qvel="1 2 3 4 5 6 7" mpos="1 2 3"/></keyframe></mujoco>"""
    model = hx.loads(text, "mjcf").scaled(2).to_mujoco()
    assert model.key_qpos.tolist() == [[2, 4, 6, 1, 0, 0, 0, 1]]
    assert model.key_qvel.tolist() == [[2, 4, 6, 4, 5, 6, 14]]
    assert model.key_mpos.tolist() == [[2, 4, 6]]


@pytest.mark.parametrize("size", [2.0, 0.3])
def test_a_geom_between_the_two_points_of_its_class_gets_the_new_length(size: float) -> None:
    text = """<mujoco><default><default class="bar"><geom type="cylinder" fromto="0 .015 0 0 -.02 0.01" size=".02"/></default></default>
      <worldbody><body><joint/><geom class="bar"/></body></worldbody></mujoco>"""
    robot = hx.loads(text, "mjcf")
    small, big = robot.to_mujoco(), robot.scaled(size).to_mujoco()
    assert big.geom_size == pytest.approx(size * small.geom_size)
    assert big.geom_pos == pytest.approx(size * small.geom_pos)
    with robot.edit() as e:
        bar = next(iter(e.shapes.values()))
        bar.geometry = hx.Cylinder(0.01, 0.5)
    edited = e.robot.to_mujoco()
    assert edited.geom_size.tolist() == [pytest.approx([0.01, 0.25, 0])]
    assert edited.geom_quat == pytest.approx(small.geom_quat)


def test_a_height_field_that_moves_is_still_one() -> None:
    text = """<mujoco><asset><hfield name="hills" nrow="2" ncol="2" size="1 1 1 .1"/></asset>
      <worldbody><geom name="ground" type="hfield" hfield="hills" pos="0 0 -.01"/></worldbody></mujoco>"""
    with hx.loads(text, "mjcf").edit() as e:
        e.shapes["ground"].pose = (1, 2, 3)
    model = e.robot.to_mujoco()
    assert (model.geom_type.tolist(), model.geom_pos.tolist()) == ([int(mujoco.mjtGeom.mjGEOM_HFIELD)], [[1, 2, 3]])


def test_a_pose_between_two_points_can_be_moved() -> None:
    text = """<mujoco><worldbody><body><site name="rod" type="capsule" size=".1" fromto="0 0 0 0 0 1"/></body></worldbody></mujoco>"""
    robot = hx.loads(text, "mjcf")
    assert robot.scaled(3).to_mujoco().site("rod").pos == pytest.approx([0, 0, 1.5])
    with robot.edit() as e:
        e.frames["rod"].pose = e.frames["rod"].pose @ hx.Pose((1, 0, 0))
    assert e.robot.to_mujoco().site("rod").pos.tolist() != [0, 0, 0.5]
