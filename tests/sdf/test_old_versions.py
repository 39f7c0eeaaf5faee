# ruff: noqa: E501 - files as they stand
"""Files of SDF 1.0 to 1.2: the root is <gazebo>, and in 1.0 values are attributes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

import hymeko_x as hx
from hymeko_x.diagnostics import Report

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.unread("HX006")

OLD = """<?xml version="1.0"?>
<gazebo version="1.0">
  <world name="w">
    <physics type="ode"><gravity xyz="0 0 -9.8"/><ode><solver type="quick" dt="0.001" iters="100" sor="1.3"/></ode></physics>
    <scene><ambient rgba="0.1 0.1 0.1 1"/><shadows enabled="true"/><fog rgba="1 1 1 1" type="linear"/></scene>
    <light name="sun" type="directional" cast_shadows="true"><origin pose="0 0 10 0 0 0"/><diffuse rgba="1 1 1 1"/>
      <direction xyz="0 0 -1"/></light>
    <model name="door" static="false">
      <origin pose="1 2 0 0 0 0"/>
      <link name="frame" gravity="false" self_collide="true">
        <inertial mass="2"><origin pose="0 0 1 0 0 0"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
        <damping linear="0.1" angular="0.2"/>
        <collision name="c" laser_retro="1"><origin pose="0 0 1 0 0 0"/><geometry><box size="1 0.1 2"/></geometry>
          <surface><friction><ode mu="0.5" mu2="0.4" fdir1="0 0 0" slip1="0" slip2="0"/></friction></surface></collision>
        <visual name="v" cast_shadows="false"><geometry><cylinder radius="0.1" length="2"/></geometry>
          <material script="Gazebo/Grey"><diffuse rgba="1 0 0 1"/></material></visual>
        <sensor name="eye" type="camera" update_rate="30"><origin pose="0 0 1 0 0 0"/>
          <camera><horizontal_fov angle="1.2"/><image width="64" height="48" format="R8G8B8"/><clip near="0.1" far="9"/></camera>
          <plugin name="p" filename="libp.so"><gain value="2"/></plugin></sensor>
      </link>
      <link name="leaf"><origin pose="0.5 0 1 0 0 0"/><inertial mass="1"><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
        <visual name="v"><geometry><mesh filename="leaf.dae" scale="1 1 2"/></geometry></visual></link>
      <joint name="hinge" type="revolute"><parent link="frame"/><child link="leaf"/><origin pose="-0.5 0 0 0 0 0"/>
        <axis xyz="0 0 1"><dynamics damping="0.3" friction="0.1"/><limit lower="-1" upper="1" effort="5" velocity="2"/></axis></joint>
    </model>
  </world>
</gazebo>
"""
NEW = """<sdf version="1.3">
  <world name="w">
    <physics type="ode"><gravity>0 0 -9.8</gravity><ode><solver><type>quick</type><dt>0.001</dt><iters>100</iters><sor>1.3</sor></solver></ode></physics>
    <scene><ambient>0.1 0.1 0.1 1</ambient><shadows>true</shadows><fog><color>1 1 1 1</color><type>linear</type></fog></scene>
    <light name="sun" type="directional"><cast_shadows>true</cast_shadows><pose>0 0 10 0 0 0</pose><diffuse>1 1 1 1</diffuse>
      <direction>0 0 -1</direction></light>
    <model name="door"><static>false</static>
      <pose>1 2 0 0 0 0</pose>
      <link name="frame"><gravity>false</gravity><self_collide>true</self_collide>
        <inertial><mass>2</mass><pose>0 0 1 0 0 0</pose>
          <inertia><ixx>1</ixx><ixy>0</ixy><ixz>0</ixz><iyy>1</iyy><iyz>0</iyz><izz>1</izz></inertia></inertial>
        <velocity_decay><linear>0.1</linear><angular>0.2</angular></velocity_decay>
        <collision name="c"><laser_retro>1</laser_retro><pose>0 0 1 0 0 0</pose><geometry><box><size>1 0.1 2</size></box></geometry>
          <surface><friction><ode><mu>0.5</mu><mu2>0.4</mu2><fdir1>0 0 0</fdir1><slip1>0</slip1><slip2>0</slip2></ode></friction></surface></collision>
        <visual name="v"><cast_shadows>false</cast_shadows><geometry><cylinder><radius>0.1</radius><length>2</length></cylinder></geometry>
          <material><script><uri>file://media/materials/scripts/gazebo.material</uri><name>Gazebo/Grey</name></script><diffuse>1 0 0 1</diffuse></material></visual>
        <sensor name="eye" type="camera"><update_rate>30</update_rate><pose>0 0 1 0 0 0</pose>
          <camera><horizontal_fov>1.2</horizontal_fov><image><width>64</width><height>48</height><format>R8G8B8</format></image>
            <clip><near>0.1</near><far>9</far></clip></camera>
          <plugin name="p" filename="libp.so"><gain value="2"/></plugin></sensor>
      </link>
      <link name="leaf"><pose>0.5 0 1 0 0 0</pose><inertial><mass>1</mass>
        <inertia><ixx>1</ixx><ixy>0</ixy><ixz>0</ixz><iyy>1</iyy><iyz>0</iyz><izz>1</izz></inertia></inertial>
        <visual name="v"><geometry><mesh><uri>leaf.dae</uri><scale>1 1 2</scale></mesh></geometry></visual></link>
      <joint name="hinge" type="revolute"><parent>frame</parent><child>leaf</child><pose>-0.5 0 0 0 0 0</pose>
        <axis><xyz>0 0 1</xyz><dynamics><damping>0.3</damping><friction>0.1</friction></dynamics>
          <limit><lower>-1</lower><upper>1</upper><effort>5</effort><velocity>2</velocity></limit></axis></joint>
    </model>
  </world>
</sdf>
"""
SCRIPT = "<uri>file://media/materials/scripts/gazebo.material</uri><name>Gazebo/Grey</name>"


@pytest.mark.unread
@pytest.mark.parametrize("version", ["1.0", "1.1"])
def test_attributes_mean_what_elements_mean(version: str) -> None:
    old = hx.loads(OLD.replace('version="1.0">', f'version="{version}">'), "sdf")
    new = hx.loads(NEW, "sdf")
    assert hx.diff(new, old) == ()
    assert "hinge" in old.joints


@pytest.mark.unread
def test_a_file_of_1_2_has_only_another_root() -> None:
    old = NEW.replace('<sdf version="1.3">', '<gazebo version="1.2">').replace("</sdf>", "</gazebo>").replace(SCRIPT, "Gazebo/Grey")
    assert hx.diff(hx.loads(NEW, "sdf"), hx.loads(old, "sdf")) == ()


@pytest.mark.unread
def test_the_line_of_a_diagnostic_is_that_of_the_file() -> None:
    report = Report()
    hx.loads(OLD.replace('mass="2"', 'mass="-2"'), "sdf", report=report)
    found = {(diagnostic.code.id, diagnostic.origin.line) for diagnostic in report if diagnostic.origin is not None}
    assert ("HX006", 2) in found
    assert ("HX315", 11) in found


@pytest.mark.unread
def test_a_copy_has_the_words_of_now(tmp_path: Path) -> None:
    (tmp_path / "old.sdf").write_text(OLD, "utf-8")
    hx.convert(tmp_path / "old.sdf", tmp_path / "new.sdf", assets="reference")
    text = (tmp_path / "new.sdf").read_text("utf-8")
    assert '<sdf version="1.3">' in text
    assert "<mu2>0.4</mu2>" in text
    assert hx.diff(hx.load(tmp_path / "old.sdf"), hx.load(tmp_path / "new.sdf")) == ()


@pytest.mark.unread
def test_an_old_model_is_included(tmp_path: Path) -> None:
    (tmp_path / "m.sdf").write_text(
        '<gazebo version="1.0"><model name="m"><link name="a"><origin pose="0 0 1 0 0 0"/></link></model></gazebo>'
    )
    (tmp_path / "w.sdf").write_text('<gazebo version="1.0"><world name="w"><include filename="m.sdf"/></world></gazebo>')
    (joint,) = hx.load(tmp_path / "w.sdf").mechanism.joints.values()
    assert joint.parent_pose.xyz == (0.0, 0.0, 1.0)


def test_another_version_of_that_root_is_refused() -> None:
    from hymeko_x.diagnostics import Refusal

    with pytest.raises(Refusal, match="HX006"):
        hx.loads('<gazebo version="1.4"><model name="m"/></gazebo>', "sdf")
