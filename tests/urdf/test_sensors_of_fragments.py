"""Cameras and IMUs of <gazebo> elements, and IMUs of SDF, in MJCF and USD."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import mujoco
import numpy as np
import pytest
from pxr import Usd, UsdGeom

import hymeko_x as hx
from hymeko_x.cli import main

if TYPE_CHECKING:
    from pathlib import Path

INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
CAMERA = """<gazebo reference="head"><sensor name="eye" type="{kind}">
<pose>0.1 0 0.2 0 0 1.5707963267948966</pose><update_rate>30</update_rate>
<camera><horizontal_fov>1.2</horizontal_fov><image><width>640</width><height>320</height></image></camera></sensor></gazebo>"""
GYRO = '<gazebo reference="head"><sensor name="imu" type="imu"><pose>0 0 0.5 0 0 0</pose><update_rate>100</update_rate></sensor></gazebo>'
NO_LINK = '<gazebo reference="no_link"><sensor name="x" type="imu"/></gazebo>'
OTHERS = '<gazebo reference="head"><sensor name="far" type="ray"/></gazebo>'


def robot(*fragments: str) -> str:
    joint = '<joint name="j" type="continuous"><parent link="base"/><child link="head"/><axis xyz="0 0 1"/></joint>'
    return f'<robot name="r"><link name="base"/><link name="head">{INERTIAL}</link>{joint}{"".join(fragments)}</robot>'


def model_of(text: str, folder: Path, name: str = "r.urdf") -> mujoco.MjModel:
    (folder / name).write_text(text, "utf-8")
    hx.convert(folder / name, folder / "r.xml", base="fixed")
    return mujoco.MjModel.from_xml_path(str(folder / "r.xml"))


@pytest.mark.parametrize("kind", ["camera", "depth"])
def test_a_camera_looks_along_x_of_its_sensor(kind: str, tmp_path: Path) -> None:
    model = model_of(robot(CAMERA.format(kind=kind)), tmp_path)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert model.body(model.camera("eye").bodyid[0]).name == "head"
    assert list(model.cam_resolution[model.camera("eye").id]) == [640, 320]
    across = 2.0 * math.atan(math.tan(math.radians(model.camera("eye").fovy[0]) / 2.0) * 640 / 320)
    assert across == pytest.approx(1.2, abs=1e-12)
    right, up, back = data.camera("eye").xmat.reshape(3, 3).T
    assert np.allclose((data.camera("eye").xpos, -back, up, right), ([0.1, 0, 0.2], [0, 1, 0], [0, 0, 1], [1, 0, 0]), atol=1e-12)


def test_an_imu_measures_accelerations_and_angular_velocities_at_its_pose(tmp_path: Path) -> None:
    model = model_of(robot(GYRO), tmp_path)
    data = mujoco.MjData(model)
    data.qvel[0] = 2.0
    mujoco.mj_forward(model, data)
    assert list(data.site("imu").xpos) == [0.0, 0.0, 0.5]
    assert np.allclose(data.sensor("imu_gyro").data, [0, 0, 2])
    assert np.allclose(data.sensor("imu_accelerometer").data, [0, 0, 9.81])


def test_other_sensors_and_unknown_links_are_left_alone(tmp_path: Path) -> None:
    model = model_of(robot(OTHERS, NO_LINK), tmp_path)
    assert (model.ncam, model.nsensor, model.nsite) == (0, 0, 0)


def test_an_imu_of_sdf_is_one_too(tmp_path: Path) -> None:
    sensor = '<sensor name="imu" type="imu"><pose>0 0 0.5 0 0 0</pose></sensor>'
    model = model_of(f'<sdf version="1.11"><model name="m"><link name="a">{sensor}</link></model></sdf>', tmp_path, "r.sdf")
    assert [model.sensor(i).name for i in range(model.nsensor)] == ["imu_accelerometer", "imu_gyro"]


def test_a_stage_has_the_camera_and_the_frame_of_the_imu(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(robot(CAMERA.format(kind="camera"), GYRO), "utf-8")
    hx.convert(tmp_path / "r.urdf", tmp_path / "r.usda")
    stage = Usd.Stage.Open(str(tmp_path / "r.usda"))
    prims = {prim.GetName(): prim for prim in stage.Traverse()}
    assert (prims["eye"].GetTypeName(), prims["imu"].GetTypeName()) == ("Camera", "Xform")
    camera = UsdGeom.Camera(prims["eye"])
    across = 2.0 * math.atan(camera.GetVerticalApertureAttr().Get() / 2.0 / camera.GetFocalLengthAttr().Get() * 640 / 320)
    assert across == pytest.approx(1.2, abs=1e-5)


def test_the_way_back_has_the_fragments_as_they_were(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "r.urdf").write_text(robot(CAMERA.format(kind="depth"), GYRO), "utf-8")
    for target in ("r.xml", "r.usda"):
        hx.convert(tmp_path / "r.urdf", tmp_path / target, keep="beside")
        hx.convert(tmp_path / target, tmp_path / "back.urdf")
        assert main(["diff", str(tmp_path / "r.urdf"), str(tmp_path / "back.urdf")]) == 0
        assert (tmp_path / "back.urdf").read_text("utf-8").count("<sensor") == 2
    assert capsys.readouterr().out.count("differ") == 0


EYES = """<mujoco model="r"><worldbody><body name="base"><geom size="0.1"/>
<body name="head" pos="0 0 1"><joint name="j" axis="0 0 1"/><geom size="0.1"/>
<camera name="eye" pos="0.1 0 0.2" euler="40 20 10" fovy="40" resolution="640 480"/>
<site name="imu" pos="0 0.3 0.5" euler="0 0 30"/><site name="mark" pos="1 0 0"/></body></body></worldbody>
<sensor><accelerometer name="acc" site="imu"/><gyro name="rate" site="imu"/><gyro name="other" site="mark"/></sensor></mujoco>"""


def test_for_ros_cameras_and_imus_are_sensors_of_gazebo_and_come_back(tmp_path: Path) -> None:
    (tmp_path / "r.xml").write_text(EYES, "utf-8")
    hx.convert(tmp_path / "r.xml", tmp_path / "r.urdf", target="ros2")
    text = (tmp_path / "r.urdf").read_text("utf-8")
    assert [text.count(f'type="{kind}"') for kind in ("camera", "imu")] == [1, 1]
    hx.convert(tmp_path / "r.urdf", tmp_path / "back.xml")
    before, after = (mujoco.MjModel.from_xml_path(str(tmp_path / name)) for name in ("r.xml", "back.xml"))
    states = []
    for model in (before, after):
        data = mujoco.MjData(model)
        data.qvel[0] = 2.0
        mujoco.mj_forward(model, data)
        eye = data.camera("eye")
        states.append(np.concatenate([eye.xpos, eye.xmat, model.camera("eye").fovy, data.site("imu").xpos, data.site("imu").xmat]))
        states.append(np.concatenate([data.sensordata[:6]]))
    assert np.allclose(states[0], states[2], atol=1e-9)
    assert np.allclose(states[1], states[3], atol=1e-9)
