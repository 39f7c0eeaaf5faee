"""What stands beside an edit stays as it is in the original: colours, missing inertials, comments."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x.diagnostics import Report
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.residue.delta import residue_of
from hymeko_x.residue.merge import restore

LAMP = """<robot name="lamp">
  <link name="foot">
    <visual>
      <geometry><box size="0.1 0.1 0.02"/></geometry>
      <material name="grey"><color rgba="0.65 0.65 0.75 1"/></material>
    </visual>
    <collision>
      <geometry><box size="0.1 0.1 0.02"/></geometry>
    </collision>
  </link>
  <!-- the sensor -->
  <gazebo reference="foot">
    <sensor name="imu" type="imu">
      <update_rate>100</update_rate>
      <!-- from the
           data sheet -->
      <always_on>1</always_on>
    </sensor>
  </gazebo>
</robot>
"""


def updated(there: Path, change: tuple[str, str], lamp: str = LAMP) -> tuple[str, list[str]]:
    """The lamp's text after a change in another format, and the warnings."""
    original = there.with_name("lamp.urdf")
    original.write_text(lamp)
    hx.convert(original, there)
    text, number = re.subn(*change, there.read_text(), count=1)
    assert number == 1
    there.write_text(text)
    report = hx.update(original, there).report
    return original.read_text(), [str(row) for row in report if row.code.id == "HX118"]


COLOUR = '<color rgba="1 0 0 1"/>'
PAINT = f'<material name="">\n        {COLOUR}\n      </material>\n'
ORIGIN = '<origin xyz="0 0 0.5" rpy="0 0 0"/>'


@pytest.mark.unread("HX101", "HX105", "HX201", "HX204")
@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("lamp.sdf", ('(<visual name="visual">)', r"\1<pose>0 0 0.5 0 0 0</pose>")),
        ("lamp.usda", (r'(?s)(Cube "visual".*?xformOp:translate = )\(0, 0, 0\)', r"\1(0, 0, 0.5)")),
        ("lamp.xml", ('material="grey"', 'material="grey" pos="0 0 0.5"')),
    ],
)
def test_a_shape_that_moves_keeps_its_colour(name: str, change: tuple[str, str], tmp_path: Path) -> None:
    text, missing = updated(tmp_path / name, change)
    assert missing == []
    assert text == LAMP.replace("<visual>\n", f"<visual>\n      {ORIGIN}\n")


@pytest.mark.unread("HX101", "HX105", "HX201", "HX204")
def test_a_link_without_inertial_has_none_when_its_shape_is_painted(tmp_path: Path) -> None:
    text, missing = updated(
        tmp_path / "lamp.usda", (r'(?s)(Cube "collision".*?double size = 1\n)', r"\1color3f[] primvars:displayColor = [(1, 0, 0)]\n")
    )
    assert missing == []
    assert text == LAMP.replace("    </collision>", f"      {PAINT}    </collision>")


@pytest.mark.unread("HX101", "HX105", "HX201", "HX204")
def test_a_link_without_inertial_has_none_when_its_shape_is_resized(tmp_path: Path) -> None:
    """A stage states no mass for it: its engine computes one, of the shape's old size and of its new one."""
    text, missing = updated(tmp_path / "lamp.usda", (r'(?s)(Cube "collision".*?xformOp:scale = )\(0.1, 0.1, 0.02\)', r"\1(0.2, 0.1, 0.02)"))
    assert missing == []
    assert text == "0.2 0.1 0.02".join(LAMP.rsplit("0.1 0.1 0.02", 1))


MASSLESS = '<inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>'


@pytest.mark.unread("HX101", "HX105", "HX110", "HX201", "HX204")
def test_a_link_of_mass_zero_has_none_when_its_shape_is_moved(tmp_path: Path) -> None:
    lamp = LAMP.replace('<link name="foot">', f'<link name="foot">{MASSLESS}')
    change = (r'(?s)(Cube "collision".*?xformOp:translate = )\(0, 0, 0\)', r"\1(0, 0, 0.5)")
    text, missing = updated(tmp_path / "lamp.usda", change, lamp)
    assert missing == []
    assert text == lamp.replace("<collision>\n", f"<collision>\n      {ORIGIN}\n")


@pytest.mark.unread("HX101", "HX105", "HX201", "HX204")
def test_a_mass_that_a_stage_gets_is_an_edit(tmp_path: Path) -> None:
    change = (
        r'(Xform "foot" \(\s*prepend apiSchemas = \["PhysicsRigidBodyAPI")(\]\s*\)\s*\{)',
        r'\1, "PhysicsMassAPI"\2 float physics:mass = 2',
    )
    text, missing = updated(tmp_path / "lamp.usda", change)
    assert missing == []
    assert '<mass value="2"/>' in text


@pytest.mark.unread("HX101", "HX105", "HX201", "HX204")
def test_a_colour_in_place_of_a_material_is_no_edit_that_is_lost(tmp_path: Path) -> None:
    text, missing = updated(tmp_path / "lamp.xml", ('material="grey"', 'material="grey" rgba="1 0 0 1"'))
    assert missing == []
    assert text == LAMP.replace(
        '<material name="grey"><color rgba="0.65 0.65 0.75 1"/></material>', f'<material name="">{COLOUR}</material>'
    )


ARM = """<robot name="arm">
  <link name="a">
    <visual><geometry><sphere radius="0.1"/></geometry><material name="red"><color rgba="1 0 0 1"/></material></visual>
  </link>
  <link name="b">
    <visual><geometry><sphere radius="0.1"/></geometry><material name="blue"><color rgba="0 0 1 1"/></material></visual>
  </link>
  <joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>
</robot>
"""


@pytest.mark.unread("HX101")
def test_a_material_that_only_the_painted_shape_had_is_no_edit_that_is_lost(tmp_path: Path) -> None:
    """It is gone from the URDF with its shape, and the MJCF file still has it."""
    original, there = tmp_path / "arm.urdf", tmp_path / "arm.xml"
    original.write_text(ARM)
    hx.convert(original, there)
    there.write_text(there.read_text().replace(' material="blue"/>', ' material="blue" rgba="0 1 0 1"/>'))
    report = hx.update(original, there).report
    assert [str(row) for row in report if row.code.id == "HX118"] == []
    assert original.read_text() == ARM.replace('"blue"', '""').replace("0 0 1 1", "0 1 0 1")


@pytest.mark.unread("HX101", "HX105", "HX201", "HX204")
def test_what_rounding_leaves_of_zero_is_no_edit(tmp_path: Path) -> None:
    """Programs that compose poses and take them apart again write 3e-17 m for 0."""
    scaled = r'(?s)(Cube "visual".*?xformOp:scale = )\(0.1, 0.1, 0.02\)'
    moved = r'(.*?Cube "collision".*?xformOp:translate = )\(0, 0, 0\)'
    text, missing = updated(tmp_path / "lamp.usda", (scaled + moved, r"\1(0.2, 0.2, 0.04)\2(2.7755575615628914e-17, 0, 0)"))
    assert missing == []
    assert text == LAMP.replace('"0.1 0.1 0.02"', '"0.2 0.2 0.04"', 1)


def test_a_fragment_that_lost_more_comments_is_the_same_fragment() -> None:
    one, two = LAMP.replace("<update_rate>", "<!-- fast --><update_rate>"), LAMP.replace("<!-- from the\n           data sheet -->\n", "")
    source, image, edited = (hx.loads(text, "urdf").mechanism for text in (one, LAMP, two))
    assert len({robot.extras[ROOT] for robot in (source, image, edited)}) == 3
    assert restore(edited, residue_of(source, image), Report()).mechanism.extras == source.extras


ROD = """<mujoco model="rod">
  <worldbody>
    <body name="rod">
      <freejoint/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <geom name="side" type="capsule" fromto="0 0 0 0 0 1" size="0.1"/>
      <site name="tip" type="capsule" fromto="0 0 1 0 0 1.2" size="0.01"/>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.mark.unread("HX101")
@pytest.mark.parametrize(
    ("change", "line"),
    [
        ((r'(Capsule "side".*?translate = )\(0, 0, 0.5\)', r"\1(0.2, 0, 0.5)"), ("0 0 0 0 0 1", "0.2 0 0 0.2 0 1")),
        ((r'("tip".*?translate = )\(0, 0, 1.1\)', r"\1(0, 0, 2.1)"), ("0 0 1 0 0 1.2", "0 0 2 0 0 2.2")),
    ],
)
def test_two_points_between_which_a_shape_is_move_with_it(change: tuple[str, str], line: tuple[str, str], tmp_path: Path) -> None:
    (tmp_path / "rod.xml").write_text(ROD)
    hx.convert(tmp_path / "rod.xml", tmp_path / "rod.usda")
    text, number = re.subn(change[0], change[1], (tmp_path / "rod.usda").read_text(), count=1, flags=re.DOTALL)
    assert number == 1
    (tmp_path / "rod.usda").write_text(text)
    hx.update(tmp_path / "rod.xml", tmp_path / "rod.usda")
    assert (tmp_path / "rod.xml").read_text() == ROD.replace(f'fromto="{line[0]}"', f'fromto="{line[1]}"')


HELD = """<robot name="r">
  <link name="world"/>
  <link name="base">
    <inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
  </link>
  <joint name="held" type="floating"><parent link="world"/><child link="base"/><origin xyz="0 0 1"/></joint>
</robot>
"""


@pytest.mark.unread("HX105")
@pytest.mark.parametrize(
    ("name", "kind", "change"),
    [
        ("r.usda", "floating", (r"translate = \(0, 0, 1\)", "translate = (0, 0.5, 1)")),
        ("r.usda", "fixed", (r"localPos0 = \(0, 0, 1\)", "localPos0 = (0, 0.5, 1)")),
        ("r.sdf", "floating", ("0 0 1 0 0 0", "0 0.5 1 0 0 0")),
        ("r.sdf", "fixed", ("0 0 1 0 0 0", "0 0.5 1 0 0 0")),
        ("r.xml", "floating", ('pos="0 0 1"', 'pos="0 0.5 1"')),
        ("r.xml", "fixed", ('pos="0 0 1"', 'pos="0 0.5 1"')),
    ],
)
def test_the_place_of_a_base_below_the_link_of_the_world_comes_home(name: str, kind: str, change: tuple[str, str], tmp_path: Path) -> None:
    held = HELD.replace("floating", kind)
    text, missing = updated(tmp_path / name, change, held)
    assert (text, missing) == (held.replace("0 0 1", "0 0.5 1"), [])


@pytest.mark.parametrize("name", ["r.usda", "r.sdf", "r.xml"])
def test_a_link_that_stands_for_the_world_is_no_loss_where_the_world_is(name: str, tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(HELD)
    report = hx.convert(tmp_path / "r.urdf", tmp_path / name)
    assert [(loss.element, loss.field) for loss in report.losses] == ([] if name == "r.xml" else [("joint 'held'", "name")])


STAGE = """#usda 1.0
(
    defaultPrim = "r"
    upAxis = "Z"
    metersPerUnit = 1
)

def Xform "r"
{
    def Xform "arm" (prepend apiSchemas = ["PhysicsRigidBodyAPI"])
    {
    }

    def PhysicsRevoluteJoint "j"
    {
        uniform token physics:axis = "X" # along the arm

        rel physics:body1 = </r/arm>
    }
}
"""
DAMPED = """    def PhysicsRevoluteJoint "j" (
        prepend apiSchemas = ["MjcJointAPI", "NewtonJointAPI"]
    )
    {
        uniform double mjc:damping = 0.25
"""


@pytest.mark.unread("HX101", "HX103", "HX105")
def test_schemas_of_a_prim_without_any_stand_behind_its_name(tmp_path: Path) -> None:
    (tmp_path / "r.usda").write_text(STAGE)
    hx.convert(tmp_path / "r.usda", tmp_path / "r.xml")
    there = (tmp_path / "r.xml").read_text()
    assert there.count('<joint name="j"') == 1
    (tmp_path / "r.xml").write_text(there.replace('<joint name="j"', '<joint name="j" damping="0.25"'))
    report = hx.update(tmp_path / "r.usda", tmp_path / "r.xml").report
    assert [str(row) for row in report if row.code.id in ("HX108", "HX118")] == []
    text = (tmp_path / "r.usda").read_text()
    assert DAMPED in text
    lines = text.splitlines()
    assert [line for line in STAGE.splitlines() if line not in lines] == ['    def PhysicsRevoluteJoint "j"']


@pytest.mark.parametrize("opening", ["\ufeff", '\ufeff<?xml version="1.0"?>\n', '\n<?xml version="1.0"?>\n'])
@pytest.mark.unread("HX005")
def test_what_stands_before_the_root_stays_as_it_is(opening: str, tmp_path: Path) -> None:
    (tmp_path / "lamp.urdf").write_text(opening + LAMP)
    hx.convert(tmp_path / "lamp.urdf", tmp_path / "lamp.json")
    there = (tmp_path / "lamp.json").read_text()
    (tmp_path / "lamp.json").write_text(there.replace('"size":[0.1,0.1,0.02]', '"size":[0.1,0.1,0.03]'))
    hx.update(tmp_path / "lamp.urdf", tmp_path / "lamp.json")
    assert (tmp_path / "lamp.urdf").read_text() == opening + LAMP.replace("0.02", "0.03")


FRAGMENTS = """<robot name="r" xmlns:xacro="http://ros.org/wiki/xacro">
  <link name="a"/>
  <gazebo reference="a">
    <!-- rubber -->
    <mu1>0.9</mu1>
  </gazebo>
  <gazebo reference="a">
    <mu2>0.9</mu2>
  </gazebo>
</robot>
"""


def test_a_fragment_that_was_edited_takes_the_place_of_its_old_text_where_the_target_has_others_otherwise(tmp_path: Path) -> None:
    """The fragment with a comment is another text in the xacro file."""
    after, warnings = updated(tmp_path / "lamp.xacro", ("<mu2>0.9", "<mu2>0.7"), FRAGMENTS)
    assert (after, warnings) == (FRAGMENTS.replace("<mu2>0.9", "<mu2>0.7"), [])
