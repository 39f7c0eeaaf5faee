"""Lumped networks as robots: trees of masses on joints have the same motion in other formats, and other networks are refused."""

from __future__ import annotations

import random
from pathlib import Path

import mujoco
import numpy as np
import pytest

import hymeko_x as hx
from hymeko_x.pipeline import Stopped
from tests.dynamics.networks import load

LISTING = Path(__file__).parents[2] / "corpus" / "listings" / "quarter_vehicle_model.hymeko"


def random_tree(seed: int) -> str:
    """Up to six masses, each on the ground or on one before it by one or two edges in either direction, with pushing ports."""
    rng = random.Random(seed)
    domain = rng.choice(["translation", "rotation"])
    lines = ["ground : ground {}"]
    for number in range(rng.randint(1, 6)):
        kind = f"mass {{ mass {rng.uniform(0.5, 4)!r} }}" if domain == "translation" else f"inertia {{ mass {rng.uniform(0.5, 4)!r} }}"
        parent = rng.choice(["ground", *[f"m{before}" for before in range(number)]])
        lines.append(f"m{number} : {kind}")
        for edge in range(rng.randint(1, 2)):
            name = f"{number}_{edge}"
            lines.append(f"s{name} : spring {{ stiffness {rng.uniform(5, 80)!r} rest {rng.choice([0, 0.1, -0.3])} }}")
            lines.append(f"d{name} : damper {{ damping {rng.uniform(0, 2)!r} }}")
            lines.append(f"f{name} : force {{}}")
            ends = rng.choice([f"+ {parent} - m{number}", f"- {parent} + m{number}"])
            lines.append(f"@e{name} : constitutive {{ {ends} ~ s{name} ~ d{name} ~ f{name} }}")
    return "net : robot {\n" + "\n".join(lines) + "\n}\n"


@pytest.mark.parametrize("seed", range(20))
def test_a_tree_of_masses_moves_in_mujoco_as_its_network_does(seed: int) -> None:
    network = hx.dynamics(load(random_tree(seed)))
    model = mujoco.MjModel.from_xml_string(hx.dumps(load(random_tree(seed)), "mjcf"))
    data = mujoco.MjData(model)
    rng = np.random.default_rng(seed)
    masses = [state.name.removesuffix(".position") for state in network.system.states if state.name.endswith(".position")]
    positions, velocities = rng.uniform(-0.2, 0.2, len(masses)), rng.uniform(-1, 1, len(masses))
    pushes = rng.uniform(-3, 3, len(network.system.inputs))
    space = network.state_space()
    a, b, _, _ = space.floats
    rates = a @ np.concatenate([positions, velocities]) + b @ pushes + np.array(space.offset.tolist(), dtype=float).ravel()
    for body in range(1, model.nbody):
        own = masses.index(model.body(body).name)
        parent = model.body(model.body_parentid[body]).name
        above = (0.0, 0.0) if parent == "world" else (positions[masses.index(parent)], velocities[masses.index(parent)])
        joint = model.body_jntadr[body]
        data.qpos[joint], data.qvel[joint] = positions[own] - above[0], velocities[own] - above[1]
    for number, variable in enumerate(network.system.inputs):
        data.actuator(variable.name.removesuffix(".effort")).ctrl[0] = pushes[number]
    mujoco.mj_forward(model, data)
    for body in range(1, model.nbody):
        own = masses.index(model.body(body).name)
        parent = model.body(model.body_parentid[body]).name
        above = 0.0 if parent == "world" else rates[len(masses) + masses.index(parent)]
        assert data.qacc[model.body_jntadr[body]] == pytest.approx(rates[len(masses) + own] - above, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("target", ["r.xml", "r.usda", "r.hymeko"])
def test_the_quarter_vehicle_comes_back_with_its_poles(target: str, tmp_path: Path) -> None:
    hx.convert(LISTING, tmp_path / "r.xml")
    hx.convert(tmp_path / "r.xml", tmp_path / target) if target != "r.xml" else None
    space = hx.dynamics(hx.load(tmp_path / target).mechanism).state_space()
    assert sorted((round(pole.value.real, 6), round(pole.value.imag, 6)) for pole in space.poles) == [(-10.0, -30.0), (-10.0, 30.0)]


@pytest.mark.parametrize("target", ["urdf", "xacro", "mjcf", "usd", "sdf"])
def test_every_format_for_robots_has_the_masses(target: str) -> None:
    robot = hx.loads(hx.dumps(hx.load(LISTING), target), target).mechanism
    (joint,) = robot.joints.values()
    assert [dof.kind.value for dof in joint.joint.dofs] == ["slide"]
    (mass,) = [body.inertial.mass for key, body in robot.vertices(hx.ir.parts.Body) if key.name == "link" and body.inertial is not None]
    assert mass == 50.0


MASS = "m : mass { mass 1 } n : mass { mass 1 } w : ground {} k : spring { stiffness 2 } j : spring { stiffness 2 }"


@pytest.mark.parametrize(
    ("lines", "reason"),
    [
        ("@e { + w - m ~ k } c : pid { p 1 } @f { + m - n ~ c }", "'c' is a controller"),
        ('@e { + w - m ~ l } l : spring { stiffness 1 law "k*x^3" }', "has a law of its own"),
        ("@e { + w - m [2] - n ~ k }", "does not join two ends of ratio 1"),
        ("@e { + w - m ~ k } @f { + m - n ~ j } @g { + n - w ~ k }", "closes a circle of branches"),
        ("@e { + w - m ~ k } @f : coupling { + n [0 2] - m }", "follows other masses"),
    ],
)
def test_networks_that_are_no_trees_are_refused_with_the_reason(lines: str, reason: str) -> None:
    lines = lines.replace("@e {", "@e : constitutive {").replace("@f {", "@f : constitutive {").replace("@g {", "@g : constitutive {")
    with pytest.raises((Stopped, hx.Refusal)) as caught:
        hx.dumps(load(f"r : robot {{ {MASS} {lines.replace('x^3', 'x**3')} }}"), "mjcf")
    assert reason in str(caught.value)
