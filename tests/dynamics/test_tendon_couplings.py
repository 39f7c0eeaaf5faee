"""Couplings of fixed tendons, and joints that are held, against MuJoCo."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

import hymeko_x as hx
from hymeko_x.diagnostics import Report
from hymeko_x.dynamics.couplings import expanded
from hymeko_x.dynamics.multibody import Multibody
from hymeko_x.dynamics.numbers import floats

INERTIA = '<inertial mass="1" pos=".2 0 .05" diaginertia=".01 .02 .02"/>'
LINKS = "".join(f'<body pos=".3 0 0"><joint name="{name}" axis="{axis}" {more}/>{INERTIA}' for name, axis, more in (
    ("a", "0 1 0", ""), ("b", "0 1 0", 'ref="20"'), ("c", "1 0 0", 'ref="-10"'), ("d", "0 0 1", ""), ("e", "0 1 0", 'ref="5"')
))  # fmt: skip
TENDONS = """<tendon><fixed name="two"><joint joint="a" coef="1"/><joint joint="b" coef="2"/></fixed>
<fixed name="one"><joint joint="c" coef="0.5"/></fixed><fixed name="turned"><joint joint="d" coef="-1"/><joint joint="b" coef="1"/></fixed>
</tendon>"""


def model(equalities: str, more: str = "") -> str:
    bodies = f"<worldbody>{LINKS}{'</body>' * 5}</worldbody>"
    default = '<default><default class="off"><equality active="false"/></default></default>'
    return f"<mujoco>{default}{bodies}{TENDONS.replace('</tendon>', more + '</tendon>')}<equality>{equalities}</equality></mujoco>"


def whole(found: Multibody, z: np.ndarray, rate: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The positions and velocities of all joints, and G with v = G z'."""
    motion = expanded(found.tree, found.followers, list(z), list(rate), floats())
    return np.array(motion.q, dtype=float), np.array(motion.v, dtype=float), np.array(motion.ratios, dtype=float)


@pytest.mark.parametrize(
    ("equalities", "freedom"),
    [
        ('<tendon tendon1="two"/>', 4),
        ('<tendon tendon1="two" polycoef="0.3"/><joint joint1="e" polycoef="-0.2"/>', 3),
        ('<tendon tendon1="two" tendon2="one" polycoef="0.1 2 0.5"/>', 4),
        ('<tendon tendon1="two" tendon2="turned" polycoef="0 0.5"/><joint joint1="c" joint2="a"/>', 3),
        ('<tendon tendon1="two" tendon2="turned"/><tendon tendon1="turned" polycoef="0.1"/>', 3),
        ('<tendon tendon1="two" class="off"/>', 5),
    ],
)
def test_coupled_tendons_move_as_mujoco_demands(equalities: str, freedom: int) -> None:
    """Positions keep MuJoCo's equalities, and accelerations are those of its mass matrix and forces under its Jacobian."""
    text = model(equalities)
    report = Report()
    found = hx.dynamics(hx.loads(text, "mjcf").mechanism, report=report)
    assert not list(report)
    theirs = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(theirs)
    rng = np.random.default_rng(3)
    z, rate = rng.normal(size=freedom), rng.normal(size=freedom)
    data.qpos, data.qvel, ratios = whole(found, z, rate)
    mujoco.mj_forward(theirs, data)
    rows = data.ne
    np.testing.assert_allclose(data.efc_pos[:rows], 0.0, atol=1e-12)
    jacobian = data.efc_J.reshape(-1, theirs.nv)[:rows] if rows else np.zeros((0, theirs.nv))
    np.testing.assert_allclose(jacobian @ ratios, 0.0, atol=1e-12)
    mass = np.zeros((theirs.nv, theirs.nv))
    mujoco.mj_fullM(theirs, data, mass)
    step = 1e-6
    drift = (whole(found, z + step * rate, rate)[1] - whole(found, z - step * rate, rate)[1]) / (2 * step)
    expected = np.linalg.solve(ratios.T @ mass @ ratios, ratios.T @ (data.qfrc_smooth - mass @ drift))
    ours = np.array(found.graph([*z, *rate], [0.0] * len(found.system.inputs)), dtype=float)[freedom:, 0]
    np.testing.assert_allclose(ours, expected, rtol=1e-7)


def test_couplings_without_equations_are_named() -> None:
    """Of a path, and a polynomial of the sum of two coordinates."""
    report = Report()
    path = '<spatial name="path"><site site="s"/><site site="t"/></spatial>'
    text = model('<tendon name="cable" tendon1="path"/><tendon tendon1="one" tendon2="two" polycoef="0 1 1"/>', path)
    text = text.replace("<worldbody>", '<worldbody><site name="s"/><site name="t" pos="0 0 1"/>')
    hx.dynamics(hx.loads(text, "mjcf").mechanism, report=report)
    words = "couples along a path, or by a polynomial of several coordinates, which is not in the equations"
    assert [str(found).partition("HX408]: ")[2] for found in report] == [f"coupling 'cable' {words}", f"coupling 'one' {words}"]


def test_a_coupling_of_tendons_in_hymeko_text_is_in_the_equations() -> None:
    robot = hx.loads(model(""), "mjcf").mechanism
    text = hx.dumps(robot, "hymeko").rstrip().removesuffix("}") + "  @pair : coupling { + two [0 3] - one }\n}\n"
    found = hx.dynamics(hx.loads(text, "hymeko").mechanism)
    q = whole(found, np.array([0.4, 0.3, 0.2, 0.1]), np.zeros(4))[0]
    assert q[0] + 2.0 * q[1] == pytest.approx(1.5 * q[2])
