"""Robots by name: those of robot_descriptions where it is installed, and those of the catalogue that have been fetched."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x.cli import exits, main
from hymeko_x.corpus import cache, catalog, names
from hymeko_x.diagnostics import Refusal

ARM = '<robot name="arm"><link name="base"/></robot>'
LIMB = (
    '<robot xmlns:xacro="http://ros.org/wiki/xacro" name="limb"><xacro:arg name="side" default="none"/><link name="$(arg side)"/></robot>'
)


@pytest.fixture
def library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package robot_descriptions with three robots, one of which cannot be cloned."""
    folder = tmp_path / "library/robot_descriptions"
    folder.mkdir(parents=True)
    (folder / "__init__.py").write_text("")
    (tmp_path / "arm.urdf").write_text(ARM)
    (tmp_path / "limb.xacro").write_text(LIMB)
    (folder / "arm_description.py").write_text(f"URDF_PATH = {str(tmp_path / 'arm.urdf')!r}")
    (folder / "limb_description.py").write_text(f"XACRO_PATH = {str(tmp_path / 'limb.xacro')!r}\nXACRO_ARGS = {{'side': 'left'}}")
    (folder / "gone_description.py").write_text("raise OSError('no route to host')")
    monkeypatch.syspath_prepend(str(folder.parent))
    for name in [name for name in sys.modules if name.partition(".")[0] == "robot_descriptions"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.chdir(tmp_path)
    return folder


def test_a_name_of_robot_descriptions_is_converted(library: Path) -> None:
    assert main(["convert", "arm_description", "out.xml", "--lenient", "-q"]) == exits.DONE
    assert hx.load("out.xml", lenient=True).mechanism.name == "arm"


def test_a_xacro_of_robot_descriptions_has_its_arguments_and_those_of_the_user(library: Path) -> None:
    for words, name in (([], "left"), (["--arg", "side=right"], "right")):
        assert main(["convert", "limb_description", "out.urdf", "-q", *words]) == exits.DONE
        assert [root.name for root in hx.load("out.urdf").mechanism.roots] == [name]


def test_a_file_of_the_same_name_wins(library: Path) -> None:
    Path("arm_description").write_text(ARM.replace("arm", "own"))
    assert names.located("arm_description").path == "arm_description"


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("amr_description", "has the name 'amr_description'\n  hint: did you mean arm_description"),
        ("gone_description", "robot_descriptions cannot provide 'gone_description': no route to host"),
    ],
)
def test_a_name_that_is_not_there_is_one_diagnostic(name: str, message: str, library: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["info", name]) == exits.FAILED
    assert message in capsys.readouterr().err


def test_without_the_library_its_name_is_advised(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(names, "find_spec", lambda name: None)
    with pytest.raises(Refusal, match="pip install robot_descriptions"):
        names.located("arm_description")


def test_every_robot_of_the_catalogue_has_a_name_of_its_own() -> None:
    for package in catalog.load():
        robots = names.catalogued(package)
        assert sorted(robots.values()) == sorted(path for _, path in package.listed())


def test_a_robot_of_the_catalogue_is_found_where_its_package_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(cache.CACHE_VARIABLE, str(tmp_path))
    (package,) = catalog.select(("upkie_description",))
    name, path = next(iter(names.catalogued(package).items()))
    assert main(["info", f"upkie_description/{name}"]) == exits.FAILED
    assert "hint: hymeko-x corpus fetch upkie_description" in capsys.readouterr().err
    place = cache.package_path(package, tmp_path) / path
    place.parent.mkdir(parents=True)
    place.write_text(ARM)
    assert names.located(f"upkie_description/{name}").path == str(place)
    assert main(["corpus", "search", "upkie"]) == exits.DONE
    assert f"upkie_description/{name}" in capsys.readouterr().out
    assert main(["corpus", "search", "no such robot"]) == exits.FAILED
