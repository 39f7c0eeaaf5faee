"""Every development URDF and MJCF as a stage: `verify` calls the two the same."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x.corpus.catalog import development_files

FEW = ("Pendulum.urdf", "cube_no_rotation.urdf", "racecar.urdf", "hopper.xml", "constraints.xml", "pendula.xml", "arm.xml")
"""Tensors that no body can have, worlds that are links, balanced torques, references, loops."""
FILES = [file for format in ("urdf", "mjcf") for file in development_files(format)]

pytestmark = pytest.mark.corpus


def assert_same_in_usd(robot: Path, folder: Path) -> None:
    stage = folder / "robot.usdc"
    hx.dump(hx.load(robot), stage)
    verdict = hx.verify(robot, stage, samples=20)
    assert verdict.checks, verdict.reason
    assert [f"{check.quantity} at {check.at}" for check in verdict.failed] == []


@pytest.mark.parametrize("robot", [file for file in FILES if Path(file.path).name in FEW], ids=lambda file: file.id, indirect=True)
@pytest.mark.unread("HX028")
def test_a_real_robot_is_the_same_in_usd(robot: Path, tmp_path: Path) -> None:
    assert_same_in_usd(robot, tmp_path)


@pytest.mark.full
@pytest.mark.parametrize("robot", [file for file in FILES if Path(file.path).name not in FEW], ids=lambda file: file.id, indirect=True)
def test_every_real_robot_is_the_same_in_usd(robot: Path, tmp_path: Path) -> None:
    assert_same_in_usd(robot, tmp_path)
