"""Lumped networks: the published example, random networks against MuJoCo and the matrix exponential, and what is refused."""

from __future__ import annotations

import re
from pathlib import Path

import control
import hypothesis
import mujoco
import numpy as np
import pytest
import sympy
from hypothesis import strategies as st
from scipy.linalg import expm
from scipy.signal import lsim

import hymeko_x as hx
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.dynamics.linear import report_unstable
from hymeko_x.dynamics.signals import signal_of, table
from hymeko_x.dynamics.simulation import simulate
from tests.dynamics.networks import load, mujoco_model, random_network

LISTING = Path(__file__).parents[2] / "corpus" / "listings" / "quarter_vehicle_model.hymeko"


@pytest.fixture(scope="module")
def car() -> hx.dynamics.Lumped:
    return hx.dynamics(hx.load(LISTING).mechanism)


# ---- the published example -----------------------------------------------------------------------------------------------


def test_the_quarter_vehicle_has_the_published_matrices(car: hx.dynamics.Lumped) -> None:
    space = car.state_space()
    assert sympy.Matrix([[0, 1], [-1000, -20]]) == space.A
    assert sympy.Matrix([[0, 0], [1000, 20]]) == space.B
    assert (sympy.Matrix([[1, 0]]), sympy.Matrix([[0, 0]])) == (space.C, space.D)
    assert [variable.name for variable in space.inputs] == ["chassis.position", "chassis.velocity"]
    assert sorted((round(p.value.real, 9), round(p.value.imag, 9)) for p in space.poles) == [(-10.0, -30.0), (-10.0, 30.0)]
    assert (space.controllable, space.observable) == (2, 2)


def test_the_quarter_vehicle_in_symbols_is_equation_8(car: hx.dynamics.Lumped) -> None:
    m, c, k = sympy.symbols("m c k", positive=True)
    space = car.state_space(symbolic=True)
    assert sympy.Matrix([[0, 1], [-k / m, -c / m]]) == space.A
    assert sympy.Matrix([[0, 0], [k / m, c / m]]) == space.B
    s = sympy.Symbol("s")
    assert sympy.simplify(space.transfer()[0][0] - (c * s + k) / (m * s**2 + c * s + k)) == 0


def test_the_transfer_function_is_that_of_python_control(car: hx.dynamics.Lumped) -> None:
    space = car.state_space()
    (function,) = space.transfer()[0]
    both = control.ss2tf(control.ss(*space.floats))
    frequency = np.logspace(-1, 3, 20)
    theirs = both(1j * frequency)
    s = sympy.Symbol("s")
    ours = np.array([complex(function.subs(s, 1j * w)) for w in frequency])
    np.testing.assert_allclose(ours, theirs[0, 0] + 1j * frequency * theirs[0, 1], rtol=1e-9)


def test_the_response_is_that_of_lsim(car: hx.dynamics.Lumped) -> None:
    """A road without jumps: the velocity is given to lsim as a second input, in the same straight lines."""
    t = np.arange(2001) * 1e-3
    road = 0.05 * np.sin(5 * t) ** 2
    response = car.simulate(2.0, 1e-3, {"chassis": table(t.tolist(), road.tolist())})
    a, b, c, d = car.state_space().floats
    shifted = (a, (b[:, :1] + a @ b[:, 1:]), c, d[:, :1] + c @ b[:, 1:])
    _, y, _ = lsim(shifted, road, t)
    np.testing.assert_allclose(response.outputs[:, 0], y, atol=1e-12)


def test_a_jump_of_the_road_kicks_the_mass_through_the_damper(car: hx.dynamics.Lumped) -> None:
    response = car.simulate(1.0, 1e-3, {"chassis.position": signal_of((("signal", "step"), ("amplitude", 0.1)), 1.0, "chassis")})
    assert response.states[0] == pytest.approx([0.0, 20 * 0.1])
    a = car.state_space().floats[0]
    for k in (1, 500, 1000):
        free = expm(a * response.time[k]) @ np.array([-0.1, 2.0])
        assert response.states[k] == pytest.approx([0.1 + free[0], free[1]], abs=1e-12)


# ---- random networks -----------------------------------------------------------------------------------------------------


def _compare(seed: int) -> None:
    case = random_network(seed)
    found = hx.dynamics(load(case.text))
    unit = "rad" if seed % 3 == 0 else "m"
    assert [variable.unit for variable in found.system.states] == [unit] * len(case.positions) + [f"{unit}/s"] * len(case.positions)
    form = found.second_order()
    m, c, k = (np.array(matrix.tolist(), dtype=float) for matrix in (form.M, form.C, form.K))
    for matrix in (m, c, k):
        np.testing.assert_array_equal(matrix, matrix.T)
    assert np.linalg.eigvalsh(m).min() > 0
    assert np.linalg.eigvalsh(k).min() > -1e-9 * np.abs(k).max()
    assert np.linalg.eigvalsh(c).min() > -1e-9 * max(1.0, np.abs(c).max())
    space = found.state_space()
    start = [*case.positions, *case.velocities]
    response = simulate(found.system, {}, 1.0, 0.01, start)
    a, offset = space.floats[0], np.array(space.offset.tolist(), dtype=float).reshape(-1)
    whole = np.block([[a, offset[:, None]], [np.zeros((1, len(a) + 1))]])
    for row in (37, 100):
        exact = (expm(whole * response.time[row]) @ [*start, 1.0])[:-1]
        np.testing.assert_allclose(response.states[row], exact, atol=1e-9)
    model = mujoco_model(found.network)
    data = mujoco.MjData(model)
    data.qpos, data.qvel = case.positions, case.velocities
    for _ in range(1000):
        mujoco.mj_step(model, data)
    np.testing.assert_allclose(response.states[-1], [*data.qpos, *data.qvel], atol=1e-6)


@pytest.mark.parametrize("seed", range(12))
def test_a_random_network_moves_as_in_mujoco_and_by_the_matrix_exponential(seed: int) -> None:
    _compare(seed)


@pytest.mark.full
@hypothesis.settings(max_examples=1000, deadline=None)
@hypothesis.given(st.integers(0, 2**32))
def test_a_thousand_random_networks_do(seed: int) -> None:
    _compare(seed)


@pytest.mark.parametrize("seed", range(5))
def test_the_port_hamiltonian_form_is_the_same_system(seed: int) -> None:
    """J antisymmetric, R positive semidefinite, and the rates of deflections and momenta are those of the equations."""
    case = random_network(seed)
    found = hx.dynamics(load(case.text.replace("ground : ground", 'ground : port { type "flow" } old : ground')))
    form = found.port_hamiltonian()
    assert form.J == -form.J.T
    together = np.array(form.R.row_join(form.P).col_join(form.P.T.row_join(form.S)).tolist(), dtype=float)
    assert np.linalg.eigvalsh(together).min() > -1e-9 * np.abs(together).max()
    n = len(case.positions)
    network = found.network
    incidence = np.array(form.J[:-n, -n:].tolist(), dtype=float)
    road = np.array(form.G[:-n, :].tolist(), dtype=float)[:, 0]
    z, velocity = 0.03, 0.4
    deflections = incidence @ case.positions + road * z
    momenta = [network.masses[key] * v for key, v in zip(network.coordinates, case.velocities, strict=True)]
    values = dict(zip(form.symbols, [*deflections, *momenta], strict=True))
    gradient = np.array(form.gradient.subs(values).tolist(), dtype=float)[:, 0]
    j, r, g, p = (np.array(matrix.tolist(), dtype=float) for matrix in (form.J, form.R, form.G, form.P))
    rates = (j - r) @ gradient + (g - p) @ [velocity]
    from hymeko_x.dynamics.numbers import floats

    system = found.system
    ours = system.rates([*case.positions, *case.velocities, z], [velocity], system.values("parameters"), floats())
    np.testing.assert_allclose(rates[-n:], np.array(ours[n : 2 * n]) * list(network.masses.values()), atol=1e-9)
    np.testing.assert_allclose(rates[:-n], incidence @ case.velocities + road * velocity, atol=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_the_midpoint_rule_keeps_the_power_balance(seed: int) -> None:
    """What the energy grows by is what enters through the ports less what the dampers take; without dampers and inputs nothing."""
    case = random_network(seed)
    form = hx.dynamics(load(case.text.replace("ground : ground {}", 'ground : port { type "flow" }'))).port_hamiltonian()
    rng = np.random.default_rng(seed)
    start, u, h = rng.normal(size=len(form.states)), rng.normal(size=(200, 1)), 0.01
    x, y, energy = form.simulate(start, u, h)
    r, p, s, q = (np.array(m.tolist(), dtype=float) for m in (form.R, form.P, form.S, form.gradient.jacobian(form.symbols)))
    rest = np.array(form.gradient.subs(dict.fromkeys(form.symbols, 0)).tolist(), dtype=float)[:, 0]
    e = (x[1:] + x[:-1]) / 2 @ q.T + rest
    whole = np.block([[r, p], [p.T, s]])
    both = np.hstack([e, u])
    balance = h * (np.einsum("ni,ni->n", y, u) - np.einsum("ni,ij,nj->n", both, whole, both))
    assert np.ptp(energy) > 1e-3
    np.testing.assert_allclose(np.diff(energy), balance, atol=1e-8 * np.abs(energy).max())
    quiet = hx.dynamics(load(re.sub(r" ~ d\d", "", case.text))).port_hamiltonian()
    _, _, kept = quiet.simulate(start, np.zeros((1000, len(quiet.inputs))), h)
    np.testing.assert_allclose(kept, kept[0], rtol=1e-8)


# ---- what networks are made of -------------------------------------------------------------------------------------------

RACK = """rack : robot {
  wheel : inertia { mass 0.02kg*m^2 } bar : mass { mass 3kg } wall : ground {}
  @teeth : coupling { + bar [0 0.05] - wheel }
  k : spring { stiffness 40N/m } twist : damper { damping 0.1Nm*s/rad } hand : force {}
  @a : constitutive { + wall - bar ~ k } @b : constitutive { + wall - wheel ~ twist ~ hand }
}"""


def test_a_rack_and_its_pinion_are_one_coordinate() -> None:
    form = hx.dynamics(load(RACK)).second_order()
    assert sympy.Matrix([[sympy.Rational("0.02") + 3 * sympy.Rational("0.05") ** 2]]) == form.M
    assert sympy.Matrix([[40 * sympy.Rational("0.05") ** 2]]) == form.K
    assert sympy.Matrix([[sympy.Rational("0.1")]]) == form.C
    assert [(variable.name, variable.unit) for variable in form.inputs] == [("hand.effort", "N*m")]


CONTROLLED = """held : robot {
  m : mass { mass 2 } wall : ground {} push : disturbance {}
  law : pid { p 30 i 10 d 4 value 0.5 }
  @drive : constitutive { + wall - m ~ law ~ push }
}"""


def test_a_pid_controller_holds_a_mass_against_a_disturbance() -> None:
    found = hx.dynamics(load(CONTROLLED))
    assert [variable.name for variable in found.system.states] == ["m.position", "m.velocity", "law.integral"]
    response = found.simulate(60.0, 0.01, {"push": signal_of((("signal", "step"), ("amplitude", 3.0)), 60.0, "push")})
    assert response.outputs[-1, 0] == pytest.approx(0.5, abs=1e-6)
    polynomial = sympy.Poly(sympy.fraction(found.state_space().transfer()[0][0])[1])
    assert [c / polynomial.LC() for c in polynomial.all_coeffs()] == [1, 2, 15, 5]


def test_state_feedback_moves_the_poles() -> None:
    text = CONTROLLED.replace("law : pid { p 30 i 10 d 4 value 0.5 }", "law : feedback {}").replace("~ law", "~ law [4 6] sense ~ m")
    poles = hx.dynamics(load(text)).state_space().poles
    assert [pole.value for pole in poles] == pytest.approx([-1, -2])


def test_a_nonlinear_spring_and_damper_move_by_their_laws() -> None:
    """The energy of a Duffing oscillator without damping stays what it is."""
    text = 'd : robot { m : mass { mass 1 } w : ground {} k : spring { stiffness 2 law "k*x + 5*x**3" } @e : constitutive { + w - m ~ k } }'
    found = hx.dynamics(load(text))
    assert not found.is_linear
    assert sympy.Matrix([[0, 1], [-2, 0]]) == found.state_space().A
    response = simulate(found.system, {}, 5.0, 0.01, [0.6, 0.0])
    x, v = response.states.T
    energy = v**2 / 2 + x**2 + 5 / 4 * x**4
    np.testing.assert_allclose(energy, energy[0], rtol=1e-8)


REFUSED = {
    "a : mass {} ": "needs 'mass'",
    "a : mass { mass 0 } w : ground {} k : spring { k 1 } @e : constitutive { + w - a ~ k }": "HX402]: mass 'a' moves and has the mass 0",
    "a { } w : ground {} k : spring { k 1 } @e : constitutive { + w - a ~ k }": "HX402]: body 'a' moves and has no mass",
    "a : mass { mass 1kg } k : spring { k 3Nm/rad } w : ground {} @e : constitutive { + w - a ~ k }": "HX401]: spring 'k' is in rotation",
    "a : mass { mass 1 } b : mass { mass 1 } @c : coupling { + a [0 2] - b } @d : coupling { + b [0 2] - a }": "HX403]: mass 'a', mass 'b'",
    'a : mass { mass 1 } w : port { type "magic" } k : spring { k 1 } @e : constitutive { + w - a ~ k }': "HX406]: port 'w' is a port of",
    'a : mass { mass 1 } w : ground {} k : spring { k 1 law "k*y" } @e : constitutive { + w - a ~ k }': "HX406]: the law of spring 'k'",
    'a : mass { mass 1 } w : ground {} k : spring { k 1 law "x.real" } @e : constitutive { + w - a ~ k }': "has 'x.real'; it is arithmetic",
    "a : mass { mass 1 } w : ground {} c : pid { pp 3 } @e : constitutive { + w - a ~ c }": (
        "HX406]: port 'c': a pid has no 'pp'; it has p, i, d, value and a signal"
    ),
    "a : mass { mass 1 } w : ground {} c : feedback { p 3 } @e : constitutive { + w - a ~ c }": "HX406]: port 'c': a feedback has no 'p'",
    'a : mass { mass 1 } w : ground {} f : force { signal "step" ampitude 3 } @e : constitutive { + w - a ~ f }': (
        "HX407]: port 'f': a step has no 'ampitude'; it has amplitude, start"
    ),
    "k : spring { k 1 } w : ground {} @e : constitutive { + w ~ k }": "HX400]: net: nothing in the network has a mass",
}


@pytest.mark.parametrize("text", REFUSED)
def test_a_network_without_equations_is_refused_with_the_name_of_the_element(text: str) -> None:
    with pytest.raises(Refusal) as refusal:
        hx.dynamics(load(f"net : robot {{ {text} }}"))
    assert REFUSED[text] in str(refusal.value)


def test_an_input_that_excites_an_unstable_motion_is_named() -> None:
    text = "u : robot { m : mass { mass 1 } w : ground {} k : spring { k -4 } push : force {} @e : constitutive { + w - m ~ k ~ push } }"
    report = Report()
    report_unstable(hx.dynamics(load(text)).state_space(), report)
    message = "warning[HX405]: port 'push': input 'push.effort' excites the unstable pole 2 1/s"
    assert [str(diagnostic) for diagnostic in report] == [message]


def test_a_law_that_grows_without_bounds_stops_with_a_diagnostic() -> None:
    text = 'd : robot { m : mass { mass 1 } w : ground {} k : spring { k 1 law "-x**3" } @e : constitutive { + w - m ~ k } }'
    with pytest.raises(Refusal, match="HX409"):
        simulate(hx.dynamics(load(text)).system, {}, 50.0, 0.1, [1.0, 1.0])
