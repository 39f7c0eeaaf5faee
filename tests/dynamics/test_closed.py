"""Mechanisms with closed loops in the system, the linear form and the simulation: a four-bar and a delta robot against two engines."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest
import sympy

import hymeko_x as hx
from hymeko_x.diagnostics import Refusal
from hymeko_x.dynamics.assembly import assembled, reduction
from hymeko_x.dynamics.loops import closing
from hymeko_x.dynamics.multibody import Multibody
from hymeko_x.dynamics.pages import page_of, printed
from hymeko_x.dynamics.positions import moved
from hymeko_x.dynamics.signals import constant
from hymeko_x.ir.parts import DofKind
from tests.dynamics.networks import load

EXAMPLES = Path(__file__).parents[2] / "examples"
FREEDOM = {"four_bar": (1, 3), "delta": (3, 21)}


@pytest.fixture(scope="module", params=FREEDOM)
def found(request: pytest.FixtureRequest) -> Multibody:
    return hx.dynamics(hx.load(EXAMPLES / f"{request.param}.hymeko").mechanism, inputs="actuators")


def drawn(found: Multibody) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A closed configuration away from the reference, velocities that keep it closed, and controls."""
    rng = np.random.default_rng(3)
    step = rng.uniform(-0.1, 0.1, found.tree.nv)
    q = np.array(assembled(found, moved(found.tree.links, found.system.values("states")[: found.tree.nq], step.tolist())))
    assert np.abs(found.closed_at(q)[0]).max() < 1e-14
    basis = reduction(found, q).basis
    return q, basis @ rng.normal(size=basis.shape[1]), rng.normal(size=len(found.motors or ()))


def test_the_degrees_of_freedom_are_those_that_the_rank_leaves(found: Multibody) -> None:
    q, _, _ = drawn(found)
    assert (found.freedom(q), found.tree.nv) == FREEDOM[found.tree.name]
    assert found.tree.nv - np.linalg.matrix_rank(found.closed_at(q)[1], tol=1e-8) == found.freedom(q)


def test_the_page_says_how_loops_are_closed() -> None:
    text = printed(page_of(hx.dynamics(hx.load(EXAMPLES / "four_bar.hymeko").mechanism), "state-space"), "text")
    words = "loops: 1 closed; 1 of 3 degrees of freedom remain; in simulations and generated files stabilised (Baumgarte) at 20 1/s"
    assert words in text


def pinocchio_of(found: Multibody) -> pin.Model:
    """The links of the tree as a model of Pinocchio."""
    model = pin.Model()
    kinds = {DofKind.HINGE: pin.JointModelRevoluteUnaligned, DofKind.FREE: pin.JointModelFreeFlyer}
    for number, link in enumerate(found.tree.links):
        joint = kinds[link.dof.kind](*([np.array(link.dof.axis)] if link.dof.kind is DofKind.HINGE else []))
        place = pin.SE3(np.array(link.frame.rotation, dtype=float), np.array(link.frame.position))
        model.addJoint(link.parent + 1, joint, place, f"joint {number}")
        for frame, inertial in link.bodies:
            xx, yy, zz, xy, xz, yz = inertial.tensor or (0.0,) * 6
            inertia = pin.Inertia(inertial.mass or 0.0, np.array(inertial.com), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
            model.appendBodyToJoint(number + 1, inertia, pin.SE3(np.array(frame.rotation, dtype=float), np.array(frame.position)))
    return model


def test_accelerations_are_those_of_pinocchios_constrained_dynamics(found: Multibody) -> None:
    q, v, u = drawn(found)
    model = pinocchio_of(found)
    data = model.createData()
    loops, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    for closure in found.closures:
        ends = [pin.SE3(np.array(end.frame.rotation, dtype=float), np.array(end.frame.position)) for end in (closure.first, closure.second)]
        kind = pin.ContactType.CONTACT_3D
        loops.append(pin.RigidConstraintModel(kind, model, closure.first.link + 1, ends[0], closure.second.link + 1, ends[1], pin.LOCAL))
        datas.append(loops[len(loops) - 1].createData())
    pin.initConstraintDynamics(model, data, loops, datas)
    theirs_q = q.copy()
    tau = found.passive(q, v)
    for motor, control in zip(found.motors or (), u, strict=True):
        ((place, gear),) = motor.line.terms
        tau[found.tree.links[place].v] += gear * control
    for link in found.tree.links:
        if link.dof.kind is DofKind.FREE:
            theirs_q[link.q + 3 : link.q + 7] = np.roll(q[link.q + 3 : link.q + 7], -1)
    theirs = pin.constraintDynamics(model, data, theirs_q, v, tau, loops, datas, pin.ProximalSettings(1e-14, 1e-10, 1000))
    ours = np.array(found.graph([*q, *v], u), dtype=float)[found.tree.nq :, 0]
    np.testing.assert_allclose(ours, theirs, atol=1e-8 * np.abs(theirs).max())


def test_accelerations_are_those_of_mujoco_with_stiff_connects(found: Multibody) -> None:
    q, v, u = drawn(found)
    model = mujoco.MjModel.from_xml_string(hx.dumps(found.mechanism, "mjcf"))
    model.eq_solref[:], model.eq_solimp[:, :3], model.opt.timestep = (0.002, 1.0), (0.99999, 0.99999, 0.001), 1e-4
    data = mujoco.MjData(model)
    data.ctrl = u
    turn, drift = np.eye(found.tree.nv), np.zeros(found.tree.nv)
    for joint, link in enumerate(found.tree.links):
        at, column = model.jnt_qposadr[joint], model.jnt_dofadr[joint]
        data.qpos[at : at + link.coordinates] = q[link.q : link.q + link.coordinates]
        data.qvel[column : column + link.velocities] = v[link.v : link.v + link.velocities]
        if link.dof.kind is DofKind.FREE:
            data.qpos[at : at + 3] += np.array(link.frame.position)
            matrix = np.zeros(9)
            mujoco.mju_quat2Mat(matrix, q[link.q + 3 : link.q + 7])
            turn[link.v : link.v + 3, link.v : link.v + 3] = matrix.reshape(3, 3)
            data.qvel[column : column + 3] = matrix.reshape(3, 3) @ v[link.v : link.v + 3]
            drift[link.v : link.v + 3] = np.cross(v[link.v + 3 : link.v + 6], v[link.v : link.v + 3])
    mujoco.mj_forward(model, data)
    theirs = turn.T @ data.qacc - drift
    ours = np.array(found.graph([*q, *v], u), dtype=float)[found.tree.nq :, 0]
    np.testing.assert_allclose(ours, theirs, atol=1e-3 * np.abs(theirs).max())


def test_the_linear_system_is_what_finite_differences_along_the_closure_give(found: Multibody) -> None:
    """The independent positions are moved, the others follow; the accelerations of the independent ones change as A tells."""
    point = found.at("")
    space = found.state_space()
    kept, _ = reduction(found, point.positions)
    a, n, h = space.floats[0], len(kept), 1e-5
    names = [link.name for link in found.tree.links if link.v in kept]
    assert [variable.name for variable in space.states[:n]] == [f"{name}.position" for name in names]
    for column, name in enumerate(names):
        sides = []
        for sign in (1, -1):
            at = found.at(",".join(f"{other}={sign * h * (other == name)}" for other in names)).positions
            rates = np.array(found.graph([*at, *[0.0] * found.tree.nv], point.inputs), dtype=float)[:, 0]
            sides.append(rates[found.tree.nq + np.array(kept)])
        np.testing.assert_allclose(a[n:, column], (sides[0] - sides[1]) / (2 * h), atol=1e-6 * np.abs(a).max())


def test_a_simulation_keeps_the_loops_closed(found: Multibody) -> None:
    name = (found.motors or ())[0].id.name
    response = found.simulate(0.2, 0.05, {name: constant(0.05)})
    assert np.abs(response.states[-1] - response.states[0]).max() > 0.05
    for row in response.states:
        assert np.abs(found.closed_at(row[: found.tree.nq])[0]).max() < 1e-7


@pytest.mark.full
def test_the_formulas_of_a_loop_have_their_jacobian() -> None:
    """Of a linkage in a plane two rows: what is across the plane is closed everywhere."""
    found = hx.dynamics(hx.load(EXAMPLES / "four_bar.hymeko").mechanism)
    phi, slope = found.symbolic_loops()
    q = sympy.symbols("q1:4", real=True)
    assert phi.shape == (2, 1)
    there = dict(zip(q, (0.3, -0.8, 1.1), strict=True))
    ours, theirs = (np.array(matrix.subs(there).tolist(), dtype=float) for matrix in (slope, phi.jacobian(q)))
    np.testing.assert_allclose(ours, theirs, atol=1e-12)
    assert np.abs(ours).max() > 0.1


def test_a_loop_that_cannot_be_closed_is_refused_with_its_name() -> None:
    text = (EXAMPLES / "four_bar.hymeko").read_text().replace("[0 0 0.4] ~ rocker", "[0 0 4] ~ rocker")
    with pytest.raises(Refusal, match=r"HX408\]: loop 'shut' cannot be closed near that configuration; a gap of"):
        hx.dynamics(load(text)).at("")


@pytest.mark.parametrize("shut", ["weld {", 'loop { type "joint" dof { moves=hinge axis=Y }'])
def test_welds_and_hinges_close_a_planar_linkage_as_well(shut: str) -> None:
    """A hinge repeats what the other joints hold already; a weld of the rocker to the coupler stops the linkage."""
    text = (EXAMPLES / "four_bar.hymeko").read_text()
    plain, other = (hx.dynamics(load(each)) for each in (text, text.replace("connect {", shut)))
    q = plain.at("drive=0.3").positions
    if "weld" in shut:
        assert other.freedom(other.at("").positions) == 0
        return
    assert other.freedom(q) == 1
    x = [*q, *(reduction(plain, q).basis[:, 0] * 1.7)]
    u = [0.4, 0.0, -0.1]
    ours, theirs = (np.array(each.graph(x, u), dtype=float)[:, 0] for each in (plain, other))
    np.testing.assert_allclose(ours, theirs, atol=1e-8 * np.abs(ours).max())


def test_what_carries_both_ends_of_a_loop_moves_no_closure() -> None:
    """The Jacobian of the four-bar on a cart, which may turn too, has plain zeros there, in formulas and in numbers."""
    text = (EXAMPLES / "four_bar.hymeko").read_text().replace("+ world", "+ cart")
    text = text.replace("world {}", "world {} base : link { mass 1 inertia [1 1 1] } cart : link { mass 1 inertia [1 1 1] }")
    text = text.replace("~ world", "~ cart").rstrip().removesuffix("}")
    found = hx.dynamics(load(f"{text} @slide : prismatic {{ + world - base axis=X }} @turn : revolute {{ + base - cart axis=[1 2 3] }} }}"))
    carried = [link.v for link in found.tree.links if link.name in ("slide", "turn")]
    slope = closing(found.closures, found._constants, list(np.linspace(0.3, 0.9, found.tree.nq)), [0.0] * found.tree.nv).slope
    assert len(carried) == 2
    assert all(isinstance(row[k], int) for row in slope for k in carried)
    assert all(any(row[k] for row in slope) for k in range(found.tree.nv) if k not in carried)
