"""Denavit-Hartenberg tables as the makers publish them, in every style."""

from __future__ import annotations

import csv
import io
import json
import math
import re
from pathlib import Path

import pytest

from hymeko_x.cli import exits, main
from hymeko_x.corpus import catalog
from tests.conftest import RealRobots

RIGHT = math.pi / 2
UR5E = {  # d, a, alpha; Universal Robots, "DH parameters for calculations of kinematics and dynamics"
    "shoulder_pan": (0.1625, 0, RIGHT),
    "shoulder_lift": (0, -0.425, 0),
    "elbow": (0, -0.3922, 0),
    "wrist_1": (0.1333, 0, RIGHT),
    "wrist_2": (0.0997, 0, -RIGHT),
    "wrist_3": (0.0996, 0, 0),
}
PANDA = {  # d, a, alpha in Craig's convention; Franka Control Interface, "Denavit-Hartenberg parameters"
    "panda_joint1": (0.333, 0, 0),
    "panda_joint2": (0, 0, -RIGHT),
    "panda_joint3": (0.316, 0, RIGHT),
    "panda_joint4": (0, 0.0825, RIGHT),
    "panda_joint5": (0.384, -0.0825, -RIGHT),
    "panda_joint6": (0, 0, RIGHT),
    "panda_joint7": (0, 0.088, RIGHT),
}


@pytest.fixture
def ur5e(tmp_path: Path) -> Path:
    """The UR5e of docs/dh.md."""
    page = (Path(__file__).parents[2] / "docs/dh.md").read_text("utf-8")
    block = re.search(r"```xml ur5e.urdf\n(.*?)```", page, re.DOTALL)
    assert block is not None
    path = tmp_path / "ur5e.urdf"
    path.write_text(block[1])
    return path


def table(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, object]:
    assert main(["dh", *words, "--check", "--format", "json"]) == exits.DONE
    (found,) = json.loads(capsys.readouterr().out)
    assert isinstance(found, dict)
    return found


def numbers(found: dict[str, object]) -> dict[str, tuple[float, float, float]]:
    rows = found["rows"]
    assert isinstance(rows, list)
    assert all(abs(row["theta"]) < 1e-9 and row["beta"] == 0 for row in rows), "theta has an offset"
    return {row["joint"]: (row["d"], row["a"], row["alpha"]) for row in rows}


def test_a_ur5e_has_the_table_that_its_maker_publishes(ur5e: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = table(capsys, str(ur5e), "--tip", "tool0")
    assert numbers(found) == {joint: pytest.approx(row, abs=1e-9) for joint, row in UR5E.items()}
    assert found["base_rows"] == [{"theta": pytest.approx(math.pi), "d": 0, "a": 0, "alpha": 0, "beta": 0}]


@pytest.mark.corpus
def test_a_panda_has_the_table_that_its_maker_publishes(real_robot: RealRobots, capsys: pytest.CaptureFixture[str]) -> None:
    (wheel,) = catalog.select(("example_robot_data",))
    (path,) = real_robot.package(wheel).rglob("panda.urdf")
    found = table(capsys, str(path), "--tip", "panda_hand", "--convention", "modified")
    assert numbers(found) == {joint: pytest.approx(row, abs=1e-9) for joint, row in PANDA.items()}
    assert found["base_rows"] == []
    assert found["tool_rows"] == [pytest.approx({"theta": -math.pi / 4, "d": 0.107, "a": 0, "alpha": 0, "beta": 0}, abs=1e-9)]


def test_every_style_prints_the_same_rows(ur5e: Path, capsys: pytest.CaptureFixture[str]) -> None:
    printed = {}
    for style in ("text", "md", "latex", "csv"):
        assert main(["dh", str(ur5e), "--tip", "tool0", "--format", style]) == exits.DONE
        printed[style] = capsys.readouterr().out
    assert [line.split() for line in printed["text"].splitlines()[1:4]] == [
        ["joint", "theta", "d", "a_i", "alpha_i"],
        ["base", "pi", "0", "0", "0"],
        ["shoulder_pan", "q", "0.1625", "0", "pi/2"],
    ]
    assert "| wrist_2 | q | 0.0997 | 0 | -pi/2 |\n" in printed["md"]
    assert "  wrist\\_2 & $q$ & $0.0997$ & $0$ & $-\\frac{\\pi}{2}$ \\\\\n" in printed["latex"]
    rows = list(csv.DictReader(io.StringIO(printed["csv"])))
    assert [(row["joint"], row["kind"]) for row in rows] == [("base", "fixed"), *((joint, "hinge") for joint in UR5E)]
    assert float(rows[1]["alpha"]) == pytest.approx(RIGHT)
    assert "-0.0," not in printed["csv"]
