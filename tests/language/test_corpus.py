"""The robots in corpus/: the published listings as printed, one robot per concept, the arm and the humanoid."""

from __future__ import annotations

import math
from pathlib import Path

import mujoco
import numpy as np
import pinocchio
import pytest

import hymeko_x as hx
from hymeko_x.backends.hymeko import write
from hymeko_x.diagnostics import Report
from hymeko_x.frontends.hymeko import read
from hymeko_x.ir import lumped, parts
from hymeko_x.ir.mechanism import WORLD, Id, Mechanism
from hymeko_x.ir.parts import DofKind, Role
from hymeko_x.ir.values import Pose, quat_from_rpy
from hymeko_x.rewrite.context import Options
from hymeko_x.source import Source

CORPUS = Path(__file__).parents[2] / "corpus"
LISTINGS = CORPUS / "listings"
ROBOTS = sorted((CORPUS / "robots").glob("*.hymeko"))
RIGHT_ANGLE = math.radians(90.0)


def load(path: Path) -> Mechanism:
    """A file about which nothing has to be reported."""
    report = Report()
    mechanism = hx.load(path, report=report).mechanism
    assert [str(diagnostic) for diagnostic in report] == []
    return mechanism


# ---- the published listings ------------------------------------------------------------------------------------------------


def test_listing_1_is_a_hypergraph_with_one_edge() -> None:
    graph = load(LISTINGS / "simple.hymeko").graph
    assert list(graph.vertices) == [Id("datum", name) for name in ("x1", "x2", "x3", "x4")]
    (edge,) = graph.edges.values()
    assert [(arc.target.name, arc.sign) for arc in edge.arcs] == [("x1", 1), ("x2", 1), ("x3", -1), ("x4", -1)]


def test_listing_2_is_a_robot_of_two_links_that_turns_about_z_without_limits() -> None:
    robot = load(LISTINGS / "simple_robot.hymeko")
    assert robot.name == "simple_robot"
    assert list(robot.graph.vertices) == [Id("body", "shoulder_link"), Id("body", "base_link")]
    (joint,) = robot.joints.values()
    assert joint.joint == parts.Joint((parts.Dof(DofKind.HINGE, (0.0, 0.0, 1.0)),))
    assert (joint.parent.name, joint.child.name) == ("base_link", "shoulder_link")
    assert joint.parent_pose == Pose((0.0, 0.0, 0.35))
    assert joint.child_pose == Pose()


def test_listing_4_is_a_scara_with_masses_and_solids_where_the_links_put_them() -> None:
    robot = load(LISTINGS / "scara_robot.hymeko")
    bodies = {key.name: body.inertial for key, body in robot.vertices(parts.Body)}
    assert bodies == {
        "base_link": parts.Inertial(2.0, (0.0, 0.0, 0.3)),
        "shoulder_link": parts.Inertial(1.0, (0.3, 0.0, 0.0)),
        "wrist_link": parts.Inertial(1.0, (0.3, 0.0, 0.0)),
    }
    lying = quat_from_rpy((0.0, RIGHT_ANGLE, 0.0))
    shapes = {key.name: [(view.shape, view.pose) for view in views] for key, views in robot.shapes.items()}
    assert shapes == {
        "base_link": [(parts.Shape(parts.Cylinder(0.1, 0.6), Role.BOTH), Pose((0.0, 0.0, 0.3)))],
        "shoulder_link": [(parts.Shape(parts.Cylinder(0.1, 0.6), Role.BOTH), Pose((0.3, 0.0, 0.0), lying))],
        "wrist_link": [(parts.Shape(parts.Cylinder(0.1, 0.5), Role.BOTH), Pose((0.3, 0.0, 0.0), lying))],
    }
    poses = {key.name: view.parent_pose for key, view in robot.joints.items()}
    assert poses == {
        "joint_1": Pose((0.0, 0.0, 0.63), quat_from_rpy((0.0, 0.0, RIGHT_ANGLE))),
        "joint_2": Pose((0.5, 0.0, 0.0)),
    }
    assert all(view.joint.dofs == (parts.Dof(DofKind.HINGE, (0.0, 0.0, 1.0)),) for view in robot.joints.values())


def test_listing_5_is_a_mass_on_spring_and_damper() -> None:
    model = load(LISTINGS / "quarter_vehicle_model.hymeko")
    assert dict(model.graph.vertices) == {
        Id("spring", "spring"): lumped.Spring(50000.0),
        Id("damper", "damping"): lumped.Damper(1000.0),
        Id("mass", "link"): lumped.Mass(50.0),
        Id("port", "chassis"): lumped.Port("ground"),
    }
    ((key, edge),) = model.graph.edges.items()
    assert (key, edge.data) == (Id("constitutive", "joint"), lumped.Constitutive())
    assert [(arc.target.name, arc.sign) for arc in edge.arcs] == [("chassis", 1), ("link", -1), ("damping", 1), ("spring", -1)]


@pytest.mark.parametrize("name", ["simple_robot", "scara_robot"])
@pytest.mark.unread("HX103")
def test_the_robots_among_the_listings_move_as_the_paper_says(name: str, tmp_path: Path) -> None:
    robot = load(LISTINGS / f"{name}.hymeko")
    model, data = compiled(robot, tmp_path)
    data.qpos[:] = 0.25
    mujoco.mj_forward(model, data)
    wrist = [-0.5 * math.sin(0.25), 0.5 * math.cos(0.25), 0.63]
    body, place = {"simple_robot": ("shoulder_link", [0.0, 0.0, 0.35]), "scara_robot": ("wrist_link", wrist)}[name]
    np.testing.assert_allclose(data.body(body).xpos, place, atol=1e-12)


# ---- all robots ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", ROBOTS, ids=lambda path: path.stem)
def test_a_robot_is_read_in_silence_and_its_text_says_the_same_again(path: Path) -> None:
    robot = load(path)
    text = write(robot, Options(), Report()).main
    back = read(Source(path.name, text), Report()).mechanism
    assert back == robot
    assert write(back, Options(), Report()).main == text


@pytest.mark.parametrize("path", ROBOTS, ids=lambda path: path.stem)
@pytest.mark.unread("HX101", "HX103")
def test_pinocchio_and_mujoco_see_the_same_robot_after_export(path: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    robot = load(path)
    hx.dump(robot, tmp_path / "robot.urdf", packages={"robots": path.parent})
    pin = pinocchio.buildModelFromUrdf(str(tmp_path / "robot.urdf"))
    model, data = compiled(robot, tmp_path)
    assert capfd.readouterr().err == "", "urdfdom complains"
    assert model.nv == pin.nv == sum(_VELOCITIES[dof.kind] for view in robot.joints.values() for dof in view.joint.dofs)
    mujoco.mj_forward(model, data)
    pin_data = pin.createData()
    pinocchio.forwardKinematics(pin, pin_data, pinocchio.neutral(pin))
    pinocchio.updateFramePlacements(pin, pin_data)
    seen = {frame.name: place.translation for frame, place in zip(pin.frames, pin_data.oMf, strict=True) if frame.type == pinocchio.BODY}
    names = {model.body(number).name: number for number in range(1, model.nbody)}
    common = [name for name in names if name in seen]
    assert len(common) >= min(len(names), 2)
    if not any(view.parent == WORLD for view in robot.joints.values()):
        for name in common:
            np.testing.assert_allclose(data.xpos[names[name]], seen[name], atol=1e-12, err_msg=name)


_VELOCITIES = {DofKind.HINGE: 1, DofKind.SLIDE: 1, DofKind.SCREW: 1, DofKind.BALL: 3, DofKind.FREE: 6}


def compiled(robot: Mechanism, folder: Path) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """The robot as MuJoCo sees it."""
    hx.dump(robot, folder / "robot.xml", packages={"robots": CORPUS / "robots"})
    model = mujoco.MjModel.from_xml_path(str(folder / "robot.xml"))
    return model, mujoco.MjData(model)


# ---- the two large ones ------------------------------------------------------------------------------------------------------


def test_the_arm_reaches_as_far_and_weighs_as_much_as_its_class(tmp_path: Path) -> None:
    robot = load(CORPUS / "robots" / "arm6.hymeko")
    model, data = compiled(robot, tmp_path)
    assert (model.nq, model.nv) == (6, 6)
    assert model.body_mass.sum() == pytest.approx(122.2)
    data.qpos[:] = [0.0, math.radians(90), math.radians(-90), 0.0, 0.0, 0.0]
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(data.body("tool0").xpos, [0.12 + 0.61 + 0.15 + 0.46 + 0.12, 0.0, 0.25 + 0.2 + 0.05], atol=1e-12)
    assert float(np.min(np.linalg.eigvalsh(_mass_matrix(model, data)))) > 0.1


def test_the_humanoid_has_31_dofs_and_the_mass_height_and_symmetry_of_a_person(tmp_path: Path) -> None:
    robot = load(CORPUS / "robots" / "humanoid.hymeko")
    model, data = compiled(robot, tmp_path)
    mujoco.mj_forward(model, data)
    assert model.nv == 6 + 31
    assert model.body_mass.sum() == pytest.approx(68.2)
    low, high = _extent(model, data)
    assert low == pytest.approx(0.0, abs=1e-9)
    assert 1.6 < high < 1.8
    assert data.ncon == 0
    assert data.subtree_com[0][1] == pytest.approx(0.0, abs=1e-12)
    for number in range(1, model.nbody):
        name = model.body(number).name
        if name.startswith("left_"):
            twin = data.body(name.replace("left_", "right_")).xpos
            np.testing.assert_allclose(data.xpos[number] * [1, -1, 1], twin, atol=1e-12, err_msg=name)


def test_the_limbs_of_the_humanoid_have_the_inertia_of_a_capsule() -> None:
    """Against the integral over a solid capsule, slice by slice along its axis."""
    robot = load(CORPUS / "robots" / "humanoid.hymeko")
    for key, body in robot.vertices(parts.Body):
        capsules = [view.shape.geometry for view in robot.shapes.get(key, ()) if isinstance(view.shape.geometry, parts.Capsule)]
        if not capsules:
            continue
        assert body.inertial is not None
        r, half = capsules[0].radius, capsules[0].length / 2
        edges = np.linspace(-half - r, half + r, 200_001)
        z = (edges[:-1] + edges[1:]) / 2
        square = r**2 - np.maximum(np.abs(z) - half, 0.0) ** 2
        weight = square * body.inertial.mass / square.sum()
        across, along = float((weight * (square / 4 + z**2)).sum()), float((weight * square / 2).sum())
        np.testing.assert_allclose(body.inertial.tensor, (across, across, along, 0.0, 0.0, 0.0), rtol=1e-6, err_msg=key.name)


def test_the_humanoid_falls_on_a_floor_without_trouble(tmp_path: Path) -> None:
    robot = load(CORPUS / "robots" / "humanoid.hymeko")
    hx.dump(robot, tmp_path / "robot.xml")
    spec = mujoco.MjSpec.from_file(str(tmp_path / "robot.xml"))
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1])
    model = spec.compile()
    data = mujoco.MjData(model)
    for _ in range(500):
        mujoco.mj_step(model, data)
    assert np.isfinite(data.qpos).all()
    assert np.abs(data.qvel).max() < 50.0
    assert data.warning.number.sum() == 0
    assert 0.0 < data.body("pelvis").xpos[2] < 0.94


def _mass_matrix(model: mujoco.MjModel, data: mujoco.MjData) -> np.ndarray:
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    return full


def _extent(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[float, float]:
    """The lowest and the highest point of all boxes, spheres and capsules that stand upright."""
    kind = mujoco.mjtGeom
    half = {kind.mjGEOM_SPHERE: lambda s: s[0], kind.mjGEOM_BOX: lambda s: s[2], kind.mjGEOM_CAPSULE: lambda s: s[0] + s[1]}
    reach = [half[kind(int(model.geom_type[geom]))](model.geom_size[geom]) for geom in range(model.ngeom)]
    heights = data.geom_xpos[:, 2]
    return float(np.min(heights - reach)), float(np.max(heights + reach))
