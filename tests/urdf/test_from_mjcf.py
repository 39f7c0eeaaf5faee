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
