"""Stages have no values that say nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

import hymeko_x as hx

if TYPE_CHECKING:
    from pathlib import Path

pytest.importorskip("pxr")

ARM = """<mujoco model="r">
  <worldbody>
    <body name="a">
      <geom name="here" size="0.1" rgba="1 0 0 1" friction="0.5"/>
      <geom name="there" size="0.1" pos="1 0 0" rgba="1 0 0 0.5" friction="0.9"/>
      <site name="grip"/>
      <body name="b"><joint name="down" axis="0 0 -1"/><geom size="0.1"/></body>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.fixture
def stage(tmp_path: Path) -> str:
    """The text of a stage."""
    (tmp_path / "r.xml").write_text(ARM)
    hx.convert(tmp_path / "r.xml", tmp_path / "r.usda")
    return (tmp_path / "r.usda").read_text()


def prim(stage: str, name: str) -> str:
    """The text of a prim up to its end."""
    return stage.split(f'"{name}"', 1)[1].split("\n        }", 1)[0]


def test_only_what_is_beside_the_frame_of_its_body_has_ops(stage: str) -> None:
    assert {name: "xformOp" in prim(stage, name) for name in ("here", "there", "grip")} == {"here": False, "there": True, "grip": False}


def test_bodies_have_ops_which_simulators_write_to(stage: str) -> None:
    assert "double3 xformOp:translate = (0, 0, 0)" in stage.split('def Xform "a"')[1].split("def ")[0]


def test_only_what_is_seen_through_has_an_opacity(stage: str) -> None:
    assert "displayOpacity" not in prim(stage, "here")
    assert "float[] primvars:displayOpacity = [0.5]" in prim(stage, "there")


def test_an_axis_that_points_the_other_way_is_half_a_turn(stage: str) -> None:
    assert 'physics:axis = "Z"' in prim(stage, "down")
    assert "physics:localRot1 = (0, 1, 0, 0)" in prim(stage, "down")


def test_frictions_are_named_by_their_value(stage: str) -> None:
    assert "physics = </r/frictions/friction_0_5>" in prim(stage, "here")
    assert "physics = </r/frictions/friction_0_9>" in prim(stage, "there")
