"""No change of a mesh or an image is handed on, or left out, without a word."""

from __future__ import annotations

import pytest

from tests.residue.asset_changes import Robot, changed, lost_whole, may_be_silent, robots, shown

TARGETS = ("urdf", pytest.param("xacro", marks=pytest.mark.full), "mjcf", "usd", "sdf", "hymeko")


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("robot", list(robots()), ids=lambda robot: robot.name)
def test_every_change_of_a_file_is_seen(robot: Robot, target: str) -> None:
    before = shown(robot, target)
    silent = {name for name, other in changed(robot) if shown(other, target) == before}
    assert silent <= may_be_silent(robot, target)
    assert silent == set() or all(f"loss: {lost}" in str(before) for lost in lost_whole(robot, target))
