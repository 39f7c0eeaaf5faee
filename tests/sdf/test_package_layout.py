"""`--package-layout`: the folder of the output is a model of Gazebo, which other files include by its name."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

import hymeko_x as hx
from hymeko_x.cli import main

if TYPE_CHECKING:
    from pathlib import Path

TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
ARM = """<mujoco model="arm"><asset><mesh name="hull" file="hull.obj"/><texture name="wood" type="2d" file="wood.png"/>
<material name="wood" texture="wood"/></asset><worldbody><body name="base"><geom type="mesh" mesh="hull" material="wood"/><body name="tip">
<joint name="j"/><geom size="0.1"/></body></body></worldbody></mujoco>"""
PIXEL = bytes.fromhex(
    "89504e470d0a1a0a0000000d49484452000000010000000108060000001f15c4890000000d49444154789c6360606060000000050001a5f645400000000049454e44ae426082"
)
WORLD = """<sdf version="1.9"><world name="w"><include><uri>model://arm</uri><name>left</name><pose>1 0 0 0 0 0</pose></include>
<include><uri>model://arm</uri><name>right</name></include></world></sdf>"""


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    """The folder `models/arm` with the model of an arm."""
    (tmp_path / "arm.xml").write_text(ARM, "utf-8")
    (tmp_path / "hull.obj").write_text(TETRAHEDRON, "utf-8")
    (tmp_path / "wood.png").write_bytes(PIXEL)
    folder = tmp_path / "models" / "arm"  # is made
    assert main(["convert", str(tmp_path / "arm.xml"), str(folder / "model.sdf"), "--package-layout", "--base", "fixed"]) == 0
    return folder


def test_the_folder_has_what_gazebo_looks_for(arm: Path) -> None:
    files = {path.relative_to(arm).as_posix() for path in arm.rglob("*") if path.is_file()}
    assert files == {"model.sdf", "model.config", "meshes/hull.obj", "materials/textures/wood.png"}
    config = '<model>\n  <name>arm</name>\n  <version>1.0</version>\n  <sdf version="1.9">model.sdf</sdf>\n</model>\n'
    assert (arm / "model.config").read_text("utf-8") == f'<?xml version="1.0"?>\n{config}'
    text = (arm / "model.sdf").read_text("utf-8")
    assert "<uri>model://arm/meshes/hull.obj</uri>" in text
    assert "<albedo_map>model://arm/materials/textures/wood.png</albedo_map>" in text


@pytest.mark.unread("HX010")
def test_a_conversion_that_fails_leaves_no_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "arm.xml").write_text("<mujoco>", "utf-8")
    command = ["convert", str(tmp_path / "arm.xml"), str(tmp_path / "models" / "arm" / "model.sdf")]
    assert main([*command, "--package-layout"]) == 1
    assert not (tmp_path / "models").exists()
    capsys.readouterr()
    (tmp_path / "arm.xml").write_text(ARM, "utf-8")
    assert main(command) == 1
    assert "there is no folder" in capsys.readouterr().err


def test_a_world_includes_it_by_its_name(arm: Path) -> None:
    pytest.importorskip("pydrake")
    (arm.parent / "w.sdf").write_text(WORLD, "utf-8")
    robot = hx.load(arm.parent / "w.sdf").mechanism
    assert {joint.child.name for joint in robot.joints.values()} == {"left::base", "left::tip", "right::base", "right::tip"}
    assert hx.verify(arm.parent / "w.sdf", robot, samples=3).is_same
    hx.convert(arm.parent / "w.sdf", arm.parent / "w.xml")
    assert hx.verify(arm.parent / "w.sdf", arm.parent / "w.xml", samples=3).is_same


def test_the_engine_sees_the_same_robot_with_its_mesh(arm: Path) -> None:
    pytest.importorskip("pydrake")
    verdict = hx.verify(arm.parent.parent / "arm.xml", arm / "model.sdf", samples=3)
    assert verdict.is_same
    assert any("mesh" in check.quantity for check in verdict.checks)


def test_several_models_have_no_model_config(tmp_path: Path) -> None:
    models = '<model name="a"><link name="l"/></model><model name="b"><link name="l"/></model>'
    (tmp_path / "w.sdf").write_text(f'<sdf version="1.9"><world name="w">{models}</world></sdf>', "utf-8")
    (tmp_path / "w").mkdir()
    result = hx.convert(tmp_path / "w.sdf", tmp_path / "w" / "model.sdf", package_layout=True)
    assert "model.config is not written: it is for a file with one model" in [diagnostic.message for diagnostic in result.report]
    assert not (tmp_path / "w" / "model.config").exists()


def test_other_formats_refuse_the_option(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "arm.xml").write_text(ARM, "utf-8")
    assert main(["convert", str(tmp_path / "arm.xml"), str(tmp_path / "arm.urdf"), "--package-layout"]) == 2
    assert "--package-layout is for sdf, and the output is urdf" in capsys.readouterr().err
