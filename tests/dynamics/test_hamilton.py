"""The port-Hamiltonian form of mechanisms: its structure, that it is the same system, and the power balance over time."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
import sympy

import hymeko_x as hx
from hymeko_x.dynamics.assembly import reduction
from hymeko_x.dynamics.balance import balanced_response
from hymeko_x.dynamics.hamilton import formulas_of, loop_formulas
from hymeko_x.dynamics.multibody import Multibody
from hymeko_x.dynamics.pages import page_of, printed
from hymeko_x.dynamics.signals import table
from tests.dynamics.networks import load
from tests.dynamics.test_drives import MODEL as DRIVEN
from tests.dynamics.test_lumped import LISTING
from tests.dynamics.test_mechanisms import CART_POLE, DOUBLE, SPINNING
from tests.dynamics.test_mechanisms import MODEL as BALL
from tests.dynamics.test_passive import RUBBED, SPRUNG

COUPLED = DOUBLE.replace("lower axis=-Y", "lower axis=-Y damping 0.2 stiffness 3 [0.1 0.5 0.3] mimic - shoulder")
SYSTEMS = {
    "cart_pole": lambda: hx.dynamics(load(CART_POLE.replace("pole axis=Y", "pole axis=Y damping 0.1"))),
    "coupled": lambda: hx.dynamics(
        load(DOUBLE.replace("lower axis=-Y", "lower axis=-Y damping 0.2 stiffness 3 [0.1 0.5 0.3] mimic - shoulder"))
    ),
    "ball": lambda: hx.dynamics(hx.loads(BALL, "mjcf").mechanism),
    "sprung": lambda: hx.dynamics(hx.loads(SPRUNG, "mjcf")),
    "rubbed": lambda: hx.dynamics(hx.loads(RUBBED, "mjcf")),
    "top": lambda: hx.dynamics(load(SPINNING)),
    "driven": lambda: hx.dynamics(hx.loads(DRIVEN, "mjcf").mechanism, inputs="actuators"),
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
    found = hx.dynamics(hx.loads(BALL, "mjcf").mechanism)
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
    car = hx.dynamics(hx.load(LISTING).mechanism)
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


# ---- closed loops --------------------------------------------------------------------------------------------------------

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module", params=["four_bar", pytest.param("delta", marks=pytest.mark.full)])
def looped(request: pytest.FixtureRequest) -> Multibody:
    return hx.dynamics(hx.load(EXAMPLES / f"{request.param}.hymeko").mechanism)


def test_the_forces_of_closed_loops_are_a_port_without_power(looped: Multibody) -> None:
    """At closed positions and velocities B' dH/dx = 0, and some f makes the rates of the form those of the system."""
    form = looped.port_hamiltonian()
    q = looped.start("")
    basis = reduction(looped, q).basis
    rng = np.random.default_rng(4)
    v, u = basis @ rng.normal(size=basis.shape[1]), rng.normal(size=len(looped.system.inputs))
    _, gradient, j, r, g = (np.array(value, dtype=float) for value in form.functions(form.state(q, v)))
    n, h = len(q), 1e-5
    b = np.vstack([np.zeros((n, len(looped.closed_at(q)[0]))), looped.closed_at(q)[1].T])
    np.testing.assert_allclose(b.T @ gradient, 0.0, atol=1e-12)
    rates = np.array(looped.graph([*q, *v], u), dtype=float)[:, 0]
    ahead, behind = (form.state((np.array(q) + s * rates[:n]).tolist(), (v + s * rates[n:]).tolist()) for s in (h, -h))
    missing = (np.array(ahead) - behind) / (2 * h) - (j - r) @ gradient[:, 0] - g @ u
    force = np.linalg.lstsq(b, missing, rcond=1e-10)[0]
    assert np.abs(force).max() > 0.1
    np.testing.assert_allclose(b @ force, missing, atol=1e-6 * np.abs(missing).max())


def test_the_discrete_gradient_keeps_loops_closed_and_the_power_balance(looped: Multibody) -> None:
    form = looped.port_hamiltonian()
    q = looped.start("")
    u = 0.03 * np.random.default_rng(2).normal(size=(20, len(looped.system.inputs)))
    flow = form.simulate(form.state(q, [0.0] * (len(form.states) - len(q))), u, 0.01)
    balance = 0.01 * np.einsum("ni,ni->n", flow.outputs, u) - flow.losses
    assert np.ptp(flow.energies) > 1e-5
    np.testing.assert_allclose(np.diff(flow.energies), balance, atol=1e-12)
    for x in flow.states:
        np.testing.assert_allclose(looped.closed_at(x[: len(q)])[0], 0.0, atol=1e-12)


def test_a_four_bar_flows_as_in_the_solver() -> None:
    """It falls for 0.5 s; half the step, a quarter of the error."""
    found = hx.dynamics(hx.load(EXAMPLES / "four_bar.hymeko").mechanism)
    form = found.port_hamiltonian()
    exact = found.simulate(0.5, 0.5, at="drive=0.5").states[-1]
    start = form.state(found.start("drive=0.5"), [0.0] * 3)
    errors = [np.abs(form.simulate(start, np.zeros((n, 3)), 0.5 / n).states[-1][:3] - exact[:3]).max() for n in (50, 100)]
    assert errors[1] < 1e-3
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


def test_the_page_of_a_four_bar_has_the_port_of_its_loop() -> None:
    page = printed(page_of(hx.dynamics(hx.load(EXAMPLES / "four_bar.hymeko").mechanism), "port-hamiltonian"), "text")
    assert "x' = (J - R) dH/dx + G u + B f, 0 = B' dH/dx, phi(q) = 0" in page
    assert "1 of 3 degrees of freedom remain" in page


@pytest.mark.full
def test_the_formulas_of_a_loop_have_its_port() -> None:
    found = hx.dynamics(hx.load(EXAMPLES / "four_bar.hymeko").mechanism)
    phi, b = loop_formulas(found.port_hamiltonian())
    q = sympy.symbols("q1:4", real=True)
    difference = b[3:, :] - phi.jacobian(sympy.Matrix(q)).T
    assert max(map(abs, difference.subs(dict(zip(q, (0.3, -0.8, 1.1), strict=True))))) < 1e-12
    assert b[:3, :] == sympy.zeros(3, len(phi))
    assert len(phi) == 2
