"""The dynamics of trees: M(q) v' + C(q, v) v + g(q) = tau - damping - friction - springs, in floats, symbols and expression graphs."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, Self

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.dynamics.couplings import Follower, TreeMotion, expanded, independent
from hymeko_x.dynamics.drives import Motor, drive, remembering, signals_of, state_rates
from hymeko_x.dynamics.loops import STABILISATION, Closing, Closure, closed_acceleration, closing
from hymeko_x.dynamics.numbers import add, dot, factorize, floats, graphs, solve, symbols
from hymeko_x.dynamics.passive import Cable, passive_forces, rubbing, smooth
from hymeko_x.dynamics.positions import nearest
from hymeko_x.dynamics.recursion import GRAVITY, Constants, forward_dynamics, inverse_dynamics, mass_matrix
from hymeko_x.dynamics.spatial import minus
from hymeko_x.dynamics.system import System, Variable
from hymeko_x.ir.parts import DofKind

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from hymeko_x.dynamics.numbers import Matrix, Number, Numbers
    from hymeko_x.dynamics.tree import Link, LinkTree
    from hymeko_x.ir.mechanism import Mechanism

    Floats = NDArray[np.floating[Any]]


class TreeFormulas(NamedTuple):
    """M(q), the bias C(q, v) v + g(q), g(q), the forces of springs, dampers and friction, and those of actuators, as sympy matrices.

    They are in the symbols q1, q2, ... and v1, v2, ..., the controls u1, u2, ... and states a1, a2, ... of actuators.
    """

    q: tuple[Any, ...]
    v: tuple[Any, ...]
    mass: Any
    bias: Any
    gravity: Any
    passive: Any
    driven: Any


class Trees(Struct, frozen=True, dict=True):
    """The dynamics of a mechanism's trees.

    Configurations q are (nq,) or (n, nq), velocities v, accelerations and forces (nv,) or (n, nv), in the order of the links of
    ``tree``; a free base has a position and a quaternion (w, x, y, z), and a linear before an angular velocity, both in its own
    axes. With couplings, ``system`` has the independent coordinates only; the other functions have all of them. Loops and tendons
    are in ``system``, not in the functions of the trees. ``motors`` None: the inputs are a force for each dof of one coordinate.
    """

    mechanism: Mechanism
    tree: LinkTree
    followers: tuple[Follower, ...] = ()
    gravity: tuple[float, float, float] = GRAVITY
    closures: tuple[Closure, ...] = ()
    cables: tuple[Cable, ...] = ()
    motors: tuple[Motor, ...] | None = None

    @cached_property
    def _constants(self) -> Constants:
        return Constants(self.tree, floats(), self.gravity)

    def mass_matrix(self, q: Floats) -> Floats:
        """M(q) with armatures: (nv, nv), or (n, nv, nv)."""
        import numpy as np

        rows = mass_matrix(self._constants, _columns(q))
        shape = np.shape(q)[:-1]
        return np.stack([np.stack([np.broadcast_to(entry, shape) for entry in row], axis=-1) for row in rows], axis=-2).astype(float)

    def bias(self, q: Floats, v: Floats) -> Floats:
        """C(q, v) v + g(q)."""
        return _array(inverse_dynamics(self._constants, _columns(q), _columns(v)), q)

    def inverse(self, q: Floats, v: Floats, a: Floats) -> Floats:
        """The forces for which the accelerations are a, without damping and springs."""
        return _array(inverse_dynamics(self._constants, _columns(q), _columns(v), _columns(a)), q)

    def forward(self, q: Floats, v: Floats, tau: Floats) -> Floats:
        """The accelerations under forces, without damping and springs.

        Raises: Refusal (HX404) where some motion moves no mass.
        """
        import numpy as np

        with np.errstate(divide="ignore", invalid="ignore"):
            found = _array(forward_dynamics(self._constants, _columns(q), _columns(v), _columns(tau)), q)
        if not np.isfinite(found).all():
            self._refuse_light(q)
        return found

    def refuse_singular(self, z: Sequence[float]) -> None:
        """Refuse (HX404) independent coordinates at which some motion moves no mass, with the joint."""
        import numpy as np

        width = sum(link.velocities for link in independent(self.tree, self.followers))
        self._refuse_light(np.array(expanded(self.tree, self.followers, z, [0.0] * width, floats()).q, dtype=float))

    def _refuse_light(self, q: Floats) -> None:
        import numpy as np

        diagonal = np.diagonal(self.mass_matrix(q), axis1=-2, axis2=-1).reshape(-1, self.tree.nv).min(axis=0)
        light = int(np.argmin(diagonal))
        link = next(link for link in self.tree.links if link.v <= light < link.v + link.velocities)
        message = f"{link.joint} moves no mass there; the mass matrix is singular"
        raise refuse(
            codes.SINGULAR_MASS,
            message,
            self.mechanism.origin(link.joint),
            element=str(link.joint),
            hint="give what it moves an inertia tensor, or it an armature",
        )

    def passive(self, q: Floats, v: Floats) -> Floats:
        """The forces of springs, damping and Coulomb friction, at joints and of tendons."""
        return _array(passive_forces(self._constants, self.cables, _columns(q), _columns(v)), q)

    @cached_property
    def frictionless(self) -> Self:
        """The same without Coulomb friction, which has no slope at rest."""
        if not rubbing(self.tree, self.cables):
            return self
        tree, cables = smooth(self.tree, self.cables)
        return replace(self, tree=tree, cables=cables)

    @cached_property
    def system(self) -> System:
        """x = (q, v, a) of the independent links and the motors that have a state, u = controls or a force for each dof of one coordinate.

        y is the positions of these dofs.
        """
        links = independent(self.tree, self.followers)
        states = [_variable(link, k, "position") for link in links for k in range(link.coordinates)]
        if self.closures:
            closed = nearest(links, self.closed_at, [variable.value for variable in states])
            states = [replace(variable, value=value) for variable, value in zip(states, closed, strict=True)]
        states += [_variable(link, k, "velocity") for link in links for k in range(link.velocities)]
        states += map(activation, remembering(self.motors))
        scalar = [link for link in links if link.velocities == 1]
        inputs = tuple(_variable(link, 0, "effort") for link in scalar) if self.motors is None else tuple(map(_control, self.motors))
        outputs = tuple(_variable(link, 0, "position") for link in scalar)
        rates = _rates(self)

        def measured(x: Sequence[Number], u: Sequence[Number], p: Sequence[Number], numbers: Numbers) -> list[Number]:
            at = [place for place, state in enumerate(states) if state.name in {output.name for output in outputs}]
            return [x[place] for place in at]

        return System(self.tree.name, tuple(states), inputs, outputs, (), rates, measured)

    def symbolic(self) -> TreeFormulas:
        """The equations of motion of the independent coordinates as formulas, numbers as fractions. For a handful of dofs."""
        import sympy

        constants, (q, v) = Constants(self.tree, symbols(), self.gravity), self._symbols()
        whole, still = (expanded(self.tree, self.followers, q, rates, symbols()) for rates in (v, [0] * len(v)))
        mass = mass_matrix(constants, whole.q)
        felt = [dot(row, whole.drift) for row in mass]
        bias = [add(b, a) for b, a in zip(inverse_dynamics(constants, whole.q, whole.v), felt, strict=True)]
        forces = [bias, inverse_dynamics(constants, still.q, still.v), passive_forces(constants, self.cables, whole.q, whole.v)]
        forces.append(self._driving(constants, whole))
        rows = [reduced(mass, whole), *[[[dot(column, force)] for column in zip(*whole.ratios, strict=True)] for force in forces]]
        return TreeFormulas(q, v, *(sympy.Matrix(found).applyfunc(sympy.trigsimp) for found in rows))

    def _symbols(self) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        """The symbols q1, q2, ... and v1, v2, ... of the independent coordinates."""
        import sympy

        links = independent(self.tree, self.followers)
        q = sympy.symbols(f"q1:{1 + sum(link.coordinates for link in links)}", real=True)
        return q, sympy.symbols(f"v1:{1 + sum(link.velocities for link in links)}", real=True)

    def _driving(self, constants: Constants, whole: TreeMotion) -> list[Number]:
        """What actuators do under the controls u1, u2, ... with their states a1, a2, ...; zero where the inputs are forces."""
        import sympy

        forces: list[Number] = [0] * self.tree.nv
        if self.motors is not None:
            states, controls = (sympy.symbols(f"{x}1:{1 + len(of)}") for x, of in (("a", remembering(self.motors)), ("u", self.motors)))
            drive(forces, self.motors, signals_of(self.motors, states, controls), constants, whole.q, whole.v)
        return forces

    def symbolic_loops(self) -> tuple[Any, Any]:
        """The closure phi(q) and its Jacobian J(q) over the independent coordinates as formulas, without rows that are zero everywhere."""
        import sympy

        q, v = self._symbols()
        whole = expanded(self.tree, self.followers, q, [0] * len(v), symbols())
        closed = reduced_closing(self.closures, Constants(self.tree, symbols(), self.gravity), whole)
        rows = [(gap, row) for gap, row in zip(closed.gap, closed.slope, strict=True) if any(entry != 0 for entry in row)]
        phi = sympy.Matrix(len(rows), 1, [gap for gap, _ in rows])
        slope = sympy.Matrix(len(rows), len(v), [entry for _, row in rows for entry in row])
        return phi.applyfunc(sympy.trigsimp), slope.applyfunc(sympy.trigsimp)

    @cached_property
    def graph(self) -> Any:
        """The casadi function (x, u) -> x', with derivatives of any order and generated C."""
        import casadi

        system = self.system
        x, u = casadi.SX.sym("x", len(system.states)), casadi.SX.sym("u", len(system.inputs))
        rates = system.rates([x[k] for k in range(x.numel())], [u[k] for k in range(u.numel())], (), graphs())
        return casadi.Function("rates", [x, u], [casadi.vertcat(*rates)], ["x", "u"], ["rates"])

    @cached_property
    def closure(self) -> Any:
        """The casadi function (z, z') -> (phi, J, J' z') of the loops, over the independent coordinates."""
        import casadi

        links = independent(self.tree, self.followers)
        z = casadi.SX.sym("z", sum(link.coordinates for link in links))
        w = casadi.SX.sym("w", sum(link.velocities for link in links))
        positions, rates = ([part[k] for k in range(part.numel())] for part in (z, w))
        whole = expanded(self.tree, self.followers, positions, rates, graphs())
        closed = reduced_closing(self.closures, Constants(self.tree, graphs(), self.gravity), whole)
        rows = [casadi.horzcat(*row) for row in closed.slope]
        values = [casadi.vertcat(*closed.gap), casadi.vertcat(*rows), casadi.vertcat(*closed.drift)]
        return casadi.Function("closure", [z, w], values, ["z", "w"], ["phi", "J", "drift"])

    def closed_at(self, z: Sequence[float]) -> tuple[Floats, Floats]:
        """phi and J of the loops over the independent coordinates z."""
        import numpy as np

        width = sum(link.velocities for link in independent(self.tree, self.followers))
        phi, slope, _ = self.closure(z, np.zeros(width))
        return np.array(phi, dtype=float)[:, 0], np.array(slope, dtype=float)


def _columns(values: Floats) -> list[Number]:
    import numpy as np

    array = np.asarray(values, dtype=float)
    return [array[..., number] for number in range(array.shape[-1])]


def _array(values: Sequence[Number], like: Floats) -> Floats:
    import numpy as np

    return np.stack([np.broadcast_to(value, np.shape(like)[:-1]) for value in values], axis=-1).astype(float)


# ---- the system of first order ----------------------------------------------------------------------------------------------

_PARTS = {DofKind.BALL: ("qw", "qx", "qy", "qz"), DofKind.FREE: ("x", "y", "z", "qw", "qx", "qy", "qz")}
_RATES = {DofKind.BALL: ("wx", "wy", "wz"), DofKind.FREE: ("vx", "vy", "vz", "wx", "wy", "wz")}
_UNITS = {"position": ("m", "rad"), "velocity": ("m/s", "rad/s"), "effort": ("N", "N*m")}


def _variable(link: Link, k: int, quantity: str) -> Variable:
    name, kind = link.name, link.dof.kind
    turns = kind is not DofKind.SLIDE
    if kind in _PARTS and quantity == "position":
        part = _PARTS[kind][k]
        return Variable(f"{name}.{part}", "" if part.startswith("q") else "m", value=1.0 if part == "qw" else 0.0, element=str(link.joint))
    if kind in _RATES:
        part = _RATES[kind][k]
        return Variable(f"{name}.{part}", _UNITS["velocity"][part.startswith("w")], element=str(link.joint))
    letter = {"position": "q", "velocity": r"\dot q", "effort": r"\tau"}[quantity]
    plain = name.replace("_", r"\_")
    value = link.dof.ref if quantity == "position" else 0.0
    return Variable(f"{name}.{quantity}", _UNITS[quantity][turns], rf"{letter}_{{\mathrm{{{plain}}}}}", value, str(link.joint))


def _control(motor: Motor) -> Variable:
    plain = motor.id.name.replace("_", r"\_")
    return Variable(f"{motor.id.name}.control", motor.unit, rf"u_{{\mathrm{{{plain}}}}}", 0.0, str(motor.id))


def activation(motor: Motor) -> Variable:
    """The state of a motor; that of an integrator of velocities is a position."""
    plain = motor.id.name.replace("_", r"\_")
    unit = motor.unit.removesuffix("/s") if not motor.law.lag else motor.unit
    return Variable(f"{motor.id.name}.activation", unit, rf"a_{{\mathrm{{{plain}}}}}", 0.0, str(motor.id))


def _rates(found: Trees) -> Callable[[Sequence[Number], Sequence[Number], Sequence[Number], Numbers], list[Number]]:
    tree, followers = found.tree, found.followers
    links = independent(tree, followers)
    nz = sum(link.coordinates for link in links)
    end = nz + sum(link.velocities for link in links)

    def rates(x: Sequence[Number], u: Sequence[Number], p: Sequence[Number], numbers: Numbers) -> list[Number]:
        constants = Constants(tree, numbers, found.gravity)
        whole = expanded(tree, followers, x[:nz], x[nz:end], numbers)
        tau = passive_forces(constants, found.cables, whole.q, whole.v)
        if found.motors is not None:
            drive(tau, found.motors, signals_of(found.motors, x[end:], u), constants, whole.q, whole.v)
        else:
            for link, value in zip([link for link in links if link.velocities == 1], u, strict=True):
                tau[link.v] = add(tau[link.v], value)
        if not followers and not found.closures:
            moved = forward_dynamics(constants, whole.q, whole.v, tau)
        else:
            moved = reduced_acceleration(constants, whole, tau, found.closures, x[nz:end])
        follow = [] if found.motors is None else state_rates(found.motors, x[end:], u, numbers)
        return [*position_rates(links, x[:nz], x[nz:end]), *moved, *follow]

    return rates


def reduced_acceleration(
    constants: Constants, whole: TreeMotion, tau: list[Number], closures: Sequence[Closure], rate: Sequence[Number]
) -> list[Number]:
    """The accelerations z'' of the independent coordinates with the velocities ``rate``: G' M G z'' = G' (tau - bias - M drift),
    and the forces of closed loops."""
    mass = mass_matrix(constants, whole.q)
    against = inverse_dynamics(constants, whole.q, whole.v)
    force = [add(add(t, minus(b)), minus(dot(row, whole.drift))) for t, b, row in zip(tau, against, mass, strict=True)]
    inertia = reduced(mass, whole)
    own = [dot(column, force) for column in zip(*whole.ratios, strict=True)] if len(rate) < len(force) else force
    if not closures:
        return solve(factorize(inertia), own)
    return closed_acceleration(inertia, own, reduced_closing(closures, constants, whole), rate, STABILISATION)


def reduced_closing(closures: Sequence[Closure], constants: Constants, whole: TreeMotion) -> Closing:
    """The closures over the independent coordinates: J G, and J' v + J drift."""
    closed = closing(closures, constants, whole.q, whole.v)
    columns = list(zip(*whole.ratios, strict=True))
    if len(columns) == constants.tree.nv:
        return closed
    slope = [[dot(row, column) for column in columns] for row in closed.slope]
    return Closing(closed.gap, slope, [add(d, dot(row, whole.drift)) for d, row in zip(closed.drift, closed.slope, strict=True)])


def reduced(matrix: Matrix, whole: TreeMotion) -> Matrix:
    """G' A G of a matrix A over all coordinates: over the independent ones."""
    columns = list(zip(*whole.ratios, strict=True))
    if len(columns) == len(matrix):
        return matrix
    moved = [[dot(row, column) for row in matrix] for column in columns]
    return [[dot(one, other) for other in moved] for one in columns]


def position_rates(links: Sequence[Link], q: Sequence[Number], v: Sequence[Number]) -> list[Number]:
    """How positions change at velocities: quaternions by half their product with the angular velocity, in the moving axes."""
    from hymeko_x.dynamics.spatial import of_quaternion, turned

    found: list[Number] = []
    at = column = 0
    for link in links:
        own, rate = q[at : at + link.coordinates], v[column : column + link.velocities]
        at, column = at + link.coordinates, column + link.velocities
        if link.coordinates == 1:
            found += rate
            continue
        if link.dof.kind is DofKind.FREE:
            found += turned(of_quaternion(own[3:]), list(rate[:3]))
        w, x, y, z = own[-4:]
        a, b, c = rate[-3:]
        found += [(-x * a - y * b - z * c) / 2, (w * a + y * c - z * b) / 2, (w * b + z * a - x * c) / 2, (w * c + x * b - y * a) / 2]
    return found
