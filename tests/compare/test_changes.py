"""`diff --markdown`: what changed between two revisions of a robot, for its reviewers and for git."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from hymeko_x.cli import exits, main

ROOT = Path(__file__).parents[2]
BEFORE = """<robot name="a">
  <link name="base"/>
  <link name="hip_left"><inertial><mass value="1.2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="gone"/>
  <joint name="j" type="revolute"><parent link="base"/><child link="hip_left"/><axis xyz="0 0 1"/><origin xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="k" type="fixed"><parent link="base"/><child link="gone"/></joint>
</robot>
"""
AFTER = (
    BEFORE.replace("1.2", "1.4").replace('<origin xyz="0 0 1"/>', '<origin xyz="0 0.5 1" rpy="0 0 1"/>').replace('upper="1"', 'upper="1.5"')
).replace("gone", "new")
CHANGES = """- mass of body `hip_left` 1.2 -> 1.4 kg
- body `gone` removed
- body `new` added
- upper position limit of joint `j` 1 -> 1.5 rad
- position of joint `j` [0 0 1] -> [0 0.5 1] m
- orientation of joint `j` turned by 1 rad (57.2958 deg)
- connection of joint `k` body 'gone' -> body 'new'
"""


def test_changes_are_told_in_words_and_units(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.urdf").write_text(BEFORE)
    Path("b.urdf").write_text(AFTER)
    assert main(["diff", "a.urdf", "b.urdf", "--markdown"]) == exits.DONE
    assert capsys.readouterr().out == f"**a.urdf -> b.urdf**: 7 changes\n\n{CHANGES}"
    assert main(["diff", "a.urdf", "a.urdf", "--markdown"]) == exits.DONE
    assert capsys.readouterr().out == "**a.urdf**: no change\n"


def test_git_shows_a_robot_as_text_and_its_changes_in_words(tmp_path: Path) -> None:
    command = tmp_path / "bin/hymeko-x"
    command.parent.mkdir()
    command.write_text(f'#!/bin/sh\nPYTHONPATH={ROOT} exec {sys.executable} -m hymeko_x "$@"\n')
    command.chmod(0o755)
    path = {"PATH": f"{command.parent}{os.pathsep}{os.environ['PATH']}"}
    names = {"GIT_AUTHOR_NAME": "a", "GIT_AUTHOR_EMAIL": "a@b", "GIT_COMMITTER_NAME": "a", "GIT_COMMITTER_EMAIL": "a@b"}

    def git(*words: str) -> str:
        environment = {**os.environ, **path, **names}
        done = subprocess.run(["git", *words], cwd=tmp_path, env=environment, capture_output=True, text=True, check=True)
        return done.stdout

    git("init", "-q")
    git("config", "diff.robot.textconv", "hymeko-x import -q --lenient")
    (tmp_path / ".gitattributes").write_text("*.urdf diff=robot\n")
    (tmp_path / "a.urdf").write_text(BEFORE)
    git("add", "a.urdf", ".gitattributes")
    git("commit", "-qm", "first")
    (tmp_path / "a.urdf").write_text(AFTER)
    lines = git("diff").splitlines()
    assert "-  hip_left { mass 1.2 inertia [1 1 1] }" in lines
    assert "+  hip_left { mass 1.4 inertia [1 1 1] }" in lines
    assert git("difftool", "--no-prompt", "--extcmd", "hymeko-x diff --markdown").endswith(CHANGES)
