"""The wheel: built, checked, and installed alone in an empty environment, where README's robot is converted."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MOST_PACKAGES = 8
MOST_BYTES = 30e6
PROCESSOR_SECONDS = 0.6
"""For a conversion with everything from the start of Python on: some 0.2 s on a quiet machine, and twice that on a crowded one."""


def run(*command: str | Path, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*map(str, command)], cwd=cwd, capture_output=True, text=True, check=False, timeout=600)


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    built = run(sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", folder, ROOT)
    if built.returncode and "hatchling" in built.stderr:
        pytest.skip("the build backend cannot be downloaded")
    assert built.returncode == 0, built.stderr
    (path,) = folder.glob("*.whl")
    return path


@pytest.fixture(scope="module")
def environment(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An environment in which nothing but the wheel and what it requires is installed; the folder of its programs."""
    folder = tmp_path_factory.mktemp("environment")
    venv.create(folder, with_pip=False)
    programs = folder / ("Scripts" if sys.platform == "win32" else "bin")
    installed = run(sys.executable, "-m", "pip", "--python", programs / "python", "install", "--quiet", wheel)
    if installed.returncode and "No matching distribution" in installed.stderr:
        pytest.skip("there is no package index")
    assert installed.returncode == 0, installed.stderr
    return programs


@pytest.mark.full
@pytest.mark.parametrize("check", [["twine", "check", "--strict"], ["check_wheel_contents"]], ids=lambda words: words[0])
def test_the_wheel_is_in_order(check: list[str], wheel: Path) -> None:
    pytest.importorskip(check[0])
    done = run(sys.executable, "-m", *check, wheel)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.full
def test_the_wheel_alone_is_small(environment: Path) -> None:
    packages = run(sys.executable, "-m", "pip", "--python", environment / "python", "list", "--format=freeze").stdout.split()
    assert len(packages) <= MOST_PACKAGES, packages
    size = sum(path.stat().st_size for path in environment.parent.rglob("site-packages/**/*") if path.is_file())
    assert size <= MOST_BYTES, f"{size / 1e6:.1f} MB"


@pytest.mark.full
def test_the_wheel_alone_converts_the_robot_of_the_readme(environment: Path, tmp_path: Path) -> None:
    block = re.search(r"```xml gripper.urdf\n(.*?)```", (ROOT / "README.md").read_text("utf-8"), re.DOTALL)
    assert block is not None
    (tmp_path / "gripper.urdf").write_text(block[1])
    took = []
    for _ in range(5):
        start = os.times()
        done = run(environment / "hymeko-x", "convert", "gripper.urdf", "gripper.xml", "--base", "fixed", cwd=tmp_path)
        end = os.times()
        took.append(end.children_user + end.children_system - start.children_user - start.children_system)
        assert done.returncode == 0, done.stderr
    assert done.stderr.startswith("wrote gripper.xml (3 bodies, ")
    assert '<mujoco model="gripper">' in (tmp_path / "gripper.xml").read_text()
    assert min(took) < PROCESSOR_SECONDS, took
