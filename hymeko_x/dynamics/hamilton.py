"""The port-Hamiltonian form of mechanisms: x = (q, p), H = p' M(q)^-1 p / 2 + V(q), x' = (J - R) dH/dx + G u, y = G' dH/dx.

J = [[0, N], [-N', C]], where q' = N(q) v and C(p) turns the momenta of balls and free bodies with their own axes:
p' = p x w of an angular momentum, and so on. R has the dampers and friction, G the inputs. Energies are in J.
Closed loops phi(q) = 0 are one more port, through which no power flows: x' = (J - R) dH/dx + G u + B f, 0 = B' dH/dx, B = [[0], [A']] with
the Jacobian A of phi over the independent velocities, and the forces f of the closures.
Source: van der Schaft & Jeltsema, Port-Hamiltonian Systems Theory (2014), chapters 2 and 6.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

from msgspec import Struct

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.dynamics.couplings import expanded, independent
from hymeko_x.dynamics.lines import stretches
from hymeko_x.dynamics.numbers import add, dot, factorize, graphs, solve, symbols, times
from hymeko_x.dynamics.passive import resist, resistances, rubbing, spring_energy
from hymeko_x.dynamics.recursion import Constants, mass_matrix
from hymeko_x.dynamics.spatial import composed, minus, plus, scaled, skew, turned
from hymeko_x.dynamics.system import Variable
from hymeko_x.dynamics.trees import position_rates, reduced, reduced_closing
from hymeko_x.ir.parts import DofKind

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from hymeko_x.dynamics.couplings import TreeMotion
    from hymeko_x.dynamics.loops import Closing
    from hymeko_x.dynamics.numbers import Matrix, Number, Numbers
    from hymeko_x.dynamics.spatial import FramePose
    from hymeko_x.dynamics.tree import Link
    from hymeko_x.dynamics.trees import Trees

    Floats = NDArray[np.floating[Any]]

_ITERATIONS = 50
_PARTS = (*(0.5**k for k in range(20)), 1.0)
"""Of a step of Newton's method, which goes too far where friction changes its sign; the first that leads nearer is taken, or all of it."""
_EXACT = 1e-12
"""Newton's last step, relative to the state."""
_TINY = 1e-12
"""In the square of a change: what the discrete gradient adds to the gradient is rounding where a robot hardly moves."""
_RANK = 1e-11


class Blocks(NamedTuple):
    """What a form is made of at (q, p): mass matrix, potential energy, J, R, G."""

    mass: Matrix
    potential: Number
    J: Matrix
    R: Matrix
    G: Matrix


class Flow(NamedTuple):
    """States and energies at n + 1 times; outputs y, and what dampers take (J), within each of the n steps between them."""

    states: Floats
    energies: Floats
    outputs: Floats
    losses: Floats


class MechanicalHamiltonian(Struct, frozen=True, dict=True):
    """The port-Hamiltonian form of a mechanism over the coordinates that follow no others; closed loops are a port."""

    found: Trees

    @property
    def links(self) -> list[Link]:
        """The independent links."""
        return independent(self.found.tree, self.found.followers)

    @property
    def states(self) -> tuple[Variable, ...]:
        """Positions and momenta."""
        system, links = self.found.system, self.links
        count = sum(link.coordinates for link in links)
        return (*system.states[:count], *[_momentum(variable) for variable in system.states[count:]])

    def blocks(self, q: Sequence[Number], p: Sequence[Number], numbers: Numbers) -> Blocks:
        """M, V, J, R and G at a state, on any number type."""
        found, links = self.found, self.links
        constants = Constants(found.tree, numbers, found.gravity)
        whole = expanded(found.tree, found.followers, q, [0] * len(p), numbers)
        mass = reduced(mass_matrix(constants, whole.q), whole)
        rates = self._rates(mass, p, whole) if rubbing(found.tree, found.cables) else whole.v
        resistance = reduced(_damping(found, constants, whole.q, rates), whole)
        driven = _driven(found, constants, whole.q)
        columns = [[dot(column, force) for column in zip(*whole.ratios, strict=True)] for force in driven]
        width = len(q) + len(p)
        r: Matrix = [[0] * width for _ in q] + [[*[0] * len(q), *row] for row in resistance]
        g: Matrix = [[0] * len(columns) for _ in q] + [[column[k] for column in columns] for k in range(len(p))]
        return Blocks(mass, _potential(found, constants, whole.q, numbers), _structure(links, q, p), r, g)

    @staticmethod
    def _rates(mass: Matrix, p: Sequence[Number], whole: TreeMotion) -> list[Number]:
        """The velocities of all coordinates, on which friction depends."""
        own = solve(factorize(mass), p)
        return [dot(row, own) for row in whole.ratios]

    def closed(self, q: Sequence[Number], numbers: Numbers) -> Closing:
        """phi of the closed loops at q, and its Jacobian A over the independent velocities."""
        found = self.found
        rest = [0] * sum(link.velocities for link in self.links)
        whole = expanded(found.tree, found.followers, q, rest, numbers)
        return reduced_closing(found.closures, Constants(found.tree, numbers, found.gravity), whole)

    # ---- as expressions of casadi ------------------------------------------------------------------------------------------------

    @cached_property
    def functions(self) -> Any:
        """The casadi function x -> (H, dH/dx, J, R, G)."""
        import casadi

        x = casadi.SX.sym("x", len(self.states))
        count = sum(link.coordinates for link in self.links)
        whole = [x[k] for k in range(x.numel())]
        q, p = whole[:count], whole[count:]
        blocks = self.blocks(q, p, graphs())
        energy = dot(p, solve(factorize(blocks.mass), p)) / 2 + blocks.potential
        matrices = [_expressions(matrix) for matrix in blocks[2:]]
        return casadi.Function("form", [x], [energy, casadi.gradient(energy, x), *matrices], ["x"], ["H", "e", "J", "R", "G"])

    @cached_property
    def _step(self) -> Any:
        """The casadi function (x0, (x1, f), u, h) -> what is missing to a step, its derivative by (x1, f), y, and what dampers take."""
        import casadi

        n, m, loops = len(self.states), len(self.found.system.inputs), sum(closure.rows for closure in self.found.closures)
        a, b, u, h = casadi.SX.sym("a", n), casadi.SX.sym("b", n), casadi.SX.sym("u", m), casadi.SX.sym("h")
        f = casadi.SX.sym("f", loops)
        before, after = self.functions(a)[0], self.functions(b)[0]
        _, middle, j, r, g = self.functions((a + b) / 2)
        change = b - a
        gradient = middle + change * (after - before - casadi.dot(middle, change)) / (casadi.dot(change, change) + _TINY)
        phi, pull = self._pull(a, b, j, f) if loops else (casadi.SX(0, 1), 0)
        missing = casadi.vertcat(change - h * (casadi.mtimes(j - r, gradient) + casadi.mtimes(g, u) + pull), phi)
        lost = h * casadi.dot(gradient, casadi.mtimes(r, gradient))
        after = casadi.vertcat(b, f)
        return casadi.Function("step", [a, after, u, h], [missing, casadi.jacobian(missing, after), casadi.mtimes(g.T, gradient), lost])

    def _pull(self, a: Any, b: Any, j: Any, f: Any) -> tuple[Any, Any]:
        """phi at the end of a step from a to b, and B f, by a discrete gradient of phi: no power flows where phi is 0 at both ends."""
        import casadi

        count = sum(link.coordinates for link in self.links)
        q = casadi.SX.sym("q", count)
        phi = casadi.Function("phi", [q], [casadi.vertcat(*self.closed([q[k] for k in range(count)], graphs()).gap)])
        slope = casadi.Function("slope", [q], [casadi.jacobian(phi(q), q)])
        before, after, change = a[:count], b[:count], b[:count] - a[:count]
        middle = slope((before + after) / 2)
        rest = phi(after) - phi(before) - casadi.mtimes(middle, change)
        discrete = middle + casadi.mtimes(rest, change.T) / (casadi.dot(change, change) + _TINY)
        return phi(after), casadi.vertcat(casadi.SX(count, 1), casadi.mtimes(casadi.mtimes(discrete, j[:count, count:]).T, f))

    def state(self, q: Sequence[float], v: Sequence[float]) -> list[float]:
        """The state at positions and velocities of the independent coordinates."""
        import numpy as np

        from hymeko_x.dynamics.numbers import floats

        mass = np.array(self.blocks(q, [0.0] * len(v), floats()).mass, dtype=float)
        return [*q, *(mass @ np.array(v, dtype=float)).tolist()]

    def simulate(self, start: Sequence[float], inputs: Floats, step: float) -> Flow:
        """The flow from a state by Gonzalez' discrete gradient, ``inputs`` (n, m) held within each of n steps.

        The energy grows in every step by step * y'u less what dampers take, but for rounding; quaternions keep their length.
        Source: O. Gonzalez, Time integration and discrete Hamiltonian systems (1996).

        Raises: Refusal (HX409) where a step has no solution.
        """
        import numpy as np

        states, outputs, losses = [np.array(start, dtype=float)], [], []
        for number, u in enumerate(inputs):
            x = states[-1]
            after = x + 1e-3 * step if number == 0 else 2 * x - states[-2]
            after, output, lost = self._advanced(x, after, u, step, number)
            states.append(after)
            outputs.append(output)
            losses.append(lost)
        energies = [float(self.functions(x)[0]) for x in states]
        return Flow(np.array(states), np.array(energies), np.array(outputs).reshape(len(outputs), -1), np.array(losses))

    def _advanced(self, x: Floats, guess: Floats, u: Floats, step: float, number: int) -> tuple[Floats, Floats, float]:
        import numpy as np

        width = len(x)
        after = np.append(guess, np.zeros(sum(closure.rows for closure in self.found.closures)))
        now = self._missing(x, after, u, step)
        for _ in range(_ITERATIONS):
            missing, slope, output, lost = now
            if not np.isfinite(slope).all():
                break
            change = _solved(slope, missing[:, 0], is_square=len(after) == width)
            if not np.isfinite(change).all():
                break
            if np.abs(change[:width]).max() <= _EXACT * (1.0 + np.abs(after[:width]).max()):
                return after[:width] - change[:width], output[:, 0], float(lost[0, 0])
            for part in _PARTS:
                now = self._missing(x, after - part * change, u, step)
                if np.linalg.norm(now[0]) < np.linalg.norm(missing):
                    break
            after = after - part * change
        message = f"the step at {number * step:.6g} s has no solution; a shorter --step may have one"
        raise refuse(codes.SIMULATION_FAILED, message)

    def _missing(self, x: Floats, after: Floats, u: Floats, step: float) -> list[Floats]:
        import numpy as np

        return [np.array(value, dtype=float) for value in self._step(x, after, u, step)]


def _expressions(matrix: Matrix) -> Any:
    import casadi

    return casadi.vertcat(*[casadi.horzcat(*row) if row else casadi.SX(1, 0) for row in matrix])


def _solved(slope: Floats, missing: Floats, *, is_square: bool) -> Floats:
    """A step of Newton's method; closures that repeat each other share their force evenly."""
    import numpy as np

    return np.linalg.solve(slope, missing) if is_square else np.linalg.lstsq(slope, missing, rcond=_RANK)[0]


def _momentum(velocity: Variable) -> Variable:
    stem, _, last = velocity.name.rpartition(".")
    name = f"{stem}.momentum" if last == "velocity" else f"{stem}.p{last}"
    return Variable(
        name, "kg*m/s" if velocity.unit == "m/s" else "kg*m^2/s", velocity.symbol.replace(r"\dot q", "p"), element=velocity.element
    )


# ---- blocks ------------------------------------------------------------------------------------------------------------------------


def _potential(found: Trees, constants: Constants, q: Sequence[Number], numbers: Numbers) -> Number:
    """The energy of springs and weights, and of actuators that pull by position."""
    energy = spring_energy(constants, found.cables, q)
    world: list[FramePose] = []
    frames = constants.link_frames(q)
    up = constants.pull.linear
    for link, frame, inertia in zip(found.tree.links, frames, constants.inertias, strict=True):
        world.append(composed(world[link.parent], frame) if link.parent >= 0 else frame)
        moment = plus(scaled(world[-1].position, inertia.mass), turned(world[-1].rotation, inertia.moment))
        energy = add(energy, dot(up, moment))
    motors = found.motors or ()
    for motor, along in zip(motors, stretches([motor.line for motor in motors], constants, q), strict=True):
        offset, slope = (numbers.exact(value) if value else 0 for value in motor.law.bias[:2])
        energy = add(energy, minus(add(times(offset, along.length), times(slope, times(along.length, along.length)) / 2)))
    return energy


def _damping(found: Trees, constants: Constants, q: Sequence[Number], v: Sequence[Number]) -> Matrix:
    """What resists velocities: dampers and friction of joints and tendons, and the dampers of actuators."""
    matrix = resistances(constants, found.cables, q, v)
    motors = [motor for motor in found.motors or () if motor.law.bias[2]]
    for motor, stretch in zip(motors, stretches([motor.line for motor in motors], constants, q), strict=True):
        resist(matrix, stretch.row, constants.numbers.exact(-motor.law.bias[2]))
    return matrix


def _driven(found: Trees, constants: Constants, q: Sequence[Number]) -> list[list[Number]]:
    """The forces of all coordinates for a unit of each input."""
    columns = range(found.tree.nv)
    if found.motors is not None:
        gains = [constants.numbers.exact(motor.law.gain[0]) for motor in found.motors]
        along = stretches([motor.line for motor in found.motors], constants, q)
        return [[times(gain, stretch.row.get(k, 0)) for k in columns] for gain, stretch in zip(gains, along, strict=True)]
    scalar = [link for link in independent(found.tree, found.followers) if link.velocities == 1]
    return [[int(k == link.v) for k in columns] for link in scalar]


def _structure(links: Sequence[Link], q: Sequence[Number], p: Sequence[Number]) -> Matrix:
    """J: how positions follow velocities, and what turning axes do to momenta."""
    columns = [position_rates(links, q, [int(k == j) for j in range(len(p))]) for k in range(len(p))]
    turns = _turns(links, p)
    upper = [[*[0] * len(q), *[column[i] for column in columns]] for i in range(len(q))]
    return upper + [[*[minus(x) for x in column], *turn] for column, turn in zip(columns, turns, strict=True)]


def _turns(links: Sequence[Link], p: Sequence[Number]) -> Matrix:
    """C(p), antisymmetric: l' = l x w and a' = l x v + a x w of a free body with the linear momentum l and the angular one a."""
    matrix: Matrix = [[0] * len(p) for _ in p]
    at = 0
    for link in links:
        own, first = list(p[at : at + link.velocities]), at
        at += link.velocities
        if link.dof.kind is DofKind.BALL:
            _place(matrix, first, first, skew(own))
        elif link.dof.kind is DofKind.FREE:
            for row, column, momentum in ((0, 3, own[:3]), (3, 0, own[:3]), (3, 3, own[3:])):
                _place(matrix, first + row, first + column, skew(momentum))
    return matrix


def _place(matrix: Matrix, row: int, column: int, block: Matrix) -> None:
    for i, values in enumerate(block):
        matrix[row + i][column : column + 3] = values


# ---- formulas ------------------------------------------------------------------------------------------------------------------------


class HamiltonFormulas(NamedTuple):
    """The form in symbols: M and V over q1, q2, ..., and J, R, G over p1, p2, ... as well."""

    mass: Any
    potential: Any
    J: Any
    R: Any
    G: Any


def formulas_of(form: MechanicalHamiltonian) -> HamiltonFormulas:
    """The form as formulas of sympy, numbers as fractions. For a handful of dofs."""
    import sympy

    links = form.links
    q = [sympy.Symbol(f"q{k}", real=True) for k in range(1, sum(link.coordinates for link in links) + 1)]
    p = [sympy.Symbol(f"p{k}", real=True) for k in range(1, sum(link.velocities for link in links) + 1)]
    blocks = form.blocks(q, p, symbols())
    width, inputs = len(q) + len(p), len(form.found.system.inputs)
    shapes = ((len(p), len(p)), (width, width), (width, width), (width, inputs))
    matrices = (blocks.mass, blocks.J, blocks.R, blocks.G)
    m, j, r, g = (sympy.Matrix(*shape, [x for row in rows for x in row]) for shape, rows in zip(shapes, matrices, strict=True))
    return HamiltonFormulas(m.applyfunc(sympy.trigsimp), sympy.trigsimp(blocks.potential), j, r, g)


def loop_formulas(form: MechanicalHamiltonian) -> tuple[Any, Any]:
    """phi(q) of closed loops and B as formulas of sympy, without rows and columns that are zero everywhere."""
    import sympy

    count = sum(link.coordinates for link in form.links)
    closed = form.closed([sympy.Symbol(f"q{k}", real=True) for k in range(1, count + 1)], symbols())
    rows = [(gap, row) for gap, row in zip(closed.gap, closed.slope, strict=True) if any(entry != 0 for entry in row)]
    phi = sympy.Matrix(len(rows), 1, [gap for gap, _ in rows])
    b = sympy.Matrix(len(form.states), len(rows), lambda i, k: rows[k][1][i - count] if i >= count else 0)
    return phi.applyfunc(sympy.trigsimp), b.applyfunc(sympy.trigsimp)
