"""Files and points that were edited in an output win over the originals that are kept beside it."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

import hymeko_x as hx
from hymeko_x.cli import exits, main
from tests.meshes.test_mesh import dae

URDF = """<robot name="r"><link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><mesh filename="parts/part.ply"/></geometry></visual>
<collision><geometry><mesh filename="parts/hull.stl"/></geometry></collision></link></robot>"""
MODEL = """<mujoco><asset><texture name="skin" type="2d" file="skin.png"/><material name="skin" texture="skin"/>
<mesh name="bent" file="bent.obj"/></asset>
<worldbody><body><freejoint/><geom type="mesh" mesh="bent" material="skin"/></body></worldbody></mujoco>"""
BENT = "v 0 0 0\nv 1 0 0\nv 1 1 0.1\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n" + (
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"
)


def robot(folder: Path) -> Path:
    """A robot with a mesh that MuJoCo does not read, and one that it reads."""
    (folder / "parts").mkdir(parents=True)
    trimesh.creation.box((2.0, 1.0, 1.0)).export(folder / "parts" / "part.ply")
    trimesh.creation.box((0.1, 0.2, 0.3)).export(folder / "parts" / "hull.stl")
    (folder / "r.urdf").write_text(URDF)
    return folder / "r.urdf"


def sizes(path: Path) -> list[float]:
    """The sizes of the meshes of a robot in URDF along x, in the order of the text."""
    uris = [part.uri or "" for _, part in hx.load(path).mechanism.assets()]
    return [round(float(trimesh.load(path.parent / uri, force="mesh").extents[0]), 6) for uri in uris]


def messages(report: hx.Report) -> list[str]:
    return [diagnostic.message for diagnostic in report if diagnostic.code.id == "HX105"]


@pytest.mark.parametrize("is_gone", [False, True])
def test_an_edited_conversion_wins_over_its_original(is_gone: bool, tmp_path: Path) -> None:
    source = robot(tmp_path / "home")
    (tmp_path / "away").mkdir()
    hx.convert(source, tmp_path / "away" / "r.xml", keep="beside")
    (edited,) = (tmp_path / "away" / "meshes").glob("part*.obj")
    trimesh.creation.box((7.0, 1.0, 1.0)).export(edited)
    if is_gone:
        (tmp_path / "home").rename(tmp_path / "gone")
    back = tmp_path / "back"
    back.mkdir()
    result = hx.convert(tmp_path / "away" / "r.xml", back / "r.urdf")
    assert sizes(back / "r.urdf") == [7.0, 0.1]
    name = f"meshes/{edited.name}"
    assert messages(result.report) == [
        f"mesh 'part': '{name}' was edited since the file was written; the edit counts, and the original 'parts/part.ply' does not"
    ]


def test_an_edited_part_of_a_file_is_reported(tmp_path: Path) -> None:
    source = robot(tmp_path / "home")
    source.write_text(URDF.replace("part.ply", "part.dae"))
    (tmp_path / "home" / "parts" / "part.dae").write_bytes(dae())
    for place in ("away", "back"):
        (tmp_path / place).mkdir()
    hx.convert(source, tmp_path / "away" / "r.xml", keep="beside")
    edited = sorted((tmp_path / "away" / "meshes").glob("*.obj"))[0]
    trimesh.creation.box((7.0, 1.0, 1.0)).export(edited)
    result = hx.convert(tmp_path / "away" / "r.xml", tmp_path / "back" / "r.urdf")
    assert messages(result.report) == [
        f"'meshes/{edited.name}' was edited since the file was written; "
        "it is a part of an original, which is kept whole and has no such edit"
    ]


def test_an_edited_copy_wins(tmp_path: Path) -> None:
    source = robot(tmp_path / "home")
    for place in ("away", "back"):
        (tmp_path / place).mkdir()
    hx.convert(source, tmp_path / "away" / "r.xml", keep="beside")
    (tmp_path / "home").rename(tmp_path / "gone")
    trimesh.creation.box((7.0, 1.0, 1.0)).export(tmp_path / "away" / "meshes" / "hull.stl")
    hx.convert(tmp_path / "away" / "r.xml", tmp_path / "back" / "r.urdf")
    assert sizes(tmp_path / "back" / "r.urdf") == [2.0, 7.0]


def test_edited_points_of_a_stage_win(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pxr = pytest.importorskip("pxr")
    source = robot(tmp_path / "home")
    for place in ("away", "back"):
        (tmp_path / place).mkdir()
    hx.convert(source, tmp_path / "away" / "r.usda", keep="beside")
    (tmp_path / "home").rename(tmp_path / "gone")
    from pxr import Usd, UsdGeom

    assert pxr is not None
    stage = Usd.Stage.Open(str(tmp_path / "away" / "r.usda"))
    meshes = [UsdGeom.Mesh(prim) for prim in stage.TraverseAll() if prim.IsA(UsdGeom.Mesh)]
    (mesh,) = [mesh for mesh in meshes if round(float(np.ptp(np.array(mesh.GetPointsAttr().Get())[:, 0])), 6) == 0.1]
    mesh.GetPointsAttr().Set(np.array(mesh.GetPointsAttr().Get()) * 30)
    stage.Save()
    assert main(["convert", str(tmp_path / "away" / "r.usda"), str(tmp_path / "back" / "r.urdf")]) == exits.DONE
    assert "mesh 'hull': its points were edited since the file was written" in capsys.readouterr().err
    assert sizes(tmp_path / "back" / "r.urdf") == [2.0, 3.0]


def test_an_edited_image_wins(tmp_path: Path) -> None:
    for place in ("home", "away", "back"):
        (tmp_path / place).mkdir()
    (tmp_path / "home" / "r.xml").write_text(MODEL)
    (tmp_path / "home" / "bent.obj").write_text(BENT)
    (tmp_path / "home" / "skin.png").write_bytes(picture(10))
    hx.convert(tmp_path / "home" / "r.xml", tmp_path / "away" / "r.usda", keep="beside")
    (tmp_path / "home").rename(tmp_path / "gone")
    (image,) = (tmp_path / "away").rglob("textures/*.png")
    image.write_bytes(picture(200))
    hx.convert(tmp_path / "away" / "r.usda", tmp_path / "back" / "r.xml")
    (home,) = (tmp_path / "back").rglob("*.png")
    assert Image.open(home).convert("L").getpixel((0, 0)) == 200


@pytest.mark.parametrize("through", ["r.xml", "r.usda", "r.usdz", "r.sdf", "r.hymeko"])
def test_nothing_counts_as_edited_that_is_as_it_was_written(through: str, tmp_path: Path) -> None:
    source = robot(tmp_path / "home")
    for place in ("away", "back"):
        (tmp_path / place).mkdir()
    hx.convert(source, tmp_path / "away" / through, keep="beside")
    (tmp_path / "home").rename(tmp_path / "gone")
    result = hx.convert(tmp_path / "away" / through, tmp_path / "back" / "r.urdf")
    assert messages(result.report) == []
    assert (tmp_path / "back").joinpath("parts/part.ply").exists() or through == "r.hymeko"


def picture(grey: int) -> bytes:
    out = io.BytesIO()
    Image.new("L", (2, 2), grey).save(out, "PNG")
    return out.getvalue()
