"""Poses and names in a world, and the models that it includes by their bare name."""

from __future__ import annotations

from typing import TYPE_CHECKING

import hymeko_x as hx
from tests.sdf.canonical import canonical

if TYPE_CHECKING:
    from pathlib import Path

FRAMES = """<sdf version="1.9"><world name="w"><frame name="f"><pose>1 2 3 0 0 0</pose></frame>
<model name="m"><pose relative_to="f">1 0 0 0 0 0</pose><frame name="f"><pose>5 5 5 0 0 0</pose></frame>
<link name="l"/></model></world></sdf>"""


def test_the_pose_of_the_only_model_is_relative_to_a_frame_of_the_world() -> None:
    robot = hx.loads(FRAMES, "sdf")
    assert [joint.parent_pose.xyz for joint in robot.joints.values()] == [(2.0, 2.0, 3.0)]
    assert canonical(hx.dumps(robot, "sdf").encode()) == canonical(FRAMES.encode())


def test_a_bare_name_is_that_of_a_model_in_the_resource_path(tmp_path: Path) -> None:
    folder = tmp_path / "models" / "part"
    folder.mkdir(parents=True)
    (folder / "model.sdf").write_text('<sdf version="1.9"><model name="p"><link name="l"/></model></sdf>', "utf-8")
    (tmp_path / "w.sdf").write_text('<sdf version="1.9"><world name="w"><include><uri>part</uri></include></world></sdf>', "utf-8")
    assert hx.load(tmp_path / "w.sdf", search_path=(tmp_path / "models",)).name == "p"
