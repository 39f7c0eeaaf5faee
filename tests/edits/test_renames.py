"""A new name arrives wherever the author's text has the old one: in frames of SDF, and in fragments that the IR cannot represent."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.xml.references import with_new_references

SDF = """<?xml version="1.0"?>
<sdf version="1.11">
  <model name="arm">
    <frame name="mount" attached_to="base"><pose>0 0 0.1 0 0 0</pose></frame>
    <link name="base"><inertial><mass>2</mass></inertial></link>
    <link name="upper">
      <pose relative_to="shoulder">0 0 0 0 0 0</pose>
      <inertial><mass>1.5</mass></inertial>
      <visual name="rod"><pose relative_to="grip">0 0 0 0 0 0</pose><geometry><sphere><radius>0.3</radius></sphere></geometry></visual>
    </link>
    <joint name="shoulder" type="revolute">
      <pose relative_to="mount">0 0 0.05 0 0 0</pose>
      <parent>base</parent>
      <child>upper</child>
      <axis><xyz expressed_in="mount">0 1 0</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis>
    </joint>
    <frame name="grip" attached_to="upper"><pose relative_to="shoulder">0 0 0.3 0 0 0</pose></frame>
    <link name="tool"><pose relative_to="grip">0 0 0.1 0 0 0</pose></link>
    <joint name="wrist" type="revolute">
      <parent>upper</parent>
      <child>tool</child>
      <axis><xyz expressed_in="upper">1 0 0</xyz><mimic joint="shoulder"><multiplier>2</multiplier></mimic></axis>
    </joint>
    <plugin filename="x" name="ctl">
      <joint_name>shoulder</joint_name>
      <link_name>upper</link_name>
    </plugin>
  </model>
</sdf>
"""
URDF = """<robot name="arm">
  <link name="base"/>
  <link name="upper"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="20" velocity="3"/>
  </joint>
  <gazebo reference="upper"><mu1>0.2</mu1></gazebo>
  <gazebo><plugin filename="x" name="ctl"><joint_name>shoulder</joint_name></plugin></gazebo>
</robot>
"""


def renamed(folder: Path, text: str, suffix: str, old: str) -> str:
    """The text after an element of its conversion to MJCF got a new name."""
    original, there = folder / f"arm{suffix}", folder / "there.xml"
    original.write_text(text)
    hx.convert(original, there)
    assert f'"{old}"' in there.read_text()
    there.write_text(there.read_text().replace(f'"{old}"', f'"new_{old}"'))
    edits = [edit for edit in hx.update(original, there).edits if edit.element != ROOT]  # whose fragments have the name, too
    assert [(edit.element.name, edit.field, edit.before, edit.after) for edit in edits] == [(old, "name", f"'{old}'", f"'new_{old}'")]
    assert hx.update(original, there, dry_run=True).edits == ()
    return original.read_text()


@pytest.mark.parametrize("name", ["shoulder", "upper", "base", "grip", "mount"])
@pytest.mark.unread("HX101", "HX102")
def test_a_new_name_arrives_in_every_reference_of_sdf(name: str, tmp_path: Path) -> None:
    after = renamed(tmp_path, SDF, ".sdf", name)
    assert after == SDF.replace(f'"{name}"', f'"new_{name}"').replace(f">{name}<", f">new_{name}<")


@pytest.mark.parametrize("name", ["shoulder", "upper"])
@pytest.mark.unread("HX101", "HX102")
def test_a_new_name_arrives_in_gazebo_s_fragments_of_urdf(name: str, tmp_path: Path) -> None:
    after = renamed(tmp_path, URDF, ".urdf", name)
    assert after == URDF.replace(f'"{name}"', f'"new_{name}"').replace(f">{name}<", f">new_{name}<")


def test_only_elements_that_name_a_joint_or_a_link_are_references() -> None:
    text = "<p><jointName> a </jointName><leftJoint>a</leftJoint><link>a</link><topic>a</topic><joints>a</joints></p>"
    after = with_new_references(text, {"a": "b"}, {"a": "c"})
    assert after == "<p><jointName> b </jointName><leftJoint>b</leftJoint><link>c</link><topic>a</topic><joints>a</joints></p>"


SCOPED = """<sdf version="1.6">
  <model name="m">
    <static>1</static>
    <link name="ball::skin"/>
  </model>
</sdf>
"""


@pytest.mark.unread("HX022", "HX040", "HX045")
def test_an_original_that_could_not_be_read_with_an_edit_stays_as_it_is(tmp_path: Path) -> None:
    """A static model has no joint that could have a name, and its link none that SDF could refer to."""
    original, there = tmp_path / "m.sdf", tmp_path / "m.urdf"
    original.write_text(SCOPED)
    hx.convert(original, there)
    text = there.read_text()
    assert text.count('joint name="ball::skin_static"') == 1
    there.write_text(text.replace('joint name="ball::skin_static"', 'joint name="hold"'))
    with pytest.raises(hx.Refusal, match="with the edits the original cannot be used"):
        hx.update(original, there)
    assert original.read_text() == SCOPED
