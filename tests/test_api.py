"""The functions of the public API have every option of the command line."""

from __future__ import annotations

import argparse
import inspect
from pathlib import Path

import pytest
from msgspec.structs import replace

import hymeko_x as hx
from hymeko_x import api, codes, formats
from hymeko_x.cli.convert import convert_arguments
from hymeko_x.diagnostics import Origin

NAMED = {"package": "packages", "arg": "arguments", "env": "environment", "variant": "variants", "paths": "source"}
OF_THE_SHELL = {"help", "jobs", "json", "report", "fail_on", "verify", "samples", "seed", "meshes", "quiet", "verbose"}
"""Options about what is shown and which exit code is returned."""

ARM = """<robot name="arm"><link name="base"/><link name="fore"><visual><geometry><mesh filename="package://arm/a.stl"/></geometry></visual>
</link><joint name="j" type="fixed"><parent link="base"/><child link="fore"/></joint></robot>"""
MACROS = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:macro name="leg" params="n"><link name="leg${n}">
<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="j${n}" type="fixed"><parent link="base"/><child link="leg${n}"/></joint></xacro:macro><link name="base"/>
<xacro:leg n="1"/><xacro:leg n="2"/><xacro:leg n="3"/></robot>"""


def arguments_of(function: object, options: type) -> set[str]:
    assert callable(function)
    return {*inspect.signature(function).parameters, *options.__annotations__}


def test_every_option_of_convert_is_an_argument() -> None:
    parser = argparse.ArgumentParser()
    convert_arguments(parser)
    options = {NAMED.get(action.dest, action.dest) for action in parser._actions} - OF_THE_SHELL
    assert options - arguments_of(api.convert, api.ReadingOptions) == set()


@pytest.mark.parametrize("function", [api.dump, api.dumps])
def test_every_option_of_the_output_is_an_argument_of_dump_and_dumps(function: object) -> None:
    assert set(api.WritingOptions.__annotations__) <= set(inspect.signature(api.convert).parameters)
    assert {*api.FindingOptions.__annotations__, *api.WritingOptions.__annotations__} <= arguments_of(function, api.WritingOptions)


def test_packages_are_found_on_the_search_path_and_inside_of_a_folder_only(tmp_path: Path) -> None:
    (tmp_path / "share/arm").mkdir(parents=True)
    (tmp_path / "share/arm/a.stl").write_bytes(b"solid")
    (tmp_path / "in").mkdir()
    (tmp_path / "in/arm.urdf").write_text(ARM)
    (tmp_path / "out").mkdir()
    robot = hx.load(tmp_path / "in/arm.urdf").mechanism
    hx.dump(robot, tmp_path / "out/arm.hymeko", assets="copy", search_path=[tmp_path / "share"])
    assert (tmp_path / "out/meshes/a.stl").read_bytes() == b"solid"
    found = hx.dump(robot, tmp_path / "out/b.hymeko", assets="copy", search_path=[tmp_path / "share"], confine=tmp_path / "in")
    assert [diagnostic.code for diagnostic in found] == [codes.ASSET_NOT_FOUND]
    with pytest.raises(hx.Refusal, match="HX001"):
        hx.load(tmp_path / "in/arm.urdf", confine=tmp_path / "out")


def test_files_beside_a_text_are_named_in_a_warning() -> None:
    report = hx.Report()
    text = hx.dumps(hx.loads(MACROS, "xacro"), "xacro", split=True, report=report)
    assert "<xacro:include" in text
    assert [diagnostic.code for diagnostic in report] == [codes.ASSET_NOT_WRITTEN]
    report = hx.Report()
    hx.dumps(hx.loads(MACROS, "xacro"), "usd", layout="layered", report=report)
    assert codes.ASSET_NOT_WRITTEN in [diagnostic.code for diagnostic in report]


def test_an_option_that_does_not_exist_is_a_type_error(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(ARM)
    with pytest.raises(TypeError, match="colour"):
        hx.load(tmp_path / "arm.urdf", colour="red")  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="colour"):
        hx.dumps(hx.load(tmp_path / "arm.urdf"), "urdf", colour="red")  # type: ignore[call-arg]


def test_files_are_found_beside_the_source_and_not_where_some_element_came_from(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "out").mkdir()
    (tmp_path / "in/a.stl").write_bytes(b"solid")
    (tmp_path / "in/arm.urdf").write_text(ARM.replace("package://arm/", ""))
    robot = hx.load(tmp_path / "in/arm.urdf").mechanism
    for origins in ({}, dict.fromkeys(robot.origins, Origin(str(tmp_path / "elsewhere/b.urdf")))):
        hx.dump(replace(robot, origins=origins), tmp_path / "out/arm.hymeko", assets="copy")
        assert (tmp_path / "out/meshes/a.stl").read_bytes() == b"solid"
        (tmp_path / "out/meshes/a.stl").unlink()


SWAPPED = (("<sdf/>", "urdf", "sdf"), ("<sdf/>", "mjcf", "sdf"), ("<robot/>", "sdf", "urdf"), ("<mujoco/>", "urdf", "mjcf"))


@pytest.mark.parametrize(("text", "format", "right"), SWAPPED)
def test_the_format_that_a_root_belongs_to_is_named_with_a_reader_that_there_is(text: str, format: str, right: str) -> None:
    with pytest.raises(hx.Refusal) as refusal:
        hx.loads(text, format)
    assert refusal.value.diagnostic.hint.endswith(f"read it with --from {right}")
    assert formats.by_name(right).frontend is not None
