"""Random lumped networks, and the same networks in MuJoCo."""

from __future__ import annotations

import random

import mujoco
from msgspec import Struct

import hymeko_x as hx
from hymeko_x.ir import lumped
from hymeko_x.networks.network import Network

TURNING = ("inertia", "kg*m^2", "Nm/rad", "rad")


class Case(Struct):
    """A network as HyMeKo text, and the initial state of its masses."""

    text: str
    positions: list[float]
    velocities: list[float]


def random_network(seed: int) -> Case:
    """Up to six masses on a ground and between each other, with springs, dampers, levers, edges of several ends, rest lengths."""
    rng = random.Random(seed)
    count = rng.randint(1, 6)
    mass, inertia, stiff, length = TURNING if seed % 3 == 0 else ("mass", "kg", "N/m", "m")
    lines = ["ground : ground {}"]
    lines += [f"m{i} : {mass} {{ mass {rng.uniform(0.5, 4):.3f}{inertia} }}" for i in range(count)]
    for number in range(count + rng.randint(0, 3)):
        ends = rng.sample(range(count), min(count, rng.choice([1, 1, 2, 2, 3])))
        if number < count:
            ends = list(dict.fromkeys([number, *ends[:2]]))
        arcs = " ".join(f"[{rng.choice([1, 1, 1, 0.5, 2])}] {'-' if i == 0 else rng.choice('+-')} m{end}" for i, end in enumerate(ends))
        lines.append(f"s{number} : spring {{ stiffness {rng.uniform(5, 80):.3f}{stiff} rest {rng.choice([0, 0, 0.1])}{length} }}")
        lines.append(f"d{number} : damper {{ damping {rng.uniform(0, 2):.3f} }}")
        lines.append(f"@e{number} : constitutive {{ + ground {arcs} ~ s{number}" + (f" ~ d{number} }}" if rng.random() < 0.8 else " }"))
    text = "net : robot {\n" + "\n".join(lines) + "\n}\n"
    return Case(text, [rng.uniform(-0.2, 0.2) for _ in range(count)], [rng.uniform(-1, 1) for _ in range(count)])


def mujoco_model(network: Network) -> mujoco.MjModel:
    """The masses as slides along x, and every edge as a tendon over them."""
    bodies = "".join(
        f'<body pos="0 {number} 0"><joint name="{key.name}" type="slide" axis="1 0 0"/><inertial pos="0 0 0" mass="{mass!r}"'
        ' diaginertia="1 1 1"/></body>'
        for number, (key, mass) in enumerate(network.masses.items())
    )
    tendons = ""
    for branch in network.branches:
        stiffness = sum(e.part.stiffness for e in branch.elements if isinstance(e.part, lumped.Spring))
        damping = sum(e.part.damping for e in branch.elements if isinstance(e.part, lumped.Damper))
        rest = next((e.part.rest for e in branch.elements if isinstance(e.part, lumped.Spring)), 0.0)
        joints = "".join(f'<joint joint="{key.name}" coef="{ratio!r}"/>' for key, ratio in branch.ends if key in network.masses)
        tendons += f'<fixed stiffness="{stiffness!r}" damping="{damping!r}" springlength="{rest!r}">{joints}</fixed>'
    option = '<option gravity="0 0 0" timestep="0.001" integrator="RK4"><flag contact="disable"/></option>'
    return mujoco.MjModel.from_xml_string(f"<mujoco>{option}<worldbody>{bodies}</worldbody><tendon>{tendons}</tendon></mujoco>")


def load(text: str) -> hx.Mechanism:
    return hx.loads(text, "hymeko").mechanism
