"""Files that mesh files refer to go where these go."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest
import trimesh

import hymeko_x as hx
from hymeko_x.assets.companions import named_in
from tests.assets.test_originals import TETRAHEDRON, png
from tests.robots import MemoryFiles

if TYPE_CHECKING:
    from pathlib import Path

URDF = """<robot name="r"><link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><mesh filename="{}"/></geometry></visual></link></robot>"""
GLTF = {"buffers": [{"uri": "a.bin"}], "images": [{"uri": "data:,"}, {"uri": "i.png"}]}
POINTS = TETRAHEDRON.split("f", 1)[0]
FACES = "vt 0 0\nvt 1 0\nvt 0 1\nusemtl skin\nf 1/1 3/2 2/3\nf 1/1 2/2 4/3\nf 1/1 4/2 3/3\nf 2/1 3/2 4/3\n"
OBJ = f"mtllib part.mtl\n{POINTS}{FACES}"


@pytest.mark.parametrize(
    ("name", "data", "found"),
    [
        ("a.obj", b"mtllib a.mtl\nmtllib  sub/b.mtl \nv 0 0 0\n", ["a.mtl", "sub/b.mtl"]),
        ("a.mtl", b"newmtl x\nmap_Kd -s 1 1 1 -clamp on red skin.png\nbump -bm 0.5 bump.png\n", ["red skin.png", "bump.png"]),
        ("a.dae", b"<image><init_from>sub/a%20b.png</init_from></image>", ["sub/a b.png"]),
        (
            "a.gltf",
            json.dumps(GLTF).encode(),
            ["a.bin", "i.png"],
        ),
        ("a.gltf", b"{", []),
        ("a.obj", b"mtllib /etc/passwd\nmtllib http://x/a.mtl\n", []),
        ("a.stl", b"mtllib a.mtl", []),
    ],
)
def test_the_files_that_a_mesh_file_refers_to(name: str, data: bytes, found: list[str]) -> None:
    assert list(named_in(name, MemoryFiles({name: data}))) == found


@pytest.mark.parametrize("target", ["r.urdf", "r.sdf", "r.hymeko"])
def test_materials_and_images_of_a_mesh_file_go_along(target: str, tmp_path: Path) -> None:
    for folder in ("home/parts/images", "away"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "home" / "r.urdf").write_text(URDF.format("parts/part.obj"))
    (tmp_path / "home" / "parts" / "part.obj").write_text(OBJ)
    (tmp_path / "home" / "parts" / "part.mtl").write_text("newmtl skin\nKd 1 0 0\nmap_Kd images/skin.png\n")
    (tmp_path / "home" / "parts" / "images" / "skin.png").write_bytes(png(77))
    (tmp_path / "home").rename(tmp_path / "moved")
    hx.convert(tmp_path / "moved" / "r.urdf", tmp_path / "away" / target, assets="copy")
    (tmp_path / "moved").rename(tmp_path / "gone")
    (mesh,) = (tmp_path / "away").rglob("*.obj")
    image = trimesh.load(mesh, force="mesh").visual.material.image
    assert (image.size, image.convert("RGB").getpixel((0, 0))) == ((2, 2), (77, 77, 77))


@pytest.mark.parametrize("target", ["r.urdf", "r.usda", "r.sdf", "r.hymeko", "r.xml"])
def test_libraries_come_home_to_mjcf_whose_engine_passes_them_over(target: str, tmp_path: Path) -> None:
    for folder in ("home/meshes", "away", "back"):
        (tmp_path / folder).mkdir(parents=True)
    mesh = '<compiler meshdir="meshes"/><asset><mesh file="part.obj"/></asset>'
    body = '<body name="a"><joint/><geom type="mesh" mesh="part"/></body>'
    (tmp_path / "home" / "r.xml").write_text(f'<mujoco model="r">{mesh}<worldbody>{body}</worldbody></mujoco>')
    (tmp_path / "home" / "meshes" / "part.obj").write_text(OBJ)
    (tmp_path / "home" / "meshes" / "part.mtl").write_text("newmtl skin\nmap_Kd skin.png\n")
    (tmp_path / "home" / "meshes" / "skin.png").write_bytes(png(77))
    hx.convert(tmp_path / "home" / "r.xml", tmp_path / "away" / target, keep="beside", assets="copy")
    (tmp_path / "home").rename(tmp_path / "gone")
    hx.convert(tmp_path / "away" / target, tmp_path / "back" / "r.xml")
    assert sorted(path.name for path in (tmp_path / "back" / "meshes").iterdir()) == ["part.mtl", "part.obj", "skin.png"]


def test_what_lies_outside_of_the_output_is_not_written(tmp_path: Path) -> None:
    for folder in ("home", "out/away"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "home" / "r.urdf").write_text(URDF.format("part.obj"))
    (tmp_path / "home" / "part.obj").write_text("mtllib ../../secret.mtl\n" + TETRAHEDRON)
    (tmp_path.parent / "secret.mtl").write_text("newmtl x\nKd 1 0 0\n")
    hx.convert(tmp_path / "home" / "r.urdf", tmp_path / "out" / "away" / "r.urdf")
    assert sorted(path.name for path in (tmp_path / "out").rglob("*") if path.is_file()) == ["part.obj", "r.urdf"]


@pytest.mark.parametrize("comment", ["# back\n", ""], ids=["two meshes", "one mesh twice"])
@pytest.mark.parametrize("target", ["r.urdf", "r.sdf", "r.hymeko"])
def test_libraries_of_one_name_stay_with_their_meshes(target: str, comment: str, tmp_path: Path) -> None:
    home = tmp_path / "home"
    for folder, grey in (("front", 77), ("back", 144)):
        (home / folder).mkdir(parents=True)
        (home / folder / "part.obj").write_text(OBJ)
        (home / folder / "part.mtl").write_text(f"# {folder}\nnewmtl skin\nmap_Kd skin.png\n")
        (home / folder / "skin.png").write_bytes(png(grey))
    second = '<visual><geometry><mesh filename="back/part.obj"/></geometry></visual></link>'
    (home / "r.urdf").write_text(URDF.format("front/part.obj").replace("</link>", second))
    (home / "back" / "part.obj").write_text(OBJ + comment)
    (tmp_path / "away").mkdir()
    hx.convert(home / "r.urdf", tmp_path / "away" / target, assets="copy")
    home.rename(tmp_path / "gone")
    meshes = sorted((tmp_path / "away").rglob("*.obj"))
    images = [trimesh.load(mesh, force="mesh").visual.material.image for mesh in meshes]
    assert sorted(image.convert("RGB").getpixel((0, 0))[0] for image in images) == [77, 144]
