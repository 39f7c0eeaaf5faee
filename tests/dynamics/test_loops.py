"""A four-bar linkage: its freedom, and its accelerations against Pinocchio's constrained dynamics and MuJoCo's stiff connect."""

from __future__ import annotations

import mujoco
import numpy as np
import pinocchio as pin
import pytest
from scipy.optimize import fsolve

import hymeko_x as hx
from hymeko_x.dynamics.multibody import Multibody
from tests.dynamics.networks import load

FOUR_BAR = """four_bar : robot {
  world {}
  crank { mass 0.5 com [0.1 0 0] inertia [0.001 0.004 0.004] }
  coupler { mass 1 com [0.25 0 0] inertia [0.001 0.03 0.03] }
  rocker { mass 0.8 com [0.2 0 0] inertia [0.001 0.015 0.015] }
  @drive : revolute { + world - crank axis=-Y }
  @pin : revolute { [0.2 0 0] + crank - coupler axis=-Y }
  @pivot : revolute { [0.5 0 0] + world - rocker axis=-Y }
  @shut : connect { [0.5 0 0] ~ coupler [0.4 0 0] ~ rocker }
}"""


@pytest.fixture(scope="module")
def linkage() -> tuple[Multibody, np.ndarray, np.ndarray]:
    """The linkage at a closed configuration, with velocities that keep it closed."""
    found = hx.dynamics(load(FOUR_BAR))

    def gap(angles: np.ndarray) -> np.ndarray:
        return np.array(found.closure([0.7, *angles], [0.0] * 3)[0], dtype=float)[[0, 2], 0]

    q = np.array([0.7, *fsolve(gap, [0.2, 1.5], xtol=1e-14)])
    slope = np.array(found.closure(q, np.zeros(3))[1], dtype=float)
    v = np.array([1.0, *np.linalg.lstsq(slope[:, 1:], -slope[:, 0], rcond=None)[0]])
    return found, q, v


def test_a_four_bar_has_one_degree_of_freedom(linkage: tuple[Multibody, np.ndarray, np.ndarray]) -> None:
    found, q, _ = linkage
    assert found.freedom(q) == 1


def test_a_four_bar_accelerates_as_in_pinocchio(linkage: tuple[Multibody, np.ndarray, np.ndarray]) -> None:
    found, q, v = linkage
    tau = np.array([2.0, -0.3, 0.5])
    model = pin.Model()
    at = {}
    for name, parent, x in (("crank", None, 0.0), ("coupler", "crank", 0.2), ("rocker", None, 0.5)):
        joint = pin.JointModelRevoluteUnaligned(np.array([0.0, -1.0, 0.0]))
        at[name] = model.addJoint(at.get(parent, 0), joint, pin.SE3(np.eye(3), np.array([x, 0.0, 0.0])), name)
    for name, mass, c, moments in (("crank", 0.5, 0.1, 0.004), ("coupler", 1.0, 0.25, 0.03), ("rocker", 0.8, 0.2, 0.015)):
        inertia = pin.Inertia(mass, np.array([c, 0.0, 0.0]), np.diag([0.001, moments, moments]))
        model.appendBodyToJoint(at[name], inertia, pin.SE3.Identity())
    data = model.createData()
    ends = [pin.SE3(np.eye(3), np.array([x, 0.0, 0.0])) for x in (0.5, 0.4)]
    loop = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, at["coupler"], ends[0], at["rocker"], ends[1], pin.LOCAL)
    loops, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    loops.append(loop)
    datas.append(loop.createData())
    pin.initConstraintDynamics(model, data, loops, datas)
    settings = pin.ProximalSettings(1e-14, 1e-10, 1000)
    theirs = pin.constraintDynamics(model, data, q, v, tau, loops, datas, settings)
    ours, _ = found.closed_forward(q, v, tau)
    np.testing.assert_allclose(ours, theirs, rtol=1e-8, atol=1e-8 * np.abs(theirs).max())


def test_a_four_bar_accelerates_as_with_a_stiff_connect_in_mujoco(linkage: tuple[Multibody, np.ndarray, np.ndarray]) -> None:
    found, q, v = linkage
    text = """<mujoco><option timestep="1e-4"><flag contact="disable"/></option><worldbody>
    <body name="crank"><joint axis="0 -1 0"/><inertial mass=".5" pos=".1 0 0" diaginertia=".001 .004 .004"/>
    <body name="coupler" pos=".2 0 0"><joint axis="0 -1 0"/><inertial mass="1" pos=".25 0 0" diaginertia=".001 .03 .03"/></body></body>
    <body name="rocker" pos=".5 0 0"><joint axis="0 -1 0"/><inertial mass=".8" pos=".2 0 0" diaginertia=".001 .015 .015"/>
    <site name="b" pos=".4 0 0"/></body></worldbody>
    <equality><connect site1="a" site2="b" solref=".002 1" solimp=".99999 .99999 .001"/></equality></mujoco>"""
    text = text.replace('ertia=".001 .03 .03"/></body>', 'ertia=".001 .03 .03"/><site name="a" pos=".5 0 0"/></body>')
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qpos, data.qvel, data.qfrc_applied = q, v, [2.0, -0.3, 0.5]
    mujoco.mj_forward(model, data)
    ours, _ = found.closed_forward(q, v, [2.0, -0.3, 0.5])
    np.testing.assert_allclose(ours, data.qacc, atol=1e-3 * np.abs(data.qacc).max())


def test_the_stabilisation_returns_to_the_closure(linkage: tuple[Multibody, np.ndarray, np.ndarray]) -> None:
    """phi'' = -2 s phi' - s^2 phi, whatever the forces."""
    found, q, v = linkage
    q, v, s, h = q + 0.01, v + 0.1, 50.0, 1e-6
    a, _ = found.closed_forward(q, v, np.zeros(3), rate=s)
    phi, slope, _ = (np.array(value, dtype=float) for value in found.closure(q, v))
    ahead = np.array(found.closure(q + h * v + h * h / 2 * a, v + h * a)[1], dtype=float) @ (v + h * a)
    behind = np.array(found.closure(q - h * v + h * h / 2 * a, v - h * a)[1], dtype=float) @ (v - h * a)
    wanted = -2 * s * slope @ v - s**2 * phi[:, 0]
    np.testing.assert_allclose(((ahead - behind) / (2 * h))[[0, 2]], wanted[[0, 2]], rtol=1e-4, atol=1e-4 * np.abs(wanted).max())
