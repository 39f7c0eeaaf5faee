"""The dynamics of a mechanism at operating points, with closed loops, and over time."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

from hymeko_x.dynamics.couplings import expanded, followers_of, independent
from hymeko_x.dynamics.forms import SecondOrder
from hymeko_x.dynamics.loops import closed_forward, constraint, freedom
from hymeko_x.dynamics.numbers import floats
from hymeko_x.dynamics.operating import OperatingPoint, linearized, named_positions, operating_point, sympy_matrix
from hymeko_x.dynamics.recursion import GRAVITY, Constants
from hymeko_x.dynamics.simulation import Response, simulate
from hymeko_x.dynamics.system import Variable, input_of
from hymeko_x.dynamics.tree import tree_of
from hymeko_x.dynamics.trees import Trees, reduced_mass

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from hymeko_x.dynamics.linear import StateSpace
    from hymeko_x.dynamics.signals import Signal
    from hymeko_x.ir.mechanism import Mechanism

    Floats = NDArray[np.floating[Any]]


class Multibody(Trees, frozen=True, dict=True):
    """The dynamics of a mechanism: of its trees, at operating points, with closed loops and over time."""

    # ---- at an operating point --------------------------------------------------------------------------------------------

    def at(self, words: str = "") -> OperatingPoint:
        """The operating point at a named configuration, at ``joint=value,...``, at the equilibrium near the rest (``found``), or at rest.

        Raises: Refusal (HX407) for other words, HX408 when no equilibrium is found.
        """
        if words == "found":
            return operating_point(self, {}, search=True)
        return operating_point(self, named_positions(self.mechanism, words) if words else {})

    def state_space(self, at: str = "") -> StateSpace:
        """A, B, C, D at an operating point (:meth:`at`), from exact derivatives."""
        return linearized(self, self.at(at))

    def second_order(self, at: str = "") -> SecondOrder:
        """M d'' + C d' + K d = F u for small displacements d from an operating point."""
        space, point = self.state_space(at), self.at(at)
        n = len(space.states) // 2
        whole = expanded(self.tree, self.followers, point.positions, [0.0] * n, floats())
        mass = reduced_mass(Constants(self.tree, floats(), self.gravity), whole, n)
        m = sympy_matrix(mass)
        a, b = space.A, space.B
        return SecondOrder(space.states[:n], space.inputs, m, -m * a[n:, n:], -m * a[n:, :n], m * b[n:, :], m * space.offset[n:, :])

    # ---- closed loops ------------------------------------------------------------------------------------------------------

    @cached_property
    def closure(self) -> Any:
        """The casadi function (q, v) -> (phi, J, J' v) of the loops between all coordinates."""
        return constraint(self)

    def closed_forward(self, q: Sequence[float], v: Sequence[float], tau: Sequence[float], rate: float = 0.0) -> tuple[Floats, Floats]:
        """The accelerations and the closures' forces of a mechanism with loops, without damping and springs; ``rate`` (1/s) stabilises."""
        return closed_forward(self, self.closure, q, v, tau, rate)

    def freedom(self, q: Sequence[float]) -> int:
        """The degrees of freedom that the loops leave at q."""
        return freedom(self, self.closure, q)

    # ---- over time ---------------------------------------------------------------------------------------------------------

    def input(self, name: str) -> Variable:
        """The input of this name, or of the joint of this name.

        Raises: Refusal (HX407) when there is none.
        """
        return input_of(self.system, name)

    def simulate(self, duration: float, step: float, inputs: Mapping[str, Signal] | None = None, at: str = "") -> Response:
        """The response to signals by the name of their input or joint, from rest at an operating point.

        Raises: Refusal (HX407) for signals and names, HX409 when the solution cannot be continued.
        """
        import numpy as np

        signals = {self.input(name).name: signal for name, signal in (inputs or {}).items()}
        width = sum(link.velocities for link in independent(self.tree, self.followers))
        start = [*operating_point(self, named_positions(self.mechanism, at) if at else {}).positions, *[0.0] * width]
        graph = self.graph
        return simulate(self.system, signals, duration, step, start, lambda x, u: np.array(graph(x, u), dtype=float).reshape(-1))


def multibody_of(mechanism: Mechanism, *, base: str | None = None, gravity: tuple[float, float, float] = GRAVITY) -> Multibody:
    """The dynamics of a mechanism.

    Raises: Refusal (HX400) when nothing moves, HX403 couplings in a circle, HX404 a dof that moves no mass.
    """
    tree = tree_of(mechanism, base=base)
    return Multibody(mechanism, tree, followers_of(mechanism, tree), gravity)
