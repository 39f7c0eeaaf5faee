"""Meshes of a model that is made of several files, looked for where the first file is."""

from __future__ import annotations

from pathlib import Path

import hymeko_x as hx

CUBE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"


def test_meshes_of_an_included_file_are_found_when_a_robot_is_written(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "cube.obj").write_text(CUBE)
    (tmp_path / "parts" / "assets.xml").write_text('<mujoco><asset><mesh name="cube" file="cube.obj"/></asset></mujoco>')
    main = '<include file="parts/assets.xml"/><worldbody><body name="b"><geom type="mesh" mesh="cube"/></body></worldbody>'
    (tmp_path / "robot.xml").write_text(f"<mujoco>{main}</mujoco>")
    robot = hx.load(tmp_path / "robot.xml").mechanism
    assert [str(item) for item in hx.dump(robot, tmp_path / "robot.usdc")] == []
