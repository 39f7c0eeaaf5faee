"""No false alarm, no break and no false peace: actuators with several controls, far masses, polygons, and meshes that are gone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
import trimesh

import hymeko_x as hx
from hymeko_x.verify.checks import inertia
from hymeko_x.verify.checks.inertia import combined, moved

if TYPE_CHECKING:
    from pathlib import Path

ACTUATORS = """<mujoco><worldbody><body name="a"><joint type="ball" name="j"/><geom size="1"/></body>
<body name="b"><joint name="k"/><geom size="1"/></body></worldbody>
<actuator><orientation joint="j" name="turn" kp="{kp}"/>
<motor joint="k" name="m" ctrlrange="-1 {upper}" ctrllimited="true"/></actuator></mujoco>"""


@pytest.mark.parametrize(
    ("changed", "verdict"), [({}, "same"), ({"upper": 3}, "different"), ({"kp": 7}, "different")], ids=["same", "range", "gain"]
)
def test_actuators_with_several_controls_are_compared(changed: dict[str, int], verdict: str, tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text(ACTUATORS.format(upper=2, kp=5))
    (tmp_path / "b.xml").write_text(ACTUATORS.format(**{"upper": 2, "kp": 5, **changed}))
    assert hx.verify(tmp_path / "a.xml", tmp_path / "b.xml").verdict == verdict


def test_the_rounding_of_far_masses_is_no_difference() -> None:
    """The tensor of two bodies 333 m apart, summed up in frames that are as far away."""
    parts = [(1.0, np.zeros(3), np.eye(3)), (1.3, np.array([200.1, 233.3, 133.7]), np.eye(3) * 1e-3)]
    place = np.eye(4)
    place[:3, 3] = 1e3 / 3, -2e3 / 3, 1e4 / 7
    whole, far = combined(parts), combined([moved(part, place) for part in parts])
    difference = float(np.abs(whole[2] - far[2]).max())
    assert difference <= inertia.RELATIVE * whole[0] * float(far[1] @ far[1])


CONCAVE = """v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 0.2 0\nv 0 4 0\nv 2 2 2
f 5 4 3 2 1\nf 1 2 6\nf 2 3 6\nf 3 4 6\nf 4 5 6\nf 5 1 6\n"""
URDF = """<robot name="r"><link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><mesh filename="{0}"/></geometry></visual>
<collision><geometry><mesh filename="{0}"/></geometry></collision></link></robot>"""


def test_that_readers_split_the_polygons_of_one_file_otherwise_is_no_difference(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text(CONCAVE)
    (tmp_path / "r.urdf").write_text(URDF.format("a.obj"))
    hx.convert(tmp_path / "r.urdf", tmp_path / "r.xml")
    assert hx.verify(tmp_path / "r.urdf", tmp_path / "r.xml").verdict == "same"
    other = tmp_path / "other"
    other.mkdir()
    (other / "a.obj").write_text(CONCAVE.replace("v 2 0.2 0", "v 2 3 0"))
    (other / "r.xml").write_text((tmp_path / "r.xml").read_text().replace("meshes/", ""))
    assert hx.verify(tmp_path / "r.urdf", other / "r.xml").verdict == "different"


@pytest.mark.unread("HX201")
def test_a_robot_without_its_shapes_is_not_called_the_same(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(URDF.format("gone.stl"))
    hx.convert(tmp_path / "r.urdf", tmp_path / "r.xml")
    verdict = hx.verify(tmp_path / "r.urdf", tmp_path / "r.xml")
    assert verdict.verdict != "same"
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "gone.stl")
    assert hx.verify(tmp_path / "r.urdf", tmp_path / "r.xml").verdict == "different"


def test_a_thin_solid_stands_for_a_flat_mesh_that_collides_where_it_is_as_near(tmp_path: Path) -> None:
    trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]]).export(tmp_path / "flat.stl")
    (tmp_path / "r.urdf").write_text(URDF.format("flat.stl"))
    hx.convert(tmp_path / "r.urdf", tmp_path / "r.xml")
    found = hx.verify(tmp_path / "r.urdf", tmp_path / "r.xml")
    assert (found.verdict, [gap.quantity for gap in found.gaps]) == ("same as far as mjcf can say", ["collision meshes without volume"])
    text = (tmp_path / "r.xml").read_text()
    (tmp_path / "r.xml").write_text(text.replace('<mesh name="flat"', '<mesh name="flat" scale="1.001 1 1"'))
    assert "collision meshes" in str(hx.verify(tmp_path / "r.urdf", tmp_path / "r.xml").failed)
