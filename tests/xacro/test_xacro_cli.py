"""xacro files on the command line and through the API."""

from __future__ import annotations

import pytest

import hymeko_x as hx
from hymeko_x import formats
from hymeko_x.cli import exits, main
from tests.xacro.samples import Folder, robot

ARGUMENTS = robot('<xacro:arg name="side" default="left"/>\n<link name="$(arg side)_$(optenv HYMEKO_X_TEST none)"/>')


@pytest.fixture
def here(folder: Folder, monkeypatch: pytest.MonkeyPatch) -> Folder:
    """The folder as working folder, with one file that has an argument and asks for a variable."""
    folder.put("r.urdf.xacro", ARGUMENTS)
    monkeypatch.chdir(folder.path)
    return folder


def links(folder: Folder) -> list[str]:
    return [key.name for key in hx.load(folder.path / "out.urdf").mechanism.graph.vertices if key.kind == "body"]


def test_arguments_and_variables_are_passed_on(here: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HYMEKO_X_TEST", "seen")
    assert main(["convert", "r.urdf.xacro", "out.urdf"]) == exits.DONE
    assert links(here) == ["left_none"]
    assert main(["convert", "r.urdf.xacro", "out.urdf", "--arg", "side:=right", "--env", "HYMEKO_X_TEST"]) == exits.DONE
    assert links(here) == ["right_seen"]
    assert main(["convert", "r.urdf.xacro", "out.urdf", "--env", "HYMEKO_X_TEST=told"]) == exits.DONE
    assert links(here) == ["left_told"]


def test_a_variable_that_is_not_there_cannot_be_passed_on(here: Folder, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["info", "r.urdf.xacro", "--env", "HYMEKO_X_NOT_THERE"]) == exits.USAGE
    assert "the environment has no variable 'HYMEKO_X_NOT_THERE'" in capsys.readouterr().err


@pytest.mark.parametrize("option", [["--arg", "a:=b"], ["--env", "A=b"]])
def test_a_format_without_arguments_takes_none(here: Folder, option: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    here.put("plain.urdf", '<robot name="r"><link name="a"/></robot>')
    assert main(["info", "plain.urdf", *option]) == exits.USAGE
    assert f"{option[0]} is for formats that take arguments, and plain.urdf is urdf" in capsys.readouterr().err


def test_a_failed_expansion_is_one_message_and_exit_1(here: Folder, capsys: pytest.CaptureFixture[str]) -> None:
    here.put("bad.xacro", robot('<xacro:include filename="$(find arm_description)/arm.xacro"/>'))
    assert main(["convert", "bad.xacro", "out.urdf"]) == exits.FAILED
    error = capsys.readouterr().err
    assert error.startswith("bad.xacro:2: error[HX052]: the package 'arm_description' was not found\n")
    assert "--package arm_description=DIR" in error
    assert not (here.path / "out.urdf").exists()


def test_the_api_takes_arguments_and_variables(here: Folder) -> None:
    words = {"arguments": {"side": "right"}, "environment": {"HYMEKO_X_TEST": "told"}}
    assert [key.name for key in hx.load("r.urdf.xacro", **words).mechanism.graph.vertices if key.kind == "body"] == ["right_told"]
    hx.convert("r.urdf.xacro", "out.urdf", **words)
    assert links(here) == ["right_told"]


def test_meshes_beside_an_included_file_are_found_from_the_main_file(here: Folder) -> None:
    """As in xacro: paths in an expansion have forgotten which file they came from."""
    here.put("mesh.stl", "solid\nendsolid\n")
    mesh = '<link name="a"><visual><geometry><mesh filename="mesh.stl"/></geometry></visual></link>'
    here.put("parts/p.xacro", f'<robot xmlns:xacro="http://www.ros.org/wiki/xacro">{mesh}</robot>')
    here.put("main.xacro", robot('<xacro:include filename="parts/p.xacro"/>'))
    loaded = hx.load("main.xacro").mechanism
    (here.path / "out").mkdir()
    hx.dump(loaded, "out/r.urdf", assets="copy")
    assert [path.name for path in (here.path / "out").rglob("*.stl")] == ["mesh.stl"]


@pytest.mark.parametrize(
    ("name", "data", "format"),
    [
        ("r.urdf.xacro", b"<robot/>", "xacro"),
        ("r.XACRO", b"<sdf/>", "xacro"),
        ("r.urdf", b'<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r"/>', "urdf"),
    ],
)
def test_the_suffix_tells_xacro(name: str, data: bytes, format: str) -> None:
    assert formats.of_input(name, data).name == format
