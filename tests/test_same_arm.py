"""The arm of docs/same-arm.md: the page shows what is written, and that is the robot of the files by hand."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import hymeko_x as hx

ROOT = Path(__file__).parents[1]
BY_HAND = [ROOT / "examples/same_arm" / name for name in ("arm.urdf", "arm.xacro", "arm.xml", "arm.sdf", "arm.usda")]


def test_the_page_is_what_the_example_prints() -> None:
    command = [sys.executable, "examples/same_arm.py"]
    run = subprocess.run(command, cwd=ROOT, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=True)
    assert run.stdout == (ROOT / "docs/same-arm.md").read_text("utf-8")


@pytest.mark.full
@pytest.mark.parametrize("by_hand", BY_HAND, ids=lambda path: path.name)
def test_the_file_by_hand_is_the_same_robot(by_hand: Path, tmp_path: Path) -> None:
    written = tmp_path / by_hand.name
    hx.convert(by_hand.parent / "arm.hymeko", written)
    assert hx.verify(by_hand, written).verdict == "same"
