"""Edits of elements that macros of a xacro file make: in the macro, where it is used once; and with its expressions."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx

ARM = """<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <link name="base"/>
  <xacro:macro name="finger" params="side y">
    <link name="${side}_finger">
      <collision>
        <geometry><sphere radius="0.05"/></geometry> <!-- padded -->
      </collision>
    </link>
    <joint name="${side}_knuckle" type="revolute">
      <origin xyz="0 ${y / 2} 0"/>
      <axis xyz="0 1 0"/> <limit lower="0" upper="1" effort="1" velocity="1"/>
      <parent link="base"/> <child link="${side}_finger"/>
    </joint>
  </xacro:macro>
  <xacro:finger side="left" y="0.1"/>
</robot>
"""


def updated(folder: Path, change: tuple[str, str], arm: str = ARM) -> tuple[str, list[str]]:
    """The text of the arm after a change in URDF, and the codes of the report."""
    original, there = folder / "arm.xacro", folder / "there.urdf"
    original.write_text(arm)
    hx.convert(original, there)
    text = there.read_text()
    assert change[0] in text
    there.write_text(text.replace(*change))
    report = hx.update(original, there).report
    return original.read_text(), [row.code.id for row in report]


def test_a_value_in_a_macro_that_is_used_once_is_edited_there(tmp_path: Path) -> None:
    assert updated(tmp_path, ('radius="0.05"', 'radius="0.06"')) == (ARM.replace('"0.05"', '"0.06"'), [])
    assert updated(tmp_path, ('upper="1"', 'upper="2"')) == (ARM.replace('upper="1"', 'upper="2"'), [])


def test_a_name_keeps_the_expression_of_its_macro(tmp_path: Path) -> None:
    assert updated(tmp_path, ('"left_finger"', '"left_thumb"')) == (ARM.replace("side}_finger", "side}_thumb"), [])
    assert updated(tmp_path, ('"left_finger"', '"my_left_finger"')) == (ARM.replace('"${side}_finger', '"my_${side}_finger'), [])
    assert updated(tmp_path, ('"left_finger"', '"thumb"')) == (ARM.replace("${side}_finger", "thumb"), [])


@pytest.mark.unread("HX023", "HX041")
def test_a_value_in_a_macro_that_is_used_twice_is_edited_in_one_element_alone(tmp_path: Path) -> None:
    arm = ARM.replace("</robot>", '  <xacro:finger side="right" y="-0.1"/>\n</robot>')
    text, found = updated(tmp_path, ('xyz="0 0.05 0"', 'xyz="0 0.07 0"'), arm)
    assert found == ["HX108"]
    assert '<xacro:finger prefix="left" y="0.07"/>' in text
    assert '<xacro:finger prefix="right" y="-0.05"/>' in text


def test_an_element_of_a_macro_with_the_name_of_another_block_is_edited(tmp_path: Path) -> None:
    arm = ARM.replace("  <xacro:finger s", '  <gazebo><joint name="left_knuckle"/><joint name="left_knuckle"/></gazebo>\n  <xacro:finger s')
    assert updated(tmp_path, ('upper="1"', 'upper="2"'), arm) == (arm.replace('upper="1"', 'upper="2"'), [])


LEGS = """<mujoco model="legs">
  <default>
    <default class="visual"><geom contype="0" conaffinity="0" group="2" rgba="0.2 0.2 0.2 1"/></default>
  </default>
  <worldbody>
    <body name="trunk">
      <inertial pos="0 0 0" mass="3" diaginertia="0.01 0.01 0.01"/>
      <geom class="visual" type="box" size="0.1 0.1 0.1"/>
      <body name="left">
        <joint name="hip" axis="0 1 0" range="-60 60"/>
        <inertial pos="0 0 0" mass="2" diaginertia="0.02 0.02 0.01"/>
        <geom class="visual" type="box" size="0.1 0.1 0.1"/>
      </body>
      <body name="right">
        <geom name="pad" size="0.1" mass="1"/>
        <geom class="visual" type="box" size="0.1 0.1 0.1"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.mark.unread("HX101", "HX105", "HX106", "HX114")
def test_a_macro_that_is_called_as_a_class_of_the_original_is_not_that_class(tmp_path: Path) -> None:
    """The visuals are a macro of the xacro file, and an edited file may have them without it."""
    original, there = tmp_path / "legs.xml", tmp_path / "legs.xacro"
    original.write_text(LEGS)
    hx.convert(original, there)
    assert '<xacro:macro name="visual"' in there.read_text()
    hx.convert(original, tmp_path / "legs.urdf")
    text = (tmp_path / "legs.urdf").read_text()
    assert text.count('mass value="3"') == 1
    there.write_text(text.replace('mass value="3"', 'mass value="4"'))
    hx.update(original, there)
    assert original.read_text() == LEGS.replace('mass="3"', 'mass="4"')
