"""Linear systems: x' = A x + B u + offset, y = C x + D u, exact, in symbols and in floats, and what follows from them."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

from msgspec import Struct

from hymeko_x import codes
from hymeko_x.dynamics.numbers import symbols
from hymeko_x.dynamics.transfer import transfer_functions

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import numpy as np
    import sympy
    from numpy.typing import NDArray

    from hymeko_x.diagnostics import Report
    from hymeko_x.dynamics.system import System, Variable

    Floats = NDArray[np.floating[Any]]

_RANK = 1e-9
"""A singular value that is smaller than this part of the largest one is zero."""
_ROUNDING = 100.0
"""How many times the estimate of its rounding error a pole is away from zero."""


class Pole(NamedTuple):
    """An eigenvalue of A in 1/s, with its natural frequency in rad/s and its damping ratio (1 for a real stable pole)."""

    value: complex
    frequency: float
    damping: float


def _damping(pole: complex) -> float:
    ratio = -pole.real / abs(pole) if pole else 0.0
    return ratio if abs(ratio) > _RANK else 0.0


class StateSpace(Struct, frozen=True, dict=True):
    """x' = A x + B u + offset, y = C x + D u at an operating point: sympy matrices whose entries are fractions or formulas."""

    states: tuple[Variable, ...]
    inputs: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    A: sympy.Matrix
    B: sympy.Matrix
    C: sympy.Matrix
    D: sympy.Matrix
    offset: sympy.Matrix

    @cached_property
    def floats(self) -> tuple[Floats, Floats, Floats, Floats]:
        """A, B, C, D as arrays of floats."""
        import numpy as np

        a, b, c, d = (np.array(matrix.tolist(), dtype=float).reshape(matrix.shape) for matrix in (self.A, self.B, self.C, self.D))
        return a, b, c, d

    @property
    def poles(self) -> list[Pole]:
        """The poles, slowest first."""
        import numpy as np

        values = map(complex, np.linalg.eigvals(self.floats[0])) if self.states else ()
        poles = [Pole(value, abs(value), _damping(value)) for value in values]
        return sorted(poles, key=lambda pole: (float(f"{pole.frequency:.9g}"), pole.value.real, pole.value.imag))

    @property
    def controllable(self) -> int:
        """How many dimensions of the state the inputs reach: the rank of the Kalman matrix [B, A B, A^2 B, ...]."""
        return reached(self.floats[0], self.floats[1])

    @property
    def observable(self) -> int:
        """How many dimensions of the state the outputs tell."""
        return reached(self.floats[0].T, self.floats[2].T)

    def transfer(self) -> list[list[Any]]:
        """The transfer functions from each free input (columns) to each output (rows), as fractions in s.

        Raises: Refusal (HX408), see :func:`hymeko_x.dynamics.transfer.transfer_functions`.
        """
        columns = {variable.name: number for number, variable in enumerate(self.inputs)}
        rates = {variable.rate_of: columns[variable.name] for variable in self.inputs if variable.rate_of}
        pairs = [(columns[variable.name], rates.get(variable.name)) for variable in self.free_inputs]
        return transfer_functions(self.A, self.B, self.C, self.D, pairs)

    @property
    def free_inputs(self) -> list[Variable]:
        """The inputs that are no rates of others: the columns of :meth:`transfer`."""
        return [variable for variable in self.inputs if not variable.rate_of]


def reached(a: Floats, b: Floats) -> int:
    """The dimension of the subspace that b reaches under a, by orthogonal steps.

    Source: the staircase algorithm (Rosenbrock), which does not compute powers of A.
    """
    import numpy as np

    if not a.size or not b.size:
        return 0
    basis = np.zeros((len(a), 0))
    new = _scaled(b)
    scale = max(1.0, float(np.linalg.norm(a, 2)))
    while new.size and basis.shape[1] < len(a):
        rest = new - basis @ (basis.T @ new)
        rest -= basis @ (basis.T @ rest)
        u, sizes, _ = np.linalg.svd(rest, full_matrices=False)
        fresh = u[:, sizes > _RANK * max(1e-300, float(np.linalg.norm(new, 2)))]
        if not fresh.size:
            break
        basis = np.hstack([basis, fresh])
        new = a @ fresh / scale
    return basis.shape[1]


def _scaled(b: Floats) -> Floats:
    import numpy as np

    sizes = np.linalg.norm(b, axis=0)
    kept: Floats = b[:, sizes > 0] / sizes[sizes > 0]
    return kept


def linearize(
    system: System, at: Sequence[float] | None = None, held: Sequence[float] | None = None, *, symbolic: bool = False
) -> StateSpace:
    """The linear system at a state (default: the initial one) and constant inputs (default: their constant parts).

    ``symbolic`` keeps the parameters as symbols; otherwise they are the fractions that their decimals stand for.
    The offset is what x' is at the operating point, zero at an equilibrium; states and inputs count from there.
    """
    import sympy

    numbers = symbols()
    x = [sympy.Symbol(f"x{i}", real=True) for i in range(len(system.states))]
    u = [sympy.Symbol(f"u{i}", real=True) for i in range(len(system.inputs))]
    p = parameter_symbols(system) if symbolic else [numbers.exact(value) for value in system.values("parameters")]
    point = dict(zip(x, map(numbers.exact, system.values("states") if at is None else at), strict=True))
    point |= dict(zip(u, map(numbers.exact, system.values("inputs") if held is None else held), strict=True))
    rates = sympy.Matrix(len(x), 1, system.rates(x, u, p, numbers))
    measured = sympy.Matrix(len(system.outputs), 1, system.measured(x, u, p, numbers))
    a, b, c, d = (_jacobian(values, by, point) for values in (rates, measured) for by in (x, u))
    return StateSpace(system.states, system.inputs, system.outputs, a, b, c, d, rates.subs(point).applyfunc(sympy.simplify))


def _jacobian(values: sympy.Matrix, by: list[sympy.Symbol], point: Mapping[Any, Any]) -> sympy.Matrix:
    import sympy

    if not by or not values.rows:
        return sympy.zeros(values.rows, len(by))
    return values.jacobian(by).subs(point).applyfunc(sympy.together)


def parameter_symbols(system: System) -> list[Any]:
    """A positive symbol for every parameter, named like it (gains may have any sign)."""
    import sympy

    return [
        sympy.Symbol(parameter.name, positive=True) if parameter.value > 0 else sympy.Symbol(parameter.name, real=True)
        for parameter in system.parameters
    ]


def is_linear(system: System) -> bool:
    """Whether the rates and outputs are linear (or affine) in states and inputs."""
    import sympy

    numbers = symbols()
    x = [sympy.Symbol(f"x{i}", real=True) for i in range(len(system.states))]
    u = [sympy.Symbol(f"u{i}", real=True) for i in range(len(system.inputs))]
    p = [numbers.exact(value) for value in system.values("parameters")]
    values = sympy.Matrix([*system.rates(x, u, p, numbers), *system.measured(x, u, p, numbers)])
    return not values.jacobian([*x, *u]).free_symbols if x or u else True


def report_unstable(space: StateSpace, report: Report) -> None:
    """Warn (HX405) of every input that reaches a pole with a positive real part, once, with the fastest such pole."""
    found: dict[int, complex] = {}
    for pole, reach in _unstable(*space.floats[:2]):
        for number in reach:
            found[number] = max(found.get(number, 0j), pole, key=lambda value: value.real)
    for number, pole in sorted(found.items()):
        variable = space.inputs[number]
        words = f"input '{variable.name}' excites the unstable pole {complex_text(pole)} 1/s"
        report.warn(codes.UNSTABLE_INPUT, f"{variable.element or variable.name}: {words}", element=variable.element)


def _unstable(a: Floats, b: Floats) -> list[tuple[complex, list[int]]]:
    """The poles with a positive real part beyond rounding, and the inputs that reach each.

    Rounding moves a pole by eps |A| / |y'x| with its left and right unit eigenvectors y and x: much where poles coincide.
    Source: Golub & Van Loan, 7.2.2, and the test of Popov, Belevitch and Hautus.
    """
    import numpy as np
    from scipy.linalg import eig

    if not a.size:
        return []
    poles, left, right = eig(a, left=True)
    moved = _ROUNDING * np.finfo(float).eps * np.linalg.norm(a, 2) / np.maximum(np.abs(np.sum(left.conj() * right, axis=0)), 1e-300)
    found = []
    for pole, y, error in zip(poles, left.T, moved, strict=True):
        if pole.real > max(error, _RANK) and pole.imag >= 0:
            reach = np.abs(y.conj() @ b) / np.maximum(np.linalg.norm(b, axis=0), 1e-300)
            found.append((complex(pole), [int(number) for number in np.flatnonzero(reach > _RANK)]))
    return found


def complex_text(value: complex) -> str:
    """A complex number with six digits; parts that are rounding errors of the other are left out."""
    real, imaginary = (0.0 if abs(part) < 1e-9 * max(1.0, abs(value)) else part for part in (value.real, value.imag))
    return f"{real:.6g}" if not imaginary else f"{real:.6g} {'-' if imaginary < 0 else '+'} {abs(imaginary):.6g}i"
