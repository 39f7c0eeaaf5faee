"""Every stage with joints of the package newton, also those that are no development files, into every format and back."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from pxr import Usd

import hymeko_x as hx
from hymeko_x.compare.diff import diff
from hymeko_x.corpus import catalog
from tests.conftest import RealRobots
from tests.usd.stages import again, opened, parsed, read_file, written
from tests.usd.test_real_stages import differing, lost_properties

FEW = ("boxes_fourbar.usda", "test_joint_revolute_actuated_unary.usda", "mjc_schema_import.usda")
"""One that closes a loop, one with a balanced torque, one with MuJoCo's schemas."""
JOINT = re.compile(r'def Physics\w*Joint "')
BY_REFERENCE = ("ant_multi.usda",)
"""Its joints stand in another file."""
LEAST = 62
"""How many of them there are: fewer would mean that they are not found."""

pytestmark = pytest.mark.corpus


def stages(real_robot: RealRobots) -> list[Path]:
    package = next(package for package in catalog.load() if package.name == "newton")
    found = sorted(
        path for path in real_robot.package(package).rglob("*.usda") if path.name in BY_REFERENCE or JOINT.search(path.read_text())
    )
    assert len(found) >= LEAST
    return found


def verdicts(paths: list[Path], suffix: str, folder: Path) -> dict[str, object]:
    """What `verify` has against the results of converting: nothing."""
    wrong: dict[str, object] = {}
    for path in paths:
        target = folder / f"out{suffix}"
        hx.dump(hx.load(path), target)
        verdict = hx.verify(path, target, samples=50)
        if not verdict.is_same:
            wrong[str(path)] = [f"{check.quantity}: {check.worst} at {check.at}" for check in verdict.failed] or verdict.reason
    return wrong


@pytest.mark.parametrize("suffix", [".usdc", ".xml", ".urdf"])
def test_a_stage_is_the_same_robot_in_every_format(suffix: str, real_robot: RealRobots, tmp_path: Path) -> None:
    few = [path for path in stages(real_robot) if path.name in FEW]
    assert verdicts(few, suffix, tmp_path) == {}


@pytest.mark.full
@pytest.mark.parametrize("suffix", [".usda", ".xml", ".urdf"])
def test_every_stage_is_the_same_robot_in_every_format(suffix: str, real_robot: RealRobots, tmp_path: Path) -> None:
    assert verdicts(stages(real_robot), suffix, tmp_path) == {}


@pytest.mark.full
def test_every_stage_comes_back_from_what_is_written_of_it(real_robot: RealRobots, tmp_path: Path) -> None:
    wrong = {}
    for path in stages(real_robot):
        mechanism = read_file(path)
        before, after = Usd.Stage.Open(str(path)), opened(written(mechanism), tmp_path, f"{path.stem}.usda")
        source, result = parsed(before), parsed(after)
        found = [str(item) for item in diff(mechanism, again(mechanism))] + lost_properties(before, after)
        masses = {body: mass for body, mass in source.masses.items() if mass}  # others are computed, and written
        found += [f"mass: {item}" for item in differing(masses, {body: result.masses.get(body, ()) for body in masses}).items()]
        for aspect in ("bodies", "joints", "shapes"):
            found += [f"{aspect}: {item}" for item in differing(getattr(source, aspect), getattr(result, aspect)).items()]
        if found:
            wrong[str(path)] = found
    assert wrong == {}
