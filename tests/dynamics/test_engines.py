"""Mass matrix, bias, inverse and forward dynamics of real robots against Pinocchio and MuJoCo."""

from __future__ import annotations

import warnings
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest

import hymeko_x as hx
from hymeko_x.diagnostics import Refusal
from hymeko_x.dynamics.multibody import Multibody
from hymeko_x.ir.parts import DofKind

KINDS = {DofKind.FREE: 0, DofKind.BALL: 1, DofKind.SLIDE: 2, DofKind.HINGE: 3}
FLAGS = ("CONSTRAINT", "ACTUATION", "SPRING", "DAMPER")
BAD_CONDITION = 1e10
"""Of a mass matrix: beyond it no two programs agree on accelerations to ten digits."""


def of(path: Path, **options: object) -> Multibody | None:
    """The dynamics of a robot; None where nothing moves, or something moves no mass."""
    try:
        return hx.dynamics(hx.load(path).mechanism, **options)  # type: ignore[return-value]
    except Refusal as refusal:
        if refusal.diagnostic.code.id not in ("HX400", "HX404"):
            raise
        return None


def close(ours: np.ndarray, theirs: np.ndarray, tolerance: float) -> None:
    assert np.abs(ours - theirs).max() <= tolerance * max(1e-6, np.abs(theirs).max())


@pytest.mark.robots("urdf", every=6)
@pytest.mark.unread("HX005", "HX040")
def test_a_urdf_moves_as_in_pinocchio(robot: Path) -> None:
    found = of(robot)
    try:
        model = pin.buildModelFromUrdf(str(robot))
    except (ValueError, RuntimeError) as error:
        pytest.skip(f"Pinocchio refuses it: {error}")
    data = model.createData()
    if found is None:
        mass = np.array(pin.crba(model, data, pin.neutral(model)))
        assert model.nv == 0 or np.diag(mass).min() < 1e-12
        return
    rng = np.random.default_rng(0)
    n = 3
    q, v, a = (rng.uniform(-1, 1, (n, found.tree.nv)) for _ in range(3))
    joints = [model.joints[model.getJointId(link.joint.name)] for link in found.tree.links]
    columns = np.array([joint.idx_v for joint in joints])
    theirs_q = np.tile(pin.neutral(model), (n, 1))
    for link, joint in zip(found.tree.links, joints, strict=True):
        angle = q[:, link.q]
        theirs_q[:, joint.idx_q : joint.idx_q + joint.nq] = angle[:, None] if joint.nq == 1 else np.stack([np.cos(angle), np.sin(angle)], 1)
    mass, tau, bias = found.mass_matrix(q), found.inverse(q, v, a), found.bias(q, v)
    singular = min(np.linalg.eigvalsh(matrix).min() for matrix in mass) < 1e-14
    moved = a if singular else found.forward(q, v, a)
    for row in range(n):
        theirs_v, theirs_a = np.zeros(model.nv), np.zeros(model.nv)
        theirs_v[columns], theirs_a[columns] = v[row], a[row]
        upper = np.triu(np.array(pin.crba(model, data, theirs_q[row])))
        whole = upper + np.triu(upper, 1).T
        close(mass[row], whole[np.ix_(columns, columns)], 1e-10)
        close(tau[row], np.array(pin.rnea(model, data, theirs_q[row], theirs_v, theirs_a))[columns], 1e-10)
        close(bias[row], np.array(pin.rnea(model, data, theirs_q[row], theirs_v, 0 * theirs_a))[columns], 1e-10)
        if not singular and np.linalg.cond(whole) < BAD_CONDITION:
            close(
                moved[row],
                np.array(pin.aba(model, data, theirs_q[row], theirs_v, theirs_a))[columns],
                1e-10 * max(1.0, np.linalg.cond(whole) * 1e-4),
            )


def mujoco_model(path: Path) -> mujoco.MjModel | None:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            model = mujoco.MjModel.from_xml_path(str(path))
    except ValueError:
        return None
    for flag in FLAGS:
        model.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag}"))
    model.opt.viscosity = model.opt.density = 0.0
    model.body_gravcomp[:] = 0.0
    return model


def relative(found: Multibody, qpos: np.ndarray) -> np.ndarray:
    """MuJoCo's configuration with the poses of free joints counted from the frames of these joints."""
    q = qpos.copy()
    for link in found.tree.links:
        if link.dof.kind is DofKind.FREE:
            own = slice(link.q, link.q + 3), slice(link.q + 3, link.q + 7)
            back, turn, quat = np.zeros(4), np.zeros(4), np.zeros(4)
            rotation = np.array(link.frame.rotation)
            mujoco.mju_mat2Quat(turn, rotation.reshape(-1))
            mujoco.mju_negQuat(back, turn)
            mujoco.mju_mulQuat(quat, back, qpos[own[1]])
            q[own[0]], q[own[1]] = rotation.T @ (qpos[own[0]] - np.array(link.frame.position)), quat
    return q


@pytest.mark.robots("mjcf", every=8)
def test_an_mjcf_moves_as_in_mujoco(robot: Path) -> None:
    """MuJoCo's free joints count from the world and move along its axes, ours from their joint's frame and along their own:
    v_world = R v, a_world = R (a + w x v)."""
    model = mujoco_model(robot)
    if model is None:
        pytest.skip("MuJoCo refuses it")
    if model.nv == 0:
        assert of(robot) is None
        return
    pulls = not model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_GRAVITY)
    found = of(robot, gravity=tuple(model.opt.gravity * pulls))
    assert found is not None
    assert [KINDS[link.dof.kind] for link in found.tree.links] == list(model.jnt_type)
    data = mujoco.MjData(model)
    rng = np.random.default_rng(0)
    mujoco.mj_integratePos(model, data.qpos, rng.normal(size=model.nv), 0.5)
    data.qvel = rng.normal(size=model.nv)
    mujoco.mj_forward(model, data)
    turn = np.eye(model.nv)
    for link in found.tree.links:
        if link.dof.kind is DofKind.FREE:
            matrix = np.zeros(9)
            mujoco.mju_quat2Mat(matrix, data.qpos[link.q + 3 : link.q + 7])
            turn[link.v : link.v + 3, link.v : link.v + 3] = matrix.reshape(3, 3)
    v = turn.T @ data.qvel
    drift = np.zeros(model.nv)
    for link in found.tree.links:
        if link.dof.kind is DofKind.FREE:
            drift[link.v : link.v + 3] = np.cross(v[link.v + 3 : link.v + 6], v[link.v : link.v + 3])
    whole = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, whole)
    theirs = turn.T @ whole @ turn
    q = relative(found, data.qpos)
    close(found.mass_matrix(q), theirs, 1e-10)
    close(found.bias(q, v), turn.T @ data.qfrc_bias + theirs @ drift, 1e-10)
    close(found.forward(q, v, np.zeros(model.nv)), turn.T @ data.qacc - drift, 1e-14 * max(1e5, np.linalg.cond(theirs)))
