"""GetPut on real robots: through another format and back they are the same to the last bit, and what they weigh besides is little."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x.corpus.catalog import development_files
from hymeko_x.diagnostics import Report
from tests.residue.exactness import unequal

SUFFIXES = {"urdf": ".urdf", "mjcf": ".xml", "xacro": ".xacro", "usd": ".usda"}
EVERY = {"urdf": 30, "mjcf": 32, "usd": 20, "xacro": 30}
"""One of so many development files is looked at in every run, the others with `make test-full`."""

LEGS = [
    (file, target, number % EVERY[file.format])
    for format in EVERY
    for number, file in enumerate(development_files(format))
    for target in SUFFIXES
    if target != format
]
FEW = [(file, target) for file, target, place in LEGS if place == 3]
REST = [(file, target) for file, target, place in LEGS if place != 3]

pytestmark = pytest.mark.corpus


def assert_comes_back(robot: Path, target: str, folder: Path) -> None:
    report = Report()
    source = hx.load(robot).mechanism
    there = folder / f"there{SUFFIXES[target]}"
    hx.convert(robot, there, to_format=target, keep="beside")
    assert unequal(source, hx.load(there, target, report=report).mechanism) == []
    assert [str(diagnostic) for diagnostic in report if diagnostic.code.id in ("HX105", "HX106", "HX107")] == []


def _id(value: object) -> str:
    return str(getattr(value, "id", value))


@pytest.mark.parametrize(("robot", "target"), FEW, ids=_id, indirect=["robot"])
@pytest.mark.unread  # generated or damaged input: any
def test_a_real_robot_comes_back_to_the_last_bit(robot: Path, target: str, tmp_path: Path) -> None:
    assert_comes_back(robot, target, tmp_path)


@pytest.mark.full
@pytest.mark.parametrize(("robot", "target"), REST, ids=_id, indirect=["robot"])
def test_every_real_robot_comes_back_to_the_last_bit(robot: Path, target: str, tmp_path: Path) -> None:
    assert_comes_back(robot, target, tmp_path)
