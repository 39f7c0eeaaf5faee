"""Files that only the way home needs are kept beside the output, and come home as they were."""

from __future__ import annotations

import shutil
import struct
import zlib
from pathlib import Path
from typing import Literal

import mujoco
import numpy as np
import pytest

import hymeko_x as hx
from hymeko_x.cli import exits, main
from hymeko_x.residue.originals import kept_name
from tests.mjcf.mjmodels import differences

TETRAHEDRON = "v 0 0 0\nv 0.1 0 0\nv 0 0.2 0\nv 0 0 0.3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
QUAD = "v 0 0 0\nv 1 0 0\nv 1 1 0.1\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n" + (
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"
)
MODEL = """<mujoco model="files">
  <compiler meshdir="../parts" texturedir="images" angle="radian"/>
  <asset>
    <mesh name="used" file="tet.obj" scale="1 2 1" refpos="0.01 0.02 0.03" refquat="1 1 0 0"/>
    <mesh name="bent" file="bent.obj"/>
    <mesh name="unused" file="spare.obj"/>
    <hfield name="ground" file="ground.bin" size="1 1 0.2 0.1"/>
    <texture name="sky" type="skybox" fileright="a.png" fileleft="b.png" fileup="a.png" filedown="a.png" filefront="a.png"
             fileback="b.png"/>
    <texture name="spare" type="2d" file="b.png"/>
    <texture name="skin" type="2d" file="a.png"/>
    <material name="skin" texture="skin"/>
    <skin name="hide" file="hide.skn"/>
  </asset>
  <worldbody>
    <geom type="hfield" hfield="ground"/>
    <body name="link"><freejoint/><geom type="mesh" mesh="used" material="skin"/><geom type="mesh" mesh="bent" pos="0 0 1"/></body>
  </worldbody>
</mujoco>
"""


def png(grey: int) -> bytes:
    """A picture of 2 x 2 points of one colour."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = (b"\0" + bytes([grey, grey, grey] * 2)) * 2
    head = chunk(b"IHDR", struct.pack(">IIBBBBB", 2, 2, 8, 2, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + head + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def skin() -> bytes:
    """A skin of one triangle on the body ``link``."""
    vertices, faces = np.eye(3, dtype="<f4"), np.array([[0, 1, 2]], "<i4")
    bone = b"link".ljust(40, b"\0") + np.array([0, 0, 0, 1, 0, 0, 0], "<f4").tobytes() + np.array([3], "<i4").tobytes()
    bone += np.array([0, 1, 2], "<i4").tobytes() + np.ones(3, "<f4").tobytes()
    return np.array([3, 0, 1, 1], "<i4").tobytes() + vertices.tobytes() + faces.tobytes() + bone


def home(folder: Path) -> Path:
    """A model whose files are beside it, and in a folder beside its own."""
    for name in ("home/images", "parts"):
        (folder / name).mkdir(parents=True)
    (folder / "home" / "robot.xml").write_text(MODEL)
    (folder / "parts" / "tet.obj").write_text(TETRAHEDRON)
    (folder / "parts" / "spare.obj").write_text(TETRAHEDRON)
    (folder / "parts" / "bent.obj").write_text(QUAD)
    (folder / "parts" / "hide.skn").write_bytes(skin())
    (folder / "parts" / "ground.bin").write_bytes(np.array([2, 2], "<i4").tobytes() + np.array([0, 0.5, 1, 0.2], "<f4").tobytes())
    (folder / "home" / "images" / "a.png").write_bytes(png(10))
    (folder / "home" / "images" / "b.png").write_bytes(png(200))
    return folder / "home" / "robot.xml"


@pytest.mark.parametrize("through", ["robot.urdf", "robot.usda", "robot.usdz", "robot.sdf", "robot.hymeko", "robot.urdf.xacro"])
@pytest.mark.unread("HX104")
def test_every_file_of_the_source_comes_home_when_the_source_is_gone(through: str, tmp_path: Path) -> None:
    source = home(tmp_path)
    before = mujoco.MjModel.from_xml_path(str(source))
    for place in ("away", "back"):
        (tmp_path / "further" / place).mkdir(parents=True)
    hx.convert(source, tmp_path / "further" / "away" / through, keep="beside")
    shutil.rmtree(source.parent)
    shutil.rmtree(tmp_path / "parts")
    hx.convert(tmp_path / "further" / "away" / through, tmp_path / "further" / "back" / "robot.xml")
    shutil.rmtree(tmp_path / "further" / "away")
    assert differences(before, mujoco.MjModel.from_xml_path(str(tmp_path / "further" / "back" / "robot.xml"))) == []


@pytest.mark.parametrize("through", ["robot.urdf", "robot.usda", "robot.usdz", "robot.sdf"])
@pytest.mark.unread("HX104")
def test_what_is_kept_inside_has_beside_it_only_files_for_which_nothing_stands_in(through: str, tmp_path: Path) -> None:
    source = home(tmp_path)
    for place in ("away", "back"):
        (tmp_path / place).mkdir()
    hx.convert(source, tmp_path / "away" / through, keep="inside")
    kept = [path.name for path in (tmp_path / "away" / f"{through}.keep.files").rglob("*") if path.is_file()]
    assert {"bent.obj", "tet.obj"}.isdisjoint(kept)
    assert {"ground.bin", "hide.skn", "spare.obj"} <= set(kept)
    shutil.rmtree(source.parent)
    shutil.rmtree(tmp_path / "parts")
    hx.convert(tmp_path / "away" / through, tmp_path / "back" / "robot.xml")
    mujoco.MjModel.from_xml_path(str(tmp_path / "back" / "robot.xml"))


def test_files_of_no_geom_go_along_within_the_format(tmp_path: Path) -> None:
    source = home(tmp_path)
    (tmp_path / "back").mkdir()
    before = mujoco.MjModel.from_xml_path(str(source))
    hx.convert(source, tmp_path / "back" / "robot.xml")
    shutil.rmtree(source.parent)
    shutil.rmtree(tmp_path / "parts")
    assert differences(before, mujoco.MjModel.from_xml_path(str(tmp_path / "back" / "robot.xml"))) == []


def test_originals_of_an_earlier_run_are_removed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = home(tmp_path)
    out = str(tmp_path / "home" / "robot.urdf")
    assert main(["convert", str(source), out, "--keep"]) == exits.DONE
    kept = tmp_path / "home" / "robot.urdf.keep.files"
    assert sorted(path.name for path in kept.rglob("*") if path.is_file()) == [
        "b.png", "bent.obj", "digests.txt", "ground.bin", "hide.skn", "spare.obj", "tet.obj",
    ]  # fmt: skip
    assert "6 originals in robot.urdf.keep.files/" in capsys.readouterr().err
    assert main(["convert", str(source), out]) == exits.DONE
    assert not kept.exists()


@pytest.mark.parametrize(
    ("uri", "name"),
    [
        ("parts/a.stl", "parts/a.stl"),
        ("./parts//a.stl", "parts/a.stl"),
        ("../a.stl", "elsewhere/bd7747d1/a.stl"),
        ("/etc/passwd", "elsewhere/74acf318/etc/passwd"),
        ("package://robot/a.stl", "elsewhere/9ab68e96/robot/a.stl"),
        ("C:\\parts\\..\\a.stl", "elsewhere/d3e237e9/parts/a.stl"),
        ("..", "elsewhere/5ec1f7e7/file"),
    ],
)
def test_an_original_is_named_after_its_reference(uri: str, name: str) -> None:
    assert kept_name(uri) == name


@pytest.mark.parametrize("assets", ["copy", "reference"])
def test_an_exact_text_in_another_folder_refers_to_every_file(assets: Literal["copy", "reference"], tmp_path: Path) -> None:
    source = home(tmp_path)
    for place in ("away", "back"):
        (tmp_path / place).mkdir()
    before = mujoco.MjModel.from_xml_path(str(source))
    result = hx.convert(source, tmp_path / "away" / "robot.hymeko", assets=assets)
    assert [str(found) for found in (*result.report, *(result.losses or ()))] == []
    hx.convert(tmp_path / "away" / "robot.hymeko", tmp_path / "back" / "robot.xml")
    assert differences(before, mujoco.MjModel.from_xml_path(str(tmp_path / "back" / "robot.xml"))) == []


@pytest.mark.parametrize("name", ["robot.urdf", "robot.usda", "robot.sdf", "robot.hymeko"])
@pytest.mark.unread("HX104")
def test_originals_follow_a_conversion_within_the_format(name: str, tmp_path: Path) -> None:
    source = home(tmp_path)
    for place in ("away", "further", "back"):
        (tmp_path / place).mkdir()
    before = mujoco.MjModel.from_xml_path(str(source))
    hx.convert(source, tmp_path / "away" / name, keep="beside")
    hx.convert(tmp_path / "away" / name, tmp_path / "further" / name, keep="beside")
    for place in ("away", "home", "parts"):
        shutil.rmtree(tmp_path / place)
    hx.convert(tmp_path / "further" / name, tmp_path / "back" / "robot.xml")
    assert differences(before, mujoco.MjModel.from_xml_path(str(tmp_path / "back" / "robot.xml"))) == []


@pytest.mark.unread("HX104")
def test_a_kept_file_follows_a_conversion_within_the_format(tmp_path: Path) -> None:
    source = home(tmp_path)
    for place in ("away", "further", "back"):
        (tmp_path / place).mkdir()
    before = mujoco.MjModel.from_xml_path(str(source))
    hx.convert(source, tmp_path / "away" / "robot.urdf", keep="beside")
    hx.convert(tmp_path / "away" / "robot.urdf", tmp_path / "further" / "robot.urdf")
    hx.convert(tmp_path / "further" / "robot.urdf", tmp_path / "further" / "robot.urdf", base="free")
    for place in ("away", "home", "parts"):
        shutil.rmtree(tmp_path / place)
    hx.convert(tmp_path / "further" / "robot.urdf", tmp_path / "back" / "robot.xml")
    assert differences(before, mujoco.MjModel.from_xml_path(str(tmp_path / "back" / "robot.xml"))) == []
