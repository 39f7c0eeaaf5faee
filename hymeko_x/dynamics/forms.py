"""Two forms of a lumped network beside the state space: M q'' + C q' + K q = F u, and the port-Hamiltonian one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from msgspec import Struct

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.dynamics.equations import Moment, participation
from hymeko_x.dynamics.layout import layout_of, tex
from hymeko_x.dynamics.linear import parameter_symbols
from hymeko_x.dynamics.numbers import symbols, times
from hymeko_x.dynamics.system import System, Variable
from hymeko_x.ir import lumped
from hymeko_x.networks.domains import UNITS

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    import sympy
    from numpy.typing import NDArray

    from hymeko_x.diagnostics import Refusal
    from hymeko_x.ir.ids import Id
    from hymeko_x.networks.network import Branch, Network

    Floats = NDArray[np.floating[Any]]


class SecondOrder(Struct, frozen=True):
    """M q'' + C q' + K q = F u + offset: sympy matrices whose entries are fractions or formulas."""

    coordinates: tuple[Variable, ...]
    inputs: tuple[Variable, ...]
    M: sympy.Matrix
    C: sympy.Matrix
    K: sympy.Matrix
    F: sympy.Matrix
    offset: sympy.Matrix


class PortHamiltonian(Struct, frozen=True):
    """x' = (J - R) e + (G - P) u, y = (G + P)' e + S u, where e = dH/dx is the gradient of the energy H in J, and y'u the power.

    States are the deflections of the edges with springs and the momenta of the coordinates; J is made of the signed ratios with
    which the coordinates belong to the edges: the graph's own Dirac structure. P and S are zero unless a damper lies
    at a moved end. Source: van der Schaft & Jeltsema, Port-Hamiltonian Systems Theory (2014), chapters 2, 4 and 12.
    """

    states: tuple[Variable, ...]
    inputs: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    J: sympy.Matrix
    R: sympy.Matrix
    G: sympy.Matrix
    P: sympy.Matrix
    S: sympy.Matrix
    energy: Any
    gradient: sympy.Matrix
    symbols: tuple[Any, ...]

    def simulate(self, start: Sequence[float], inputs: Floats, step: float) -> tuple[Floats, Floats, Floats]:
        """States, outputs and energies over time by the implicit midpoint rule, ``inputs`` (n, m) held within each of n steps.

        The rule keeps the power balance of a quadratic energy exactly: H grows by (y'u - e'R e - ...) * step in every step, with
        gradient e and output y at the midpoint, which are what ``outputs`` (n, m) has. States and energies have n + 1 rows.
        Source: van der Schaft & Jeltsema, chapter 12; the midpoint rule is the discrete gradient of a quadratic function.
        """
        import numpy as np
        import sympy

        def array(matrix: Any) -> Floats:
            return np.array(matrix.tolist(), dtype=float).reshape(matrix.shape)

        j, r, g, p, s, q = map(array, (self.J, self.R, self.G, self.P, self.S, self.gradient.jacobian(self.symbols)))
        rest = array(self.gradient.subs(dict.fromkeys(self.symbols, 0)))[:, 0]
        constant = float(sympy.sympify(self.energy).subs(dict.fromkeys(self.symbols, 0)))
        implicit = np.eye(len(q)) - step / 2 * (j - r) @ q
        states, outputs = [np.array(start, dtype=float)], []
        for u in np.atleast_2d(inputs):
            middle = np.linalg.solve(implicit, states[-1] + step / 2 * ((j - r) @ rest + (g - p) @ u))
            states.append(2 * middle - states[-1])
            outputs.append((g + p).T @ (q @ middle + rest) + s @ u)
        x = np.array(states)
        energies = np.einsum("ni,ij,nj->n", x, q, x) / 2 + x @ rest + constant
        return x, np.array(outputs), energies


def second_order(network: Network, *, symbolic: bool = False) -> SecondOrder:
    """The linear equations of second order of a network, about the state zero.

    Raises: Refusal (HX408) for a network with integral controllers or ends of given velocity, which have states of first order.
    """
    import sympy

    layout = layout_of(network)
    n = len(network.coordinates)
    if len(layout.states) > 2 * n:
        variable = layout.states[2 * n]
        message = f"{variable.element} has the state {variable.name} of first order; there is no form of second order"
        raise refuse(codes.NO_FORM, message, element=variable.element, hint="--form state-space")
    numbers = symbols()
    x, u = sympy.symbols(f"x:{2 * n}", real=True), sympy.symbols(f"u:{len(layout.inputs)}", real=True)
    p = parameters_of(network, symbolic=symbolic)
    now = Moment(layout, x, u, p, numbers)
    forces = sympy.Matrix(n, 1, now.forces())
    zero = dict.fromkeys((*x, *u), 0)
    stiffness, damping = (-forces.jacobian(part).subs(zero) for part in (x[:n], x[n:]))
    driven = forces.jacobian(u).subs(zero) if u else sympy.zeros(n, 0)
    return SecondOrder(layout.states[:n], layout.inputs, sympy.Matrix(now.mass_matrix()), damping, stiffness, driven, forces.subs(zero))


def parameters_of(network: Network, *, symbolic: bool) -> list[Any]:
    """A symbol for each parameter, or the fraction that its decimal stands for."""
    layout = layout_of(network)
    bare = System(network.name, (), (), (), layout.parameters, lambda *_: [], lambda *_: [])
    return parameter_symbols(bare) if symbolic else [symbols().exact(variable.value) for variable in layout.parameters]


def port_hamiltonian(network: Network, *, symbolic: bool = False) -> PortHamiltonian:
    """The port-Hamiltonian form of a network.

    Raises: Refusal (HX408) for laws that are not linear and for controllers, whose energy is not known.
    """
    import sympy

    _check_energies(network)
    layout = layout_of(network)
    p = parameters_of(network, symbolic=symbolic)
    now = Moment(layout, (), (), p, symbols())
    sprung = [branch for branch in network.branches if any(isinstance(element.part, lumped.Spring) for element in branch.elements)]
    n, k = len(network.coordinates), len(sprung)
    incidence = {branch.id: _incidence(network, branch) for branch in network.branches}
    efforts = [(branch, element) for branch, element in network.ports]
    moved = [key for key in network.moved if (key, "velocity") in layout.input_of]
    x = sympy.symbols(" ".join([f"delta_{b.id.name}" for b in sprung] + [f"p_{key.name}" for key in network.coordinates]) + ",", real=True)
    momenta = sympy.Matrix(n, 1, x[k:])
    energy = (momenta.T * sympy.Matrix(now.mass_matrix()).LUsolve(momenta))[0] / 2 + _energy_of_springs(now, sprung, x[:k])
    ends = {branch.id: [_moved_by(branch, key) for key in moved] for branch in network.branches}
    m = len(efforts) + len(moved)
    J, R = sympy.zeros(n + k), sympy.zeros(n + k)
    G, P, S = sympy.zeros(n + k, m), sympy.zeros(n + k, m), sympy.zeros(m)
    J[k:, :k] = sympy.Matrix(n, k, lambda i, b: -incidence[sprung[b].id][i])
    J[:k, k:] = -J[k:, :k].T
    for column, (branch, element) in enumerate(efforts):
        G[k:, column] = symbols().exact(element.count) * incidence[branch.id]
    for row, branch in enumerate(sprung):
        for column, ratio in enumerate(ends[branch.id], len(efforts)):
            G[row, column] = ratio
    for branch in network.branches:
        damping = _total(now, branch, lumped.Damper, "damping")
        along = sympy.Matrix([*[0] * len(efforts), *ends[branch.id]])
        R[k:, k:] += damping * incidence[branch.id] * incidence[branch.id].T
        if m:
            P[k:, :] += damping * incidence[branch.id] * along.T
            S += damping * along * along.T
    inputs, outputs = _ports(layout.network, efforts, moved, layout.inputs, layout.input_of)
    gradient = sympy.Matrix([energy]).jacobian(x).T
    return PortHamiltonian(_states(network, sprung), inputs, outputs, J, R, G, P, S, energy, gradient, tuple(x))


def _check_energies(network: Network) -> None:
    """Raises: Refusal (HX408) for an element whose energy is not known."""
    for branch in network.branches:
        for element in branch.elements:
            if element.law is not None or (isinstance(element.part, lumped.Port) and element.part.kind != "effort"):
                words = "has a law of its own" if element.law is not None else "is a controller"
                raise _no_form(element.id, f"{words}; its energy is not known")


def _energy_of_springs(now: Moment, sprung: Sequence[Branch], deflections: Sequence[Any]) -> Any:
    """The energy in J of the springs of some edges at their deflections."""
    return sum(
        symbols().exact(element.count) * now.parameter(element.id, "stiffness") * (x - symbols().exact(element.part.rest)) ** 2 / 2
        for x, branch in zip(deflections, sprung, strict=True)
        for element in branch.elements
        if isinstance(element.part, lumped.Spring)
    )


def _total(now: Moment, branch: Branch, part: type[lumped.Spring | lumped.Damper], parameter: str) -> Any:
    """The sum of a parameter over the elements of an edge that are such parts."""
    return sum(symbols().exact(e.count) * now.parameter(e.id, parameter) for e in branch.elements if isinstance(e.part, part))


def _no_form(key: Id, words: str) -> Refusal:
    message = f"{key} {words}; there is no port-Hamiltonian form"
    return refuse(codes.NO_FORM, message, element=str(key), hint="--form state-space")


def _incidence(network: Network, branch: Branch) -> sympy.Matrix:
    """How each independent coordinate enters the deflection of an edge."""
    import sympy

    moves = participation(network, symbols())
    row = [sympy.Integer(0)] * len(network.coordinates)
    for key, ratio in branch.ends:
        for number, value in moves.get(key, {}).items():
            row[number] = row[number] + times(symbols().exact(ratio), value)
    return sympy.Matrix(len(row), 1, row)


def _moved_by(branch: Branch, key: Id) -> Any:
    return symbols().exact(sum(ratio for end, ratio in branch.ends if end == key))


def _states(network: Network, sprung: list[Branch]) -> tuple[Variable, ...]:
    deflections = [
        Variable(f"{branch.id.name}.deflection", UNITS[network.domains[branch.id]].position, rf"\delta_{{{tex(branch.id)}}}")
        for branch in sprung
    ]
    momenta = []
    for key in network.coordinates:
        units = UNITS[network.domains[key]]
        momenta.append(Variable(f"{key.name}.momentum", f"{units.effort}*s", f"p_{{{tex(key)}}}"))
    return (*deflections, *momenta)


def _ports(
    network: Network, efforts: list[Any], moved: list[Id], known: tuple[Variable, ...], input_of: Any
) -> tuple[tuple[Variable, ...], tuple[Variable, ...]]:
    """The inputs (efforts, then velocities) and the outputs that make power with them."""
    keys = [(element.id, "effort") for _, element in efforts] + [(key, "velocity") for key in moved]
    inputs = tuple(known[input_of[key]] for key in keys)
    rates = [Variable(f"{e.id.name}.rate", UNITS[network.domains[b.id]].velocity, f"y_{{{tex(e.id)}}}") for b, e in efforts]
    reactions = [Variable(f"{key.name}.effort", UNITS[network.domains[key]].effort, f"y_{{{tex(key)}}}") for key in moved]
    return inputs, (*rates, *reactions)
