"""`--collision hull|decompose`: concave meshes that collide become convex; what is seen, and what is convex, stays."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x.diagnostics import Refusal
from hymeko_x.ir.mechanism import Mechanism, ShapeView
from hymeko_x.ir.parts import Mesh, Role
from hymeko_x.meshes.convex import is_convex
from hymeko_x.meshes.reader import inline_part

ANGLE = """v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1
f 1 3 2\nf 1 4 3\nf 1 5 4\nf 1 6 5\nf 7 8 9\nf 7 9 10\nf 7 10 11\nf 7 11 12
f 1 2 8\nf 1 8 7\nf 2 3 9\nf 2 9 8\nf 3 4 10\nf 3 10 9\nf 4 5 11\nf 4 11 10\nf 5 6 12\nf 5 12 11\nf 6 1 7\nf 6 7 12
"""
"""Three cubes of 1 m in an L: a volume of 3 m^3, in a hull of 3.5 m^3."""
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
ROBOT = """<robot name="r"><link name="a">
  <visual><geometry><mesh filename="angle.obj"/></geometry></visual>
  <collision><origin xyz="0 0 1"/><geometry><mesh filename="angle.obj" scale="0.5 0.5 0.5"/></geometry></collision>
  <collision><geometry><mesh filename="angle.obj" scale="0.5 0.5 0.5"/></geometry></collision>
  <collision><geometry><mesh filename="tetra.obj"/></geometry></collision>
</link></robot>"""


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    (tmp_path / "angle.obj").write_text(ANGLE)
    (tmp_path / "tetra.obj").write_text(TETRAHEDRON)
    (tmp_path / "robot.urdf").write_text(ROBOT)
    return tmp_path / "robot.urdf"


def colliding(mechanism: Mechanism) -> list[tuple[ShapeView, Mesh]]:
    return [
        (view, mechanism.vertex(view.mesh, Mesh)) for view in mechanism.every_shape() if view.shape.role is not Role.VISUAL and view.mesh
    ]


def test_a_concave_mesh_is_replaced_by_its_hull_once_for_all_its_shapes(robot: Path, tmp_path: Path) -> None:
    result = hx.convert(robot, tmp_path / "out.urdf", collision="hull")
    found = colliding(result.mechanism)
    assert [mesh.name or mesh.uri for _, mesh in found] == ["tetra.obj", "angle_hull", "angle_hull"]
    assert sorted(view.pose.xyz[2] for view, _ in found) == [0.0, 0.0, 1.0]
    hull = found[1][1]
    assert (max(hull.vertices), is_convex(inline_part(hull))) == (1.0, True)
    assert [item.message for item in result.report] == ["--collision hull: 1 concave collision mesh replaced by convex hulls: 'angle'"]
    assert (tmp_path / "shapes" / "angle_hull.obj").exists()
    again = hx.convert(tmp_path / "out.urdf", tmp_path / "again.urdf", collision="hull")
    assert [item.message for item in again.report] == ["--collision hull: no concave mesh collides; nothing is changed"]


def test_a_shape_that_is_seen_and_touched_becomes_two(robot: Path, tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(
        '<mujoco><asset><mesh name="angle" file="angle.obj"/></asset><worldbody><body name="a"><inertial mass="1" pos="0 0 0" '
        'diaginertia="1 1 1"/><geom name="g" type="mesh" mesh="angle" pos="0 0 2" friction="0.5"/></body></worldbody></mujoco>'
    )
    result = hx.convert(tmp_path / "arm.xml", tmp_path / "arm.urdf", collision="hull")
    shapes = [(view.shape.name, view.shape.role, view.pose.xyz, view.shape.friction) for view in result.mechanism.every_shape()]
    assert shapes == [("g", Role.VISUAL, (0.0, 0.0, 2.0), (0.5,)), (None, Role.COLLISION, (0.0, 0.0, 2.0), (0.5,))]


def test_without_the_library_one_line_says_how_to_install_it(robot: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "coacd", None)
    with pytest.raises((Refusal, ModuleNotFoundError)) as caught:
        hx.convert(robot, tmp_path / "out.urdf", collision="decompose")
    assert "coacd" in str(caught.value)
    assert not (tmp_path / "out.urdf").exists()


def test_a_mesh_in_convex_parts_keeps_its_volume(robot: Path, tmp_path: Path) -> None:
    pytest.importorskip("coacd")
    result = hx.convert(robot, tmp_path / "out.urdf", collision="decompose")
    parts = [mesh for _, mesh in colliding(result.mechanism) if (mesh.name or "").startswith("angle_part")]
    assert len(parts) == 4
    assert all(is_convex(inline_part(mesh)) for mesh in parts)
    assert [item.message for item in result.report] == [
        "--collision decompose: 1 concave collision mesh replaced by 2 convex parts: 'angle' 2 (86% of its hull)"
    ]
