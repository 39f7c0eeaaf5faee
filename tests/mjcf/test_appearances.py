"""The appearances of mesh files in MJCF: what looks like a material of the robot is that one."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING

import mujoco
import pytest
from PIL import Image

import hymeko_x as hx

if TYPE_CHECKING:
    from pathlib import Path

OBJ = """mtllib part.mtl
v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1
usemtl skin\nf 1/1 3/2 2/3\nf 1/1 2/2 4/3\nf 1/1 4/2 3/3\nf 2/1 3/2 4/3
"""
ROBOT = """<robot name="part">
  <material name="coat">{}</material>
  <link name="a">
    <visual><geometry><mesh filename="part.obj"/></geometry></visual>
    <visual><geometry><box size="1 1 1"/></geometry><material name="coat"/></visual>
  </link>
</robot>
"""
RED, IMAGE = '<color rgba="1 0 0 1"/>', '<texture filename="coat.png"/>'


def png(colour: tuple[int, int, int]) -> bytes:
    data = BytesIO()
    Image.new("RGB", (8, 8), colour).save(data, "PNG")
    return data.getvalue()


@pytest.mark.parametrize(
    ("own", "skin", "names"),
    [
        (RED, "Kd 1 0 0", ["coat"]),
        (RED, "Kd 0 1 0", ["coat", "skin"]),
        (IMAGE, "Kd 1 1 1\nmap_Kd coat.png", ["coat"]),
        (IMAGE, "Kd 1 1 1\nmap_Kd other.png", ["coat", "skin"]),
        (IMAGE, "Kd 1 1 1", ["coat", "skin"]),
        (RED, "Kd 1 0 0\nmap_Kd coat.png", ["coat", "skin"]),
    ],
)
@pytest.mark.unread("HX101", "HX202")
def test_what_looks_like_a_material_of_the_robot_is_that_material(own: str, skin: str, names: list[str], tmp_path: Path) -> None:
    (tmp_path / "part.urdf").write_text(ROBOT.format(own))
    (tmp_path / "part.obj").write_text(OBJ)
    (tmp_path / "part.mtl").write_text(f"newmtl skin\n{skin}\n")
    (tmp_path / "coat.png").write_bytes(png((255, 0, 0)))
    (tmp_path / "other.png").write_bytes(png((0, 0, 255)))
    (tmp_path / "out").mkdir()
    hx.convert(tmp_path / "part.urdf", tmp_path / "out" / "part.xml")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "part.xml"))
    assert sorted(model.mat(number).name for number in range(model.nmat)) == names
    assert model.ntex == len({name for name in ("coat.png", "other.png") if name in own or name in skin})
