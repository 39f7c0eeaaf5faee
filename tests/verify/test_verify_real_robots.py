"""Real robots: a robot is the same as itself, as its MJCF, and moves as yourdfpy's own kinematics say."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yourdfpy

import hymeko_x as hx
from hymeko_x.corpus.catalog import development_files
from hymeko_x.verify import model_of
from hymeko_x.verify.kinematics import draw, prepare
from hymeko_x.verify.model import KinematicModel

URDFS = development_files("urdf")
FEW = [
    file for file in URDFS if file.path.endswith(("/hand.urdf", "double_pendulum.urdf", "cartpole.urdf", "r2d2.urdf", "al5d_robot.urdf"))
]

MORE = [file for file in URDFS if file not in FEW][::12]

pytestmark = pytest.mark.corpus


def assert_same_in_mjcf(robot: Path, folder: Path, *, meshes: bool) -> None:
    target = folder / "robot.xml"
    hx.convert(robot, target)
    verdict = hx.verify(robot, target, samples=20, meshes=meshes)
    assert [f"{check.quantity} at {check.at}" for check in verdict.failed] == []
    assert verdict.is_same


@pytest.mark.parametrize("robot", FEW, ids=lambda file: file.id, indirect=True)
@pytest.mark.unread("HX101", "HX103")
def test_a_real_robot_is_the_same_in_mjcf(robot: Path, tmp_path: Path) -> None:
    assert_same_in_mjcf(robot, tmp_path, meshes=True)


@pytest.mark.slow
@pytest.mark.parametrize("robot", MORE, ids=lambda file: file.id, indirect=True)
@pytest.mark.unread("HX005", "HX040", "HX101", "HX103")
def test_more_real_robots_are_the_same_in_mjcf(robot: Path, tmp_path: Path) -> None:
    assert_same_in_mjcf(robot, tmp_path, meshes=False)


@pytest.mark.full
@pytest.mark.parametrize("robot", [file for file in URDFS if file not in (*FEW, *MORE)], ids=lambda file: file.id, indirect=True)
def test_every_real_robot_is_the_same_in_mjcf(robot: Path, tmp_path: Path) -> None:
    assert_same_in_mjcf(robot, tmp_path, meshes=False)


@pytest.mark.slow
@pytest.mark.robots("mjcf", every=9)
def test_a_real_mjcf_is_the_same_as_itself(robot: Path) -> None:
    assert hx.verify(robot, robot, samples=2, meshes=False).is_same


@pytest.mark.slow
@pytest.mark.robots("usd")
def test_a_real_stage_is_the_same_as_itself(robot: Path) -> None:
    assert hx.verify(robot, robot, samples=2, meshes=False).is_same


@pytest.mark.robots("urdf", every=3)
def test_yourdfpys_own_kinematics_agree(robot: Path) -> None:
    """Its scene graph, not its numbers: wherever axes have unit length, which it does not see to itself."""
    model = model_of(robot)
    other = yourdfpy.URDF.load(str(robot), load_meshes=False)
    actuated = set(other.actuated_joint_names)
    if any(joint.mimic and joint.mimic.joint not in actuated for joint in other.robot.joints):
        return  # yourdfpy does not follow joints that are followers themselves, or fixed
    if any(len(body.joint.dofs) > 1 or any(not dof.kind.scalar for dof in body.joint.dofs) for body in model.bodies):
        return  # yourdfpy holds planar and floating joints still
    other = with_unit_axes(other)
    row = draw(model, 1, np.random.default_rng(2))[3]
    other.update_cfg({name: row[column] for name, column in coordinates(model).items() if name in actuated})
    poses = prepare(model).poses(row[None])[0]
    for index, body in enumerate(model.bodies[1:], start=1):
        assert np.abs(other.get_transform(body.name) - poses[index]).max() < 1e-9, body.name


def coordinates(model: KinematicModel) -> dict[str | None, int]:
    return {dof.name: column for dof, column in zip(model.dofs, model.columns, strict=True)}


def with_unit_axes(other: yourdfpy.URDF) -> yourdfpy.URDF:
    for joint in other.robot.joints:
        if joint.axis is not None and joint.type != "fixed":
            joint.axis = joint.axis / np.linalg.norm(joint.axis)
    return yourdfpy.URDF(robot=other.robot, load_meshes=False)
