"""The dynamics of a mechanism at operating points, with closed loops, and over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.dynamics.assembly import reduction
from hymeko_x.dynamics.couplings import expanded, followers_of, independent
from hymeko_x.dynamics.drives import motors_of, remembering
from hymeko_x.dynamics.forms import SecondOrder
from hymeko_x.dynamics.hamilton import MechanicalHamiltonian
from hymeko_x.dynamics.loops import closing, closures_of
from hymeko_x.dynamics.numbers import floats
from hymeko_x.dynamics.operating import OperatingPoint, linearized, named_positions, operating_point, start_of, sympy_matrix
from hymeko_x.dynamics.passive import cables_of
from hymeko_x.dynamics.recursion import GRAVITY, mass_matrix
from hymeko_x.dynamics.simulation import Response, simulate
from hymeko_x.dynamics.system import Variable, input_of
from hymeko_x.dynamics.tree import tree_of
from hymeko_x.dynamics.trees import Trees, reduced

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
        return operating_point(self, named_positions(self, words) if words else {}, keep="=" in words)

    def state_space(self, at: str = "") -> StateSpace:
        """A, B, C, D at an operating point (:meth:`at`), from exact derivatives."""
        return linearized(self, self.at(at))

    def second_order(self, at: str = "") -> SecondOrder:
        """M d'' + C d' + K d = F u for small displacements d from an operating point.

        Raises: Refusal (HX408) for actuators with a state of their own.
        """
        self.refuse_states("second-order")
        space, point = self.state_space(at), self.at(at)
        n = len(space.states) // 2
        basis = reduction(self, point.positions).basis
        whole = expanded(self.tree, self.followers, point.positions, [0.0] * len(basis), floats())
        mass = reduced(mass_matrix(self._constants, whole.q), whole)
        m = sympy_matrix(basis.T @ mass @ basis)
        a, b = space.A, space.B
        return SecondOrder(space.states[:n], space.inputs, m, -m * a[n:, n:], -m * a[n:, :n], m * b[n:, :], m * space.offset[n:, :])

    def refuse_states(self, form: str) -> None:
        """Refuse (HX408) actuators with a state of their own, which a form has no place for."""
        for motor in remembering(self.motors):
            message = f"{motor.id} has a state of its own, which the {form} form has no place for"
            raise refuse(codes.NO_FORM, message, self.mechanism.origin(motor.id), element=str(motor.id), hint="--form state-space has it")

    def port_hamiltonian(self) -> MechanicalHamiltonian:
        """H, J, R, G over positions and momenta; closed loops are a port.

        Raises: Refusal (HX408) for actuators with a state of their own, and for those whose gain changes as they move.
        """
        self.refuse_states("port-Hamiltonian")
        for motor in self.motors or ():
            if any(motor.law.gain[1:]):
                message = f"the gain of {motor.id} changes with its length or rate, which the port-Hamiltonian form has no place for"
                raise refuse(codes.NO_FORM, message, self.mechanism.origin(motor.id), element=str(motor.id))
        return MechanicalHamiltonian(self)

    # ---- closed loops ------------------------------------------------------------------------------------------------------

    def closed_forward(self, q: Sequence[float], v: Sequence[float], tau: Sequence[float], rate: float = 0.0) -> tuple[Floats, Floats]:
        """The accelerations and the closures' forces of a mechanism with loops, without damping and springs; ``rate`` (1/s) stabilises.

        Closures that repeat each other (a planar four-bar closed by a point in space) share their force evenly.
        """
        import numpy as np

        state, rates = np.array(q, dtype=float), np.array(v, dtype=float)
        gap, slope, drift = (np.array(part, dtype=float) for part in closing(self.closures, self._constants, list(state), list(rates)))
        mass, bias = self.mass_matrix(state), self.bias(state, rates)
        free = np.linalg.solve(mass, np.array(tau) - bias)
        wanted = -drift - 2 * rate * slope @ rates - rate**2 * gap
        inverse = np.linalg.solve(mass, slope.T)
        force = np.linalg.lstsq(slope @ inverse, wanted - slope @ free, rcond=1e-10)[0]
        return free + inverse @ force, force

    def freedom(self, q: Sequence[float]) -> int:
        """The degrees of freedom that the loops leave at q, the independent coordinates."""
        return len(reduction(self, q).columns)

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

        signals = self.signals(duration, inputs or {})
        width = sum(link.velocities for link in independent(self.tree, self.followers))
        start = [*self.start(at), *[0.0] * (width + len(remembering(self.motors)))]
        graph = self.graph
        return simulate(self.system, signals, duration, step, start, lambda x, u: np.array(graph(x, u), dtype=float).reshape(-1))

    def signals(self, duration: float, inputs: Mapping[str, Signal]) -> dict[str, Signal]:
        """The signals by the names of inputs.

        Raises: Refusal (HX407) for names.
        """
        return {self.input(name).name: signal for name, signal in inputs.items()}

    def start(self, at: str) -> list[float]:
        """The independent positions at an operating point (:meth:`at`)."""
        if at == "found":
            return self.at(at).positions
        return start_of(self, named_positions(self, at) if at else {}, keep="=" in at)


def multibody_of(
    mechanism: Mechanism, *, base: str | None = None, gravity: tuple[float, float, float] = GRAVITY, actuated: bool = False
) -> Multibody:
    """The dynamics of a mechanism; its inputs are the controls of its actuators if ``actuated``.

    Raises: Refusal (HX400) when nothing moves, HX403 couplings in a circle, HX404 a dof that moves no mass, HX408 no actuator to use.
    """
    tree = tree_of(mechanism, base=base)
    closures, _ = closures_of(mechanism, tree)
    cables, _ = cables_of(mechanism, tree)
    motors = motors_of(mechanism, tree)[0] if actuated else None
    if actuated and not motors:
        message = f"{mechanism.name}: no actuator of it drives a joint by a law that is linear in control, position and velocity"
        raise refuse(codes.NO_FORM, message, hint="the inputs are forces of the joints without --inputs actuators")
    return Multibody(mechanism, tree, followers_of(mechanism, tree)[0], gravity, closures, cables, motors)
