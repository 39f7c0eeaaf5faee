"""Keyframes have as many numbers as the robot has coordinates and controls."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest

import hymeko_x as hx
from hymeko_x.cli import main
from hymeko_x.formats.mjcf.lengths import controls_of
from hymeko_x.ir.parts import Actuator

ROBOT = """<mujoco model="k">
  <default><default class="quick"><pid input="pos vel ff"/></default></default>
  <worldbody>
    <body name="a"><joint name="turn" type="ball"/><geom size="0.1"/></body>
    <body name="b"><joint name="hinge"/><geom size="0.1"/></body>
  </worldbody>
  <actuator>ACTUATOR</actuator>
  <keyframe><key name="home" qpos="1 0 0 0 0.5" ctrl="CTRL"/></keyframe>
</mujoco>"""

ACTUATORS = {
    '<motor joint="hinge"/>': 1,
    '<pid joint="hinge" kp="1"/>': 2,
    '<pid joint="hinge" kp="1" input="ff"/>': 1,
    '<pid joint="hinge" kp="1" class="quick"/>': 3,
    '<orientation joint="turn" kp="1"/>': 3,
    '<orientation joint="turn" kp="1" input="quat"/>': 4,
    '<dcmotor joint="hinge" motorconst="1" resistance="1" input="none"/>': 0,
    '<dcmotor joint="hinge" motorconst="1" resistance="1" input="pos voltage"/>': 2,
    '<general joint="hinge" gaintype="pid" dyntype="pid" biastype="affine" gainprm="1" biasprm="0 -1"/>': 2,
    '<general joint="turn" gaintype="so3" biastype="so3" gainprm="1" biasprm="0 -1"/>': 3,
}


@pytest.mark.parametrize(("text", "number"), ACTUATORS.items(), ids=ACTUATORS)
def test_an_actuator_has_as_many_controls_as_in_mujoco(text: str, number: int, tmp_path: Path) -> None:
    robot = ROBOT.replace("ACTUATOR", text).replace("CTRL", " ".join("0.25" for _ in range(number)))
    assert mujoco.MjModel.from_xml_string(robot).nu == number
    assert [controls_of(part) for _, part in hx.loads(robot, "mjcf").mechanism.vertices(Actuator)] == [number]
    (tmp_path / "k.xml").write_text(robot, "utf-8")
    hx.convert(tmp_path / "k.xml", tmp_path / "k.hymeko")
    hx.convert(tmp_path / "k.hymeko", tmp_path / "back.xml")
    back = mujoco.MjModel.from_xml_path(str(tmp_path / "back.xml"))
    assert back.key("home").ctrl.tolist() == [0.25] * number


LONG = "keyframe 'home' has {} numbers in {}, and the robot has {}; MuJoCo refuses the file"
SHORT = "keyframe 'home' has {} numbers in {}, and the robot has {}; MuJoCo leaves the others at rest"


@pytest.mark.parametrize(
    ("numbers", "errors", "warnings"),
    [
        ('qpos="1 0 0 0 0.5" ctrl="0 0"', [], []),
        ('qpos="1 0 0 0 0.5 1" ctrl="0 0"', [LONG.format(6, "qpos", 5)], []),
        ('qvel="1 2 3 4 5"', [LONG.format(5, "qvel", 4)], []),
        ('ctrl="1 2 3"', [LONG.format(3, "ctrl", 2)], []),
        ('qpos="0 1 0 0"', [], [SHORT.format(4, "qpos", 5)]),
    ],
)
def test_check_finds_the_keyframes_that_mujoco_refuses_or_fills_up(
    numbers: str, errors: list[str], warnings: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robot = ROBOT.replace("ACTUATOR", '<pid joint="hinge" kp="1"/>').replace('qpos="1 0 0 0 0.5" ctrl="CTRL"', numbers)
    path = tmp_path / "k.xml"
    path.write_text(robot, "utf-8")
    code = main(["check", str(path)])
    found = [line for line in capsys.readouterr().err.splitlines() if "keyframe" in line]
    wanted = {"error": errors, "warning": warnings}
    assert found == [f"{path}: {severity}[HX020]: {message}" for severity, messages in wanted.items() for message in messages]
    assert code == (3 if errors else 0)
    if errors:
        with pytest.raises(ValueError, match="invalid"):
            mujoco.MjModel.from_xml_string(robot)
    else:
        assert mujoco.MjModel.from_xml_string(robot).key("home").qpos[4] == (0.0 if warnings else 0.5)
