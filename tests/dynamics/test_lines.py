"""Tendons along paths, actuators with a state of their own and those at sites, against MuJoCo."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np
import pytest
from msgspec.structs import replace

import hymeko_x as hx
from hymeko_x.corpus.catalog import development_files
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.dynamics.drives import drive, motors_of, remembering, signals_of
from hymeko_x.dynamics.lines import Stretch, line_of, seats_of, stretches
from hymeko_x.dynamics.multibody import Multibody
from hymeko_x.dynamics.numbers import floats, symbols
from hymeko_x.dynamics.operating import linearized
from hymeko_x.dynamics.pages import page_of
from hymeko_x.dynamics.recursion import Constants
from hymeko_x.dynamics.signals import constant
from hymeko_x.ir import parts
from hymeko_x.ir.parts import DofKind
from tests.dynamics.test_engines import relative
from tests.pace import assert_at_most

if TYPE_CHECKING:
    from collections.abc import Callable

BODY = '<inertial mass="{}" pos=".2 0 0.02" diaginertia=".01 .02 .02"/>'
ARM = f"""<site name="w" pos="0.1 0 .3"/><site name="w2" pos="-.2 .1 .4"/>
<body><joint name="a" axis="0 1 0" damping="0.1"/>{BODY.format(1)}<site name="s1" pos=".1 0 .1"/>
<site name="s2" pos=".3 0 .1" euler="10 20 30"/>
<body pos=".4 0 0"><joint name="b" axis="0 1 0" ref="10" springref="20"/>{BODY.format(0.5)}<site name="s3" pos=".1 .02 .1" euler="30 0 20"/>
<body pos=".3 0 0"><joint name="c" type="slide" axis="1 0 0"/>{BODY.format(0.3)}<site name="s4" pos=".1 0 .05"/>
</body></body></body>"""
LOOSE = f"""<body pos="0 1 0" euler="10 20 0"><freejoint name="base"/>{BODY.format(2)}<site name="s5" pos=".1 0 .1"/>
<body pos="0.1 0 0.2"><joint name="ball" type="ball"/>{BODY.format(0.7)}<site name="s6" pos="0 .3 .1"/></body></body>"""
TENDONS = """<tendon>
<spatial name="straight" stiffness="30" damping="2"><site site="w"/>
<site site="s1"/><site site="s2"/><site site="s3"/><site site="s4"/></spatial>
<spatial name="slack" stiffness="50" springlength="0.2 0.9"><site site="w2"/><site site="s4"/></spatial>
<spatial name="block" stiffness="20" damping="1" springlength="0.3"><site site="w"/><site site="s2"/><pulley divisor="2"/><site site="s2"/>
<site site="w2"/><pulley divisor="2"/><site site="s3"/><site site="s1"/></spatial>
{}</tendon>"""
ACROSS = '<spatial name="across" stiffness="8" damping=".3"><site site="s4"/><site site="s5"/><site site="s6"/><site site="w"/></spatial>'
ACTUATORS = """<actuator>
<general name="filter" joint="a" gear="3" dyntype="filter" dynprm=".2" gainprm="4" biastype="affine" biasprm="0.1 -2 -.3"/>
<general name="exact" tendon="straight" gear="1.5" dyntype="filterexact" dynprm="0.05" gaintype="affine" gainprm="2 .3 .1"/>
<intvelocity name="speed" joint="b" kp="7" kv=".5"/><position name="late" joint="c" kp="9" dampratio="0.7" timeconst="0.1"/>
<position name="damped" joint="a" kp="20" dampratio="1" gear="2"/><damper name="brake" joint="b" kv="3" ctrlrange="0 1"/>
<motor name="pull" tendon="block" gear="-2"/><motor name="jet" site="s3" gear="1 2 3 .1 .2 .3"/>
<motor name="plain" joint="c"/><cylinder class="wide" name="oil" joint="c" timeconst=".3" bias=".1 .2 -.3"/></actuator>"""
FLAGS = '<option timestep="1e-4"><flag contact="disable" constraint="disable" eulerdamp="disable" clampctrl="disable"/></option>'
CLASS = '<default><default class="wide"><cylinder diameter="2"/></default></default>'
MODEL = f"<mujoco>{FLAGS}{CLASS}<worldbody>{ARM}</worldbody>{TENDONS.format('')}{ACTUATORS}</mujoco>"
WHOLE = f"<mujoco>{FLAGS}{CLASS}<worldbody>{ARM}{LOOSE}</worldbody>{TENDONS.format(ACROSS)}{ACTUATORS}</mujoco>"


def turns(found: Multibody, data: mujoco.MjData) -> np.ndarray:
    """T with v_mujoco = T v: MuJoCo's free joints move along the world's axes, ours along their own."""
    turn = np.eye(found.tree.nv)
    for link in found.tree.links:
        if link.dof.kind is DofKind.FREE:
            matrix = np.zeros(9)
            mujoco.mju_quat2Mat(matrix, data.qpos[link.q + 3 : link.q + 7])
            turn[link.v : link.v + 3, link.v : link.v + 3] = matrix.reshape(3, 3)
    return turn


def dense(found: list[Stretch], width: int) -> np.ndarray:
    rows = np.zeros((len(found), width))
    for row, stretch in zip(rows, found, strict=True):
        row[list(stretch.row)] = list(stretch.row.values())
    return rows


def compare(found: Multibody, model: mujoco.MjModel) -> None:
    """Lengths and Jacobians of tendons, and the forces and states' rates of actuators, at a random state, to 1e-10."""
    data, rng = mujoco.MjData(model), np.random.default_rng(3)
    mujoco.mj_integratePos(model, data.qpos, rng.normal(size=model.nv), 0.5)
    data.qvel, data.ctrl, data.act = (rng.normal(size=size) for size in (model.nv, model.nu, model.na))
    mujoco.mj_forward(model, data)
    turn, q = turns(found, data), list(relative(found, data.qpos))
    v, constants = list(turn.T @ data.qvel), Constants(found.tree, floats())
    if model.ntendon:
        seats = seats_of(found.mechanism, found.tree)
        lines = [line_of(found.mechanism, found.tree, tendon, arcs, seats) for _, tendon, arcs in found.mechanism.edges(parts.Tendon)]
        along = stretches(lines, constants, q)  # type: ignore[arg-type]
        jacobian = np.zeros((model.ntendon, model.nv))
        mujoco.mju_sparse2dense(jacobian, data.ten_J, model.ten_J_rownnz, model.ten_J_rowadr, model.ten_J_colind)
        np.testing.assert_allclose([float(stretch.length) for stretch in along], data.ten_length, atol=1e-10, rtol=0)
        np.testing.assert_allclose(dense(along, model.nv), jacobian @ turn, atol=1e-10, rtol=0)
    motors = found.motors or ()
    forces: list[Any] = [0.0] * model.nv
    drive(forces, motors, signals_of(motors, list(data.act), list(data.ctrl)), constants, q, v)
    theirs = turn.T @ data.qfrc_actuator
    np.testing.assert_allclose(np.array(forces, dtype=float), theirs, atol=1e-10 * max(1, abs(theirs).max()), rtol=0)
    if model.na:
        rates = np.array(found.graph([*q, *v, *data.act], data.ctrl), dtype=float)[:, 0]
        np.testing.assert_allclose(rates[-model.na :], data.act_dot, atol=1e-10 * max(1, abs(data.act_dot).max()))


@pytest.mark.parametrize("text", [MODEL, WHOLE])
def test_paths_and_actuators_with_states_are_as_in_mujoco(text: str) -> None:
    found, model = hx.dynamics(hx.loads(text, "mjcf").mechanism, inputs="actuators"), mujoco.MjModel.from_xml_string(text)
    compare(found, model)
    assert [state.name for state in found.system.states if state.name.endswith("activation")] == [
        "filter.activation",
        "exact.activation",
        "speed.activation",
        "late.activation",
        "oil.activation",
    ]
    assert {state.name: state.unit for state in found.system.states}["speed.activation"] == "rad"


def test_tendons_along_paths_pull_as_in_mujoco() -> None:
    found, model = hx.dynamics(hx.loads(WHOLE, "mjcf").mechanism), mujoco.MjModel.from_xml_string(WHOLE)
    data, rng = mujoco.MjData(model), np.random.default_rng(4)
    mujoco.mj_integratePos(model, data.qpos, rng.normal(size=model.nv), 0.5)
    data.qvel = rng.normal(size=model.nv)
    mujoco.mj_forward(model, data)
    turn = turns(found, data)
    forces = found.passive(relative(found, data.qpos), turn.T @ data.qvel)
    np.testing.assert_allclose(forces, turn.T @ data.qfrc_passive, atol=1e-10 * np.abs(data.qfrc_passive).max())
    assert [cable.id.name for cable in found.cables] == ["straight", "slack", "block", "across"]


def test_the_length_of_a_path_has_symbols() -> None:
    """Exactly: the distance of two sites as a formula, equal to its value in floats."""
    import sympy

    found = hx.dynamics(hx.loads(MODEL, "mjcf").mechanism)
    q = sympy.symbols("q1 q2 q3", real=True)
    (formula,) = stretches([found.cables[1].line], Constants(found.tree, symbols()), list(q))
    (value,) = stretches([found.cables[1].line], Constants(found.tree, floats()), [0.3, -0.2, 0.1])
    at = dict(zip(q, (0.3, -0.2, 0.1), strict=True))
    assert float(formula.length.subs(at)) == pytest.approx(float(value.length), abs=1e-12)
    slope = [float(sympy.diff(formula.length, symbol).subs(at)) for symbol in q]
    assert slope == pytest.approx([float(value.row[k]) for k in range(3)], abs=1e-12)


def test_the_linear_system_has_the_states_of_actuators() -> None:
    """Against the finite differences of one step of Euler: x+ = x + h f(x, u)."""
    text = MODEL.replace("filterexact", "filter").replace('timeconst="0.1"', "")
    found = hx.dynamics(hx.loads(text, "mjcf").mechanism, inputs="actuators")
    point = found.at("a=0.3,b=-0.4,c=0.1")
    point = point._replace(inputs=[0.2 * k for k in range(10)], activations=[0.5, -0.2, 0.3, 0.7])
    a, b, _, _ = linearized(found, point).floats
    model, h, n = mujoco.MjModel.from_xml_string(text), 1e-4, 3
    data = mujoco.MjData(model)
    data.qpos[:], data.ctrl, data.act = (0.3, -0.4, 0.1), point.inputs, point.activations
    mujoco.mj_forward(model, data)
    theirs, driven = np.zeros((2 * n + 4, 2 * n + 4)), np.zeros((2 * n + 4, 10))
    mujoco.mjd_transitionFD(model, data, 1e-6, True, theirs, driven, None, None)
    np.testing.assert_allclose(a[n:], (theirs - np.eye(2 * n + 4))[n:] / h, atol=1e-5 * np.abs(a).max())
    np.testing.assert_allclose(b[n:], driven[n:] / h, atol=1e-5 * np.abs(b).max())


def test_a_filter_holds_a_robot_and_lags() -> None:
    text = (
        f'<mujoco><worldbody><body><joint name="j" axis="0 1 0"/>{BODY.format(1)}</body></worldbody>'
        "<actuator>"
        '<general name="lag" joint="j" dyntype="filter" dynprm="0.5"/>'
        '<general name="sum" joint="j" dyntype="integrator"/></actuator></mujoco>'
    )
    found = hx.dynamics(hx.loads(text, "mjcf").mechanism, inputs="actuators")
    point = found.at("j=0.4")
    assert point.is_equilibrium
    assert point.inputs == [point.activations[0], 0.0]
    assert sum(point.activations) == pytest.approx(-9.81 * (0.2 * np.cos(0.4) + 0.02 * np.sin(0.4)))
    assert re.sub(r"-?\d+\.\d+", "F", page_of(found, "state-space", at="j=0.4").facts["held by"]) == (
        "lag.control = F, lag.activation = F, sum.activation = F"
    )
    poles = sorted(pole.value.real for pole in found.state_space("j=0.4").poles)
    assert min(abs(np.array(poles) + 2.0)) < 1e-9
    response = found.simulate(1.0, 0.25, {"lag": constant(1.0)})
    assert response.states[:, 2] == pytest.approx(1.0 - np.exp(-2.0 * response.time), abs=1e-8)
    for form in (found.second_order, found.port_hamiltonian):
        with pytest.raises(Refusal, match=r"HX408\]: actuator 'lag' has a state of its own"):
            form()


def test_the_energy_form_has_paths() -> None:
    """The gradient of the energy is what the recursions have: p' of the form is M v' of the system, at rest."""
    text = MODEL[: MODEL.index("<actuator>")] + '<actuator><motor name="m" tendon="block"/></actuator></mujoco>'
    found = hx.dynamics(hx.loads(text, "mjcf").mechanism, inputs="actuators")
    form, q = found.port_hamiltonian(), [0.3, -0.4, 0.1]
    _, effort, j, r, g = (np.array(part, dtype=float) for part in form.functions([*q, 0, 0, 0]))
    rates = (j - r) @ effort[:, 0] + g[:, 0] * 0.7
    moved = np.array(found.graph([*q, 0, 0, 0], [0.7]), dtype=float)[3:, 0]
    np.testing.assert_allclose(rates[3:], found.mass_matrix(np.array(q)) @ moved, atol=1e-10, rtol=0)


def test_paths_around_shapes_and_muscles_are_named() -> None:
    wrapped = MODEL.replace('<site name="s1"', '<geom name="g" type="sphere" size=".02"/><site name="s1"', 1).replace(
        '<site site="s1"/><site site="s2"/>', '<site site="s1"/><geom geom="g"/><site site="s2"/>', 1
    )
    text = wrapped.replace("</actuator>", '<muscle name="biceps" joint="a"/></actuator>')
    text = text.replace('name="slack"', 'name="slack" frictionloss=".1" armature=".2"')
    report = Report()
    hx.dynamics(hx.loads(text, "mjcf").mechanism, inputs="actuators", report=report)
    assert [d.message for d in report if d.code.id == "HX408"] == [
        "tendon 'straight' wraps around the shape 'g', which is not in the equations",
        "actuator 'exact' pulls tendon 'straight', which wraps around the shape 'g', which is not in the equations",
        "actuator 'biceps' is of the kind 'muscle', which is not in the equations",
        "tendon 'slack' has an armature, which is not in the equations",
    ]


ROBOTS = (
    "dm_control/model_with_third_order_actuators.xml",
    "dm_control/quadruped.xml",
    "gymnasium_robotics/coupled_half_cheetah.xml",
    "safety_gymnasium/point.xml",
)


@pytest.mark.corpus
@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.unread
def test_the_tendons_and_actuators_of_a_robot_are_as_in_mujoco(name: str, real_robot: Any) -> None:
    """Tendons along paths, filters and integrators, and actuators at sites."""
    (file,) = [file for file in development_files("mjcf") if file.id == name]
    assert_acts_as_in_mujoco(real_robot(file))


@pytest.mark.full
@pytest.mark.robots("mjcf")
@pytest.mark.unread
def test_those_of_every_robot_are_as_in_mujoco(robot: Path) -> None:
    assert_acts_as_in_mujoco(robot)


def assert_acts_as_in_mujoco(robot: Path) -> None:
    try:
        model = mujoco.MjModel.from_xml_path(str(robot))
    except ValueError as error:
        pytest.skip(str(error))
    paths = {int(mujoco.mjtWrap.mjWRAP_SITE), int(mujoco.mjtWrap.mjWRAP_PULLEY), int(mujoco.mjtWrap.mjWRAP_JOINT)}
    if not model.nu + model.ntendon or not set(model.wrap_type.tolist()) <= paths:
        pytest.skip("it has no tendons and actuators that this test compares")
    mechanism = hx.load(robot).mechanism
    found = hx.dynamics(mechanism)
    motors, left = motors_of(mechanism, found.tree)
    if left or len(motors) != model.nu:
        pytest.skip(f"not in the equations: {left[:1]}")
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT | mujoco.mjtDisableBit.mjDSBL_CLAMPCTRL)
    model.actuator_forcelimited[:], model.jnt_actfrclimited[:], model.tendon_actfrclimited[:], model.jnt_actgravcomp[:] = 0, 0, 0, 0
    model.actuator_actlimited[:] = 0
    compare(replace(found, motors=motors, followers=(), closures=()), model)


def test_a_chain_of_followers_is_ordered_in_linear_time() -> None:
    from hymeko_x.dynamics.couplings import Follower, _ordered

    def ordering(count: int) -> Callable[[], list[int]]:
        chain = {place: Follower(place, ((place - 1, (0.0, 1.0)),)) for place in range(count, 0, -1)}
        return lambda: [follower.link for follower in _ordered(None, None, dict(chain))]  # type: ignore[arg-type]

    assert ordering(16_000)() == list(range(1, 16_001))
    assert_at_most(2.0, ordering(16_000), ordering(2_000), count=8)
    assert remembering(None) == []
