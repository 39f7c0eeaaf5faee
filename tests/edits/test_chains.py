"""Joints of several dofs that URDF has as chains of joints: something new on a link between two of them leaves all that refers to them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import pytest

import hymeko_x as hx

if TYPE_CHECKING:
    from pathlib import Path

STACK = """<mujoco model="stack">
  <worldbody>
    <body name="hand" pos="2 0 0">
      <joint name="turn" axis="0 0 1" stiffness="0.3"/>
      <joint name="slide" type="slide" axis="1 0 0" range="0 1" armature="0.2"/>
      <geom type="sphere" size="0.1"/>
    </body>
  </worldbody>
  <tendon>
    <fixed name="both">
      <joint joint="turn" coef="0.1"/>
      <joint joint="slide" coef="-0.2"/>
    </fixed>
  </tendon>
  <actuator>
    <motor name="drive" joint="slide" gear="2"/>
    <position name="pull" tendon="both" kp="3"/>
  </actuator>
  <sensor>
    <jointpos name="angle" joint="turn"/>
  </sensor>
</mujoco>
"""
LINK = '  <link name="turn_link"/>\n'
TOOL = """  <link name="tool">
    <inertial>
      <mass value="1"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>
    </inertial>
  </link>
  <joint name="mount" type="fixed">
    <parent link="turn_link"/>
    <child link="tool"/>
  </joint>
"""


@pytest.mark.unread("HX101", "HX105", "HX108", "HX202")
def test_a_tool_between_two_joints_of_a_body_leaves_tendons_actuators_and_sensors(tmp_path: Path) -> None:
    original, there = tmp_path / "stack.xml", tmp_path / "stack.urdf"
    original.write_text(STACK)
    hx.convert(original, there)
    text = there.read_text()
    assert text.count(LINK) == 1
    there.write_text(text.replace(LINK, LINK + TOOL))
    hx.update(original, there)
    model = mujoco.MjModel.from_xml_path(str(original))
    turn, slide = model.joint("turn").id, model.joint("slide").id
    assert [model.body(row).name for row in (model.jnt_bodyid[turn], model.jnt_bodyid[slide])] == ["turn_link", "hand"]
    assert (model.jnt_stiffness[turn], model.dof_armature[slide]) == (0.3, 0.2)
    assert (list(model.wrap_objid), list(model.wrap_prm)) == ([turn, slide], [0.1, -0.2])
    assert (model.actuator("drive").trnid[0], model.actuator("drive").gear[0], model.actuator("pull").trnid[0]) == (slide, 2, 0)
    assert model.sensor("angle").objid == turn
    assert hx.update(original, there).edits == ()
