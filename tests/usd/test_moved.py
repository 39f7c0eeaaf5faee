"""A stage without the mesh files of its source: what it shows leaves it as files again."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

import hymeko_x as hx
from tests.meshes.test_mesh import dae

URDF = """<robot name="r"><link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><origin xyz="0 0 1" rpy="0 1 0"/><geometry><mesh filename="{visual}" scale="2 -3 1"/></geometry></visual>
<collision><geometry><mesh filename="{collision}"/></geometry></collision></link></robot>"""


def moved(folder: Path, visual: str = "a.dae", collision: str = "b.stl") -> tuple[Path, Path]:
    """A URDF with its mesh files, and a stage that was made of it in another folder."""
    (folder / "home").mkdir()
    (folder / "away").mkdir()
    source = folder / "home" / "r.urdf"
    source.write_text(URDF.format(visual=visual, collision=collision))
    (folder / "home" / "a.dae").write_bytes(dae())
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.1)
    ball.vertices += (0.123456789, 0.0, 0.0)
    ball.export(folder / "home" / "b.stl")
    stage = folder / "away" / "r.usdc"
    hx.convert(source, stage, packages={"p": folder / "home"}, keep="inside")
    return source, stage


@pytest.mark.parametrize("target", ["back.urdf", "back.xml", "back.usda"])
def test_what_the_stage_has_of_a_mesh_stands_in_for_its_file(target: str, tmp_path: Path) -> None:
    source, stage = moved(tmp_path)
    result = hx.convert(stage, tmp_path / "away" / target, keep="inside")
    codes = [item.code.id for item in result.report if "becomes the points" in item.message]
    assert codes == ([] if target == "back.usda" else ["HX201", "HX201"])  # a stage has the points itself
    verdict = hx.verify(source, tmp_path / "away" / target)
    assert (verdict.is_same, [note for note in verdict.not_compared if "not found" in note]) == (True, [])


def test_the_points_are_those_of_the_file_in_single_precision(tmp_path: Path) -> None:
    _, stage = moved(tmp_path)
    hx.convert(stage, tmp_path / "away" / "back.urdf", keep="inside")
    (written,) = [path for path in (tmp_path / "away").rglob("*.obj") if path.stem == "b"]
    before, after = (trimesh.load(path, process=False).triangles.astype(np.float32) for path in (tmp_path / "home" / "b.stl", written))
    assert np.array_equal(before, after)


def test_where_the_package_is_the_file_is_named_as_before_elsewhere_the_points_stand_in(tmp_path: Path) -> None:
    source, stage = moved(tmp_path, "package://p/a.dae", "package://p/b.stl")
    away = tmp_path / "away" / "back.urdf"
    hx.convert(stage, away, keep="inside")
    assert 'filename="shapes/a.obj"' in away.read_text()
    assert (tmp_path / "away" / "shapes" / "a.obj").is_file()
    at_home, back = stage.rename(tmp_path / "home" / "r.usdc"), tmp_path / "home" / "back.urdf"
    hx.convert(at_home, back, packages={"p": tmp_path / "home"}, keep="inside")
    assert 'filename="package://p/a.dae"' in back.read_text()
    assert hx.diff(hx.load(source).mechanism, hx.load(back).mechanism) == ()
    assert not (tmp_path / "home" / "shapes").exists()


def test_several_meshes_in_several_colours_at_one_place_are_told_apart(tmp_path: Path) -> None:
    source, stage = moved(tmp_path)
    twice = source.read_text().replace("<collision>", '<visual><geometry><mesh filename="c.dae"/></geometry></visual><collision>')
    source.write_text(twice.replace('<origin xyz="0 0 1" rpy="0 1 0"/>', "").replace(' scale="2 -3 1"', ""))
    (tmp_path / "home" / "c.dae").write_bytes(dae().replace(b"1 0 0 1", b"0.5 0.5 0 1"))
    hx.convert(source, stage, keep="inside")
    report = hx.convert(stage, tmp_path / "away" / "back.urdf", keep="inside").report
    reported = {item.element: "becomes the points" in item.message for item in report if item.code.id == "HX201"}
    assert reported == {"mesh 'a'": True, "mesh 'c'": True, "mesh 'b'": True}
    files = {path.stem: path.read_text().count("\nf ") for path in (tmp_path / "away").rglob("*.obj")}
    assert files == {"a": 6, "b": 320, "c": 6}


@pytest.mark.parametrize("materials", [3, 1])
def test_the_colours_of_the_file_stand_in_with_its_points(materials: int, tmp_path: Path) -> None:
    _, stage = moved(tmp_path)
    if materials == 1:
        (tmp_path / "home" / "a.dae").write_bytes(dae().replace(b"#m1", b"#m0").replace(b"#m2", b"#m0"))
        hx.convert(tmp_path / "home" / "r.urdf", stage, keep="inside")
    hx.convert(stage, tmp_path / "away" / "back.urdf")
    library = (tmp_path / "away" / "shapes" / "a.mtl").read_text()
    colours = ["1 0 0", "0 1 0", "0 0 1"][:materials]
    assert [line for line in library.splitlines() if line.startswith("Kd")] == [f"Kd {colour}" for colour in colours]
    hx.convert(stage, tmp_path / "away" / "back.xml")
    assert [f'rgba="{colour} 1"' in (tmp_path / "away" / "back.xml").read_text() for colour in colours] == [True] * materials
    hx.convert(stage, tmp_path / "away" / "back.usda")
    shown = {
        view.material.name: view.faces for views in hx.load(tmp_path / "away" / "back.usda").mechanism.subsets.values() for view in views
    }
    assert sorted(shown.values()) == ([(0, 1), (2, 3), (4, 5)] if materials == 3 else [])  # one material is that of the whole shape


def test_the_image_of_the_file_stands_in_with_its_points(tmp_path: Path) -> None:
    from tests.usd.test_textures import IMAGE_FACES, RED_FACES, image, lay_obj

    (tmp_path / "home").mkdir()
    (tmp_path / "away").mkdir()
    hx.convert(lay_obj(tmp_path / "home", IMAGE_FACES + RED_FACES), tmp_path / "away" / "r.usda", keep="inside")
    hx.convert(tmp_path / "away" / "r.usda", tmp_path / "away" / "back.urdf")
    library = (tmp_path / "away" / "shapes" / "a.mtl").read_text().splitlines()
    assert [line for line in library if line.startswith(("Kd", "map_Kd"))] == ["Kd 1 1 1", "map_Kd ../textures/wood.png", "Kd 1 0 0"]
    assert (tmp_path / "away" / "textures" / "wood.png").read_bytes() == image()
    assert (tmp_path / "away" / "shapes" / "a.obj").read_text().count("\nvt ") == 5
