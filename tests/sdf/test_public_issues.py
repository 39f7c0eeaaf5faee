"""What users of other converters asked for in public, each with a file of that kind."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

import hymeko_x as hx
from hymeko_x.ir.parts import Body
from tests.sdf.samples import AXIS, SAMPLES, TWO, joint, model

if TYPE_CHECKING:
    from pathlib import Path

CABLE = (
    '<joint name="cable" type="universal"><pose relative_to="b">0.15 0 -0.025 0 1.5707963267948966 0</pose><parent>a</parent>'
    "<child>b</child><axis><xyz>0 1 0</xyz></axis><axis2><xyz>1 0 0</xyz></axis2></joint>"
)
PENDULUM = (
    f'<link name="base"/><model name="pendulum"><pose>0 0 1 0 0 1</pose>{TWO}<joint name="j" type="revolute"><parent>a</parent>'
    f'<child>b</child>{AXIS.format("")}</joint></model><joint name="k" type="fixed"><parent>base</parent><child>pendulum::a</child></joint>'
)
CONTROL = (
    '<ros2_control name="rig" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>'
    '<joint name="j"><command_interface name="position"/></joint></ros2_control>'
)
HINGE = f'<joint name="j" type="revolute"><parent>a</parent><child>b</child>{AXIS.format("")}</joint>'
LUMPED = """<robot name="m">
  <link name="base"><inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="tool"><visual name="v"><geometry><sphere radius="0.1"/></geometry></visual></link>
  <link name="tip"/>
  <joint name="flange" type="fixed"><origin xyz="0 0 1" rpy="0.1 0 0"/><parent link="base"/><child link="tool"/></joint>
  <joint name="probe" type="revolute">
    <parent link="tool"/><child link="tip"/><limit lower="-1" upper="1" effort="3" velocity="4"/><dynamics damping="0.5"/>
  </joint>
</robot>"""
ISSUES = {
    "gz-usd 45: a universal joint in USD": (model(TWO + CABLE), "m.usda"),
    "gz-usd 40: nested models in USD": (model(PENDULUM), "m.usda"),
    "gz-mujoco 9: kinematic loops in MJCF": (SAMPLES["a loop"], "m.xml"),
    "gz-mujoco 10: nested models in MJCF": (model(PENDULUM), "m.xml"),
    "gz-mujoco 23: universal joints in MJCF": (model(TWO + CABLE), "m.xml"),
    "gz-mujoco 23: revolute2 joints in MJCF": (SAMPLES["revolute2"], "m.xml"),
    "gz-mujoco 24: gearboxes in MJCF": (SAMPLES["a gearbox between hinges"], "m.xml"),
    "gz-mujoco 24: screws in MJCF": (SAMPLES["screw"], "m.xml"),
    "sdformat 273 and 289: SDF as URDF": (joint("prismatic", AXIS.format("<limit><lower>-1</lower><upper>2</upper></limit>")), "m.urdf"),
    "sdformat 273 and 289: a mimic joint as URDF": (SAMPLES["mimic"], "m.urdf"),
}


@pytest.mark.parametrize("issue", ISSUES)
def test_it_is_converted(issue: str, tmp_path: Path) -> None:
    text, name = ISSUES[issue]
    (tmp_path / "in.sdf").write_text(text, "utf-8")
    hx.convert(tmp_path / "in.sdf", tmp_path / name)
    is_read = "revolute2" not in issue  # by Drake
    verdict = hx.verify(tmp_path / "in.sdf" if is_read else hx.load(tmp_path / "in.sdf").mechanism, tmp_path / name, samples=10)
    assert verdict.is_same, [*verdict.failed, verdict.reason]


def test_gz_mujoco_9_a_loop_that_a_slide_closes_is_named_and_left_out(tmp_path: Path) -> None:
    """MuJoCo has no constraint that leaves one direction free; docs/mapping/mjcf.md has the measurements."""
    original, there = tmp_path / "in.sdf", tmp_path / "m.xml"
    original.write_text(SAMPLES["a loop"].replace('type="revolute"', 'type="prismatic"'), "utf-8")
    report = hx.convert(original, there).report
    assert "loop 'l' closes a loop by a slide, for which there is no closure; it is left out" in [line.message for line in report]
    verdict = hx.verify(original, there, samples=10)
    assert verdict.is_same, verdict.failed
    assert [(gap.format, gap.quantity, gap.count) for gap in verdict.gaps] == [("mjcf", "closures that leave a slide free", 1)]
    assert not hx.verify(there, original, samples=10).is_same


def test_gz_usd_33_a_joint_without_an_actuator_has_no_drive() -> None:
    assert "drive:" not in hx.dumps(hx.loads(SAMPLES["continuous"], "sdf"), "usd")


def test_sdformat_986_no_link_and_no_fixed_joint_is_lost_on_the_way_from_urdf(tmp_path: Path) -> None:
    """Links without inertia were left out with all that is below them, and fixed joints were lumped: frames and names were gone."""
    (tmp_path / "m.urdf").write_text(LUMPED, "utf-8")
    hx.convert(tmp_path / "m.urdf", tmp_path / "m.sdf")
    robot = hx.load(tmp_path / "m.sdf").mechanism
    assert [key.name for key, _ in robot.vertices(Body)] == ["base", "tool", "tip"]
    assert [(view.id.name, len(view.joint.dofs)) for view in robot.joints.values()] == [("flange", 0), ("probe", 1)]
    verdict = hx.verify(tmp_path / "m.urdf", tmp_path / "m.sdf", samples=10)
    assert verdict.is_same, [*verdict.failed, verdict.reason]


def test_ros2_control_632_what_a_model_of_sdf_says_of_its_controllers_is_in_its_urdf() -> None:
    robot = hx.loads(model(TWO + HINGE + CONTROL), "sdf").mechanism
    assert f"  {CONTROL}\n</robot>" in hx.dumps(robot, "urdf")
    assert CONTROL in hx.dumps(robot, "sdf")


def test_ros2_control_632_a_parallel_robot_with_ball_and_universal_joints_has_a_urdf(tmp_path: Path) -> None:
    """Each such joint is a chain of hinges there, and ros2_control reads URDF."""
    leg = '<link name="c"/><joint name="ball" type="ball"><parent>b</parent><child>c</child></joint>'
    (tmp_path / "m.sdf").write_text(model(TWO + leg + CABLE), "utf-8")
    hx.convert(tmp_path / "m.sdf", tmp_path / "m.urdf")
    verdict = hx.verify(tmp_path / "m.sdf", tmp_path / "m.urdf", samples=10)
    assert verdict.is_same, [*verdict.failed, verdict.reason]
