"""A material that a shape loses in a converted file is no material of the original's shape any more."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import pytest

import hymeko_x as hx

POST = """<mujoco model="post">
  <asset> <material name="red" rgba="1 0 0 1"/> </asset>
  <default> <geom material="red"/> </default>
  <worldbody>
    <body name="post">
      <geom name="low" type="box" size="0.1 0.1 0.1"/>
      <geom name="high" type="box" size="0.1 0.1 0.2"/>
    </body>
  </worldbody>
</mujoco>
"""
LINK = """<robot name="post">
  <material name="red"><color rgba="1 0 0 1"/></material>
  <link name="post">
    <visual>
      <geometry><box size="0.2 0.2 0.2"/></geometry>
      <material name="red"/>
    </visual>
    <visual>
      <geometry><box size="0.2 0.2 0.4"/></geometry>
      <material name="red"/>
    </visual>
  </link>
</robot>
"""
WITHOUT = {
    "post.urdf": (r'(<visual.*?)\s*<material name="red"/>', r"\1"),
    "post.sdf": (r"\s*<material>.*?</material>", ""),
    "post.usda": (r"\n *rel material:binding = [^\n]*", ""),
    "post.json": (r',\{"to":\["material","red"\],"role":"material"\}', ""),
}


def without_first_material(original: Path, there: Path) -> str:
    """The original's text after its first shape lost its material in another format."""
    hx.convert(original, there)
    text, number = re.subn(*WITHOUT[there.name], there.read_text(), count=1, flags=re.DOTALL)
    assert number == 1
    there.write_text(text)
    hx.update(original, there)
    assert hx.update(original, there).edits == ()
    return original.read_text()


@pytest.mark.parametrize("name", WITHOUT)
@pytest.mark.unread("HX101", "HX105", "HX118")
def test_a_geom_whose_class_gives_a_material_has_none(name: str, tmp_path: Path) -> None:
    (tmp_path / "post.xml").write_text(POST)
    text = without_first_material(tmp_path / "post.xml", tmp_path / name)
    assert text == POST.replace('size="0.1 0.1 0.1"/>', 'size="0.1 0.1 0.1" material=""/>')
    assert list(mujoco.MjModel.from_xml_string(text).geom_matid) == [-1, 0]


@pytest.mark.unread("HX101", "HX105", "HX204")
def test_a_visual_whose_colour_is_gone_in_a_format_without_names_of_materials_has_no_material(tmp_path: Path) -> None:
    (tmp_path / "link.urdf").write_text(LINK)
    text = without_first_material(tmp_path / "link.urdf", tmp_path / "post.sdf")
    assert text == LINK.replace('      <material name="red"/>\n', "", 1)
