"""Robots in memory are what their files are: with the masses that the engine of their format computes, and what actuators exert."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

import hymeko_x as hx
from tests.robot.robots import ARM

if TYPE_CHECKING:
    from pathlib import Path

LIMITED = ARM.replace('kp="50"', 'kp="50" forcerange="-30 30"').replace('gear="20"', 'gear="20" ctrllimited="true" ctrlrange="-1 1"')


@pytest.mark.parametrize("suffix", ["xml", "urdf", "hymeko"])
def test_a_robot_is_the_same_as_its_file(tmp_path: Path, suffix: str) -> None:
    robot = hx.loads(LIMITED, "mjcf")
    hx.dump(robot, tmp_path / f"arm.{suffix}")
    verdict = hx.verify(tmp_path / f"arm.{suffix}", robot, samples=5)
    assert [check for check in verdict.checks if not check.passed] == []
    assert verdict.verdict == ("same as far as urdf can say" if suffix == "urdf" else "same")


def test_another_force_range_is_a_difference(tmp_path: Path) -> None:
    hx.dump(hx.loads(LIMITED, "mjcf"), tmp_path / "arm.urdf")
    other = hx.loads(LIMITED.replace("-30 30", "-31 31"), "mjcf")
    (found,) = [check for check in hx.verify(tmp_path / "arm.urdf", other, samples=5).checks if not check.passed]
    assert (found.quantity, found.worst, found.at) == ("effort limits", 1.0, "joint 'shoulder'")
