"""Poses and names in a world, and the models that it includes by their bare name."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

import hymeko_x as hx
from tests.sdf.canonical import canonical

if TYPE_CHECKING:
    from pathlib import Path

FRAMES = """<sdf version="1.9"><world name="w"><frame name="f"><pose>1 2 3 0 0 0</pose></frame>
<model name="m"><pose relative_to="f">1 0 0 0 0 0</pose><frame name="f"><pose>5 5 5 0 0 0</pose></frame>
<link name="l"/></model></world></sdf>"""


def test_the_pose_of_the_only_model_is_relative_to_a_frame_of_the_world() -> None:
    robot = hx.loads(FRAMES, "sdf").mechanism
    assert [joint.parent_pose.xyz for joint in robot.joints.values()] == [(2.0, 2.0, 3.0)]
    assert canonical(hx.dumps(robot, "sdf").encode()) == canonical(FRAMES.encode())


def test_a_bare_name_is_that_of_a_model_in_the_resource_path(tmp_path: Path) -> None:
    folder = tmp_path / "models" / "part"
    folder.mkdir(parents=True)
    (folder / "model.config").write_text('<model><sdf version="1.9">model.sdf</sdf></model>', "utf-8")
    (folder / "model.sdf").write_text('<sdf version="1.9"><model name="p"><link name="l"/></model></sdf>', "utf-8")
    (tmp_path / "w.sdf").write_text('<sdf version="1.9"><world name="w"><include><uri>part</uri></include></world></sdf>', "utf-8")
    assert hx.load(tmp_path / "w.sdf", search_path=(tmp_path / "models",)).mechanism.name == "p"


TWO_MODELS = """<sdf version="1.9"><world name="w"><model name="a"><link name="l"/></model><model name="b"><link name="l"/></model>
</world></sdf>"""


def test_each_model_of_a_world_stands_once_in_the_layout() -> None:
    robot = hx.loads(TWO_MODELS, "sdf").mechanism
    assert len(set(robot.layout)) == len(robot.layout)
    assert hx.loads(hx.dumps(robot, "json"), "json").mechanism.layout == robot.layout


STATIC = """<sdf version="1.9"><model name="m"><static>true</static><link name="a"/><link name="b"/>
<joint name="j" type="revolute"><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis></joint></model></sdf>"""


def test_a_joint_of_a_static_model_is_fixed_in_other_formats() -> None:
    robot = hx.loads(STATIC, "sdf").mechanism
    assert canonical(hx.dumps(robot, "sdf").encode()) == canonical(STATIC.encode())
    report = hx.Report()
    assert "<joint" not in hx.dumps(robot, "mjcf", report=report)
    assert "joint 'j' is in a static model, in which nothing moves; it is written as fixed" in [diagnostic.message for diagnostic in report]
    assert 'type="fixed"' in hx.dumps(robot, "urdf")


def test_a_joint_of_a_nested_model_is_as_static_as_the_models_around_it() -> None:
    inner = STATIC.removeprefix('<sdf version="1.9">').removesuffix("</sdf>")
    moving, around = inner.replace("<static>true</static>", ""), '<sdf version="1.9"><model name="n">{}<link name="l"/>{}</model></sdf>'
    assert "<joint" not in hx.dumps(hx.loads(around.format("", inner), "sdf"), "mjcf").replace("<freejoint", "")
    assert "<joint" not in hx.dumps(hx.loads(around.format("<static>1</static>", moving), "sdf"), "mjcf")
    assert "<joint" in hx.dumps(hx.loads(around.format("", moving), "sdf"), "mjcf")


@pytest.mark.unread("HX045")
def test_a_world_without_models_is_a_scene() -> None:
    """libsdformat accepts it; it was an error, and nothing was written."""
    sun = '<sdf version="1.9"><world name="w"><light name="sun" type="directional"/></world></sdf>'
    assert '<light name="sun"' in hx.dumps(hx.loads(sun, "sdf"), "sdf")
    assert "<light" in hx.dumps(hx.loads(sun, "sdf"), "mjcf")


@pytest.mark.unread("HX045", "HX055", "HX104")
@pytest.mark.parametrize("keep", ["beside", "inside"])
@pytest.mark.parametrize("name", ["m.urdf", "m.xacro", "m.usda", "m.xml"])
def test_a_world_without_links_comes_back_from_what_is_kept(name: str, keep: str, tmp_path: Path) -> None:
    text = '<sdf version="1.9"><world name="w"><scene><sky/></scene></world></sdf>'
    (tmp_path / "w.sdf").write_text(text, "utf-8")
    hx.convert(tmp_path / "w.sdf", tmp_path / name, keep=keep)
    hx.convert(tmp_path / name, tmp_path / "back.sdf")
    assert [line for line in canonical((tmp_path / "back.sdf").read_bytes()) if "made by" not in line] == canonical(text.encode())


def test_a_frame_of_a_model_without_links_stays_on_the_link_of_the_model_in_it() -> None:
    inner = '<model name="nested" canonical_link="b"><link name="a"/><link name="b"/></model>'
    text = f'<sdf version="1.9"><model name="top"><frame name="f"/>{inner}</model></sdf>'
    assert canonical(hx.dumps(hx.loads(text, "sdf"), "sdf").encode()) == canonical(text.encode())
