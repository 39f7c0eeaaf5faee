"""Mechanisms: closed forms of the textbooks, linearisation, equilibria, couplings, and derivatives."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
import sympy

import hymeko_x as hx
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.dynamics.balance import balanced_response
from hymeko_x.dynamics.numbers import floats
from hymeko_x.dynamics.operating import linearized
from tests.dynamics.networks import load
from tests.pace import assert_within

CART_POLE = """cart_pole : robot {
  world {}
  cart { mass 1.5 inertia [0.1 0.1 0.1] }
  pole { mass 0.2 com [0 0 0.5] inertia [0.01 0.01 0.001] }
  @slider : prismatic { + world - cart axis=X }
  @pivot : revolute { + cart - pole axis=Y }
}"""
DOUBLE = """double : robot {
  world {}
  upper { mass 1.2 com [0 0 -0.3] inertia [0.05 0.05 0.001] }
  lower { mass 0.7 com [0 0 -0.25] inertia [0.03 0.03 0.001] }
  @shoulder : revolute { + world - upper axis=-Y }
  @elbow : revolute { [0 0 -0.6] + upper - lower axis=-Y }
}"""
SCARA = """scara : robot {
  world {}
  inner { mass 4 com [0.2 0 0] inertia [0.01 0.06 0.06] }
  outer { mass 3 com [0.15 0 0] inertia [0.01 0.04 0.04] }
  quill { mass 1 com [0 0 -0.1] inertia [0.002 0.002 0.001] }
  @shoulder : revolute { [0 0 0.3] + world - inner axis=Z }
  @elbow : revolute { [0.4 0 0] + inner - outer axis=Z }
  @lift : prismatic { [0.3 0 0] + outer - quill axis=Z }
}"""


def is_zero(matrix: sympy.Matrix) -> bool:
    return sympy.simplify(matrix) == sympy.zeros(*matrix.shape)


def test_the_cart_pole_has_its_closed_form() -> None:
    found = hx.dynamics(load(CART_POLE)).symbolic()
    mc, m, c, j, g = map(sympy.Rational, ("1.5", "0.2", "0.5", "0.01", "9.81"))
    (_, q), (_, w) = found.q, found.v
    assert is_zero(found.mass - sympy.Matrix([[mc + m, m * c * sympy.cos(q)], [m * c * sympy.cos(q), j + m * c**2]]))
    assert is_zero(found.bias - sympy.Matrix([-m * c * w**2 * sympy.sin(q), -m * g * c * sympy.sin(q)]))


def test_the_double_pendulum_has_its_closed_form() -> None:
    found = hx.dynamics(load(DOUBLE)).symbolic()
    m1, l1, c1, j1, m2, c2, j2, g = map(sympy.Rational, ("1.2", "0.6", "0.3", "0.05", "0.7", "0.25", "0.03", "9.81"))
    (a, b), (u, w) = found.q, found.v
    coupled = m2 * (c2**2 + l1 * c2 * sympy.cos(b)) + j2
    whole = m1 * c1**2 + j1 + m2 * (l1**2 + c2**2 + 2 * l1 * c2 * sympy.cos(b)) + j2
    assert is_zero(found.mass - sympy.Matrix([[whole, coupled], [coupled, m2 * c2**2 + j2]]))
    h = m2 * l1 * c2 * sympy.sin(b)
    first = (m1 * c1 + m2 * l1) * g * sympy.sin(a) + m2 * c2 * g * sympy.sin(a + b)
    assert is_zero(found.bias - sympy.Matrix([-h * (2 * u * w + w**2) + first, h * u**2 + m2 * c2 * g * sympy.sin(a + b)]))


def test_the_scara_has_its_closed_form_within_two_seconds() -> None:
    """The sympy library itself is loaded before."""
    robot = load(SCARA)
    assert_within(2.0, lambda: hx.dynamics(robot).symbolic())
    found = hx.dynamics(robot).symbolic()
    m1, c1, j1, l1, m2, c2, j2, l2, m3, j3, g = map(
        sympy.Rational, ("4", "0.2", "0.06", "0.4", "3", "0.15", "0.04", "0.3", "1", "0.001", "9.81")
    )
    _, b, _ = found.q
    u, w, _ = found.v
    reach = m2 * c2 + m3 * l2
    own = m2 * c2**2 + j2 + m3 * l2**2 + j3
    coupled = own + l1 * reach * sympy.cos(b)
    whole = m1 * c1**2 + j1 + (m2 + m3) * l1**2 + own + 2 * l1 * reach * sympy.cos(b)
    assert is_zero(found.mass - sympy.Matrix([[whole, coupled, 0], [coupled, own, 0], [0, 0, m3]]))
    h = l1 * reach * sympy.sin(b)
    assert is_zero(found.bias - sympy.Matrix([-h * (2 * u * w + w**2), h * u**2, m3 * g]))


def test_many_configurations_at_once_are_those_one_by_one() -> None:
    found = hx.dynamics(load(DOUBLE))
    rng = np.random.default_rng(0)
    q, v, tau = rng.normal(size=(3, 5, 2))
    moved, mass = found.forward(q, v, tau), found.mass_matrix(q)
    for row in range(5):
        np.testing.assert_array_equal(moved[row], found.forward(q[row], v[row], tau[row]))
        np.testing.assert_allclose(mass[row] @ moved[row] + found.bias(q[row], v[row]), tau[row], atol=1e-12)
    np.testing.assert_allclose(found.inverse(q, v, moved), tau, atol=1e-12)


MODEL = """<mujoco><option timestep="1e-4"><flag contact="disable" constraint="disable" eulerdamp="disable"/></option><worldbody>
<body><joint name="slider" type="slide" axis="1 0 0" damping="0.3"/><inertial mass="1.5" pos="0 0 0" diaginertia=".1 .1 .1"/>
<body><joint name="pivot" axis="0 1 0" damping="0.05" stiffness="2" springref="20"/>
<inertial mass=".2" pos="0 0 .5" diaginertia=".01 .01 .001"/>
<body pos="0 0 1"><joint name="tip" type="ball" damping="0.01"/><inertial mass=".1" pos="0.02 0 .1" diaginertia=".003 .002 .001"/>
</body></body></body></worldbody><actuator><motor joint="slider"/></actuator></mujoco>"""


def test_the_linear_system_is_that_of_mujocos_finite_differences() -> None:
    """One step of semi-implicit Euler: v+ = v + h a(q, v), q+ = q + h v+."""
    found = hx.dynamics(hx.loads(MODEL, "mjcf").mechanism)
    a, b, _, _ = linearized(found, found.at("pivot=0.3")._replace(inputs=[0.0, 0.0])).floats
    n, h = 5, 1e-4
    model = mujoco.MjModel.from_xml_string(MODEL)
    data = mujoco.MjData(model)
    data.qpos[1] = 0.3
    mujoco.mj_forward(model, data)
    theirs, driven = np.zeros((2 * n, 2 * n)), np.zeros((2 * n, 1))
    mujoco.mjd_transitionFD(model, data, 1e-6, True, theirs, driven, None, None)
    np.testing.assert_allclose(a[n:, :n], (theirs[n:, :n]) / h, rtol=1e-5, atol=1e-5 * np.abs(a).max())
    np.testing.assert_allclose(a[n:, n:], (theirs[n:, n:] - np.eye(n)) / h, rtol=1e-5, atol=1e-5 * np.abs(a).max())
    np.testing.assert_allclose(b[n:, 0], driven[n:, 0] / h, rtol=1e-5, atol=1e-5)


def test_derivatives_are_those_of_finite_differences() -> None:
    found = hx.dynamics(load(DOUBLE))
    x, u = np.array([0.4, -0.7, 0.0, 0.0]), np.array([0.0, 0.0])
    space = found.state_space(at="shoulder=0.4,elbow=-0.7")
    system, held = found.system, found.at("shoulder=0.4,elbow=-0.7").inputs
    for column in range(4):
        step = np.zeros(4)
        step[column] = 1e-6
        ahead, behind = (np.array(system.rates(list(x + s), list(u + held), (), floats()), dtype=float) for s in (step, -step))
        np.testing.assert_allclose(space.floats[0][:, column], (ahead - behind) / 2e-6, atol=1e-6 * np.abs(space.floats[0]).max())


def test_an_equilibrium_is_found_and_a_hanging_pendulum_swings_at_its_frequency() -> None:
    text = """p : robot { world {} bob { mass 2 com [0 0 -0.8] inertia [0.1 0.1 0.1] }
      @pivot : revolute { + world - bob axis=Y damping 0.4 stiffness 3 spring_ref 60 } }"""
    found = hx.dynamics(load(text))
    point = found.at("found")
    (q,) = point.positions
    assert point.is_equilibrium
    assert 3 * (np.radians(60) - q) == pytest.approx(2 * 9.81 * 0.8 * np.sin(q))
    inertia = 0.1 + 2 * 0.64
    frequency = np.sqrt((3 + 2 * 9.81 * 0.8 * np.cos(q)) / inertia)
    poles = found.state_space(at="found").poles
    assert [pole.frequency for pole in poles] == pytest.approx([frequency] * 2)
    assert poles[0].damping == pytest.approx(0.4 / (2 * inertia * frequency))


def test_a_coupled_joint_moves_as_its_leader_makes_it() -> None:
    """A polynomial follower: energy is kept, and the reduced mass is G' M G."""
    text = DOUBLE.replace("lower axis=-Y", "lower axis=-Y [0.1 0.5 0.3] mimic - shoulder")
    found = hx.dynamics(load(text))
    assert [variable.name for variable in found.system.states] == ["shoulder.position", "shoulder.velocity"]
    response = found.simulate(2.0, 0.01, at="shoulder=1.1")
    q, v = response.states.T
    whole_q = np.stack([q, 0.1 + 0.5 * q + 0.3 * q**2], axis=1)
    whole_v = np.stack([v, (0.5 + 0.6 * q) * v], axis=1)
    kinetic = np.einsum("ni,nij,nj->n", whole_v, found.mass_matrix(whole_q), whole_v) / 2
    height = -1.2 * 0.3 * np.cos(whole_q[:, 0]) - 0.7 * (0.6 * np.cos(whole_q[:, 0]) + 0.25 * np.cos(whole_q.sum(axis=1)))
    energy = kinetic + 9.81 * height
    assert np.ptp(kinetic) > 1.0
    np.testing.assert_allclose(energy, energy[0], atol=1e-7)


SPINNING = (
    """top : robot { world {} rotor { mass 2 com [0.1 0 0.3] inertia [0.02 0.05 0.06] } @base : floating { [0 0 1] + world - rotor } }"""
)


def test_a_free_body_keeps_its_energy_and_angular_momentum() -> None:
    from hymeko_x.dynamics.simulation import simulate

    found = hx.dynamics(load(SPINNING), gravity=(0.0, 0.0, 0.0))
    start = [0, 0, 0, 1, 0, 0, 0, 0.1, -0.2, 0.3, 1.0, 2.0, -1.5]
    response = simulate(found.system, {}, 2.0, 0.1, start, lambda x, u: np.array(found.graph(x, u), dtype=float).reshape(-1))
    q, v = response.states[:, :7], response.states[:, 7:]
    energy = np.einsum("ni,nij,nj->n", v, found.mass_matrix(q), v) / 2
    np.testing.assert_allclose(energy, energy[0], rtol=1e-8)
    np.testing.assert_allclose(np.linalg.norm(q[:, 3:], axis=1), 1.0, atol=1e-8)


REFUSED = {
    "r : robot { a {} b {} @j : fixed { + a - b } }": "HX400]: r: no joint of it moves",
    "r : robot { world {} a {} @j { + world - a } }": "HX404]: joint 'j' moves no mass; the mass matrix is singular",
    "r : robot { world {} a { mass 1 } b { mass 1 } @j { + world - a mimic - k } @k { + a - b mimic - j } }": (
        "HX403]: joint 'j', joint 'k' follow each other in a circle"
    ),
}


@pytest.mark.parametrize("text", REFUSED)
def test_a_mechanism_without_equations_is_refused_with_the_name_of_the_element(text: str) -> None:
    with pytest.raises(Refusal) as refusal:
        hx.dynamics(load(text))
    assert REFUSED[text] in str(refusal.value)


def test_a_point_mass_on_its_own_axis_is_refused_when_it_accelerates() -> None:
    found = hx.dynamics(load("r : robot { world {} a { mass 1 } @j { + world - a axis=Z } }"))
    with pytest.raises(Refusal, match=r"HX404\]: joint 'j' moves no mass there"):
        found.forward(np.zeros(1), np.zeros(1), np.ones(1))
    for act in (found.state_space, lambda: found.simulate(0.1, 0.05), lambda: balanced_response(found, 0.1, 0.05)):
        with pytest.raises(Refusal, match=r"HX404\]: joint 'j' moves no mass there"):
            act()


def test_what_is_not_in_the_equations_is_named() -> None:
    text = """r : robot { world {} a { mass 1 inertia [1 1 1] } b { mass 1 inertia [1 1 1] }
      @j { + world - a friction 0.2 } @k { + world - b }
      @shut : loop { type "joint" ~ a ~ b dof { moves=screw axis=X } } s : site { + a } t : site { + b }
      @rope : tendon { ~ s ~ t stiffness 30 armature 0.1 } }"""
    report = Report()
    hx.dynamics(load(text), report=report)
    assert [str(diagnostic).split(": ", 2)[1:] for diagnostic in report] == [
        ["warning[HX408]", "loop 'shut' is a loop of a kind, which is not in the equations"],
        ["warning[HX408]", "tendon 'rope' has an armature, which is not in the equations"],
    ]


def test_a_hundred_configurations_of_a_humanoid_take_less_than_fifty_milliseconds() -> None:
    found = hx.dynamics(hx.load(Path(__file__).parents[2] / "corpus" / "robots" / "humanoid.hymeko").mechanism)
    q, v = np.tile(found.tree.rest, (100, 1)), np.ones((100, found.tree.nv))
    assert found.tree.nv >= 37
    assert_within(0.050, lambda: found.inverse(q, v, v))
