"""Options of reading are obeyed or refused, never passed over."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hymeko_x.cli import exits, main

URDF = '<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint></robot>'
XACRO = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="mass" default="1"/>
<link name="a"><inertial><mass value="$(arg mass)"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "r.urdf").write_text(URDF)
    (tmp_path / "r.urdf.xacro").write_text(XACRO)
    return tmp_path


@pytest.mark.parametrize("verb", [["verify", "r.urdf", "r.urdf"], ["dh", "r.urdf"]])
@pytest.mark.parametrize("option", [["--from", "urdf"], ["--env", "A=b"], ["--ignore-kept"]])
def test_what_an_engine_cannot_be_told_is_refused(
    verb: list[str], option: list[str], folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*verb, *option]) == exits.USAGE
    assert f"{option[0]} changes nothing here: the files are read by the formats' own engines" in capsys.readouterr().err


@pytest.mark.unread("HX059")
def test_a_round_trip_reads_the_file_with_its_arguments(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["roundtrip", "r.urdf.xacro", "--through", "mjcf", "--arg", "mass=7", "--json"]) == exits.DONE
    assert [leg["differences"] for leg in json.loads(capsys.readouterr().out)["legs"]] == [0, 0]
    assert main(["roundtrip", "r.urdf.xacro", "--through", "mjcf", "--arg", "mass=7", "-o", "legs"]) == exits.DONE
    assert 'mass="7"' in (folder / "legs" / "leg1" / "robot.xml").read_text()


def test_keyframes_that_do_not_fit_are_one_warning_with_their_names(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    keys = "".join(f'<key name="k{number}" qpos="1 2 3"/>' for number in range(13))
    (folder / "r.xml").write_text(
        f'<mujoco><worldbody><body><joint/><geom size="1"/></body></worldbody><keyframe>{keys}</keyframe></mujoco>'
    )
    assert main(["convert", "r.xml", "r.hymeko"]) == exits.DONE
    capsys.readouterr()
    assert main(["convert", "r.hymeko", "back.xml"]) == exits.DONE
    lines = [line for line in capsys.readouterr().err.splitlines() if "keyframe" in line and "warning" in line]
    assert [line.partition("warning")[2] for line in lines] == [
        "[HX104]: 13 keyframes ('k0', 'k1', ...) have 3 numbers in qpos, and the robot has 1; they are left out"
    ]
    assert lines[0].startswith("r.hymeko:")
