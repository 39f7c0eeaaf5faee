"""Conversion within a format leaves the author's text as it is, and takes along what the text includes."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x import disk, formats, pipeline
from hymeko_x.diagnostics import Report
from hymeko_x.edits.copying import copied
from tests.edits.test_update import ARM
from tests.residue.samples import MJCF

XACRO = """<?xml version="1.0"?>
<robot name="cart" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:include filename="parts/wheel.xacro"/>
  <link name="base"/>
  <xacro:wheel name="left"  y="${0.5 * 0.4}"/>
</robot>
"""
WHEEL = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="wheel" params="name y">
    <link name="${name}"/>
    <joint name="${name}_axle" type="fixed"><origin xyz="0 ${y} 0"/><parent link="base"/><child link="${name}"/></joint>
  </xacro:macro>
</robot>
"""
HYMEKO = "// as I like it\nr : robot {\n  base { mass 2.50 }   link { }\n  @j : revolute { + base - link  axis=Y }\n}\n"
USD = '#usda 1.0\n(\n    upAxis = "Z"\n)\n\ndef Xform "r" ( # the robot\n    prepend apiSchemas = ["PhysicsRigidBodyAPI"]\n)\n{\n}\n'
TEXTS = {"urdf": ARM, "mjcf": MJCF, "xacro": XACRO, "hymeko": HYMEKO, "usd": USD}
SUFFIXES = {"urdf": ".urdf", "mjcf": ".xml", "usd": ".usda", "hymeko": ".hymeko", "xacro": ".xacro"}


@pytest.mark.parametrize("format", TEXTS)
@pytest.mark.parametrize("folder", ["", "other"])
def test_a_conversion_within_a_format_gives_the_same_bytes(format: str, folder: str, tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "other").mkdir()
    (tmp_path / "parts/wheel.xacro").write_text(WHEEL)
    text = TEXTS[format].replace("\n", "\r\n")
    source, target = tmp_path / f"a{SUFFIXES[format]}", tmp_path / folder / f"b{SUFFIXES[format]}"
    source.write_bytes(text.encode())
    result = hx.convert(source, target)
    assert (target.read_bytes(), result.losses) == (text.encode(), ())
    assert (tmp_path / folder / "parts/wheel.xacro").exists() is (folder == "" or format == "xacro")


def test_of_a_file_that_moves_only_the_path_changes(tmp_path: Path) -> None:
    text = ARM.replace('<box size="0.20 0.2 0.05"/>', '<mesh filename="../plate.stl" scale="1.0 1 1"/>')
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
    (tmp_path / "plate.stl").write_bytes(b"solid plate\nendsolid plate\n")
    (tmp_path / "a/arm.urdf").write_text(text)
    hx.convert(tmp_path / "a/arm.urdf", tmp_path / "b/arm.urdf")
    assert (tmp_path / "b/arm.urdf").read_text() == text.replace("../plate.stl", "meshes/plate.stl")
    assert (tmp_path / "b/meshes/plate.stl").exists()


def test_what_a_text_includes_from_above_its_folder_becomes_part_of_a_new_text(tmp_path: Path) -> None:
    for folder in ("a", "b/c"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "arm.xml").write_text('<mujoco><worldbody><body name="x"><geom size="1"/></body></worldbody></mujoco>')
    (tmp_path / "a/m.xml").write_text('<mujoco model="m"><include file="../arm.xml"/></mujoco>')
    hx.convert(tmp_path / "a/m.xml", tmp_path / "b/c/m.xml")
    assert "include" not in (tmp_path / "b/c/m.xml").read_text()
    assert hx.diff(hx.load(tmp_path / "a/m.xml").mechanism, hx.load(tmp_path / "b/c/m.xml").mechanism) == ()


def test_an_option_that_changes_the_robot_gives_a_new_text(tmp_path: Path) -> None:
    source, target = tmp_path / "a.urdf", tmp_path / "b.urdf"
    source.write_text(ARM)
    hx.convert(source, target, base="free")
    assert target.read_text() != ARM


@pytest.mark.robots("urdf", "mjcf", "xacro", "usd", every=12)
@pytest.mark.unread("HX005", "HX040", "HX052")
def test_a_real_robot_keeps_its_bytes(robot: Path) -> None:
    source = disk.open_source(str(robot))
    format = formats.of_input(source.name, source.data)
    mechanism = pipeline.read(source, format, Report())
    beside = copied(source, format, mechanism, pipeline.Place(str(robot.parent)), Report())
    assert beside is not None
    assert (beside.main, beside.files, beside.copies) == (source.data, {}, {})
