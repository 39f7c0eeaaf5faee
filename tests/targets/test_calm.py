"""Real robots with effort limits, for MuJoCo with position servos at home: nothing moves after a second, or the report says why."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

import hymeko_x as hx
from hymeko_x.corpus.catalog import DevelopmentFile, development_files
from hymeko_x.ir.mechanism import Mechanism
from tests.conftest import RealRobots

pytestmark = pytest.mark.corpus

CALM = 0.05
"""In rad/s or m/s."""
FILES = development_files("urdf")
NAMES = ("xarm7.urdf", "puma560_robot.urdf", "vision60.urdf", "hand.urdf")
FEW = [file for file in FILES if Path(file.path).name in NAMES]
FAKE = frozenset({"r8_6.urdf"})
"""Most links have no mass, so that soft couplings between them give in."""


def fastest(path: Path) -> float:
    """The greatest speed between the first and the second second, in rad/s or m/s; infinite where the simulation diverges."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    worst = 0.0
    for step in range(round(2.0 / model.opt.timestep)):
        mujoco.mj_step(model, data)
        if any(warning.number for warning in data.warning[4:7]):
            return float("inf")
        if step * model.opt.timestep >= 1.0:
            worst = max(worst, float(np.abs(data.qvel).max(initial=0.0)))
    return worst


def has_effort_limits(robot: Mechanism) -> bool:
    return any(dof.limits.effort for view in robot.joints.values() for dof in view.joint.dofs)


def speed_of(robot: Path, root: Path, folder: Path) -> tuple[float, bool]:
    """The greatest speed, and whether the report says that a joint cannot hold the robot."""
    target = folder / "robot.xml"
    done = hx.convert(robot, target, base="fixed", actuators="position", target="mujoco", search_path=[root], lenient=True)
    return fastest(target), any("cannot hold" in diagnostic.message for diagnostic in done.report)


@pytest.mark.parametrize("file", FEW, ids=lambda file: file.id)
@pytest.mark.unread("HX103")
def test_a_real_robot_is_calm(file: DevelopmentFile, real_robot: RealRobots, tmp_path: Path) -> None:
    root = real_robot.package(file.package)
    assert speed_of(root / file.path, root, tmp_path)[0] < CALM


@pytest.mark.full
def test_every_real_robot_is_calm_or_cannot_hold_itself(real_robot: RealRobots, tmp_path: Path) -> None:
    restless, count = {}, 0
    for number, file in enumerate(FILES):
        root = real_robot.package(file.package)
        if not has_effort_limits(hx.load(root / file.path, search_path=[root], lenient=True).mechanism):
            continue
        count += 1
        folder = tmp_path / str(number)
        folder.mkdir()
        speed, is_weak = speed_of(root / file.path, root, folder)
        if not speed < CALM:
            restless[Path(file.path).name] = is_weak
    assert count > 40
    assert {name for name, is_weak in restless.items() if not is_weak} <= FAKE
    assert len(restless) <= 0.07 * count
