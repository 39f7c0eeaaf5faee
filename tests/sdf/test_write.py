# ruff: noqa: E501 - files as they stand
"""Robots of other formats as SDF: what the file says, and that Drake sees the same robot."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx

ARM = """<robot name="arm"><link name="base"/>
<link name="upper"><inertial><origin xyz="0 0 1"/><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  <visual><geometry><box size="1 2 3"/></geometry><material name=""><color rgba="1 0 0 1"/></material></visual></link>
<link name="tool"/><link name="finger"/>
<joint name="shoulder" type="revolute"><origin xyz="0 0 0.5" rpy="0.1 0.2 0.3"/><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
  <limit lower="-1" upper="2" effort="3" velocity="4"/><dynamics damping="0.5" friction="0"/></joint>
<joint name="tool" type="fixed"><origin xyz="0 0 2"/><parent link="upper"/><child link="tool"/></joint>
<joint name="grip" type="prismatic"><parent link="tool"/><child link="finger"/><axis xyz="1 0 0"/><limit lower="0" upper="1" effort="1" velocity="1"/>
  <mimic joint="shoulder" multiplier="2" offset="0.5"/></joint>
</robot>"""


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    (tmp_path / "arm.urdf").write_text(ARM, "utf-8")
    return tmp_path


def test_poses_are_relative_to_the_joint_and_the_parent(arm: Path) -> None:
    hx.convert(str(arm / "arm.urdf"), str(arm / "arm.sdf"))
    text = (arm / "arm.sdf").read_text("utf-8")
    assert '<pose relative_to="base">0 0 0.5 0.1 0.2 0.3</pose>' in text
    assert '<pose relative_to="shoulder">0 0 0 0 0 0</pose>' in text
    assert '<joint name="tool_joint" type="fixed">' in text  # a link has the name already


def test_what_is_carried_brings_the_robot_back(arm: Path) -> None:
    hx.convert(str(arm / "arm.urdf"), str(arm / "arm.sdf"), keep="inside")
    assert hx.load(str(arm / "arm.sdf")).mechanism == hx.load(str(arm / "arm.urdf")).mechanism


def test_drake_sees_the_same_robot(arm: Path) -> None:
    pytest.importorskip("pydrake")
    hx.convert(str(arm / "arm.urdf"), str(arm / "arm.sdf"), keep="inside")
    assert hx.verify(str(arm / "arm.urdf"), str(arm / "arm.sdf"), samples=10).is_same


MUJOCO = """<mujoco model="scene"><worldbody><light name="sun" pos="0 0 3"/><geom name="floor" type="plane" size="5 5 .1"/>
<body name="torso" pos="0 0 1"><freejoint name="root"/><geom type="capsule" size=".1 .2"/>
  <body name="thigh" pos="0 0 -.3"><joint name="hip_x" axis="1 0 0" range="-30 40" pos="0 0 .1"/><joint name="hip_y" axis="0 1 0"/>
    <geom type="ellipsoid" size=".1 .2 .3"/></body></body></worldbody></mujoco>"""


def test_a_scene_with_lights_becomes_a_world(tmp_path: Path) -> None:
    (tmp_path / "scene.xml").write_text(MUJOCO, "utf-8")
    hx.convert(str(tmp_path / "scene.xml"), str(tmp_path / "scene.sdf"), keep="inside")
    text = (tmp_path / "scene.sdf").read_text("utf-8")
    assert '<world name="default">' in text
    assert '<light name="sun" type="spot">' in text
    assert hx.load(str(tmp_path / "scene.sdf")).mechanism == hx.load(str(tmp_path / "scene.xml")).mechanism
    pytest.importorskip("pydrake")
    assert hx.verify(str(tmp_path / "scene.xml"), str(tmp_path / "scene.sdf"), samples=10).is_same


def test_a_model_goes_to_other_formats_and_back(tmp_path: Path) -> None:
    file = tmp_path / "m.sdf"
    file.write_text(
        '<sdf version="1.9"><model name="m"><link name="a"/><link name="b"><pose>1 2 3 0.1 0 0</pose></link>'
        '<joint name="j" type="revolute"><pose>0 0 1 0 0 0</pose><parent>a</parent><child>b</child><axis><xyz>0 1 0</xyz></axis></joint>'
        '<joint name="w" type="fixed"><parent>world</parent><child>a</child></joint></model></sdf>',
        "utf-8",
    )
    pytest.importorskip("pydrake")
    for name in ("m.urdf", "m.xml", "m.usda", "m.hymeko"):
        hx.convert(str(file), str(tmp_path / name), keep="inside")
        assert hx.load(str(tmp_path / name)).mechanism == hx.load(str(file)).mechanism, name
        verdict = hx.verify(str(file), str(tmp_path / name), samples=10)
        assert verdict.is_same, f"{name}: {[check for check in verdict.checks if not check.passed]}"


def test_the_ambient_colour_that_is_written_beside_the_diffuse_one_is_no_loss(arm: Path) -> None:
    result = hx.convert(str(arm / "arm.urdf"), str(arm / "arm.sdf"))
    assert "<ambient>1 0 0 1</ambient>" in (arm / "arm.sdf").read_text("utf-8")
    assert [loss for loss in result.losses if "material" in loss.field] == []
