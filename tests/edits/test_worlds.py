"""Edits of robots whose original is an SDF world of several models: in such a world all links are in models."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from lxml import etree

import hymeko_x as hx
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import Id, joint_edge
from hymeko_x.ir.parts import Body, Inertial, Joint, Loop

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.unread("HX101")

WORLD = """<?xml version="1.0"?>
<sdf version="1.9">
  <world name="w">
    <model name="arm">
      <link name="base">
        <inertial><mass>1</mass></inertial>
      </link>
    </model>
    <model name="box">
      <pose>2 0 0 0 0 0</pose>
      <link name="shell">
        <inertial><mass>1</mass></inertial>
      </link>
    </model>
  </world>
</sdf>
"""
SHELL = '<body name="box::shell" pos="2 0 0">'
TOOL = '<body name="tool" pos="0 0 1"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><joint name="turn" axis="0 0 1"/></body>'
BALL = '<body name="ball" pos="1 2 3"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body>'
MASS = Inertial(1.0, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0, 0.0, 0.0, 0.0))


def updated(folder: Path, old: str, new: str) -> str:
    """The world after this change in its conversion to MJCF, with which a second update finds no edit."""
    original, there = folder / "world.sdf", folder / "there.xml"
    original.write_text(WORLD)
    hx.convert(original, there)
    assert old in there.read_text()
    there.write_text(there.read_text().replace(old, new))
    hx.update(original, there)
    text = original.read_text()
    assert hx.update(original, there).edits == ()
    return text


def links(text: str) -> dict[str, list[str]]:
    """The names of the links, and joints, of each model of a world, which has none beside its models."""
    (world,) = etree.fromstring(text.encode())
    assert not world.findall("link")
    assert not world.findall("joint")
    return {model.get("name"): [one.get("name") for one in model if one.tag in ("link", "joint")] for model in world.findall("model")}


def test_a_body_on_a_link_is_in_the_model_of_that_behind_its_first_link(tmp_path: Path) -> None:
    text = updated(tmp_path, SHELL, SHELL + TOOL)
    assert links(text) == {"arm": ["base"], "box": ["shell", "tool", "turn"]}
    assert hx.load(tmp_path / "world.sdf").mechanism.joints[Id("joint", "box::turn")].parent == Id("body", "box::shell")


def test_a_body_in_the_world_is_in_a_model_of_its_name(tmp_path: Path) -> None:
    text = updated(tmp_path, "</worldbody>", f"{BALL}</worldbody>")
    assert links(text) == {"arm": ["base"], "box": ["shell"], "ball": ["ball"]}


def test_a_new_name_without_the_model_stays_in_the_model(tmp_path: Path) -> None:
    assert updated(tmp_path, '"box::shell"', '"case"') == WORLD.replace("shell", "case")


def test_what_is_in_no_model_is_written_into_models_and_named(tmp_path: Path) -> None:
    (tmp_path / "world.sdf").write_text(WORLD)
    shell, tool, hand = Id("body", "box::shell"), Id("body", "tool"), Id("body", "hand")
    robot = hx.load(tmp_path / "world.sdf").mechanism.replace(
        vertices={tool: Body(MASS), hand: Body(MASS)},
        edges={
            Id("joint", "turn"): joint_edge(Joint(), shell, tool),
            Id("joint", "hold"): joint_edge(Joint(), tool, hand),
            Id("loop", "weld"): Edge(Loop("weld"), (Arc(shell, 1), Arc(hand, -1))),
        },
    )
    text = hx.dumps(robot, "sdf")
    assert links(text)["box"] == ["shell", "tool", "hand", "turn", "hold", "weld"]
    report = hx.convert(tmp_path / "world.sdf", tmp_path / "same.sdf").report
    assert "in a world of several models" not in "\n".join(map(str, report))
