"""Robots of another size move as their originals do, where gravity has grown as much."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from msgspec.structs import replace

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
      <body><joint type="ball"/><joint type="slide"/><geom size=".1"/></body>
      <body mocap="true"><geom size=".1"/></body></worldbody>
      <keyframe><key qpos="1 2 3 1 0 0 0 .5 1 0 0 0 .5" qvel="1 2 3 4 5 6 7 1 2 3 4" mpos="1 2 3"/></keyframe></mujoco>"""
    model = hx.loads(text, "mjcf").scaled(2).to_mujoco()
    assert model.key_qpos.tolist() == [[2, 4, 6, 1, 0, 0, 0, 1, 1, 0, 0, 0, 1]]
    assert model.key_qvel.tolist() == [[2, 4, 6, 4, 5, 6, 14, 1, 2, 3, 8]]
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
    assert e.robot.to_mujoco().site("rod").pos == pytest.approx([1, 0, 0.5])
    with robot.edit() as e:
        e.frames["rod"].pose = replace(e.frames["rod"].pose, xyz=(0, 0, 2))  # which still has its two points as its notation
    assert e.robot.to_mujoco().site("rod").pos == pytest.approx([0, 0, 2])


PILE = """<mujoco><option timestep="1e-3" solver="Newton" tolerance="1e-15" iterations="200"/>
  <default>{classes}<geom condim="6" friction="0.7 0.02 0.01" solimp="0.8 0.95 0.02" margin="0.01"/></default>
  <worldbody><geom name="floor" type="plane" size="5 5 .1"/>
    <body name="box" pos="0 0 0.095" euler="3 2 0"><freejoint name="fly"/><geom name="box" type="box" size=".1 .1 .1" gap="0.002"/>
      <body name="arm" pos="0 0 .1"><joint name="turn" axis="0 1 0" range="-10 10" limited="true" solimplimit=".8 .95 .1" margin="0.05"/>
        <geom type="capsule" size=".02 .1" pos="0 0 .12"/>
        <body name="slider" pos="0 0 .2"><joint name="slide" type="slide" axis="0 0 1" range="-.01 .01" limited="true" {own}/>
          <geom name="tip" size=".05" contype="0" conaffinity="0"/><site name="end"/></body></body></body>
    <body name="ball" pos="0.05 0 0.7"><joint name="hold" type="slide" axis="1 0 0"/>
      <geom name="ball" size=".05" contype="0" conaffinity="0"/></body>
  </worldbody>
  <contact><pair geom1="tip" geom2="ball" margin=".5" gap="0.01" condim="6" friction="0.7 0.6 0.02 0.01 0.01"
    solimp=".8 .95 .02"/></contact>
  <tendon><spatial name="rope" range="0 0.1" limited="true" solimplimit=".8 .95 .2" margin=".02">
    <site site="end"/><site site="peg"/></spatial></tendon>
  <equality><connect body1="ball" body2="slider" anchor="0 0 0.1" solimp=".8 .95 .3"/></equality>
</mujoco>""".replace('<geom name="floor"', '<site name="peg" pos="0.3 0 0.6"/><geom name="floor"')
OF_JOINTS = 'solimplimit=".8 .95 .02" margin="0.01"'


@pytest.mark.parametrize("size", [2.0, 0.3])
@pytest.mark.parametrize("where", ["element", "class"])
def test_constraints_of_a_scaled_robot_push_as_those_of_its_original(where: str, size: float) -> None:
    """Margins, gaps, the widths of impedances, and torsional and rolling friction are lengths."""
    own, classes = (OF_JOINTS, "") if where == "element" else ("", f"<joint {OF_JOINTS}/>")
    robot = hx.loads(PILE.format(own=own, classes=classes), "mjcf")
    small, big = robot.to_mujoco(), robot.scaled(size).to_mujoco()
    for name in ("geom_gap", "geom_margin", "pair_gap", "pair_margin", "tendon_margin"):
        assert getattr(big, name) == pytest.approx(size * getattr(small, name)), name
    assert (big.jnt_solimp[1, 2], big.jnt_solimp[2, 2]) == (small.jnt_solimp[1, 2], pytest.approx(size * 0.02))
    assert big.jnt_margin[1:3] == pytest.approx([small.jnt_margin[1], size * 0.01])
    big.opt.gravity[:] *= size
    turns = np.array((size, size, size, 1, 1, 1, 1, size, size))
    before, after = mujoco.MjData(small), mujoco.MjData(big)
    lengths = np.array((size, size, size, 1, 1, 1, 1, 1, size, size))
    before.qpos[7:9] = (0.2, 0.015)
    before.qvel[:] = (0.1, 0.2, -0.1, 0.3, 0.2, 0.1, 1.0, 0.1, 0.2)
    after.qpos, after.qvel = before.qpos * lengths, before.qvel * turns
    mujoco.mj_forward(small, before)
    mujoco.mj_forward(big, after)
    assert (after.nefc, after.ncon) == (before.nefc, before.ncon)
    kinds = ("EQUALITY", "LIMIT_JOINT", "LIMIT_TENDON", "CONTACT_PYRAMIDAL")
    assert {*before.efc_type.tolist()} == {int(getattr(mujoco.mjtConstraint, f"mjCNSTR_{kind}")) for kind in kinds}
    assert {*before.efc_id[before.efc_type == 3].tolist()} == {1, 2}  # of the hinge and of the slide
    assert np.abs(before.qfrc_constraint).max() > 1
    assert after.qacc / turns == pytest.approx(before.qacc, rel=1e-6, abs=1e-6 * np.abs(before.qacc).max())


def test_what_a_whole_gives_as_lengths_and_masses_grows() -> None:
    text = """<mujoco><compiler settotalmass="3"/><statistic extent="2" meanmass="4"/>
      <asset><hfield name="hills" nrow="2" ncol="2" size="1 2 3 0.1"/></asset>
      <worldbody><geom type="hfield" hfield="hills"/><body><joint/><geom size=".1"/></body></worldbody></mujoco>"""
    robot = hx.loads(text, "mjcf")
    model = robot.scaled(2).to_mujoco()
    assert model.hfield_size.tolist() == [[2, 4, 6, 0.2]]
    assert (model.stat.extent, model.stat.meanmass, sum(model.body_mass)) == (4, 32, pytest.approx(24))
    assert hx.diff(robot.scaled(2).scaled(0.5), robot) == ()
