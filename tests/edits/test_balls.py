"""Balls, which URDF shows as three hinges: they move as one, and are three hinges where one of them is edited by itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import pytest
from lxml import etree

import hymeko_x as hx

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

ROPE = """<mujoco model="rope">
  <worldbody>
    <body name="hook">
      <geom size="0.1"/>
      <body name="rope" pos="0 0 -1">
        <joint name="knot" type="ball" damping="0.5"/>
        <geom size="0.1"/>
        <body name="end" pos="0 0 -1">
          <joint name="last" type="ball"/>
          <geom size="0.1"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def joint(root: etree._Element, name: str) -> etree._Element:
    return root.find(f"joint[@name='{name}']")


def place(root: etree._Element) -> None:
    joint(root, "last_x").find("origin").set("xyz", "0 0.5 -1")


def other_parent(root: etree._Element) -> None:
    joint(root, "last_x").find("parent").set("link", "hook")


def axis(root: etree._Element) -> None:
    joint(root, "last_y").find("axis").set("xyz", "1 0 0")


def something_between(root: etree._Element) -> None:
    etree.SubElement(root, "link", name="tag")
    new = etree.SubElement(root, "joint", name="tag_mount", type="fixed")
    etree.SubElement(new, "parent", link=joint(root, "last_y").find("parent").get("link"))
    etree.SubElement(new, "child", link="tag")


@pytest.mark.parametrize(
    ("edit", "balls", "new"),
    [
        (place, ["knot", "last"], '<body name="end" pos="0 0.5 -1">'),
        (other_parent, ["knot", "last"], '      <body name="end" pos="0 0 -1">'),
        (axis, ["knot"], '<joint name="last_y" axis="1 0 0"'),
        (something_between, ["knot"], '<body name="tag"'),
    ],
)
@pytest.mark.parametrize("is_kept", [False, True], ids=["update", "kept"])
@pytest.mark.unread
def test_an_edit_of_a_hinge_of_a_ball_arrives(
    edit: Callable[[etree._Element], None], balls: list[str], new: str, tmp_path: Path, *, is_kept: bool
) -> None:
    original, there = tmp_path / "rope.xml", tmp_path / "rope.urdf"
    original.write_text(ROPE)
    hx.convert(original, there, keep="beside" if is_kept else None)
    tree = etree.parse(there)
    edit(tree.getroot())
    tree.write(there)
    if is_kept:
        original = tmp_path / "home.xml"
        hx.convert(there, original)
    else:
        report = hx.update(original, there).report
        assert [row.message for row in report if row.code.id == "HX118" and row.severity.name == "WARNING"] == []
        assert hx.update(original, there).edits == ()
    model = mujoco.MjModel.from_xml_path(str(original))
    kinds = {model.joint(number).name: mujoco.mjtJoint(model.jnt_type[number]).name for number in range(model.njnt)}
    assert [name for name, kind in kinds.items() if kind == "mjJNT_BALL"] == balls
    assert sum(kind == "mjJNT_HINGE" for kind in kinds.values()) == 3 * (2 - len(balls))
    assert new in original.read_text()
