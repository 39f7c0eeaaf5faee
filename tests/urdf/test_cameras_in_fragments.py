"""Sensors and cameras of SDF that stand in <gazebo> fragments of a URDF file are no losses."""

from __future__ import annotations

from pathlib import Path

import hymeko_x as hx

SENSORS = """<sdf version="1.11"><model name="r"><link name="base"><inertial><mass>1</mass></inertial>
<sensor name="eye" type="camera"><pose>0.1 0 0.2 0 0 0</pose><camera><horizontal_fov>1.2</horizontal_fov></camera></sensor>
<sensor name="imu" type="imu"><update_rate>100</update_rate></sensor></link></model></sdf>"""


def test_what_stands_in_a_fragment_is_not_dropped(tmp_path: Path) -> None:
    (tmp_path / "r.sdf").write_text(SENSORS, "utf-8")
    result = hx.convert(tmp_path / "r.sdf", tmp_path / "r.urdf")
    assert (tmp_path / "r.urdf").read_text("utf-8").count("<sensor") == 2
    assert [loss.element for loss in result.losses or () if loss.element.startswith(("camera", "sensor"))] == []
