"""Models that are made of several files: where these, and the meshes that they name, are found, and how messages call them."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x.diagnostics import Refusal

CUBE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
BODY = '<worldbody><body name="b"><geom type="mesh" mesh="cube"/></body></worldbody>'


def write(folder: Path, **texts: str) -> None:
    """XML files by their paths, in which two underscores are a slash."""
    for name, text in texts.items():
        path = folder / f"{name.replace('__', '/')}.xml"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"<mujoco>{text}</mujoco>")


def test_meshes_of_an_included_file_are_found_when_a_robot_is_written(tmp_path: Path) -> None:
    write(tmp_path, robot=f'<include file="parts/assets.xml"/>{BODY}', parts__assets='<asset><mesh name="cube" file="cube.obj"/></asset>')
    (tmp_path / "cube.obj").write_text(CUBE)
    robot = hx.load(tmp_path / "robot.xml").mechanism
    assert [str(item) for item in hx.dump(robot, tmp_path / "robot.usdc")] == []


def test_files_and_meshes_beside_an_included_file_are_found_from_everywhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(
        tmp_path,
        robots__main=f'<include file="parts/first.xml"/>{BODY}',
        robots__parts__first='<include file="inner/second.xml"/>',
        robots__parts__inner__second='<asset><mesh name="cube" file="cube.obj"/></asset>',
    )
    (tmp_path / "robots" / "parts" / "inner" / "cube.obj").write_text(CUBE)
    for here, main in (("", "robots/main.xml"), ("robots", "main.xml"), ("robots/parts", "../main.xml")):
        monkeypatch.chdir(tmp_path / here)
        robot = hx.load(main)
        assert [part.uri for _, part in robot.mechanism.assets()] == ["parts/inner/cube.obj"]
        assert [str(item) for item in hx.dump(robot, tmp_path / "robot.usdc")] == []


def test_a_message_names_an_included_file_from_the_working_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path, robots__main='<include file="parts/first.xml"/><worldbody/>', robots__parts__first='<option apirate="100"/>')
    monkeypatch.chdir(tmp_path)
    with pytest.raises(Refusal, match=r"^robots/parts/first\.xml:1: error\[HX027\]"):
        hx.load("robots/main.xml")
    monkeypatch.chdir(tmp_path / "robots" / "parts")
    with pytest.raises(Refusal, match=r"^\.\./parts/first\.xml:1: error\[HX027\]"):
        hx.load("../main.xml")
