"""Images of other formats in MJCF: on the six sides of a cube where only solids show them, flat where a mesh places them."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import pytest
from PIL import Image

import hymeko_x as hx

BOX = '<box size="0.2 0.2 0.4"/>'
PLATE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/2\nf 1/1 4/2 2/2\nf 2/2 4/2 3/3\n"
SOLID = "solid s\n" + "".join(
    f"facet normal 0 0 0\nouter loop\n{''.join(f'vertex {point}' + chr(10) for point in corners)}endloop\nendfacet\n"
    for corners in (
        ("0 0 0", "0 1 0", "1 0 0"),
        ("0 0 0", "1 0 0", "0 0 1"),
        ("0 0 0", "0 0 1", "0 1 0"),
        ("1 0 0", "0 1 0", "0 0 1"),
    )
)
MESH = '<mesh filename="{}"/>'
WOOD = '<material name="wood"/>'


def types_of(folder: Path, *geometries: str, size: tuple[int, int] = (16, 16), material: str = WOOD) -> list[str]:
    """The types of the textures in MJCF of a URDF robot that shows an image on these; MuJoCo compiles it."""
    Image.new("RGB", size, (200, 100, 50)).save(folder / "wood.png")
    (folder / "plate.obj").write_text(PLATE)
    (folder / "solid.stl").write_text(SOLID)
    visuals = "".join(f"<visual><geometry>{geometry}</geometry>{material}</visual>" for geometry in geometries)
    image = '<texture filename="wood.png"/>'
    (folder / "r.urdf").write_text(
        f'<robot name="r"><material name="wood">{image}</material><material name="spare"><color rgba="1 0 0 1"/>{image}</material>'
        f'<link name="a">{visuals}</link></robot>'
    )
    return types_in_mjcf(folder / "r.urdf")


def types_in_mjcf(file: Path) -> list[str]:
    """The types of the textures of a robot in MJCF, which MuJoCo compiles."""
    out = file.with_name("out") / "r.xml"
    out.parent.mkdir(exist_ok=True)
    hx.convert(file, out)
    mujoco.MjModel.from_xml_path(str(out))
    return re.findall(r'<texture name="wood" type="(\w+)" file="\S+"/>', out.read_text())


@pytest.mark.parametrize("geometry", [BOX, '<sphere radius="0.2"/>', '<cylinder radius="0.1" length="0.3"/>', MESH.format("solid.stl")])
def test_an_image_on_a_solid_is_on_each_side_of_a_cube(geometry: str, tmp_path: Path) -> None:
    assert types_of(tmp_path, geometry) == ["cube"]


def test_an_image_that_a_mesh_places_lies_flat(tmp_path: Path) -> None:
    assert types_of(tmp_path, MESH.format("plate.obj")) == ["2d"]
    assert types_of(tmp_path, BOX, MESH.format("plate.obj")) == ["2d"]


def test_an_image_that_is_no_square_lies_flat_since_mujoco_refuses_it_for_a_cube(tmp_path: Path) -> None:
    assert types_of(tmp_path, BOX, size=(16, 32)) == ["2d"]


def test_an_image_that_no_shape_shows_lies_flat(tmp_path: Path) -> None:
    assert types_of(tmp_path, BOX, material="") == ["2d"]


def test_an_image_on_a_cube_of_mjcf_is_one_again_behind_urdf(tmp_path: Path) -> None:
    Image.new("RGB", (16, 16), (200, 100, 50)).save(tmp_path / "wood.png")
    (tmp_path / "r.xml").write_text(
        '<mujoco><asset><texture name="wood" type="cube" file="wood.png"/><material name="wood" texture="wood"/></asset>'
        '<worldbody><body><geom type="box" size="0.1 0.1 0.2" material="wood"/></body></worldbody></mujoco>'
    )
    hx.convert(tmp_path / "r.xml", tmp_path / "r.urdf")
    assert types_in_mjcf(tmp_path / "r.urdf") == ["cube"]
