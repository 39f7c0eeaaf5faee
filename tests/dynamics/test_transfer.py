"""Transfer functions of real sizes: those of an arm are C (s I - A)^-1 B + D, and those of a humanoid are refused at once."""

from __future__ import annotations

import numpy as np
import pytest
import sympy

import hymeko_x as hx
from hymeko_x.diagnostics import Refusal
from tests.dynamics.networks import load


def arm(count: int) -> hx.dynamics.Multibody:
    """An arm whose joints turn about x, y, z, x, ..., with strong dampers at its light end."""
    links = "".join(f"l{k} {{ mass {2.5 / (k + 1):.3f} com [0.1 0.02 0.3] inertia [0.013 0.007 0.011] }}\n" for k in range(count))
    joints = "".join(
        f"@j{k} : revolute {{ [0.1 0 0.3] + {f'l{k - 1}' if k else 'world'} - l{k} axis={'ZYX'[k % 3]} damping {1 + 3 * k} }}\n"
        for k in range(count)
    )
    return hx.dynamics(load(f"arm : robot {{ world {{}}\n{links}{joints} }}"))


def test_those_of_an_arm_of_six_joints_keep_their_digits() -> None:
    space = arm(6).state_space("j1=0.4,j3=-0.7")
    a, b, c, d = space.floats
    functions = space.transfer()
    s = sympy.Symbol("s")
    for point in (0.7j, 30j, 2 + 5j):
        exact = c @ np.linalg.solve(point * np.eye(len(a)) - a, b) + d
        found = np.array([[complex(sympy.N(function.subs(s, point))) for function in row] for row in functions])
        assert np.abs(found - exact).max() < 1e-9 * np.abs(exact).max()


def test_a_fraction_of_seventy_states_is_refused() -> None:
    with pytest.raises(Refusal, match=r"HX408\]: transfer functions of 34 states are fractions of that degree") as error:
        arm(17).state_space().transfer()
    assert error.value.diagnostic.hint == "--form state-space has the same system as matrices"
