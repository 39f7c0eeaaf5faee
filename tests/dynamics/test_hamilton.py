"""The port-Hamiltonian form of mechanisms: its structure, that it is the same system, and the power balance over time."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
import sympy

import hymeko_x as hx
from hymeko_x.diagnostics import Refusal
from hymeko_x.dynamics.balance import balanced_response
from hymeko_x.dynamics.hamilton import formulas_of
from hymeko_x.dynamics.multibody import Multibody
from hymeko_x.dynamics.signals import table
from tests.dynamics.networks import load
from tests.dynamics.test_drives import MODEL as DRIVEN
from tests.dynamics.test_lumped import LISTING
from tests.dynamics.test_mechanisms import CART_POLE, DOUBLE, SPINNING
from tests.dynamics.test_mechanisms import MODEL as BALL

COUPLED = DOUBLE.replace("lower axis=-Y", "lower axis=-Y damping 0.2 stiffness 3 [0.1 0.5 0.3] mimic - shoulder")
SYSTEMS = {
    "cart_pole": lambda: hx.dynamics(load(CART_POLE.replace("pole axis=Y", "pole axis=Y damping 0.1"))),
    "coupled": lambda: hx.dynamics(
        load(DOUBLE.replace("lower axis=-Y", "lower axis=-Y damping 0.2 stiffness 3 [0.1 0.5 0.3] mimic - shoulder"))
    ),
    "ball": lambda: hx.dynamics(hx.loads(BALL, "mjcf")),
    "top": lambda: hx.dynamics(load(SPINNING)),
    "driven": lambda: hx.dynamics(hx.loads(DRIVEN, "mjcf"), inputs="actuators"),
}


@pytest.fixture(scope="module", params=SYSTEMS)
def found(request: pytest.FixtureRequest) -> Multibody:
    return SYSTEMS[request.param]()


def drawn(found: Multibody) -> tuple[list[float], list[float]]:
    """Positions with quaternions of unit length, and velocities, of the independent coordinates."""
    rng = np.random.default_rng(4)
    form = found.port_hamiltonian()
    q: list[float] = []
    for link in form.links:
        own = rng.normal(scale=0.4, size=link.coordinates)
        if link.coordinates > 1:
            own[-4:] /= np.linalg.norm(own[-4:])
        q += own.tolist()
    return q, rng.normal(size=len(form.states) - len(q)).tolist()


def test_the_form_is_the_same_system(found: Multibody) -> None:
    """J antisymmetric, R positive semidefinite; q' is that of the system, and p' the rate of M(q) v along it."""
    form = found.port_hamiltonian()
    q, v = drawn(found)
    u = np.random.default_rng(1).normal(size=len(found.system.inputs))
    _, gradient, j, r, g = (np.array(value, dtype=float) for value in form.functions(form.state(q, v)))
    np.testing.assert_array_equal(j, -j.T)
    assert np.linalg.eigvalsh(r).min() >= -1e-12
    ours = (j - r) @ gradient[:, 0] + g @ u
    rates = np.array(found.graph([*q, *v], u), dtype=float)[:, 0]
    n, h = len(q), 1e-5
    ahead, behind = (form.state((np.array(q) + s * rates[:n]).tolist(), (np.array(v) + s * rates[n:]).tolist()) for s in (h, -h))
    np.testing.assert_allclose(ours[:n], rates[:n], atol=1e-12)
    np.testing.assert_allclose(ours[n:], (np.array(ahead) - behind)[n:] / (2 * h), atol=1e-6 * np.abs(ours).max())


def test_the_discrete_gradient_keeps_the_power_balance(found: Multibody) -> None:
    """What the energy grows by is what enters less what the dampers take, in every step and for steps of any length."""
    form = found.port_hamiltonian()
    u = np.random.default_rng(2).normal(size=(100, len(found.system.inputs)))
    q, v = drawn(found)
    flow = form.simulate(form.state(q, v), u, 0.01)
    balance = 0.01 * np.einsum("ni,ni->n", flow.outputs, u) - flow.losses
    assert np.ptp(flow.energies) > 1e-3 or not u.size
    assert (flow.losses >= 0).all()
    np.testing.assert_allclose(np.diff(flow.energies), balance, atol=1e-8 * np.abs(flow.energies).max())
    for link in form.links:
        if link.coordinates > 1:
            at = link.q + link.coordinates - 4
            np.testing.assert_allclose(np.linalg.norm(flow.states[:, at : at + 4], axis=1), 1.0, atol=1e-10)


def test_the_energy_is_that_of_mujoco() -> None:
    found = hx.dynamics(hx.loads(BALL, "mjcf"))
    q, v = drawn(found)
    model = mujoco.MjModel.from_xml_string(BALL)
    model.opt.enableflags |= int(mujoco.mjtEnableBit.mjENBL_ENERGY)
    data = mujoco.MjData(model)
    data.qpos, data.qvel = q, v
    mujoco.mj_forward(model, data)
    form = found.port_hamiltonian()
    assert float(form.functions(form.state(q, v))[0]) == pytest.approx(sum(data.energy), rel=1e-12)


def test_the_flow_is_that_of_the_solver() -> None:
    """The discrete gradient is of second order: half the step, a quarter of the error."""
    found = hx.dynamics(load(DOUBLE))
    form = found.port_hamiltonian()
    exact = found.simulate(0.5, 0.5, at="shoulder=0.9,elbow=-0.4").states[-1]
    errors = []
    for count in (50, 100):
        flow = form.simulate(form.state([0.9, -0.4], [0.0, 0.0]), np.zeros((count, 2)), 0.5 / count)
        errors.append(np.abs(flow.states[-1][:2] - exact[:2]).max())
    assert errors[1] < 1e-3
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


def test_a_response_with_the_energy_of_a_swinging_pendulum_and_of_a_car() -> None:
    """Without dampers the energy stays; a road that moves a car brings energy, of which the damper takes some."""
    swinging = balanced_response(hx.dynamics(load(DOUBLE)), 2.0, 0.02, at="shoulder=1.2")
    assert [variable.name for variable in swinging.names[1]] == [
        "shoulder.position",
        "elbow.position",
        "shoulder.momentum",
        "elbow.momentum",
    ]
    np.testing.assert_allclose(swinging.outputs[:, 0], swinging.outputs[0, 0], rtol=1e-8)
    car = hx.dynamics(hx.load(LISTING))
    road = table([0.0, 0.2, 1.5], [0.0, 0.1, 0.1])
    ours, theirs = balanced_response(car, 1.5, 1e-3, {"chassis": road}), car.simulate(1.5, 1e-3, {"chassis": road})
    np.testing.assert_allclose(ours.states[:, 1] / 50.0, theirs.states[:, 1], atol=2e-3)
    assert ours.outputs[:, 0].max() > 1.0
    assert ours.outputs[-1, 0] < 1e-6


def test_the_formulas_of_the_cart_pole() -> None:
    m, v, j, r, g = formulas_of(hx.dynamics(load(CART_POLE.replace("pole axis=Y", "pole axis=Y damping 0.1"))).port_hamiltonian())
    q = sympy.Symbol("q2", real=True)
    assert sympy.simplify(v - sympy.Rational("0.981") * sympy.cos(q)) == 0
    assert m[0, 1] == sympy.cos(q) / 10
    assert j == sympy.Matrix(4, 4, lambda i, k: (k == i + 2) - (i == k + 2))
    assert r == sympy.diag(0, 0, 0, sympy.Rational("0.1"))
    assert g == sympy.Matrix([[0, 0], [0, 0], [1, 0], [0, 1]])


def test_a_closed_loop_has_no_such_form() -> None:
    four_bar = hx.load(Path(__file__).parents[2] / "examples" / "four_bar.hymeko")
    with pytest.raises(Refusal, match=r"HX408\]: loop 'shut' closes a loop"):
        hx.dynamics(four_bar).port_hamiltonian()
