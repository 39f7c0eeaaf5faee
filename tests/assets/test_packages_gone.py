"""``package://`` on the way home when the package is gone: its files stand in a folder of its name, where the reference finds them."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pinocchio
import pytest
import yourdfpy

import hymeko_x as hx
from hymeko_x.assets.companions import companions_of
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.corpus.catalog import DevelopmentFile, development_files
from hymeko_x.residue.originals import files_named
from tests.assets.test_companions import OBJ
from tests.assets.test_originals import png
from tests.conftest import RealRobots
from tests.meshes.test_mesh import STL
from tests.residue.test_real_robots import SUFFIXES

MODEL = """<sdf version="1.9"><model name="arm"><link name="base"><visual name="v"><geometry><mesh><uri>model://arm/meshes/part.obj</uri></mesh>
</geometry></visual></link></model></sdf>"""
MESHES = ("meshes/part.obj", "meshes/sub/tip.STL")
LINK = """<link name="base">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="package://arm_description/meshes/part.obj"/></geometry></visual>
    <collision><geometry><mesh filename="package://arm_description/meshes/sub/tip.STL"/></geometry></collision>
  </link>"""
URDF = f'<robot name="arm">\n  {LINK}\n</robot>\n'
XACRO = f'<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="arm">\n  {LINK}\n</robot>\n'
OUTPUTS = {
    "urdf": "r.urdf", "xacro": "r.urdf.xacro", "mjcf": "r.xml", "usd": "r.usda", "usdz": "r.usdz", "sdf": "r.sdf", "hymeko": "r.hymeko",
}  # fmt: skip
LEGS = [(text, home, through) for text, home in ((URDF, "urdf"), (XACRO, "xacro")) for through in OUTPUTS if through != home]


def package(folder: Path, text: str, name: str) -> Path:
    """A package of ROS with a robot whose meshes have materials, an image, and a suffix in capitals."""
    for below in ("urdf", "meshes/images", "meshes/sub"):
        (folder / below).mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>arm_description</name></package>")
    (folder / "meshes" / "part.obj").write_text(OBJ)
    (folder / "meshes" / "part.mtl").write_text("newmtl skin\nKd 1 0 0\nmap_Kd images/skin.png\n")
    (folder / "meshes" / "images" / "skin.png").write_bytes(png(77))
    (folder / "meshes" / "sub" / "tip.STL").write_bytes(STL)
    (folder / "urdf" / name).write_text(text)
    return folder / "urdf" / name


@pytest.mark.filterwarnings("ignore:`Scene.dump:DeprecationWarning")  # yourdfpy calls it
@pytest.mark.parametrize(("text", "home", "through"), LEGS, ids=[f"{home}-{through}" for _, home, through in LEGS])
def test_every_file_comes_home_where_the_reference_finds_it(
    text: str, home: str, through: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = package(tmp_path / "source", text, OUTPUTS[home])
    contents = {path.relative_to(tmp_path / "source"): path.read_bytes() for path in (tmp_path / "source" / "meshes").rglob("*.*")}
    for place in ("away", "back"):
        (tmp_path / place).mkdir()
    hx.convert(source, tmp_path / "away" / OUTPUTS[through], keep="beside")
    shutil.rmtree(tmp_path / "source")
    hx.convert(tmp_path / "away" / OUTPUTS[through], tmp_path / "back" / OUTPUTS[home])
    shutil.rmtree(tmp_path / "away")
    there = tmp_path / "back" / "arm_description"
    assert {path.relative_to(there): path.read_bytes() for path in there.rglob("*.*")} == contents
    assert [(tmp_path / "back" / OUTPUTS[home]).read_text().count(f"package://arm_description/{name}") for name in MESHES] == [1, 1]
    if home == "urdf":
        monkeypatch.chdir(tmp_path / "back")
        assert meshes_of(Path("r.urdf")) == (2, 2)


def meshes_of(robot: Path) -> tuple[int, int]:
    """How many meshes Pinocchio and yourdfpy load of a robot in URDF, the working folder being the one that has packages."""
    model = pinocchio.buildModelFromUrdf(str(robot))
    kinds = (pinocchio.GeometryType.VISUAL, pinocchio.GeometryType.COLLISION)
    found = [pinocchio.buildGeomFromUrdf(model, str(robot), kind, package_dirs=["."]) for kind in kinds]
    loaded = yourdfpy.URDF.load(str(robot), build_collision_scene_graph=True, load_collision_meshes=True)
    scenes = len(loaded.scene.geometry) + len(loaded.collision_scene.geometry)
    return sum(item.meshPath != "" for each in found for item in each.geometryObjects), scenes


@pytest.mark.filterwarnings("ignore:`Scene.dump:DeprecationWarning")
def test_without_originals_a_mesh_of_the_stage_stands_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = package(tmp_path / "source", URDF, "r.urdf")
    for place in ("away", "back"):
        (tmp_path / place).mkdir()
    hx.convert(source, tmp_path / "away" / "r.usda", keep="inside")
    shutil.rmtree(tmp_path / "source")
    result = hx.convert(tmp_path / "away" / "r.usda", tmp_path / "back" / "r.urdf")
    assert sum("becomes the points that the source has of it" in diagnostic.message for diagnostic in result.report) == 2
    monkeypatch.chdir(tmp_path / "back")
    assert meshes_of(Path("r.urdf")) == (2, 2)


@pytest.mark.filterwarnings("ignore:`Scene.dump:DeprecationWarning")
@pytest.mark.parametrize("target", ["r.urdf", "r.urdf.xacro"])
def test_files_of_a_model_of_gazebo_stand_beside_a_robot_for_ros(target: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "arm" / "meshes").mkdir(parents=True)
    (tmp_path / "out").mkdir()
    (tmp_path / "arm" / "meshes" / "part.obj").write_text(OBJ)
    (tmp_path / "arm" / "model.sdf").write_text(MODEL)
    hx.convert(tmp_path / "arm" / "model.sdf", tmp_path / "out" / target)
    hx.convert(tmp_path / "arm" / "model.sdf", tmp_path / "out" / "r.sdf")
    assert 'filename="meshes/part.obj"' in (tmp_path / "out" / target).read_text()
    assert "model://arm/meshes/part.obj" in (tmp_path / "out" / "r.sdf").read_text()
    if target == "r.urdf":
        monkeypatch.chdir(tmp_path / "out")
        assert meshes_of(Path("r.urdf")) == (1, 1)


def test_a_package_that_is_there_is_referred_to_and_not_copied(tmp_path: Path) -> None:
    source = package(tmp_path / "source", URDF, "r.urdf")
    for place in ("away", "back"):
        (tmp_path / place).mkdir()
    hx.convert(source, tmp_path / "away" / "r.xml", keep="beside")
    hx.convert(tmp_path / "away" / "r.xml", tmp_path / "back" / "r.urdf", packages={"arm_description": tmp_path / "source"})
    assert [path.name for path in (tmp_path / "back").iterdir()] == ["r.urdf"]
    assert 'filename="package://arm_description/meshes/part.obj"' in (tmp_path / "back" / "r.urdf").read_text()


def test_a_robot_that_comes_home_into_its_package_finds_its_files_there(tmp_path: Path) -> None:
    source = package(tmp_path / "source", URDF, "r.urdf")
    (tmp_path / "away").mkdir()
    hx.convert(source, tmp_path / "away" / "r.xml", keep="beside")
    hx.convert(tmp_path / "away" / "r.xml", source)
    assert [path.name for path in source.parent.iterdir()] == ["r.urdf"]


def test_paths_from_the_working_folder_find_what_meshes_refer_to(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = URDF.replace("package://arm_description/", "../")
    package(tmp_path / "source", text, "r.urdf")
    (tmp_path / "away").mkdir()
    monkeypatch.chdir(tmp_path)
    hx.convert("source/urdf/r.urdf", "away/r.urdf")
    assert sorted(path.name for path in (tmp_path / "away").rglob("*.*")) == ["part.mtl", "part.obj", "r.urdf", "skin.png", "tip.stl"]


# ---- real robots -----------------------------------------------------------------------------------------------------------------


FILES = [file for format in SUFFIXES for file in development_files(format)]


def contents_of(robot: Path, format: str) -> dict[tuple[str, str], bytes]:
    """What the robot refers to, by element and, for what its mesh files refer to, by the path from there."""
    files, found = DiskFiles(robot.parent), {}
    for key, uri in files_named(hx.load(robot, format).mechanism):
        path = files.find(uri)
        if path is not None:
            found[str(key), ""] = files.read(path)
            found |= {(str(key), name): files.read(there) for name, there in companions_of(uri, path, files)}
    return found


def assert_files_come_home(file: DevelopmentFile, root: Path, through: str, folder: Path) -> None:
    shutil.copytree(root, folder / "source", copy_function=os.link)
    before = contents_of(folder / "source" / file.path, file.format)
    for place in ("away", "back"):
        (folder / place).mkdir()
    away, back = folder / "away" / f"r{SUFFIXES[through]}", folder / "back" / f"r{SUFFIXES[file.format]}"
    hx.convert(folder / "source" / file.path, away, from_format=file.format, to_format=through, keep="beside")
    shutil.rmtree(folder / "source")
    hx.convert(away, back, from_format=through, to_format=file.format)
    shutil.rmtree(folder / "away")
    after = contents_of(back, file.format)
    assert [key for key, data in before.items() if after.get(key) != data] == []


@pytest.mark.corpus
@pytest.mark.full
@pytest.mark.parametrize("through", SUFFIXES)
@pytest.mark.parametrize("file", FILES[::6], ids=lambda file: file.id)
def test_every_file_of_a_real_robot_comes_home(file: DevelopmentFile, through: str, real_robot: RealRobots, tmp_path: Path) -> None:
    if through == file.format:
        pytest.skip("not another format")
    assert_files_come_home(file, real_robot.package(file.package), through, tmp_path)
