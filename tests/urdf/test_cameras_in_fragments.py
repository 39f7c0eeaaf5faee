"""Cameras of a robot from MJCF are <gazebo> sensors of its URDF, which SDF reads as its own; the ledger counts them as kept."""

from __future__ import annotations

import math
from pathlib import Path
from xml.etree import ElementTree

import pytest

import hymeko_x as hx
from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.parts import Camera

CAMERAS = """<mujoco model="r"><worldbody><camera name="room" pos="0 0 3"/><body name="base"><geom size="0.1" mass="1"/>
<camera name="eye" pos="0.1 0 0.2" xyaxes="0 -1 0 0 0 1" fovy="60" resolution="640 480"/><camera name="back" pos="-0.1 0 0.2"/></body>
</worldbody></mujoco>"""


@pytest.fixture
def urdf(tmp_path: Path) -> Path:
    (tmp_path / "r.xml").write_text(CAMERAS, "utf-8")
    result = hx.convert(tmp_path / "r.xml", tmp_path / "r.urdf")
    assert [loss.element for loss in result.losses or () if "camera" in loss.element] == []
    return tmp_path / "r.urdf"


def test_each_camera_on_a_link_has_a_fragment(urdf: Path) -> None:
    fragments = ElementTree.parse(urdf).getroot().findall("gazebo")
    assert sorted(fragment.get("reference") or "" for fragment in fragments) == ["base", "base", "world"]
    found = {sensor.get("name"): sensor for fragment in fragments for sensor in fragment}
    assert sorted(found) == ["back", "eye", "room"]
    eye = found["eye"]
    assert (eye.get("type"), eye.findtext("pose"), eye.findtext("camera/image/width")) == ("camera", "0.1 0 0.2 0 0 0", "640")
    assert float(eye.findtext("camera/horizontal_fov") or 0) == pytest.approx(1.311, abs=2e-3)


def test_gazebo_and_the_way_back_see_the_same_camera(urdf: Path, tmp_path: Path) -> None:
    hx.convert(urdf, tmp_path / "r.sdf")
    found = hx.load(tmp_path / "r.sdf")
    degrees = [math.degrees(found.vertex(Id("camera", name), Camera).fovy or 0.0) for name in ("eye", "back")]
    assert degrees == pytest.approx([60.0, 45.0])
    again = hx.convert(urdf, tmp_path / "again.urdf")
    assert (again.losses, (tmp_path / "again.urdf").read_text("utf-8").count("<sensor")) == ((), 3)
