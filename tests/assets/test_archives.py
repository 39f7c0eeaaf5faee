"""A robot and all its files in one archive: written, and read alone in an empty folder by its engine and by ``load``."""

from __future__ import annotations

import shutil
import zipfile
from pathlib import Path

import mujoco
import pytest

import hymeko_x as hx
from hymeko_x import cli
from hymeko_x.diagnostics import Refusal, Report
from tests.assets.test_packages_gone import MESHES, URDF, package

ARCHIVES = {
    "r.mjz": "model.xml", "r.xml.zip": "model.xml", "r.urdf.zip": "model.urdf", "r.xacro.zip": "model.xacro", "r.sdf.zip": "model.sdf",
    "r.hymeko.zip": "model.hymeko", "r.usda.zip": "model.usda", "r.json.zip": "model.json", "r.usdz": "stage.usdc",
}  # fmt: skip
PART = 'filename="package://arm_description/meshes/part.obj"'


@pytest.fixture
def source(tmp_path: Path) -> Path:
    return package(tmp_path / "source", URDF, "r.urdf")


def alone(archive: Path) -> Path:
    """The archive under another name in a folder of its own, with nothing left of where it was made."""
    there = archive.parent / "alone"
    there.mkdir()
    moved = there / f"renamed{archive.suffix}"
    archive.rename(moved)
    shutil.rmtree(archive.parent / "source")
    return moved


@pytest.mark.parametrize("name", ARCHIVES)
def test_an_archive_alone_is_the_robot_with_its_files(name: str, source: Path, tmp_path: Path) -> None:
    contents = {path: (source.parents[1] / path).read_bytes() for path in MESHES}
    hx.convert(source, tmp_path / name, assets="pack")
    moved = alone(tmp_path / name)
    with zipfile.ZipFile(moved) as archive:
        assert archive.namelist()[0] == ARCHIVES[name]
    report = Report()
    robot = hx.load(moved, report=report).mechanism
    assert sum(view.mesh is not None for view in robot.every_shape()) == 2
    hx.dump(robot, moved.parent / "back.xml")
    assert mujoco.MjModel.from_xml_path(str(moved.parent / "back.xml")).nmesh == 2
    if name in ("r.urdf.zip", "r.xacro.zip", "r.sdf.zip"):
        hx.dump(robot, moved.parent / "back.urdf")
        assert PART in (moved.parent / "back.urdf").read_text()
        assert {path: (moved.parent / "arm_description" / path).read_bytes() for path in MESHES} == contents
    assert [diagnostic.message for diagnostic in report if "not found" in diagnostic.message] == []


def test_mujoco_loads_the_archive_alone_whatever_it_is_called(source: Path, tmp_path: Path) -> None:
    hx.convert(source, tmp_path / "r.xml")
    expected = mujoco.MjModel.from_xml_path(str(tmp_path / "r.xml"))
    hx.convert(source, tmp_path / "r.mjz")
    found = mujoco.MjSpec.from_file(str(alone(tmp_path / "r.mjz"))).compile()
    assert (found.mesh_vert == expected.mesh_vert).all()
    assert (found.tex_data == expected.tex_data).all()
    assert found.ntex == 1


def test_equal_robots_are_equal_archives(source: Path, tmp_path: Path) -> None:
    for name in ("a.mjz", "b.mjz"):
        hx.convert(source, tmp_path / name)
    assert (tmp_path / "a.mjz").read_bytes() == (tmp_path / "b.mjz").read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.mjz", "b.mjz", "source"]


@pytest.mark.parametrize("name", ["r.mjz", "r.urdf.zip", "r.sdf.zip"])
def test_the_engines_read_what_is_in_an_archive(name: str, source: Path, tmp_path: Path) -> None:
    hx.convert(source, tmp_path / name)
    assert hx.verify(source, tmp_path / name).is_same


def test_what_is_kept_lies_in_the_archive(tmp_path: Path) -> None:
    (tmp_path / "source").mkdir()
    source = tmp_path / "source" / "r.xml"
    source.write_text('<mujoco model="r"><option gravity="0 0 -1"/><worldbody><body><geom size="1"/></body></worldbody></mujoco>')
    hx.convert(source, tmp_path / "r.urdf.zip", keep="beside")
    moved = alone(tmp_path / "r.urdf.zip")
    with zipfile.ZipFile(moved) as archive:
        assert archive.namelist() == ["model.urdf", "model.urdf.keep.hymeko"]
    hx.convert(moved, tmp_path / "home.xml")
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "home.xml")).opt.gravity[2] == -1


def test_one_of_several_robots_is_named_by_its_path(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "two.zip", "w") as archive:
        for name in ("left.urdf", "right.urdf"):
            archive.writestr(f"arms/{name}", f'<robot name="{name[:-5]}"><link name="base"/></robot>')
    assert hx.load(tmp_path / "two.zip" / "arms" / "left.urdf").mechanism.name == "left"
    with pytest.raises(Refusal, match=r"several robots: arms/left.urdf, arms/right.urdf") as found:
        hx.load(tmp_path / "two.zip")
    assert found.value.diagnostic.hint == f"{tmp_path}/two.zip/arms/left.urdf names one"


def test_archives_of_others_are_read_like_folders(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "arm.zip", "w") as archive:
        for name, data in (("arm/meshes/part.obj", "v 0 0 0\n"), ("arm/package.xml", "<package/>"), ("arm/urdf/arm.urdf", URDF)):
            archive.writestr(name, data.replace("package://arm_description/meshes/", "../meshes/"))
    robot = hx.load(tmp_path / "arm.zip")
    assert robot.files.find("../meshes/part.obj") == f"{tmp_path}/arm.zip/arm/meshes/part.obj"
    assert robot.files.find("../../../arm.zip") is None


@pytest.mark.parametrize("data", [b"", b"PK\x03\x04 and nothing more"])
def test_a_damaged_archive_is_refused(data: bytes, tmp_path: Path) -> None:
    (tmp_path / "bad.mjz").write_bytes(data)
    with pytest.raises(Refusal, match="the archive has no file of a robot, or is damaged"):
        hx.load(tmp_path / "bad.mjz")


def test_no_name_in_an_archive_leads_out_of_it(tmp_path: Path) -> None:
    (tmp_path / "secret.stl").write_text("solid secret")
    for inner in ("in", "in/deep"):
        (tmp_path / inner).mkdir()
    with zipfile.ZipFile(tmp_path / "in" / "r.zip", "w") as archive:
        archive.writestr("r.urdf", '<robot name="r"><link name="base"/></robot>')
        archive.writestr("../../evil.urdf", '<robot name="evil"/>')
        archive.writestr("/tmp/evil.urdf", '<robot name="evil"/>')
    robot = hx.load(tmp_path / "in" / "r.zip", confine=tmp_path / "in")
    assert robot.files.find("../../secret.stl") is None
    assert hx.verify(tmp_path / "in" / "r.zip", tmp_path / "in" / "r.zip").is_same
    assert not list(tmp_path.rglob("evil*"))
    with pytest.raises(Refusal, match="to which reading is confined"):
        hx.load(tmp_path / "in" / "r.zip", confine=tmp_path / "in" / "deep")


def test_files_go_where_the_output_has_a_place_for_them(source: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ValueError, match="everything is packed into one file: name the output r.mjz"):
        hx.convert(source, tmp_path / "r.xml", assets="pack")
    assert cli.main(["convert", str(source), str(tmp_path / "r.usda"), "--assets", "pack"]) == 2
    assert "name the output r.usdz" in capsys.readouterr().err
    assert cli.main(["convert", str(source), str(tmp_path / "r.mjz"), "--assets", "copy"]) == 2
    assert "r.mjz holds the files that it refers to: they cannot be copied beside it" in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["source"]


def test_several_robots_become_an_archive_each(source: Path, tmp_path: Path) -> None:
    second = shutil.copy(source, source.with_name("second.urdf"))
    assert cli.main(["convert", str(source), str(second), "--to", "mjcf", "--assets", "pack", "-o", f"{tmp_path}/out/"]) == 0
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["r.mjz", "second.mjz"]


def test_an_archive_with_damaged_data_is_refused(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "r.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("r.urdf", '<robot name="r">' + '<link name="base"/>' * 50 + "</robot>")
    data = bytearray((tmp_path / "r.zip").read_bytes())
    data[40:60] = bytes(20)
    (tmp_path / "r.zip").write_bytes(data)
    for use in (hx.load, lambda path: hx.verify(path, path)):
        with pytest.raises(Refusal):
            use(tmp_path / "r.zip")
