"""`--for gazebo`: plugins that command the joints of a model, under the names that the file has."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest

import hymeko_x as hx
from hymeko_x.verify import model_of

ARM = """arm : robot {
  base { mass 1 inertia [0.1 0.1 0.1] }
  upper { mass 1 inertia [0.1 0.1 0.1] com [0.2 0 0] }
  hand { mass 1 inertia [0.1 0.1 0.1] }
  @upper : revolute { limit [-1 1] effort 20 + base - upper axis=Y }
  @grip : prismatic { limit [0 1] + upper - hand axis=X }
  @follows : coupling { [1] + grip [0 2] - upper }
}
"""
DRIVEN = """<mujoco model="m"><worldbody><geom type="plane" size="1 1 1"/><light/>
<body name="a"><joint name="one" axis="1 0 0"/><joint name="two" axis="0 1 0"/><geom size=".1"/>
<body name="b"><joint name="three"/><geom size=".1"/>
<body name="c"><joint name="four"/><geom size=".1"/></body></body></body></worldbody><actuator>
<position joint="one" kp="30" kv="2" gear="2" forcerange="-5 5"/><motor joint="two"/><velocity joint="three" kv="4"/>
<general joint="four" gainprm="7" biastype="affine" biasprm="0 -7 -1"/><muscle name="odd" joint="four"/></actuator></mujoco>"""


def _plugins(path: Path) -> list[dict[str, str]]:
    """What each plugin of the model says, with its system as ``is``."""
    found = ElementTree.parse(path).findall("./model/plugin")
    return [{"is": plugin.attrib["name"].rpartition("::")[2], **{child.tag: child.text or "" for child in plugin}} for plugin in found]


def test_a_robot_without_actuators_is_held_by_servos(tmp_path: Path) -> None:
    (tmp_path / "arm.hymeko").write_text(ARM, "utf-8")
    hx.convert(tmp_path / "arm.hymeko", tmp_path / "arm.sdf", target="gazebo")
    servo, publisher = _plugins(tmp_path / "arm.sdf")
    assert servo["is"] == "JointPositionController"
    assert servo["joint_name"] == "upper_joint"  # a link has the name
    assert (servo["cmd_max"], servo["cmd_min"]) == ("20", "-20")
    assert float(servo["p_gain"]) > 0.0
    assert publisher == {"is": "JointStatePublisher"}
    hx.convert(tmp_path / "arm.sdf", tmp_path / "again.sdf", target="gazebo")
    assert _plugins(tmp_path / "again.sdf") == [servo, publisher]


def test_limits_of_zero_that_would_hold_a_joint_still_are_left_out_with_a_note(tmp_path: Path) -> None:
    (tmp_path / "arm.hymeko").write_text(ARM.replace("effort 20", "effort 0 velocity 0"), "utf-8")
    report = hx.convert(tmp_path / "arm.hymeko", tmp_path / "arm.sdf", target="gazebo").report
    text = (tmp_path / "arm.sdf").read_text()
    assert ("<effort>" in text, "<velocity>" in text) == (False, False)
    note = "limits of effort or velocity of 0, by which Gazebo holds a joint still, are left out (--for gazebo): 'upper'"
    assert [row.message for row in report if "of 0" in row.message] == [note]


def test_each_actuator_has_the_plugin_of_its_kind(tmp_path: Path) -> None:
    (tmp_path / "m.xml").write_text(DRIVEN, "utf-8")
    done = hx.convert(tmp_path / "m.xml", tmp_path / "m.sdf", target="gazebo")
    assert _plugins(tmp_path / "m.sdf") == [
        {
            "is": "JointPositionController",
            "joint_name": "one",
            "p_gain": "120",
            "i_gain": "0",
            "d_gain": "8",
            "cmd_max": "10",
            "cmd_min": "-10",
        },
        {"is": "ApplyJointForce", "joint_name": "two"},
        {"is": "JointController", "joint_name": "three", "use_force_commands": "true", "p_gain": "4", "i_gain": "0", "d_gain": "0"},
        {"is": "JointPositionController", "joint_name": "four", "p_gain": "7", "i_gain": "0", "d_gain": "1"},
        {"is": "JointStatePublisher"},
    ]
    assert any("1 actuator that no plugin of Gazebo stands for: 'odd'" in diagnostic.message for diagnostic in done.report)
    pytest.importorskip("pydrake")
    assert len(model_of(tmp_path / "m.sdf").dofs) == 4


def test_a_robot_with_controllers_of_ros_keeps_them(tmp_path: Path) -> None:
    plugin = '<gazebo><plugin filename="gz_ros2_control-system" name="gz_ros2_control::GazeboSimROS2ControlPlugin"/></gazebo>'
    (tmp_path / "r.urdf").write_text(
        '<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>'
        f"{plugin}</robot>",
        "utf-8",
    )
    hx.convert(tmp_path / "r.urdf", tmp_path / "r.sdf", target="gazebo")
    assert [plugin["is"] for plugin in _plugins(tmp_path / "r.sdf")] == ["GazeboSimROS2ControlPlugin"]
