"""MuJoCo leaves polygons of more than 100 corners out of OBJ files: they are written as triangles, and read as MuJoCo reads them."""

from __future__ import annotations

from math import cos, pi, sin
from typing import TYPE_CHECKING

import mujoco
import pytest

import hymeko_x as hx

if TYPE_CHECKING:
    from pathlib import Path

ROBOT = '<robot name="r"><link name="a"><visual><geometry><mesh filename="cone.obj"/></geometry></visual></link></robot>'
MODEL = """<mujoco><asset><mesh name="cone" file="cone.obj"/></asset><worldbody><body name="a"><geom type="mesh" mesh="cone"/></body>
</worldbody></mujoco>"""


def cone(corners: int) -> str:
    """A cone on a polygon of so many corners, which has 2 n - 2 triangles."""
    ring = [f"v {cos(2 * pi * k / corners)!r} {sin(2 * pi * k / corners)!r} 0" for k in range(corners)]
    sides = [f"f {k + 1} {(k + 1) % corners + 1} {corners + 1}" for k in range(corners)]
    base = "f " + " ".join(str(corners - k) for k in range(corners))
    return "\n".join([*ring, "v 0 0 1", *sides, base, ""])


@pytest.mark.parametrize("corners", [100, 101, 128])
def test_the_mesh_of_a_robot_keeps_its_polygons(corners: int, tmp_path: Path) -> None:
    (tmp_path / "cone.obj").write_text(cone(corners), "utf-8")
    (tmp_path / "r.urdf").write_text(ROBOT, "utf-8")
    report = hx.convert(tmp_path / "r.urdf", tmp_path / "r.xml").report
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "r.xml")).mesh_facenum.tolist() == [2 * corners - 2]
    assert hx.verify(tmp_path / "r.urdf", tmp_path / "r.xml", samples=2).is_same
    reasons = [diagnostic.message for diagnostic in report if "more than 100 corners" in diagnostic.message]
    assert len(reasons) == (corners > 100)


@pytest.mark.parametrize("corners", [100, 101])
def test_a_model_of_mujoco_has_what_mujoco_reads(corners: int, tmp_path: Path) -> None:
    (tmp_path / "cone.obj").write_text(cone(corners), "utf-8")
    (tmp_path / "m.xml").write_text(MODEL, "utf-8")
    faces = mujoco.MjModel.from_xml_path(str(tmp_path / "m.xml")).mesh_facenum.tolist()
    assert faces == [198 if corners == 100 else 101]
    hx.convert(tmp_path / "m.xml", tmp_path / "m.urdf")
    assert hx.verify(tmp_path / "m.xml", tmp_path / "m.urdf", samples=2).is_same
