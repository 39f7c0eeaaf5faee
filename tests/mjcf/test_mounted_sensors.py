"""Sensors on bodies: MuJoCo's measure at sites, which they get."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import pytest

import hymeko_x as hx

if TYPE_CHECKING:
    from pathlib import Path

INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
ARM = f"""<robot name="r"><link name="base">{INERTIAL}</link><link name="head">{INERTIAL}</link>
<joint name="j" type="continuous"><parent link="base"/><child link="head"/><axis xyz="0 0 1"/></joint></robot>"""
SDF = """<sdf version="1.11"><model name="m"><link name="base"/><link name="head"><pose>0 0 1 0 0 0</pose>
<sensor name="north" type="magnetometer"><pose>0 0.2 0 0 0 0</pose></sensor></link>
<joint name="j" type="revolute"><parent>base</parent><child>head</child><axis><xyz>0 0 1</xyz></axis></joint></model></sdf>"""
NATIVE = '<mujoco model="r"><worldbody><body name="head"><joint name="j" axis="0 0 1"/><geom size="0.1"/></body></worldbody></mujoco>'


def moving(text: str) -> mujoco.MjData:
    data = mujoco.MjData(mujoco.MjModel.from_xml_string(text))
    data.qvel[:] = 2.0
    mujoco.mj_forward(data.model, data)
    return data


@pytest.mark.parametrize(("text", "format"), [(ARM, "urdf"), (NATIVE, "mjcf")])
def test_a_sensor_that_an_edit_puts_on_a_body_measures_there(text: str, format: str) -> None:
    robot = hx.loads(text, format)
    with robot.edit() as e:
        e.add_sensor("shake", "accelerometer", on="head", at=(0.5, 0.0, 0.0))
        e.add_sensor("head", "gyro", on="head")
    data = moving(hx.dumps(e.robot, "mjcf"))
    assert data.sensor("shake").data == pytest.approx([-2.0, 0.0, 9.81])  # 0.5 m from the axis, at 2 rad/s
    assert data.sensor("head").data == pytest.approx([0.0, 0.0, 2.0])
    assert list(data.site("shake").xpos) == [0.5, 0.0, 0.0]


def test_a_magnetometer_of_sdf_measures_the_field_where_it_is(tmp_path: Path) -> None:
    (tmp_path / "r.sdf").write_text(SDF, "utf-8")
    hx.convert(tmp_path / "r.sdf", tmp_path / "r.xml", base="fixed", keep="beside")
    data = moving((tmp_path / "r.xml").read_text("utf-8"))
    assert data.sensor("north").data == pytest.approx(data.model.opt.magnetic)
    assert data.site("north").xpos == pytest.approx([0.0, 0.2, 1.0])
    assert hx.verify(tmp_path / "r.sdf", tmp_path / "r.xml").is_same
    hx.convert(tmp_path / "r.xml", tmp_path / "back.sdf")
    found = hx.diff(hx.load(tmp_path / "r.sdf"), hx.load(tmp_path / "back.sdf"))
    assert {difference.element.kind for difference in found} == {"world", "joint"}  # of the base, which was to be fixed


@pytest.mark.parametrize(("text", "format"), [(ARM, "urdf"), (NATIVE, "mjcf")])
def test_kinds_that_mujoco_does_not_have_are_left_out(text: str, format: str) -> None:
    robot = hx.loads(text, format)
    with robot.edit() as e:
        e.add_sensor("height", "altimeter", on="head")
    assert "height" not in hx.dumps(e.robot, "mjcf")


@pytest.mark.parametrize(("text", "format"), [(ARM, "urdf"), (NATIVE, "mjcf")])
def test_an_imu_that_an_edit_adds_is_what_it_consists_of(text: str, format: str) -> None:
    robot = hx.loads(text, format)
    with robot.edit() as e:
        e.add_sensor("imu", "imu", on="head")
    data = moving(hx.dumps(e.robot, "mjcf"))
    assert data.sensor("imu_gyro").data == pytest.approx([0.0, 0.0, 2.0])
    assert data.sensor("imu_accelerometer").data == pytest.approx([0.0, 0.0, 9.81])
