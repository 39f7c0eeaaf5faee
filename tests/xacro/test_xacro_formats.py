"""Real xacro robots in every format and back: the engines see the same robot in all of them."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x import disk
from hymeko_x.compare.diff import diff
from hymeko_x.corpus.catalog import DevelopmentFile, development_files, select
from hymeko_x.diagnostics import Report
from hymeko_x.frontends.xacro import read
from hymeko_x.source import Source
from tests.xacro.test_xacro_writing import check

(RTB_DATA,) = select(("rtb_data",))
OTHERS = tuple(DevelopmentFile("xacro", RTB_DATA, path) for path in RTB_DATA.robots["xacro"])
"""Every robot of the package with the most of them that is no development file."""
ROBOTS = (*development_files("xacro"), *OTHERS)

TARGETS = (".hymeko", ".urdf", ".xml", ".usda")
FEW = [file for file in ROBOTS if file.path.endswith("/vxxmd.urdf.xacro")]

pytestmark = pytest.mark.corpus


def assert_same(robot: Path, other: Path) -> None:
    verdict = hx.verify(robot, other, samples=10, meshes=False)
    assert [f"{check.quantity} at {check.at}" for check in verdict.failed] == []
    assert verdict.is_same


def assert_same_there_and_back(robot: Path, suffix: str, folder: Path) -> None:
    there, back = folder / f"there{suffix}", folder / "back" / "back.xacro"
    back.parent.mkdir()
    hx.convert(robot, there, keep="inside")
    assert_same(robot, there)
    hx.convert(there, back, keep="inside")
    assert_same(robot, back)


@pytest.mark.parametrize("robot", OTHERS, ids=lambda file: file.id, indirect=True)
@pytest.mark.unread("HX052")
def test_xacro_that_is_written_again_expands_to_what_the_source_expands_to(robot: Path) -> None:
    mechanism = read(disk.open_source(str(robot)), Report()).mechanism
    assert diff(mechanism, read(Source("again.xacro", check(mechanism).encode()), Report()).mechanism) == ()


@pytest.mark.parametrize("suffix", TARGETS)
@pytest.mark.parametrize("robot", FEW, ids=lambda file: file.id, indirect=True)
@pytest.mark.unread("HX103")
def test_a_real_robot_is_the_same_in_every_format_and_back(robot: Path, suffix: str, tmp_path: Path) -> None:
    assert_same_there_and_back(robot, suffix, tmp_path)


@pytest.mark.full
@pytest.mark.parametrize("suffix", TARGETS)
@pytest.mark.parametrize("robot", [file for file in ROBOTS if file not in FEW], ids=lambda file: file.id, indirect=True)
def test_every_real_robot_is_the_same_in_every_format_and_back(robot: Path, suffix: str, tmp_path: Path) -> None:
    assert_same_there_and_back(robot, suffix, tmp_path)
