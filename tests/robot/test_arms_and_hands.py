"""Twenty arms and ten hands from public packages, of any formats: every hand on every arm, in every engine."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from pathlib import Path

import mujoco
import numpy as np
import pytest

import hymeko_x as hx
from hymeko_x.corpus import catalog
from hymeko_x.ir.parts import DofKind
from tests.robot.robots import check_same_model

ARMS = (
    ("example_robot_data", "xarm7.urdf"),
    ("robosuite", "baxter_arm.urdf"),
    ("rtb_data", "lbr_iiwa_14_r820.urdf"),
    ("rtb_data", "al5d_robot.urdf"),
    ("rtb_data", "puma560_robot.urdf"),
    ("mani_skill", "so100.urdf"),
    ("scikit_robot", "kuka.urdf"),
    ("rtb_data", "xarm6.xacro"),
    ("rtb_data", "kr3r540.xacro"),
    ("rtb_data", "wx250s.urdf.xacro"),
    ("robosuite", "panda_arm.urdf.xacro"),
    ("robosuite", "iiwa/robot.xml"),
    ("robosuite", "jaco/robot.xml"),
    ("robosuite", "panda/robot.xml"),
    ("robosuite", "sawyer/robot.xml"),
    ("robosuite", "ur5e/robot.xml"),
    ("robosuite_models", "z1/robot.xml"),
    ("mjlab", "yam.xml"),
    ("pybullet", "kuka_iiwa/model.sdf"),
    ("newton", "four_link_chain_articulation.usda"),
)
HANDS = (
    ("robosuite", "panda_description/urdf/hand.urdf"),
    ("robosuite", "panda_description/urdf/hand.urdf.xacro"),
    ("mani_skill", "allegro_hand_right_glb.urdf"),
    ("mani_skill", "dclaw_gripper_glb.urdf"),
    ("mani_skill", "inspire_hand_left_floating.urdf"),
    ("genesis_world", "shadow_hand.urdf"),
    ("robosuite", "grippers/robotiq_gripper_140.xml"),
    ("robosuite", "grippers/rethink_gripper.xml"),
    ("drake", "planar_gripper.sdf"),
    ("newton", "revolute_articulation.usda"),
)
PREFIX = "hand/"


@pytest.fixture(scope="module")
def opened(real_robot: Callable[..., Path]) -> Callable[[tuple[str, str]], hx.Robot]:
    """Opens a robot by its package and the end of its path there."""

    @cache
    def found(which: tuple[str, str]) -> hx.Robot:
        return hx.load(path_of(real_robot, which), lenient=True)

    return found


def path_of(real_robot: Callable[..., Path], which: tuple[str, str]) -> Path:
    """The file of a robot by its package and the end of its path there."""
    package = next(package for package in catalog.load() if package.name == which[0])
    folder = real_robot.package(package)  # type: ignore[attr-defined]
    return min(folder.rglob(f"*/{which[1]}"), key=lambda path: (len(path.parts), path))


def matrices(poses: dict[str, hx.Pose]) -> dict[str, np.ndarray]:
    return {name: np.array(pose.matrix()) for name, pose in poses.items()}


@pytest.mark.corpus
@pytest.mark.full
@pytest.mark.parametrize("hand", HANDS, ids=[name for _, name in HANDS])
@pytest.mark.parametrize("arm", ARMS, ids=[name for _, name in ARMS])
def test_a_hand_on_an_arm_loads_in_every_engine_and_moves_as_its_parts(
    opened: Callable[[tuple[str, str]], hx.Robot], arm: tuple[str, str], hand: tuple[str, str]
) -> None:
    host, part = opened(arm), opened(hand)
    tip = list(host.bodies)[-1]
    whole = host.attach(part, at=tip, prefix=PREFIX)

    scalar = [name for name, joint in whole.joints.items() if [dof.kind for dof in joint.dofs] in ([DofKind.HINGE], [DofKind.SLIDE])]
    q = {name: 0.05 + 0.3 * math.sin(number) for number, name in enumerate(scalar)}
    own = {name: value for name, value in q.items() if not name.startswith(PREFIX)}
    poses, before = matrices(whole.fk(q)), matrices(host.fk(own))
    alone = matrices(part.fk({name.removeprefix(PREFIX): value for name, value in q.items() if name.startswith(PREFIX)}))
    for name, pose in before.items():
        assert np.abs(poses[name] - pose).max() < 1e-12, name
    for name, pose in alone.items():
        assert np.abs(poses[f"{PREFIX}{name}"] - before[tip] @ pose).max() < 1e-12, name
    assert whole.mass == pytest.approx(host.mass + part.mass, rel=1e-12)

    model = whole.to_mujoco()
    data = mujoco.MjData(model)
    for name, value in q.items():
        data.joint(name).qpos[:] = value
    mujoco.mj_kinematics(model, data)
    named = {model.body(number).name for number in range(model.nbody)}
    for name in set(alone) & {name.removeprefix(PREFIX) for name in named if name.startswith(PREFIX)}:
        assert np.abs(data.body(f"{PREFIX}{name}").xpos - poses[f"{PREFIX}{name}"][:3, 3]).max() < 1e-9, name
    pinocchio = whole.to_pinocchio()
    assert sum(inertia.mass for inertia in pinocchio.inertias) <= whole.mass * (1 + 1e-9)
    assert {frame.name for frame in pinocchio.frames} >= {f"{PREFIX}{name}" for name in alone}
    stage = whole.to_usd()
    assert stage.GetDefaultPrim()


@pytest.mark.corpus
@pytest.mark.full
@pytest.mark.parametrize("hand", [hand for hand in HANDS if hand[1].endswith(".xml")], ids=lambda which: which[1])
@pytest.mark.parametrize("arm", [arm for arm in ARMS if arm[1].endswith(".xml")], ids=lambda which: which[1])
def test_within_mjcf_a_hand_on_an_arm_is_what_mujoco_attaches(
    opened: Callable[[tuple[str, str]], hx.Robot], real_robot: Callable[..., Path], arm: tuple[str, str], hand: tuple[str, str]
) -> None:
    host, part = opened(arm), opened(hand)
    spec, child = (mujoco.MjSpec.from_file(str(path_of(real_robot, which))) for which in (arm, hand))
    tip = list(host.bodies)[-1]
    spec.attach(child, prefix=PREFIX, frame=spec.body(tip).add_frame())
    check_same_model(host.attach(part, at=tip, prefix=PREFIX).to_mujoco(), spec.compile(), in_order=False)
