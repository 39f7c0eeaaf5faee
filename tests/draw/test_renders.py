"""The bar of pictures (benchmarks/renders.py): it finds a mirrored mesh, a wrong colour and a lost texture, and real robots pass it."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from benchmarks import renders
from hymeko_x import api, codes, formats
from hymeko_x.diagnostics import Refusal
from hymeko_x.draw.pair import Subject, pair
from hymeko_x.draw.render import PictureOptions, choose_backend
from hymeko_x.robot import Robot

OPTIONS = PictureOptions((240, 180))
FOOT = """v 0 0 0
v 0.4 0 0
v 0.4 0.1 0
v 0 0.3 0
v 0 0 0.2
v 0.4 0 0.1
v 0.4 0.1 0.1
v 0 0.3 0.2
vt 0 0
vt 1 0
vt 1 1
vt 0 1
f 4/4 3/3 2/2 1/1
f 5/1 6/2 7/3 8/4
f 1/1 2/2 6/3 5/4
f 2/1 3/2 7/3 6/4
f 3/1 4/2 8/3 7/4
f 4/1 1/2 5/3 8/4
"""
LEG = """<mujoco model="leg"><asset>
  <texture name="bark" type="2d" file="bark.png"/><material name="bark" texture="bark"/>
  <mesh name="foot" file="foot.obj"/></asset>
<worldbody><body name="leg"><geom type="box" size="0.05 0.05 0.2" pos="0.05 0.05 0.4" rgba="0.8 0.3 0.1 1" contype="0" conaffinity="0"/>
  <geom type="mesh" mesh="foot" material="bark" contype="0" conaffinity="0"/></body></worldbody></mujoco>"""


@pytest.fixture
def leg(tmp_path: Path) -> Path:
    """A leg whose foot has no symmetry and shows an image."""
    choose_backend()
    (tmp_path / "foot.obj").write_text(FOOT)
    bark = np.zeros((16, 16, 3), np.uint8)
    bark[:8, :8], bark[8:, 8:] = (60, 160, 60), (200, 200, 60)
    Image.fromarray(bark).save(tmp_path / "bark.png")
    (tmp_path / "leg.xml").write_text(LEG)
    try:
        changed(tmp_path / "leg.xml", tmp_path / "leg.xml")
    except Refusal as refusal:
        if refusal.diagnostic.code == codes.CANNOT_DRAW:
            pytest.skip(refusal.diagnostic.message)
        raise
    return tmp_path / "leg.xml"


def changed(a: Path, b: Path) -> float:
    """The part of the pixels in which two robots differ that MuJoCo reads itself."""
    first, second = (Subject(Robot.__new__(Robot), str(path)) for path in (a, b))
    return pair(first, second, OPTIONS).changed


@pytest.mark.parametrize(
    "fault",
    [
        ('file="foot.obj"', 'file="foot.obj" scale="1 -1 1"'),
        ("0.8 0.3 0.1", "0.1 0.3 0.8"),
        ('name="bark" texture="bark"', 'name="bark"'),
    ],
    ids=["mirrored mesh", "wrong colour", "lost texture"],
)
def test_a_fault_in_the_appearance_is_found(fault: tuple[str, str], leg: Path) -> None:
    assert fault[0] in LEG
    other = leg.with_name("other.xml")
    other.write_text(LEG.replace(*fault))
    assert changed(leg, leg) == 0.0
    assert changed(leg, other) > renders.CHANGED


@pytest.mark.parametrize(
    ("written", "fault"),
    [
        (r'(foot\.obj")', r'\1 scale="1 -1 1"'),
        ('rgba="0.8 0.3 0.1 1"', 'rgba="0.1 0.3 0.8 1"'),
        ("<texture [^>]*>", ""),
    ],
    ids=["mirrored mesh", "wrong colour", "lost texture"],
)
def test_a_fault_of_a_writer_is_found(written: str, fault: str, leg: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def spoil(file: Path) -> None:
        text, count = re.subn(written, fault, file.read_text())
        assert count
        file.write_text(text)

    assert faults_of(leg, "urdf", spoil, monkeypatch) == ["urdf differs by"]


@pytest.mark.unread("HX201")
def test_a_mesh_that_does_not_go_along_is_found(leg: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    api.dump(api.load(leg), leg.with_name("leg.urdf"), "urdf")

    def spoil(file: Path) -> None:
        (mesh,) = file.parent.rglob("*.obj")
        mesh.unlink()

    assert faults_of(leg.with_name("leg.urdf"), "xacro", spoil, monkeypatch) == ["xacro differs by"]


def faults_of(robot: Path, target: str, spoil: Callable[[Path], None], monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The faults, without their numbers, of a robot whose conversion into a format is spoiled."""
    dump = api.dump

    def dumped(robot: Robot, file: Path, format: str, **options: Any) -> None:
        dump(robot, file, format, **options)
        if format == target:
            spoil(file)

    monkeypatch.setattr(api, "dump", dumped)
    found = renders.drawn(str(robot), targets=(formats.by_name(target),))
    assert (found.reason, found.failed) == ("", {})
    return [" ".join(fault.split()[:3]) for fault in found.faults]


def test_a_robot_with_mesh_and_texture_has_its_picture_in_every_format(leg: Path) -> None:
    found = renders.drawn(str(leg))
    assert (found.reason, found.failed, found.faults) == ("", {}, [])
    assert {*found.changed} >= {"urdf", "hymeko", "usd", "sdf"}


def test_the_bar_names_what_is_wrong() -> None:
    found = renders.Drawn("a.urdf", 0.2, 10, changed={"usd": 0.02, "sdf": 0.001}, failed={"mjcf": "HX302: no"})
    assert found.faults == ["fills 0.20", "is black", "usd differs by 2.00 %", "mjcf has no picture, HX302: no"]
    assert renders.line(found) == "  FAIL a.urdf: fills 0.20, differs by % usd 2.00 sdf 0.10; mjcf: HX302: no"
    assert renders.line(renders.Drawn("c.urdf", reason="exit -11: ")) == "  FAIL c.urdf: exit -11: "
    assert renders.line(renders.Drawn("b.urdf", reason="HX501: no")) == "  --   b.urdf: HX501: no"


@pytest.mark.full
@pytest.mark.corpus
def test_real_robots_have_their_pictures_in_every_format() -> None:
    robots = renders.development_robots(16)
    if not robots:
        pytest.skip("no package of the catalogue is here; `hymeko-x corpus fetch` brings them")
    found = [renders.apart(path, None) for path in robots]
    assert [renders.line(one) for one in found if renders.unknown(one)] == []
    assert any(one.changed for one in found)


def through_urdf(body: str, folder: Path) -> float:
    """The part of the pixels in which a robot of this body in MJCF differs from its conversion to URDF."""
    (folder / "a.xml").write_text(f"<mujoco><worldbody>{body}</worldbody></mujoco>")
    robot = api.load(folder / "a.xml")
    api.dump(robot, folder / "a.urdf", "urdf")
    return pair(Subject(robot, str(folder / "a.xml")), Subject(api.load(folder / "a.urdf"), None), OPTIONS).changed


def test_a_joint_with_a_reference_is_drawn_where_it_is_in_the_first_robot(tmp_path: Path) -> None:
    joint = '<joint name="up" type="slide" axis="0 0 1" ref="0.5"/>'
    body = f'<body name="b" pos="0 0 0.5">{joint}<geom type="box" size="0.1 0.2 0.1" mass="1" rgba="0.8 0.1 0.1 1"/></body>'
    assert through_urdf(body, tmp_path) < renders.CHANGED


def test_an_ellipsoid_looks_the_same_as_a_mesh_of_urdf(tmp_path: Path) -> None:
    body = '<body name="egg"><geom type="ellipsoid" size="0.1 0.2 0.4" mass="1" rgba="0 0.5 0.5 1"/></body>'
    assert through_urdf(body, tmp_path) < renders.CHANGED


SKINNED = """<mujoco model="r"><default><geom contype="0" conaffinity="0"/></default>
<asset><mesh name="bone" vertex="0 0 0  0.3 0 0  0 0.1 0  0 0 0.4"/>
  <skin name="s" vertex="0 0 0  0.3 0 0  0 0.1 0" face="0 1 2" texcoord="0 0  1 0  1 1">
  <bone body="b" bindpos="0 0 0" bindquat="1 0 0 0" vertid="0 1 2" vertweight="1 1 1"/></skin></asset>
<worldbody><body name="b" pos="0 0 1"><freejoint/><geom size="0.02" pos="0.1 0 0.3" mass="1"/>
  <geom type="mesh" mesh="bone" group="5" rgba="0.5 0.5 0.5 1"/></body></worldbody></mujoco>"""


@pytest.mark.full
def test_bones_below_a_skin_are_compared(tmp_path: Path) -> None:
    (tmp_path / "r.xml").write_text(SKINNED)
    found = renders.drawn(str(tmp_path / "r.xml"))
    assert (found.reason, found.failed, found.faults) == ("", {}, [])


TIED = """<mujoco model="r"><worldbody><body name="b" pos="0 0 1"><joint name="j" axis="0 1 0"/>
  <geom type="box" size="0.2 0.1 0.1" mass="1"/><site name="s" pos="0.2 0 0.1"/></body><site name="t" pos="0.6 0.3 1.6"/></worldbody>
<tendon><spatial name="cable" width="0.03" rgba="0.9 0.1 0.1 1"><site site="s"/><site site="t"/></spatial></tendon></mujoco>"""


@pytest.mark.full
def test_a_robot_with_a_cable_is_compared_without_it_in_formats_that_have_no_tendons(tmp_path: Path) -> None:
    (tmp_path / "r.xml").write_text(TIED)
    found = renders.drawn(str(tmp_path / "r.xml"))
    assert (found.reason, found.failed, found.faults) == ("", {}, [])
    assert {*found.changed} >= renders.WITHOUT_TENDONS


def test_a_lost_cable_is_found(tmp_path: Path) -> None:
    (tmp_path / "r.xml").write_text(TIED)
    (tmp_path / "other.xml").write_text(TIED[: TIED.index("<tendon>")] + "</mujoco>")
    assert changed(tmp_path / "r.xml", tmp_path / "other.xml") > renders.CHANGED


def test_an_interrupted_run_goes_on_where_it_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[str] = []

    def one(path: str, _pictures: Path | None, _seconds: float) -> renders.Drawn:
        if path == "c":
            raise KeyboardInterrupt
        drawn.append(path)
        return renders.Drawn(path, 0.5, 200, reason="took more than 1 s" if path == "b" and drawn.count("b") == 1 else "")

    monkeypatch.setattr(renders, "apart", one)
    chosen = argparse.Namespace(output=tmp_path / "renders.json", resume=True, pictures=None, seconds=1.0)
    with pytest.raises(KeyboardInterrupt):
        renders.run(["a", "b", "c", "d"], chosen)
    assert [found.path for found in renders.run(["a", "b", "d"], chosen)] == ["a", "b", "d"]
    assert drawn == ["a", "b", "b", "d"]  # the one that took too long is drawn again


WOODEN = """<mujoco model="r"><asset><texture name="wood" type="cube" file="wood.png"/><material name="wood" texture="wood"/></asset>
<worldbody><body name="b" pos="0 0 1"><freejoint/><geom type="box" size="0.2 0.3 0.4" material="wood"/></body></worldbody></mujoco>"""


@pytest.mark.full
def test_an_image_on_the_sides_of_a_box_is_there_in_every_format(tmp_path: Path) -> None:
    wood = np.zeros((32, 32, 3), np.uint8)
    wood[:16, :16], wood[16:, :16], wood[16:, 16:] = (60, 160, 60), (200, 200, 60), (160, 60, 60)
    Image.fromarray(wood).save(tmp_path / "wood.png")
    (tmp_path / "r.xml").write_text(WOODEN)
    found = renders.drawn(str(tmp_path / "r.xml"))
    assert (found.reason, found.failed, found.faults) == ("", {}, [])


TERRAIN = """<mujoco model="r"><asset><hfield name="hills" nrow="3" ncol="3" size="5 5 1 0.1" elevation="0 0 0 0 1 0 0 0 0"/></asset>
<worldbody><geom type="hfield" hfield="hills" pos="0 0 -2"/><body name="b" pos="0 0 1"><freejoint/>
<geom type="box" size="0.2 0.3 0.4"/><site name="eye" pos="0.3 0 0.5" zaxis="1 0 -1"/></body></worldbody>
<sensor><rangefinder name="far" site="eye"/></sensor></mujoco>"""


@pytest.mark.unread("HX104")
def test_a_robot_is_compared_without_its_terrain_and_the_rays_of_its_sensors(tmp_path: Path) -> None:
    (tmp_path / "r.xml").write_text(TERRAIN)
    found = renders.drawn(str(tmp_path / "r.xml"), targets=(formats.by_name("urdf"),))
    assert (found.reason, found.failed, found.faults) == ("", {}, [])


MARKED = """<mujoco model="r"><asset><texture name="t" type="cube" builtin="flat" mark="cross" width="127" rgb1="0.8 0.6 0.4"
  rgb2="0.8 0.6 0.4" markrgb="1 1 1"/><material name="m" texture="t"/></asset>
<worldbody><body name="b" pos="0 0 1"><freejoint/><geom type="sphere" size="0.3" material="m"/></body></worldbody></mujoco>"""


def test_a_robot_is_compared_without_the_marks_and_the_gloss_of_its_patterns(tmp_path: Path) -> None:
    (tmp_path / "r.xml").write_text(MARKED)
    found = renders.drawn(str(tmp_path / "r.xml"), targets=(formats.by_name("urdf"),))
    assert (found.reason, found.failed, found.faults) == ("", {}, [])
