"""Many robots in one go: one line each, whatever becomes of the others."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from hymeko_x import formats
from hymeko_x.cli import exits, main
from hymeko_x.cli.batch import Job, jobs_into
from hymeko_x.cli.exits import UsageError

ROOT = Path(__file__).parents[2]
ARM = """<robot name="{name}"><link name="base"/><link name="tip"><inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="j" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/>
  <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""

ABORTING = """
import os, sys
from argparse import Namespace
from hymeko_x import formats
from hymeko_x.cli.batch import Job, run_batch

def convert(chosen, source, target):
    print(f"wrote {target}", file=sys.stderr)
    if source == "b":
        os.abort()
    if source == "c":
        raise ValueError("an accident")
    return 0

if __name__ == "__main__":
    jobs = [Job(name, f"out/{name}") for name in "abcd"]
    sys.exit(run_batch(convert, jobs, Namespace(jobs=2, quiet=False, verbose=False), formats.OWN))
"""


def run(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "error"}
    command = [sys.executable, *words]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=120, check=False)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in ("one", "two"):
        (tmp_path / f"{name}.urdf").write_text(ARM.format(name=name))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_broken_robot_costs_one_line_and_not_the_others(folder: Path) -> None:
    (folder / "broken.urdf").write_text("<robot name='x'><link name='a'/><joint")
    done = run(folder, "-m", "hymeko_x", "convert", "broken.urdf", "one.urdf", "two.urdf", "--to", "hymeko", "-o", "out", "--jobs", "2")
    assert done.returncode == exits.FAILED
    first, *others = done.stderr.splitlines()
    assert first.startswith("failed broken.urdf:1:33: error[HX010]: not well-formed")
    assert others == [
        f"wrote {Path('out/one.hymeko')} (2 bodies, 1 joint)",
        f"wrote {Path('out/two.hymeko')} (2 bodies, 1 joint)",
        "2 robots converted, 1 failed",
    ]
    assert sorted(path.name for path in (folder / "out").iterdir()) == ["one.hymeko", "two.hymeko"]


def test_what_could_not_be_represented_is_counted_and_listed_on_request(folder: Path) -> None:
    done = run(folder, "-m", "hymeko_x", "convert", "one.urdf", "two.urdf", "--to", "mjcf", "-o", "out", "--base", "fixed")
    assert done.returncode == exits.DONE
    assert done.stderr.splitlines()[0] == f"wrote {Path('out/one.xml')} (2 bodies, 2 joints); 1 loss"
    verbose = run(folder, "-m", "hymeko_x", "convert", "one.urdf", "two.urdf", "--to", "mjcf", "-o", "out", "--base", "fixed", "-v")
    assert "joint 'j' dofs[0].limits.velocity" in verbose.stderr
    quiet = run(folder, "-m", "hymeko_x", "convert", "one.urdf", "two.urdf", "--to", "mjcf", "-o", "out", "-q")
    assert (quiet.stdout, quiet.stderr) == ("", "")


def test_a_process_that_is_killed_and_one_with_a_bug_are_one_line_each(folder: Path) -> None:
    (folder / "aborting.py").write_text(ABORTING)
    done = run(folder, "aborting.py")
    assert done.returncode == exits.FAILED
    a, b, c, d, total = done.stderr.splitlines()
    assert (a, d) == ("wrote out/a", "wrote out/d")
    assert b == "failed b: its process was ended by SIGABRT"
    assert c.startswith("failed c: error[HX901]: ValueError at ")
    assert total == "2 robots converted, 2 failed"


def test_outputs_are_named_like_their_robots_or_by_their_folders_where_names_are_equal() -> None:
    row = formats.by_name("mjcf")
    assert jobs_into("out", ["a/arm.urdf", "b/hand.urdf"], row) == [
        Job("a/arm.urdf", str(Path("out/arm.xml"))),
        Job("b/hand.urdf", str(Path("out/hand.xml"))),
    ]
    assert [job.target for job in jobs_into("out", ["a/robot.urdf", "b/robot.urdf"], row)] == [
        str(Path("out/a/robot.xml")),
        str(Path("out/b/robot.xml")),
    ]
    with pytest.raises(UsageError, match="would both be written"):
        jobs_into("out", ["arm.urdf", "arm.sdf"], row)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["one.urdf", "two.urdf", "--to", "mjcf"], "two.urdf is there, and urdf: several robots are written into a folder (-o DIR)"),
        (["one.urdf", "two.urdf", "three.urdf", "--to", "mjcf"], "several robots are written into a folder: -o DIR"),
        (["one.urdf", "two.urdf", "-o", "out"], "say which format to write into the folder: --to FORMAT"),
        (["one.urdf", "two.urdf", "--to", "mjcf", "-o", "out", "--json"], "--json and --report are for one robot at a time"),
        (
            ["one.urdf", "two.urdf", "--to", "mjcf", "-o", "out", "--jobs", "0"],
            "argument --jobs: expected a number of at least 1, found '0'",
        ),
    ],
)
def test_what_could_overwrite_a_robot_or_leads_nowhere_is_refused(
    words: list[str], message: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = (folder / "two.urdf").read_bytes()
    assert main(["convert", *words]) == exits.USAGE
    assert capsys.readouterr().err.startswith(f"hymeko-x convert: {message}")
    assert (folder / "two.urdf").read_bytes() == before
