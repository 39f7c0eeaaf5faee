"""URDF of MJCF files, as a person would write it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lxml import etree

import hymeko_x as hx

if TYPE_CHECKING:
    from pathlib import Path


def converted(world: str, folder: Path) -> etree._Element:
    """The root of the URDF file of an MJCF file with this content in its world."""
    (folder / "r.xml").write_text(f'<mujoco model="r"><worldbody>{world}</worldbody></mujoco>')
    hx.convert(folder / "r.xml", folder / "r.urdf")
    return etree.parse(folder / "r.urdf").getroot()


def test_the_collision_of_a_geom_that_is_seen_and_collides_has_no_material(tmp_path: Path) -> None:
    root = converted('<body name="a"><freejoint/><geom name="ball" size="0.1" rgba="1 0 0 1"/></body>', tmp_path)
    assert [material.getparent().tag for material in root.iter("material")] == ["visual"]


def test_each_piece_of_a_capsule_has_a_name(tmp_path: Path) -> None:
    geoms = '<geom name="leg" type="capsule" size="0.1 0.2"/><geom name="foot" size="0.2"/>'
    root = converted(f'<body name="a"><freejoint/>{geoms}</body>', tmp_path)
    for tag in ("visual", "collision"):
        assert [shape.get("name") for shape in root.iter(tag)] == ["leg", "foot", "leg_top", "leg_bottom"]


CHAIN = """
<body name="trunk">
  <joint name="x" type="slide" axis="1 0 0"/>
  <joint name="z" type="slide" axis="0 0 1" ref="1"/>
  <joint name="turn" axis="0 1 0"/>
  <geom size="0.1"/>
  <body name="leg" pos="0 0 -1"><joint name="hip" axis="0 1 0" pos="0 0 0.2"/><geom size="0.1"/></body>
</body>
"""


def test_the_links_and_joints_of_a_chain_stand_where_its_joint_stood_and_are_called_after_what_moves_them(tmp_path: Path) -> None:
    root = converted(CHAIN, tmp_path)
    assert [element.get("name") for element in root if element.tag in ("link", "joint")] == [
        *("world", "trunk", "x", "x_link", "z", "z_link", "turn"),
        *("leg", "hip", "leg_carrier", "hip_frame"),
    ]


def test_a_place_from_a_reference_has_no_negative_zeros(tmp_path: Path) -> None:
    converted(CHAIN, tmp_path)
    assert '<origin xyz="0 0 -1" rpy="0 0 0"/>' in (tmp_path / "r.urdf").read_text()
    assert "-0 " not in (tmp_path / "r.urdf").read_text()
