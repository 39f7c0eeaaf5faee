"""Files are compared by their content: what a mesh shows, and the pixels of an image."""

from __future__ import annotations

import json
import shutil
from typing import TYPE_CHECKING

import numpy as np
import pytest

import hymeko_x as hx
from hymeko_x import formats
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.cli import exits, main
from hymeko_x.compare.contents import Contents
from hymeko_x.meshes.change import area, changes, distance, volume
from hymeko_x.meshes.submesh import Submesh
from hymeko_x.residue.measuring import losses_between_files
from hymeko_x.residue.originals import fetch_from
from tests.assets.test_originals import TETRAHEDRON, home, png

if TYPE_CHECKING:
    from pathlib import Path

CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
FACES = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
)


def cube(size: float = 1.0, uv: object = None) -> Submesh:
    return Submesh(CUBE * size, FACES, uv)  # type: ignore[arg-type]


def test_a_mesh_that_grows_changes_volume_area_and_surface() -> None:
    assert (volume(cube()), area(cube())) == pytest.approx((1.0, 6.0))
    found = {name: (before, after) for name, before, after in changes(cube(), cube(1.5))}
    assert found == {
        "volume": pytest.approx((1.0, 3.375)),
        "area": pytest.approx((6.0, 13.5)),
        "distance": pytest.approx((0.0, 0.5 * 3**0.5)),
    }


def test_a_point_in_the_middle_of_a_side_changes_the_number_of_triangles_alone() -> None:
    points = np.vstack([CUBE, [[0.5, 0.5, 0.0]]])
    split = np.vstack([FACES[[0, 1, 2, 3, 4, 5, 6, 7, 10, 11]], [[0, 2, 8], [2, 6, 8], [6, 4, 8], [4, 0, 8]]])
    assert changes(cube(), Submesh(points, split)) == (("triangles", 12.0, 14.0),)


def test_the_distance_to_a_surface_of_many_triangles_is_that_to_the_nearest() -> None:
    side = np.linspace(0.0, 1.0, 31)
    points = np.array([[x, y, 0.0] for x in side for y in side])
    corner = np.array([31 * i + j for i in range(30) for j in range(30)])
    faces = np.concatenate([np.stack([corner, corner + 31, corner + 1], 1), np.stack([corner + 1, corner + 31, corner + 32], 1)])
    sheet = Submesh(points, faces)
    assert distance(sheet, Submesh(points + np.array([0.0, 0.0, 0.25]), faces)) == pytest.approx(0.25)
    assert distance(sheet, sheet) == 0.0


def test_texture_coordinates_count() -> None:
    uv = CUBE[:, :2]
    assert changes(cube(uv=uv), cube(uv=uv)) == ()
    assert changes(cube(uv=uv), cube()) == (("texture coordinates", 12.0, 0.0),)
    assert changes(cube(uv=uv), cube(uv=uv * 0.5)) == (("places in the image", 0.0, 0.5),)


def twice(folder: Path) -> tuple[str, str]:
    """A model with its files in two folders."""
    source = home(folder / "a")
    shutil.copytree(folder / "a", folder / "b")
    return str(source), str(folder / "b" / "home" / "robot.xml")


def test_the_same_files_in_another_place_are_no_difference(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = str(home(tmp_path))
    (tmp_path / "away").mkdir()
    for assets in ("copy", "reference"):
        away = str(tmp_path / "away" / f"{assets}.hymeko")
        assert main(["convert", source, away, "--assets", assets]) == exits.DONE
        assert (main(["diff", source, away]), capsys.readouterr().out) == (exits.DONE, "")


def test_a_moved_point_in_a_mesh_file_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    a, b = twice(tmp_path)
    (tmp_path / "b" / "parts" / "spare.obj").write_text(TETRAHEDRON.replace("v 0 0 0.3", "v 0 0 0.6"))
    assert main(["diff", a, b]) == exits.DIFFERENT
    lines = capsys.readouterr().out.splitlines()
    assert lines == [
        "mesh 'unused' content.volume: 0.001 -> 0.002",
        "mesh 'unused' content.area: 0.09 -> 0.167823",
        "mesh 'unused' content.distance: 0 -> 0.3",
    ]


def test_other_pixels_of_an_image_are_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    a, b = twice(tmp_path)
    (tmp_path / "b" / "home" / "images" / "b.png").write_bytes(png(201))
    assert main(["diff", a, b]) == exits.DIFFERENT
    assert capsys.readouterr().out.splitlines() == ["texture 'spare' content.rows of pixels: 0 -> 2"]


def test_the_report_has_the_change_of_a_converted_mesh_in_physical_units(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A flat mesh for contact gets a thickness, since MuJoCo makes a hull of it."""
    (tmp_path / "flat.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n")
    inertial = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    shape = '<collision><geometry><mesh filename="flat.obj"/></geometry></collision>'
    (tmp_path / "r.urdf").write_text(f'<robot name="r"><link name="b">{inertial}{shape}</link></robot>')
    report = tmp_path / "report.json"
    (tmp_path / "out").mkdir()
    assert main(["convert", str(tmp_path / "r.urdf"), str(tmp_path / "out" / "r.xml"), "--report", str(report)]) == exits.DONE
    losses = [row for row in json.loads(report.read_text())["losses"] if row["element"] == "mesh 'flat'"]
    assert {row["field"]: (row["before"], row["after"], row["unit"]) for row in losses} == {
        "content.triangles": (2, 4, None),
        "content.area": (1, pytest.approx(2), "m^2"),
        "content.distance": (0, pytest.approx(1e-4), "m"),
    }
    assert "surface of 1 mesh, off by up to 0.0001 m: 'flat'" in capsys.readouterr().err


CUBE_IN_TWO_COLOURS = """mtllib paint.mtl
v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1
usemtl red\nf 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5
usemtl blue\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8
"""


def painted(folder: Path) -> Path:
    """A URDF with a visual whose mesh has two materials, so that MJCF has it in two pieces."""
    (folder / "cube.obj").write_text(CUBE_IN_TWO_COLOURS)
    (folder / "paint.mtl").write_text("newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n")
    shape = '<visual><geometry><mesh filename="cube.obj"/></geometry></visual>'
    (folder / "r.urdf").write_text(f'<robot name="r"><link name="b">{shape}</link></robot>')
    return folder / "r.urdf"


def test_a_mesh_in_pieces_shows_the_same_as_the_whole(tmp_path: Path) -> None:
    losses = hx.convert(painted(tmp_path), tmp_path / "r.xml").losses
    assert losses is not None
    assert [str(loss) for loss in losses if "content" in loss.field] == []


def test_a_piece_without_a_triangle_is_a_change_of_the_whole(tmp_path: Path) -> None:
    source = painted(tmp_path)
    hx.convert(source, tmp_path / "r.xml")
    piece = tmp_path / "meshes" / "cube_red.obj"
    vertices = [line for line in piece.read_text().splitlines() if not line.startswith("f ")]
    piece.write_text("\n".join([*vertices, "f 1 2 3", ""]))
    fetch = fetch_from(DiskFiles(tmp_path))
    losses = losses_between_files(
        Contents(hx.load(source).mechanism, fetch), Contents(hx.load(tmp_path / "r.xml").mechanism, fetch), formats.MJCF
    )
    found = {loss.field: (loss.before, loss.after) for loss in losses if loss.field.startswith("content")}
    assert found["content.triangles"] == ("12", "7")
