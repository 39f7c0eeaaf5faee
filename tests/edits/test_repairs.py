"""`check --fix`: mechanical repairs in the author's text, and nothing else changed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pinocchio
import pytest

from hymeko_x.cli import main

if TYPE_CHECKING:
    from pathlib import Path

ROBOT = """<robot name="bad">
  <link name="base"/> <!-- stands -->
  <link name="upper">
    <inertial><mass value="2"/><inertia ixx="0.03" iyy="0.03" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><box size="0.1  0.1 0.4"/></geometry></visual>
    <collision><geometry><box size="0.1  0.1 0.4"/></geometry></collision>
  </link>
  <joint name="j" type="revolute"> <!-- turns -->
    <parent link="base"/><child link="upper"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1"   upper="1" effort="60" velocity="3"/>
  </joint>
</robot>
"""

pytestmark = pytest.mark.unread("HX023", "HX028")  # what the reader finds in the text before its repair


def fix(path: Path, *options: str) -> int:
    return main(["check", str(path), "--fix", *options])


@pytest.mark.parametrize(
    ("right", "wrong", "repaired"),
    [
        ('lower="-1"   upper="1"', 'lower="1"   upper="-1"', 'lower="-1"   upper="1"'),
        ('effort="60"', 'effort="-60"', 'effort="60"'),
        ('velocity="3"/>', 'velocity="-3"/><dynamics damping="-0.5"/>', 'velocity="3"/><dynamics damping="0.5"/>'),
        ('xyz="0 1 0"', 'xyz="0 2  0"', 'xyz="0 1  0"'),
        ('izz="0.02"', 'izz="0.09"', 'izz="0.07"'),
        ('<box size="0.1  0.1 0.4"/>', '<box size="0.1  -0.1 0.4"/>', '<box size="0.1  0.1 0.4"/>'),
    ],
)
def test_a_repair_changes_its_numbers_alone(right: str, wrong: str, repaired: str, tmp_path: Path) -> None:
    path = tmp_path / "r.urdf"
    path.write_text(ROBOT.replace(right, wrong), "utf-8")
    assert fix(path) == 0
    expected = ROBOT.replace(right, repaired)
    if "izz" in right:  # the nearest tensor that a body can have moves all three moments
        expected = expected.replace('ixx="0.03" iyy="0.03"', 'ixx="0.04" iyy="0.04"').replace("0.07", "0.08")
    assert path.read_text("utf-8") == expected


def test_the_second_of_two_elements_of_one_name_is_renamed_where_it_stands(tmp_path: Path) -> None:
    second = '  <link name="tool"/>\n  <joint name="j" type="fixed"><parent link="upper"/><child link="tool"/></joint>\n</robot>'
    path = tmp_path / "r.urdf"
    path.write_text(ROBOT.replace("</robot>", second), "utf-8")
    assert (main(["check", str(path)]), fix(path)) == (3, 0)
    assert path.read_text("utf-8") == ROBOT.replace("</robot>", second.replace('"j"', '"j_2"'))


INERTIAL = '<inertial><mass value="2"/><inertia ixx="0.03" iyy="0.03" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>'
OF_THE_BOX = 'ixx="{0}" iyy="{0}" izz="{1}" ixy="0" ixz="0" iyz="0"'


@pytest.mark.parametrize(
    ("mass", "given"),
    [
        ("0", '<mass value="4"/><inertia ' + OF_THE_BOX.format("0.0566666666666667", "0.0066666666666667")),
        ("2", '<mass value="2"/><inertia ' + OF_THE_BOX.format("0.02833333333333334", "0.00333333333333333")),
    ],
    ids=["no mass", "a mass without a tensor"],
)
def test_with_a_density_bodies_get_the_inertia_of_their_shapes(mass: str, given: str, tmp_path: Path) -> None:
    path = tmp_path / "r.urdf"
    empty = f'<mass value="{mass}"/><inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/>'
    text = ROBOT.replace(INERTIAL, f"<inertial>{empty}</inertial>")
    path.write_text(text, "utf-8")
    assert (fix(path), path.read_text("utf-8")) == (3, text)
    assert fix(path, "--density", "1000") == 0
    assert path.read_text("utf-8") == text.replace(empty, f"{given}/>")


def test_a_rehearsal_prints_what_would_change_and_names_each_repair(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "r.urdf"
    text = ROBOT.replace('effort="60"', 'effort="-60"')
    path.write_text(text, "utf-8")
    assert fix(path, "--dry-run") == 0
    printed = capsys.readouterr()
    assert path.read_text("utf-8") == text
    changed = [line for line in printed.out.splitlines() if line.startswith(("-  ", "+  "))]
    assert changed == [
        f'{sign}    <limit lower="-1"   upper="1" effort="{value}" velocity="3"/>' for sign, value in (("-", -60), ("+", 60))
    ]
    assert "r.urdf:8: note[HX321]: joint 'j': effort limit -60.0 becomes 60.0" in printed.err


def test_the_repaired_robot_goes_elsewhere_on_request_and_a_sound_one_stays_as_it_is(tmp_path: Path) -> None:
    path, out = tmp_path / "r.urdf", tmp_path / "out.urdf"
    text = ROBOT.replace('effort="60"', 'effort="-60"')
    path.write_text(text, "utf-8")
    assert fix(path, "-o", str(out)) == 0
    assert (path.read_text("utf-8"), out.read_text("utf-8")) == (text, ROBOT)
    before = out.stat().st_mtime_ns
    assert (fix(out), out.stat().st_mtime_ns) == (0, before)


def test_other_formats_are_repaired_in_their_own_text(tmp_path: Path) -> None:
    path = tmp_path / "r.sdf"
    limits = "<lower>{}</lower> <upper>{}</upper><effort>{}</effort>"
    text = (
        '<sdf version="1.11"><model name="m"><link name="a"/><link name="b"/><joint name="j" type="revolute"><parent>a</parent>'
        f"<child>b</child><axis><xyz>0 0 1</xyz><limit>{limits}</limit></axis></joint></model></sdf>\n"
    )
    path.write_text(text.format(2, -2, 5), "utf-8")
    assert fix(path, "--profile", "kinematics") == 0
    assert path.read_text("utf-8") == text.format(-2, 2, 5)


HAND = f"""<robot name="hand">
  <link name="base"/>
  <link name="hand">{INERTIAL}</link> <link name="left">{INERTIAL}</link>
  <link name="right">{INERTIAL}</link> <link name="tip">{INERTIAL}</link>
  <joint name="hand" type="revolute">
    <parent link="base"/><child link="hand"/><limit lower="-1" upper="1"  effort="10" velocity="1"/>
  </joint>
  <joint name="a_right" type="prismatic"> <!-- moves with the left one -->
    <parent link="hand"/><child link="right"/><limit lower="0" upper="0.04" effort="10" velocity="1"/>
    <mimic joint="b_left" multiplier="2" offset="0.5"/>
  </joint>
  <joint name="b_left" type="prismatic">
    <parent link="hand"/>
    <child link="left"/>
    <limit lower="0" upper="0.04" effort="10" velocity="1"/>
  </joint>
  <joint name="wrist" type="revolute">
    <parent link="left"/><child link="tip"/><limit lower="-1" upper="1" effort="10" velocity="1"/>
    <mimic joint="hand"/>
  </joint>
  <transmission name="t"><type>transmission_interface/SimpleTransmission</type>
    <joint name="hand"><hardwareInterface>hardware_interface/EffortJointInterface</hardwareInterface></joint>
    <actuator name="m"><mechanicalReduction>1</mechanicalReduction></actuator>
  </transmission>
  <gazebo reference="hand"><mu1>0.2</mu1></gazebo>
  <gazebo reference="hand"><provideFeedback>true</provideFeedback></gazebo>
  <gazebo><plugin name="p" filename="p.so"><joint_name>hand</joint_name><link_name>hand</link_name></plugin></gazebo>
</robot>
"""


def test_a_joint_called_as_a_link_gets_a_name_that_all_references_to_the_joint_have(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "r.urdf"
    text = HAND.replace('<mimic joint="b_left" multiplier="2" offset="0.5"/>', "")
    path.write_text(text, "utf-8")
    assert main(["check", str(path), "--profile", "kinematics"]) == 0
    assert "r.urdf:5: note[HX322]: a link is called 'hand' as well" in capsys.readouterr().err
    assert fix(path, "--profile", "kinematics") == 0
    fixed = text.replace('joint name="hand"', 'joint name="hand_joint"').replace("<joint_name>hand", "<joint_name>hand_joint")
    fixed = fixed.replace('mimic joint="hand"', 'mimic joint="hand_joint"').replace('"hand"><provide', '"hand_joint"><provide')
    assert path.read_text("utf-8") == fixed
    assert "r.urdf:5: note[HX321]: a link is called 'hand' as well; the joint is called 'hand_joint'" in capsys.readouterr().err


def test_a_mimic_joint_before_its_leader_leads_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The order is that of urdfdom, and so of Pinocchio, which refuses the robot otherwise: by the names of the joints."""
    path = tmp_path / "r.urdf"
    text = HAND.replace('joint name="hand"', 'joint name="turn"').replace('mimic joint="hand"', 'mimic joint="turn"')
    path.write_text(text, "utf-8")
    with pytest.raises(ValueError, match="not in the kinematic tree"):
        pinocchio.buildModelFromUrdf(str(path), mimic=True)
    assert fix(path, "--profile", "kinematics") == 0
    turned = text.replace('    <mimic joint="b_left" multiplier="2" offset="0.5"/>\n', "")
    left = '<child link="left"/>\n    <limit lower="0" upper="0.04" effort="10" velocity="1"/>'
    assert path.read_text("utf-8") == turned.replace(left, f'{left}\n    <mimic joint="a_right" multiplier="0.5" offset="-0.25"/>')
    assert "note[HX321]: joint 'b_left' follows joint 'a_right', which comes first in the tree" in capsys.readouterr().err
    assert pinocchio.buildModelFromUrdf(str(path), mimic=True).nq == 2


def test_a_joint_with_an_actuator_keeps_the_lead(tmp_path: Path) -> None:
    path = tmp_path / "r.urdf"
    text = HAND.replace('joint name="hand"', 'joint name="turn"').replace('mimic joint="hand"', 'mimic joint="turn"')
    text = text.replace('joint name="turn"><hardware', 'joint name="b_left"><hardware')
    path.write_text(text, "utf-8")
    assert fix(path, "--profile", "kinematics") == 0
    assert path.read_text("utf-8") == text


@pytest.mark.parametrize("options", [["--density", "1000"], ["-o", "out.urdf"], ["--dry-run"]])
def test_options_of_repairs_without_repairs_are_mistakes(options: list[str], tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(ROBOT, "utf-8")
    assert main(["check", str(tmp_path / "r.urdf"), *options]) == 2
