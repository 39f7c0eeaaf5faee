"""What has a mass and no tensor gets that of its geometry, as MuJoCo computes it."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

import hymeko_x as hx
from hymeko_x.diagnostics import Report
from hymeko_x.frontends import hymeko, urdf
from hymeko_x.ir.graph import Hypergraph
from hymeko_x.ir.mechanism import Id, Mechanism, shape_edge
from hymeko_x.ir.parts import Body, Box, Capsule, Cylinder, Ellipsoid, Geometry, Inertial, MeshShape, Plane, Role, Shape, Sphere
from hymeko_x.ir.values import IDENTITY, Pose, Tensor, pose_from_rpy
from hymeko_x.rewrite import legalize
from hymeko_x.source import Source
from tests.robots import MemoryFiles

A = Id("body", "a")
ELSEWHERE = pose_from_rpy((0.3, -0.1, 0.2), (0.4, 0.5, -0.6))
SOLIDS = {
    'type="box" size="0.1 0.2 0.3"': Box((0.2, 0.4, 0.6)),
    'type="sphere" size="0.2"': Sphere(0.2),
    'type="cylinder" size="0.2 0.3"': Cylinder(0.2, 0.6),
    'type="capsule" size="0.2 0.3"': Capsule(0.2, 0.6),
    'type="ellipsoid" size="0.1 0.2 0.3"': Ellipsoid((0.1, 0.2, 0.3)),
}


def heavy(*shapes: tuple[Geometry, Pose, Role], mass: float = 2.0) -> Mechanism:
    edges = {Id("shape", str(k)): shape_edge(Shape(solid, role), A, at) for k, (solid, at, role) in enumerate(shapes)}
    return Mechanism("r", Hypergraph({A: Body(Inertial(mass))}, edges))


def tensor_of(mechanism: Mechanism, target: str = "urdf") -> Tensor | None:
    inertial = legalize(mechanism, target, Report()).vertex(A, Body).inertial
    assert inertial is not None
    return inertial.tensor


def by_mujoco(*geoms: str, mass: float = 2.0) -> tuple[float, ...]:
    """The tensor that MuJoCo gives a body of evenly dense geoms of this mass together, in body axes."""
    geoms_text = "".join(f"<geom density='1' {geom}/>" for geom in geoms)
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody><body>{geoms_text}</body></worldbody></mujoco>")
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[1])
    axes = turn.reshape(3, 3)
    tensor = axes @ np.diag(model.body_inertia[1]) @ axes.T * mass / model.body_mass[1]
    return tuple(tensor[i, k] for i, k in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))


def placed(geom: str, at: Pose) -> str:
    return f"{geom} pos='{' '.join(map(str, at.xyz))}' quat='{' '.join(map(str, at.quat))}'"


@pytest.mark.parametrize("geom", SOLIDS)
@pytest.mark.parametrize("at", [IDENTITY, ELSEWHERE], ids=["in place", "elsewhere"])
def test_every_primitive_weighs_as_in_mujoco(geom: str, at: Pose) -> None:
    assert tensor_of(heavy((SOLIDS[geom], at, Role.BOTH))) == pytest.approx(by_mujoco(placed(geom, at)), rel=1e-9, abs=1e-12)


def test_several_shapes_are_of_one_density() -> None:
    shapes = [(solid, at, Role.COLLISION) for solid, at in zip(SOLIDS.values(), [IDENTITY, ELSEWHERE] * 3, strict=False)]
    geoms = [placed(geom, at) for geom, at in zip(SOLIDS, [IDENTITY, ELSEWHERE] * 3, strict=False)]
    assert tensor_of(heavy(*shapes), "mjcf") == pytest.approx(by_mujoco(*geoms), rel=1e-9, abs=1e-12)


def test_what_is_only_seen_counts_where_nothing_collides() -> None:
    ball, box = (Sphere(0.2), IDENTITY, Role.VISUAL), (Box((1.0, 1.0, 1.0)), IDENTITY, Role.COLLISION)
    assert tensor_of(heavy(ball)) == pytest.approx((0.032,) * 3 + (0.0,) * 3)
    assert tensor_of(heavy(ball, box)) == pytest.approx((1.0 / 3.0,) * 3 + (0.0,) * 3)


def test_a_mesh_alone_says_nothing() -> None:
    assert tensor_of(heavy((MeshShape(), IDENTITY, Role.BOTH))) is None


def test_the_tensors_of_the_published_listing_are_written() -> None:
    text = b"scara { base { mass = 2.0 translation = [0.0, 0.0, 0.3] geometry { type = cylinder dimensions = [0.1, 0.6] } } }"
    mechanism = hymeko.read(Source("scara.hymeko", text, MemoryFiles()), Report()).mechanism
    report = Report()
    inertial = legalize(mechanism, "urdf", report).vertex(Id("body", "base"), Body).inertial
    assert inertial is not None
    assert (inertial.mass, inertial.com) == (2.0, (0.0, 0.0, 0.3))
    assert inertial.tensor == pytest.approx((0.065, 0.065, 0.01, 0.0, 0.0, 0.0))
    assert [d.message for d in report] == ["body 'base' has a mass and no inertia tensor; that of its geometry is written"]


@pytest.mark.unread("HX045")
def test_what_urdf_leaves_out_stays_out() -> None:
    shape = '<collision><geometry><box size="1 1 1"/></geometry></collision>'
    text = f'<robot name="r"><link name="a"><inertial><mass value="2"/></inertial>{shape}</link></robot>'
    assert tensor_of(urdf.read(Source("r.urdf", text.encode(), MemoryFiles()), Report()).mechanism) is None


@pytest.mark.parametrize("name", ["robot.urdf", "robot.xml"])
def test_missing_inertials_are_missing_again_after_the_way_back(name: str, tmp_path: Path) -> None:
    source, target = tmp_path / "robot.hymeko", tmp_path / name
    source.write_text("robot { base { mass 2 shape { box [0.1 0.2 0.3] } } }")
    hx.convert(source, target, keep="inside")
    assert hx.load(target).mechanism == hx.load(source).mechanism


def test_a_plane_gives_no_tensor_even_where_it_became_a_thin_box() -> None:
    legal = legalize(heavy((Plane((1.0, 1.0)), IDENTITY, Role.VISUAL)), "urdf", Report())
    assert legalize(legal, "urdf", Report()).graph == legal.graph
    assert tensor_of(legal) is None
