"""Every development URDF as MJCF: MuJoCo compiles it, moves it as Pinocchio moves the source, and weighs it alike."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from hymeko_x.disk import open_source
from hymeko_x.ir.parts import Body
from tests.mjcf.convert import Converted, convert, worst_pose_error

SAME = 1e-9


@pytest.mark.robots("urdf", every=10)
@pytest.mark.unread("HX005")
def test_mujoco_compiles_it_and_agrees_with_pinocchio_on_poses_masses_and_tensors(robot: Path) -> None:
    done = convert(open_source(str(robot)))
    model = done.model()
    renamed = {} if "world_link" not in {key.name for key, _ in done.legal.vertices(Body)} else {"world": "world_link"}
    assert worst_pose_error(robot, model, renamed) < SAME
    assert_same_inertials(robot, done, renamed)


def assert_same_inertials(robot: Path, done: Converted, renamed: dict[str, str]) -> None:
    """Every joint carries what Pinocchio's own reader lets it carry: its link and the links fixed to it, seen from the world.

    Groups in which the report says that an inertia was repaired are left out.
    """
    model, repaired = done.model(), {d.element for d in done.report if d.code.id == "HX103"}
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    reference = pin.buildModelFromUrdf(str(robot))
    known = reference.createData()
    pin.forwardKinematics(reference, known, pin.neutral(reference))
    groups: dict[int, list[str]] = {}
    for frame in reference.frames:
        if frame.type == pin.FrameType.BODY:
            groups.setdefault(frame.parentJoint, []).append(renamed.get(frame.name, frame.name))
    for joint, names in groups.items():
        if any(f"body '{name}'" in repaired for name in names):
            continue
        expected = known.oMi[joint].act(reference.inertias[joint])
        found = sum((inertia_in_world(model, data, name) for name in names), pin.Inertia.Zero())
        assert abs(expected.mass - found.mass) < SAME, names
        assert expected.mass == 0.0 or np.abs(expected.lever - found.lever).max() < SAME, names
        assert np.abs(expected.inertia - found.inertia).max() < SAME, names


def inertia_in_world(model: mujoco.MjModel, data: mujoco.MjData, name: str) -> pin.Inertia:
    """What MuJoCo gives one body, about its centre of mass, in world axes."""
    body = model.body(name).id
    axes = data.ximat[body].reshape(3, 3)
    return pin.Inertia(float(model.body_mass[body]), data.xipos[body], axes @ np.diag(model.body_inertia[body]) @ axes.T)
