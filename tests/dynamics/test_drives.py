"""Actuators by their laws and tendons as springs, against MuJoCo."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

import hymeko_x as hx
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.dynamics.multibody import Multibody
from hymeko_x.dynamics.operating import linearized

MODEL = """<mujoco><option timestep="1e-4"><flag contact="disable" constraint="disable" eulerdamp="disable"/></option><worldbody>
<body><joint name="a" axis="0 1 0" damping="0.1"/><inertial mass="1" pos=".2 0 0" diaginertia=".01 .02 .02"/>
<body pos=".4 0 0"><joint name="b" axis="0 1 0" ref="10"/><inertial mass=".5" pos=".1 0 .02" diaginertia=".01 .02 .02"/>
<body pos=".3 0 0"><joint name="c" type="slide" axis="1 0 0"/><inertial mass=".3" pos=".1 0 0" diaginertia=".01 .02 .02"/>
</body></body></body></worldbody>
<tendon><fixed name="stiff" stiffness="3" damping="1" springlength="0.1"><joint joint="a" coef="2"/><joint joint="b" coef="-1"/></fixed>
<fixed name="slack" stiffness="40"><joint joint="c" coef="1"/><joint joint="b" coef="0.5"/></fixed></tendon>
<actuator><motor name="m" joint="a" gear="3"/><position name="p" joint="b" kp="20" kv="2" gear="2"/><velocity name="v" joint="c" kv="4"/>
<general name="g" tendon="stiff" gear="1.5" gainprm="5" biastype="affine" biasprm="0.3 -2 -3"/><motor name="t" tendon="slack"/></actuator>
</mujoco>"""


def compare(found: Multibody, model: mujoco.MjModel, tolerance: float) -> None:
    """Accelerations at random states and controls."""
    rng = np.random.default_rng(5)
    data = mujoco.MjData(model)
    for _ in range(3):
        data.qpos, data.qvel, data.ctrl, data.act = (rng.normal(size=size) for size in (model.nq, model.nv, model.nu, model.na))
        mujoco.mj_forward(model, data)
        ours = np.array(found.graph([*data.qpos, *data.qvel, *data.act], data.ctrl), dtype=float)[model.nq : model.nq + model.nv, 0]
        np.testing.assert_allclose(ours, data.qacc, atol=tolerance * np.abs(data.qacc).max())


def test_actuators_and_tendons_act_as_in_mujoco() -> None:
    found = hx.dynamics(hx.loads(MODEL, "mjcf").mechanism, inputs="actuators")
    compare(found, mujoco.MjModel.from_xml_string(MODEL), 1e-10)
    units = {"m": "N*m", "p": "rad", "v": "m/s", "g": "", "t": ""}
    assert {v.name: v.unit for v in found.system.inputs} == {f"{name}.control": unit for name, unit in units.items()}


def test_the_linear_system_has_the_laws_of_actuators() -> None:
    """Against the finite differences of one step of semi-implicit Euler: v+ = v + h a(q, v, u)."""
    found = hx.dynamics(hx.loads(MODEL, "mjcf").mechanism, inputs="actuators")
    point = found.at("a=0.3,b=-0.4")._replace(inputs=[0.2, -0.1, 0.3, 0.1, -0.2])
    a, b, _, _ = linearized(found, point).floats
    n, h = 3, 1e-4
    model = mujoco.MjModel.from_xml_string(MODEL)
    data = mujoco.MjData(model)
    data.qpos[:2], data.ctrl = (0.3, -0.4), point.inputs
    theirs, driven = np.zeros((2 * n, 2 * n)), np.zeros((2 * n, 5))
    mujoco.mj_forward(model, data)
    mujoco.mjd_transitionFD(model, data, 1e-6, True, theirs, driven, None, None)
    np.testing.assert_allclose(a[n:, :n], theirs[n:, :n] / h, atol=1e-5 * np.abs(a).max())
    np.testing.assert_allclose(a[n:, n:], (theirs[n:, n:] - np.eye(n)) / h, atol=1e-5 * np.abs(a).max())
    np.testing.assert_allclose(b[n:], driven[n:] / h, atol=1e-5 * np.abs(b).max())


@pytest.mark.full
@pytest.mark.robots("mjcf", every=6)
def test_the_actuators_of_a_robot_act_as_in_mujoco(robot: Path) -> None:
    """Those of fixed bases without balls, of which every actuator and tendon is in the equations."""
    report = Report()
    try:
        found = hx.dynamics(hx.load(robot).mechanism, inputs="actuators", report=report)
        model = mujoco.MjModel.from_xml_path(str(robot))
    except (Refusal, ValueError) as error:
        pytest.skip(str(error))
    left = [d.message for d in report if "not in the equations" in d.message]
    if left or model.nq != model.nv or model.nq != found.tree.nq or found.followers or found.closures:
        pytest.skip("it has more than this test compares")
    pulls = not model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_GRAVITY)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT | mujoco.mjtDisableBit.mjDSBL_CLAMPCTRL)
    model.actuator_forcelimited[:], model.jnt_actfrclimited[:], model.body_gravcomp[:] = 0, 0, 0.0
    model.opt.viscosity = model.opt.density = 0.0
    model.dof_frictionloss[:] = 0.0
    model.tendon_frictionloss[:] = 0.0
    found = hx.dynamics(hx.load(robot).mechanism, inputs="actuators", gravity=tuple(model.opt.gravity * pulls)).frictionless
    compare(found, model, 1e-7)


def test_actuators_that_are_not_in_the_equations_are_named() -> None:
    text = MODEL.replace("</actuator>", '<muscle name="pull" joint="a"/><motor name="push" joint="a" gear="2"/></actuator>')
    report = Report()
    found = hx.dynamics(hx.loads(text, "mjcf").mechanism, inputs="actuators", report=report)
    assert [variable.name for variable in found.system.inputs][-1] == "push.control"
    assert [str(d).split(": ", 2)[-1] for d in report if d.code.id == "HX408"] == [
        "actuator 'pull' is of the kind 'muscle', which is not in the equations"
    ]
    none = MODEL[: MODEL.index("<actuator>")] + "</mujoco>"
    with pytest.raises(Refusal, match=r"HX408\]: .*no actuator of it drives a joint"):
        hx.dynamics(hx.loads(none, "mjcf").mechanism, inputs="actuators")
