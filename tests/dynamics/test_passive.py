"""Springs of balls and free bodies, and Coulomb friction: forces, energies, linear systems and motions, against MuJoCo and closed forms."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
import sympy

import hymeko_x as hx
from hymeko_x.dynamics.multibody import Multibody
from hymeko_x.dynamics.pages import page_of, printed
from hymeko_x.dynamics.passive import SLIP
from tests.dynamics.networks import load
from tests.dynamics.test_engines import relative
from tests.dynamics.test_lines import turns

SPRUNG = """<mujoco><option timestep="1e-4"><flag contact="disable" constraint="disable" eulerdamp="disable"/></option><worldbody>
<body name="float" pos="0.1 0.2 0.3" euler="20 30 40"><joint name="f" type="free" stiffness="3" damping="0.2"/>
<inertial mass="1.5" pos="0.1 0 0.05" diaginertia=".1 .2 .15"/>
<body pos="0 0 0.4" euler="10 0 50"><joint name="b" type="ball" stiffness="2" damping="0.1" pos="0 0.02 0"/>
<inertial mass=".4" pos="0.05 0 .1" diaginertia=".01 .02 .015"/></body></body></worldbody></mujoco>"""
RUBBED = """<mujoco><option timestep="1e-4"><flag contact="disable"/></option><worldbody>
<body><joint name="a" axis="0 1 0" frictionloss="0.4" damping="0.1"/><inertial mass="1" pos=".2 0 0" diaginertia=".01 .02 .02"/>
<body pos=".4 0 0"><joint name="b" axis="0 1 0" stiffness="2"/><inertial mass=".5" pos=".1 0 .02" diaginertia=".01 .02 .02"/>
</body></body></worldbody>
<tendon><fixed name="rope" frictionloss="0.3"><joint joint="a" coef="2"/><joint joint="b" coef="-1"/></fixed></tendon></mujoco>"""


def sprung() -> tuple[Multibody, mujoco.MjModel]:
    return hx.dynamics(hx.loads(SPRUNG, "mjcf")), mujoco.MjModel.from_xml_string(SPRUNG)


def moving(model: mujoco.MjModel, seed: int, far: float = 1.5) -> mujoco.MjData:
    data, rng = mujoco.MjData(model), np.random.default_rng(seed)
    mujoco.mj_integratePos(model, data.qpos, rng.normal(size=model.nv), far)
    data.qvel = rng.normal(size=model.nv)
    mujoco.mj_forward(model, data)
    return data


@pytest.mark.parametrize("seed", range(4))
def test_springs_of_balls_and_free_bodies_are_those_of_mujoco(seed: int) -> None:
    found, model = sprung()
    data = moving(model, seed)
    turn = turns(found, data)
    ours = found.passive(relative(found, data.qpos), turn.T @ data.qvel)
    np.testing.assert_allclose(ours, turn.T @ data.qfrc_passive, atol=1e-11)
    energy = found.port_hamiltonian().functions(found.port_hamiltonian().state([*relative(found, data.qpos)], [*(turn.T @ data.qvel)]))[0]
    model.opt.enableflags |= int(mujoco.mjtEnableBit.mjENBL_ENERGY)
    mujoco.mj_forward(model, data)
    start = mujoco.MjData(model)
    mujoco.mj_forward(model, start)
    still = found.port_hamiltonian().functions(found.port_hamiltonian().state(found.tree.rest, [0.0] * model.nv))[0]
    assert float(energy - still) == pytest.approx(sum(data.energy) - sum(start.energy), rel=1e-11)


def test_the_linear_system_has_the_springs_of_balls_and_free_bodies() -> None:
    """At rest, and from exact derivatives: M A = -K there but for the weights, which do not depend on a free body's place."""
    found = hx.dynamics(hx.loads(SPRUNG, "mjcf"), gravity=(0.0, 0.0, 0.0))
    space = found.state_space()
    n = found.tree.nv
    k, c = (-found.mass_matrix(np.array(found.tree.rest)) @ space.floats[0][n:, part] for part in (slice(n), slice(n, None)))
    np.testing.assert_allclose(k, np.diag([3.0] * 6 + [2.0] * 3), atol=1e-12)
    np.testing.assert_allclose(c, np.diag([0.2] * 6 + [0.1] * 3), atol=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_a_joint_and_a_tendon_that_slide_are_braked_as_in_mujoco(seed: int) -> None:
    """At speeds at which MuJoCo's friction is all of frictionloss."""
    found, model = hx.dynamics(hx.loads(RUBBED, "mjcf")), mujoco.MjModel.from_xml_string(RUBBED)
    data = moving(model, seed)
    data.qvel *= 10
    mujoco.mj_forward(model, data)
    velocities = [data.qvel[0], 2 * data.qvel[0] - data.qvel[1]]
    assert np.abs(velocities).min() > 1
    ours = np.array(found.graph([*data.qpos, *data.qvel], [0, 0]), dtype=float)[2:, 0]
    slip = (SLIP / np.abs(velocities).min()) ** 2
    np.testing.assert_allclose(ours, data.qacc, atol=slip * np.abs(data.qacc).max())
    assert np.abs(np.array(found.frictionless.graph([*data.qpos, *data.qvel], [0, 0]), dtype=float)[2:, 0] - data.qacc).max() > 1.0


BLOCK = "r : robot { world {} a { mass 2 inertia [1 1 1] } @j : prismatic { + world - a axis=X friction 3 damping 0.5 } }"


def test_a_block_slides_to_its_stop_and_is_held_there() -> None:
    """m v' = -f - c v from v0 stops after t = m / c ln(1 + c v0 / f); a pull below f only makes it creep."""
    found = hx.dynamics(load(BLOCK))
    response = found.simulate(4.0, 0.01, {"j": hx_constant(5.0, until=1.0)})
    v = response.states[:, 1]
    v1 = (5 - 3) / 0.5 * (1 - np.exp(-0.5 / 2))
    assert v[100] == pytest.approx(v1, rel=2e-3)  # below SLIP it is held less
    stop = 1 + 2 / 0.5 * np.log(1 + 0.5 * v1 / 3)
    assert v[int(stop * 100) - 1] > 0.01
    assert np.abs(v[int(stop * 100) + 5 :]).max() < 1e-5
    held = found.simulate(2.0, 0.1, {"j": hx_constant(2.0)}).states[:, 1]
    assert held[-1] == pytest.approx(SLIP * 2 / np.sqrt(9 - 4), rel=1e-2)


def hx_constant(value: float, until: float = np.inf) -> object:
    from hymeko_x.dynamics.signals import constant, table

    return constant(value) if until == np.inf else table([0.0, until, until, 10.0], [value, value, 0.0, 0.0])


def test_a_linear_system_is_without_friction_and_says_so() -> None:
    found = hx.dynamics(load(BLOCK))
    np.testing.assert_allclose(found.state_space().floats[0], [[0, 1], [0, -0.25]])
    assert "without the Coulomb friction of: joint 'j'\n" in printed(page_of(found, "state-space"), "text")
    assert "friction" not in printed(page_of(hx.dynamics(load(BLOCK.replace("friction 3 ", ""))), "state-space"), "text")


def test_formulas_have_springs_dampers_and_friction() -> None:
    found = hx.dynamics(load(BLOCK.replace("damping 0.5", "damping 0.5 stiffness 7 spring_ref 0.2"))).symbolic()
    (q,), (v,) = found.q, found.v
    wanted = -7 * (q - sympy.Rational(1, 5)) - v / 2 - 3 * v / sympy.sqrt(v**2 + sympy.Rational(1, 10**6))
    assert sympy.simplify(found.passive[0] - wanted) == 0
    ball = hx.dynamics(load("r : robot { world {} a { mass 2 inertia [1 2 3] } @j : ball { + world - a stiffness 4 } }")).symbolic()
    turn = dict(zip(ball.q, (sympy.sqrt(3) / 2, 0, sympy.Rational(1, 2), 0), strict=True))
    assert ball.passive.subs(turn) == sympy.Matrix([0, -4 * sympy.pi / 3, 0])


def test_formulas_are_those_of_the_independent_coordinates_and_of_actuators() -> None:
    """A follower at half its leader's angle: J + J / 4 turns, and the weight and the spring of the follower act by half."""
    text = """r : robot { world {} a { mass 2 com [0.3 0 0] inertia [1 1 1] } b { mass 1 com [0 0 -0.5] inertia [1 1 1] }
      @j : revolute { + world - a axis=Z } @k : revolute { + world - b axis=Y stiffness 8 [0 0.5] mimic - j } m : servo { kp 6 - j } }"""
    found = hx.dynamics(load(text), inputs="actuators").symbolic()
    (q,), (v,) = found.q, found.v
    assert found.mass == sympy.Matrix([[sympy.Rational(118, 100) + sympy.Rational(125, 100) / 4]])
    assert sympy.simplify(found.bias[0] - sympy.Rational("9.81") / 4 * sympy.sin(q / 2)) == 0
    assert found.passive == sympy.Matrix([-2 * q])
    assert sympy.expand(found.driven[0] - 6 * (sympy.Symbol("u1") - q)) == 0
    assert v.name == "v1"
