"""What servos carry is what MuJoCo finds in its mass matrix and in its forces of gravity, and their gains follow from it."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

import hymeko_x as hx
from hymeko_x.ir.parts import Limits
from hymeko_x.ir.values import Z
from hymeko_x.rewrite.servos import Load, gains, home, loads
from tests.robots import hinge

ARM = Path(__file__).parents[2] / "corpus" / "robots" / "arm6.hymeko"
SLIDING = """<mujoco><worldbody><body pos="0 0 1"><joint name="lift" type="slide" axis="0 0.6 0.8" range="0.2 1"/>
  <inertial pos="0.1 0 0" mass="2" diaginertia="0.1 0.2 0.25"/>
  <body pos="0.3 0.1 0" quat="0.8 0 0.6 0"><joint name="a" axis="0 1 0" pos="0.1 0 0.2" range="0.3 2" armature="0.2"/>
    <joint name="b" axis="1 0 0"/><inertial pos="0 0.2 0.1" mass="1" fullinertia="0.1 0.2 0.25 0.01 0.02 0.03"/>
  </body></body></worldbody></mujoco>"""


def test_loads_are_those_of_the_mass_matrix_and_of_gravity(tmp_path: Path) -> None:
    for robot in (hx.load(ARM).mechanism, hx.loads(SLIDING, "mjcf").mechanism):
        path = tmp_path / "robot.xml"
        hx.dump(robot, path, base="fixed", target="mujoco")
        model = mujoco.MjModel.from_xml_path(str(path))
        found = loads(robot)
        assert len(found) == model.nv
        for (joint, number), load in found.items():
            dof = robot.joints[joint].joint.dofs[number]
            assert_as_in_mujoco(load, model, model.joint(dof.name or joint.name).dofadr[0])


def assert_as_in_mujoco(load: Load, model: mujoco.MjModel, dof: int) -> None:
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    forces = []
    for direction in np.eye(3):
        model.opt.gravity[:] = 9.81 * direction
        mujoco.mj_forward(model, data)
        forces.append(data.qfrc_bias[dof])
    matrix = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, matrix)
    behind = [other for other in range(dof, model.nv) if dof in above(model, other)]
    free = 1.0 / np.linalg.inv(matrix[np.ix_(behind, behind)])[0, 0]
    expected = Load(matrix[dof, dof], free, float(np.linalg.norm(forces)), abs(forces[2]))
    assert load == pytest.approx(expected, rel=1e-8, abs=1e-12)


def above(model: mujoco.MjModel, dof: int) -> list[int]:
    found = [dof]
    while (dof := model.dof_parentid[dof]) >= 0:
        found.append(dof)
    return found


def test_a_servo_sags_by_a_hundredth_and_is_damped_critically() -> None:
    stiffness, damping = gains(Load(0.5, 0.5, 8.0, 8.0), None)
    assert (stiffness, damping) == (800.0, 2.0 * (800.0 * 0.5) ** 0.5)


def test_a_servo_without_load_is_not_slower_than_twenty_radians_per_second() -> None:
    assert gains(Load(2.0, 2.0, 0.0, 0.0), None) == (800.0, 80.0)


def test_a_servo_asks_for_all_effort_at_a_hundredth_at_the_soonest() -> None:
    assert gains(Load(0.5, 0.5, 8.0, 8.0), 4.0)[0] == 400.0


def test_home_is_the_reference_or_the_limit_next_to_it() -> None:
    dofs = [hinge(axis=Z, limits=Limits(*span)).dofs[0] for span in ((-1.0, 1.0), (0.5, 1.0), (-2.0, -0.5), (None, None), (1.0, -1.0))]
    assert [home(dof) for dof in dofs] == [0.0, 0.5, -0.5, 0.0, 0.0]
