"""Outputs in one folder leave each other's files alone, also when meshes of one name differ."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x import codes
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.ir.parts import Mesh
from hymeko_x.meshes.reader import read_whole

URDF = """<robot name="r"><link name="a"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
<visual><geometry><mesh filename="meshes/a.obj"/></geometry></visual></link></robot>"""
OBJ = "v 0 0 0\nv {0} 0 0\nv 0 {0} 0\nv 0 0 {0}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


def robot(folder: Path, name: str, size: int) -> Path:
    place = folder / name
    (place / "meshes").mkdir(parents=True, exist_ok=True)
    (place / "meshes/a.obj").write_text(OBJ.format(size))
    (place / f"{name}.urdf").write_text(URDF)
    return place / f"{name}.urdf"


def size_of(main: Path) -> float:
    """How large the only mesh of an output is."""
    mechanism = hx.load(main).mechanism
    (mesh,) = [part for part in mechanism.graph.vertices.values() if isinstance(part, Mesh)]
    assert mesh.uri is not None
    mesh_file = DiskFiles(main.parent).find(mesh.uri)
    assert mesh_file is not None, mesh.uri
    return float(read_whole(Path(mesh_file).read_bytes(), Path(mesh_file).suffix, str.encode).points.max())


@pytest.mark.parametrize("suffix", ["urdf", "xml", "hymeko", "xacro"])
def test_two_robots_with_meshes_of_one_name_keep_their_own(suffix: str, tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    for name, size in (("one", 1), ("two", 2), ("two", 3), ("one", 4)):
        result = hx.convert(robot(tmp_path, name, size), out / f"{name}.{suffix}", assets="copy")
        assert [diagnostic.code for diagnostic in result.report].count(codes.ASSETS_APART) == (name == "two")
    assert (size_of(out / f"one.{suffix}"), size_of(out / f"two.{suffix}")) == (4, 3)
    assert list(out.rglob("*.part")) == []


def test_an_output_beside_its_source_leaves_the_meshes_of_the_source_alone(tmp_path: Path) -> None:
    source = robot(tmp_path, "one", 1)
    mesh = source.parent / "meshes/a.obj"
    mesh.write_text(f"{OBJ.format(1)}usemtl red\nf 1 2 3\n")  # MuJoCo gets a mesh per material, hence other files
    before = mesh.read_bytes()
    hx.convert(source, source.with_suffix(".xml"), assets="copy")
    assert mesh.read_bytes() == before


def test_what_both_have_alike_is_shared(tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    for name in ("one", "two"):
        hx.convert(robot(tmp_path, name, 1), out / f"{name}.xml")
    assert [path.name for path in out.rglob("*.obj")] == ["a.obj"]


def test_the_way_home_leads_to_the_files_of_this_robot(tmp_path: Path) -> None:
    (tmp_path / "out/meshes").mkdir(parents=True)
    (tmp_path / "out/meshes/a.obj").write_text("other")
    (tmp_path / "home").mkdir()
    source = robot(tmp_path, "one", 1)
    hx.convert(source, tmp_path / "out/one.xml")
    hx.convert(tmp_path / "out/one.xml", tmp_path / "home/one.urdf", assets="copy")
    assert size_of(tmp_path / "home/one.urdf") == 1
