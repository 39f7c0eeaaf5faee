"""Every development MJCF as URDF: Pinocchio moves it as MuJoCo moves the source, weighs it alike, and `verify` calls them the same."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x.corpus.catalog import development_files
from tests.mjcf.as_urdf import twins

FILES = development_files("mjcf")
NAMES = ("half_cheetah.xml", "quadruped.xml", "three_joint_link.xml", "pendula.xml", "constraints.xml")
FEW = [file for file in FILES if Path(file.path).name in NAMES]
POSES, INERTIAS = 1e-9, 1e-8

pytestmark = pytest.mark.corpus


def assert_same_in_urdf(robot: Path, folder: Path, *, meshes: bool) -> None:
    target = folder / "robot.urdf"
    result = hx.convert(robot, target)
    both = twins(robot, target, result.mechanism)
    assert both.worst_pose_error() < POSES
    assert both.worst_inertia_error() < INERTIAS
    verdict = hx.verify(robot, target, samples=20, meshes=meshes)
    assert [f"{check.quantity} at {check.at}" for check in verdict.failed] == []
    assert verdict.is_same


@pytest.mark.parametrize("robot", FEW, ids=lambda file: file.id, indirect=True)
@pytest.mark.unread("HX040", "HX104")
def test_a_real_robot_is_the_same_in_urdf(robot: Path, tmp_path: Path) -> None:
    assert_same_in_urdf(robot, tmp_path, meshes=True)


@pytest.mark.full
@pytest.mark.parametrize("robot", [file for file in FILES if file not in FEW], ids=lambda file: file.id, indirect=True)
def test_every_real_robot_is_the_same_in_urdf(robot: Path, tmp_path: Path) -> None:
    assert_same_in_urdf(robot, tmp_path, meshes=False)
