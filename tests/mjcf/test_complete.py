"""Inertias from geoms: what MuJoCo computes is written explicitly for a format that does not compute it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from mjmodels import read_text, write

import hymeko_x as hx
from hymeko_x.diagnostics import Report
from hymeko_x.frontends.mjcf.complete import complete
from hymeko_x.ir.mechanism import Id, Mechanism
from hymeko_x.ir.parts import Body, Capsule, Inertial, NoShape, Shape
from hymeko_x.rewrite import legalize
from hymeko_x.source import NoFiles

CUBE = "-1 -1 -1 1 -1 -1 -1 1 -1 1 1 -1 -1 -1 1 1 -1 1 -1 1 1 1 1 1"


def weighed(content: str, head: str = "") -> Mechanism:
    robot = read_text(f"<mujoco>{head}<worldbody>{content}</worldbody></mujoco>")
    return complete(robot, lambda: (robot, write(robot).encode()), NoFiles(), Report())


def inertial(mechanism: Mechanism, body: str) -> Inertial:
    found = mechanism.vertex(Id("body", body), Body).inertial
    assert found is not None
    return found


def test_a_sphere_weighs_its_volume_times_the_density_of_water() -> None:
    found = inertial(weighed('<body name="b"><freejoint/><geom size=".1" pos="1 2 3"/></body>'), "b")
    mass = 1000.0 * 4.0 / 3.0 * 3.141592653589793 * 1e-3
    assert found.mass == pytest.approx(mass, rel=1e-12)
    assert found.com == pytest.approx((1.0, 2.0, 3.0))
    assert found.tensor == pytest.approx((0.4 * mass * 0.01,) * 3 + (0.0,) * 3, abs=1e-12)


def test_a_mesh_weighs_what_mujoco_says() -> None:
    head = f'<asset><mesh name="m" vertex="{CUBE}"/></asset>'
    found = inertial(weighed('<body name="b"><geom type="mesh" mesh="m" density="1"/></body>', head), "b")
    assert found.mass == pytest.approx(8.0, rel=1e-6)


def test_an_inertia_that_is_given_stays_as_it_is() -> None:
    body = '<body name="b"><inertial pos="0 0 1" mass="2" diaginertia="1 2 2"/><geom size=".1"/></body>'
    assert inertial(weighed(body), "b") == Inertial(2.0, (0.0, 0.0, 1.0), (1.0, 2.0, 2.0, 0.0, 0.0, 0.0))


def test_where_everything_is_given_nothing_is_printed_for_mujoco() -> None:
    body = '<body name="b"><freejoint/><inertial pos="0 0 1" mass="2" diaginertia="1 2 2"/><geom size=".1"/></body>'
    robot = read_text(f"<mujoco><worldbody>{body}</worldbody></mujoco>")
    assert complete(robot, lambda: pytest.fail("it was printed"), NoFiles(), Report()) is robot


def test_a_total_mass_scales_what_is_given_as_well() -> None:
    body = '<body name="b"><inertial pos="0 0 1" mass="2" diaginertia="1 2 2"/></body>'
    assert inertial(weighed(body, '<compiler settotalmass="4"/>'), "b").mass == pytest.approx(4.0)


def test_a_free_body_keeps_its_frame_though_mujoco_would_move_it() -> None:
    found = inertial(weighed('<body name="b"><freejoint align="true"/><geom size=".1" pos="1 2 3"/></body>'), "b")
    assert found.com == pytest.approx((1.0, 2.0, 3.0))


def test_without_a_mesh_there_is_a_warning_and_no_inertia() -> None:
    asset = '<asset><mesh name="m" file="gone.stl"/></asset>'
    text = f'<mujoco>{asset}<worldbody><body name="b"><geom type="mesh" mesh="m"/></body></worldbody></mujoco>'
    robot, report = read_text(text), Report()
    assert complete(robot, lambda: (robot, write(robot).encode()), NoFiles(), report) == robot
    assert [str(diagnostic)[:15] for diagnostic in report] == ["warning[HX302]:"]


def test_textures_and_skins_that_are_not_there_weigh_nothing() -> None:
    cube = "".join(f'file{side}="far/{side}.png" ' for side in ("up", "down", "left", "right", "front", "back"))
    texture = f'<texture name="t" type="cube" {cube}/><texture name="u" type="2d" file="far.png"/>'
    skin = '<skin name="s" file="far.skn" material="m"/>'
    head = f'<asset>{texture}<material name="m" texture="t"/><material name="n" texture="u"/>{skin}</asset>'
    geoms = '<geom size=".1" mass="2" material="m"/><geom size=".1" mass="3" material="n"/>'
    assert inertial(weighed(f'<body name="b">{geoms}</body>', head), "b").mass == pytest.approx(5.0)


def test_a_capsule_around_a_mesh_has_its_size_in_every_format() -> None:
    head = f'<asset><mesh name="m" vertex="{CUBE}"/></asset>'
    robot = weighed('<body name="b"><geom type="capsule" mesh="m"/></body>', head)
    capsule = robot.shapes[Id("body", "b")][0].shape.geometry
    assert isinstance(capsule, Capsule)
    assert capsule.radius > 0.5


def test_a_time_constant_and_a_damping_ratio_become_stiffness_and_damping() -> None:
    text = '<mujoco><worldbody><body><joint name="j" springdamper="1 1"/><geom size="1" mass="1"/></body></worldbody></mujoco>'
    robot = read_text(text)
    dof = complete(robot, lambda: (robot, write(robot).encode()), NoFiles(), Report()).joints[Id("joint", "j")].joint.dofs[0]
    assert dof.stiffness > 0.0
    assert dof.damping == pytest.approx(2.0 * (dof.stiffness * 0.4) ** 0.5)


def test_a_geometry_that_only_mujoco_knows_is_left_out_elsewhere_with_a_warning() -> None:
    head = '<asset><hfield name="h" nrow="2" ncol="2" size="1 1 1 1"/></asset>'
    text = f'<mujoco>{head}<worldbody><geom name="g" type="hfield" hfield="h"/><geom size="1"/></worldbody></mujoco>'
    report = Report()
    legal = legalize(read_text(text), "urdf", report)
    assert not [shape for _, shape, _ in legal.edges(Shape) if isinstance(shape.geometry, NoShape)]
    assert any("has a geometry that only MuJoCo XML can represent; it is left out" in str(diagnostic) for diagnostic in report)


WEDGE = "-1 -1 -1 1 -1 -1 -1 1 -1 1 1 -1 -1 -1 1 1 -1 1 -1 1 1 1 1 3"


@pytest.mark.parametrize(
    "mesh",
    [
        f'vertex="{WEDGE}"',
        f'vertex="{WEDGE}" refpos="1 2 3" refquat="1 1 0 0" scale="1 2 3"',
        'builtin="cone" params="8 0.5"',
    ],
    ids=["without faces", "seen from elsewhere", "of a formula"],
)
@pytest.mark.parametrize("kind", ["mesh", "capsule", "box"])
def test_meshes_and_fitted_shapes_are_in_urdf_where_mujoco_has_them(mesh: str, kind: str, tmp_path: Path) -> None:
    source, target = tmp_path / "robot.xml", tmp_path / "robot.urdf"
    geom = f'<geom type="{kind}" mesh="m" pos=".1 .2 .3" euler="10 20 30"/>'
    source.write_text(f'<mujoco><asset><mesh name="m" {mesh}/></asset><worldbody><body name="b">{geom}</body></worldbody></mujoco>')
    hx.convert(source, target)
    verdict = hx.verify(source, target, samples=2)
    assert [f"{check.quantity} at {check.at}" for check in verdict.failed] == []
    compared = {check.quantity for check in verdict.checks}
    assert {"collision shapes", "collision meshes"} <= compared if kind == "mesh" else "collision shapes, size and pose" in compared


def test_a_file_of_mujocos_own_type_becomes_one_that_every_tool_reads(tmp_path: Path) -> None:
    source, target = tmp_path / "robot.xml", tmp_path / "robot.urdf"
    points = np.array(WEDGE.split(), dtype="<f4")
    corners = "021 014 042 765 753 736 123 135 154 246 263 456"
    faces = np.array([int(corner) for corner in corners.replace(" ", "")], dtype="<i4")
    header = np.array([len(points) // 3, 0, 0, len(faces) // 3], dtype="<i4")
    (tmp_path / "part.msh").write_bytes(header.tobytes() + points.tobytes() + faces.tobytes())
    geom = '<body name="b"><geom type="mesh" mesh="part"/></body>'
    source.write_text(f'<mujoco><asset><mesh file="part.msh"/></asset><worldbody>{geom}</worldbody></mujoco>')
    hx.convert(source, target)
    assert b'<mesh filename="shapes/part.obj"/>' in target.read_bytes()
    assert hx.verify(source, target, samples=2).is_same
