"""Operating points of a mechanism: configurations by name or number, holding forces, equilibria, and the linear system there."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.dynamics.assembly import assembled, reduction
from hymeko_x.dynamics.couplings import independent
from hymeko_x.dynamics.drives import remembering
from hymeko_x.dynamics.linear import StateSpace
from hymeko_x.dynamics.positions import moved, normal
from hymeko_x.dynamics.system import Variable
from hymeko_x.dynamics.tree import COORDINATES, reference
from hymeko_x.dynamics.trees import activation
from hymeko_x.ir import parts
from hymeko_x.ir.kinematics import dof_at
from hymeko_x.ir.mechanism import numbers_weight
from hymeko_x.ir.parts import DofKind

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from hymeko_x.dynamics.tree import Link
    from hymeko_x.dynamics.trees import Trees
    from hymeko_x.ir.mechanism import Id, Mechanism

    Floats = NDArray[np.floating[Any]]

_ELSEWHERE = "--at joint=value,... linearises at a configuration that inputs hold"
_HELD = 1e-9
"""In m/s^2 or rad/s^2: accelerations up to which a point is an equilibrium."""


class OperatingPoint(NamedTuple):
    """The positions of the independent coordinates, and the inputs that hold them as far as inputs can; ``rates`` is what remains.

    ``activations`` are the states of motors that hold them.
    """

    positions: list[float]
    inputs: list[float]
    rates: list[float]
    activations: list[float] = []  # noqa: RUF012

    @property
    def is_equilibrium(self) -> bool:
        """Whether nothing accelerates there."""
        return max(map(abs, self.rates), default=0.0) <= _HELD


def named_positions(found: Trees, words: str) -> dict[str, tuple[float, ...]]:
    """The positions that ``--at`` gives by the names of dofs: a named configuration of the file, or ``joint=value,joint=value``.

    Of a configuration they are those of the independent dofs: followers follow. Balls have a quaternion (w, x, y, z), free dofs a
    position before one.

    Raises: Refusal (HX407) for words that are neither.
    """
    mechanism = found.mechanism
    configurations = {key.name: key for key, _ in mechanism.vertices(parts.PoseSet)}
    if words in configurations:
        numbers = _configuration(mechanism, configurations[words])
        links = independent(found.tree, found.followers)
        return {link.name: numbers[link.joint, link.number] for link in links if (link.joint, link.number) in numbers}
    try:
        return {name: (float(value),) for name, value in (pair.split("=") for pair in words.split(","))}
    except ValueError as error:
        hint = f"named configurations of the file: {', '.join(configurations) or 'none'}; or joint=0.5,other=1 in rad and m"
        raise refuse(codes.BAD_SIGNAL, f"'{words}' is no configuration", hint=hint) from error


def _configuration(mechanism: Mechanism, pose: Id) -> dict[tuple[Id, int], tuple[float, ...]]:
    """The coordinates of a named configuration by joint and number of the dof."""
    found: dict[tuple[Id, int], tuple[float, ...]] = {}
    for _, _, arcs in mechanism.edges(parts.Stance):
        if not any(arc.target == pose for arc in arcs):
            continue
        for arc in arcs:
            joint, numbers = mechanism.joints.get(arc.target), list(numbers_weight(arc))
            named = dof_at(mechanism.graph.edges, arc) if arc.role else None
            if named is not None and len(numbers) == 1:
                found[arc.target, named[0]] = (numbers.pop(),)
            for number, dof in enumerate(joint.joint.dofs if joint is not None else ()):
                width = COORDINATES.get(dof.kind, 1)
                if len(numbers) >= width:
                    found[arc.target, number] = tuple(numbers[:width])
                del numbers[:width]
    return found


def operating_point(found: Trees, positions: Mapping[str, tuple[float, ...]], *, search: bool = False, keep: bool = True) -> OperatingPoint:
    """The point at these positions (others at their reference); with ``search`` the equilibrium without inputs next to it.

    Loops are closed; joints with a position keep it if ``keep``.

    Raises: Refusal (HX407) for a joint that is not there, HX408 when there is no equilibrium near, or loops cannot be closed.
    """
    import numpy as np

    z = start_of(found, positions, keep=keep)
    links = independent(found.tree, found.followers)
    width = sum(link.velocities for link in links)
    graph, still = found.graph, np.zeros(width)

    def accelerations(z: Sequence[float], signals: Sequence[float]) -> Floats:
        rates = graph([*z, *still, *_remembered(found, signals)], signals)
        return np.array(rates, dtype=float)[len(z) : len(z) + width, 0]

    none = [0.0] * len(found.system.inputs)
    if search:
        z = _equilibrium(found, links, z, lambda moved: accelerations(moved, none))
        return OperatingPoint(z, none, accelerations(z, none).tolist(), _remembered(found, none))
    free = accelerations(z, none)
    each = np.array([accelerations(z, row.tolist()) - free for row in np.eye(len(none))]).reshape(len(none), width).T
    held = np.linalg.lstsq(each, -free, rcond=None)[0] if len(none) else np.zeros(0)
    held[np.abs(held) < 1e-12] = 0.0
    rates = (free + each @ held).tolist()
    return OperatingPoint(z, _controls(found, held.tolist()), rates, _remembered(found, held.tolist()))


def _remembered(found: Trees, signals: Sequence[float]) -> list[float]:
    """Of the signals of all motors those that are states."""
    return [signal for motor, signal in zip(found.motors or (), signals, strict=False) if motor.law.lag is not None]


def _controls(found: Trees, signals: list[float]) -> list[float]:
    """The controls under which the signals of motors stay: an integrator's is 0."""
    if found.motors is None:
        return signals
    return [0.0 if motor.law.lag == 0.0 else signal for motor, signal in zip(found.motors, signals, strict=True)]


def start_of(found: Trees, positions: Mapping[str, tuple[float, ...]], *, keep: bool = True) -> list[float]:
    """The independent coordinates at these positions (others at their reference), with closed loops.

    Raises: Refusal (HX407, HX408), and HX404 where some motion moves no mass there.
    """
    import numpy as np

    z = _positions(independent(found.tree, found.followers), positions)
    z = assembled(found, z, positions if keep else ())
    still = [0.0] * (len(found.system.states) - len(z))
    if not np.isfinite(np.array(found.graph([*z, *still], [0.0] * len(found.system.inputs)), dtype=float)).all():
        found.refuse_singular(z)
    return z


def _positions(links: Sequence[Link], given: Mapping[str, tuple[float, ...]]) -> list[float]:
    widths = {link.name: link.coordinates for link in links}
    wrong = [name for name, numbers in given.items() if widths.get(name) != len(numbers)]
    if wrong:
        names = ", ".join(name for name, width in widths.items() if width == 1)
        raise refuse(codes.BAD_SIGNAL, f"there is no independent joint '{wrong[0]}' with one coordinate; there are {names}")
    z = [number for link in links for number in given.get(link.name, reference(link))]
    return normal(links, z)


def _equilibrium(trees: Trees, links: Sequence[Link], z: list[float], accelerations: Any) -> list[float]:
    import numpy as np
    from scipy.optimize import root

    width = sum(link.velocities for link in links)

    def missing(step: Floats) -> Floats:
        there = moved(links, z, step.tolist())
        return np.concatenate([accelerations(there), trees.closed_at(there)[0]]) if trees.closures else accelerations(there)

    with np.errstate(all="ignore"):
        found = root(missing, np.zeros(width), method="lm" if trees.closures else "hybr", tol=1e-13)
    if not found.success or np.abs(found.fun).max(initial=0.0) > 1e-6:
        raise refuse(codes.NO_FORM, "no equilibrium without inputs was found near the configuration", hint=_ELSEWHERE)
    return [float(value) for value in moved(links, z, found.x.tolist())]


_TANGENTS = {DofKind.BALL: ("rx", "ry", "rz"), DofKind.FREE: ("dx", "dy", "dz", "rx", "ry", "rz")}


def displacements(links: Sequence[Link]) -> tuple[Variable, ...]:
    """The small displacements from an operating point, one per velocity, in the moving axes."""
    found: list[Variable] = []
    for link in links:
        name, turns = link.name, link.dof.kind is not DofKind.SLIDE
        if link.coordinates == 1:
            plain = name.replace("_", r"\_")
            found.append(Variable(f"{name}.position", "rad" if turns else "m", rf"q_{{\mathrm{{{plain}}}}}", element=str(link.joint)))
        else:
            for part in _TANGENTS[link.dof.kind]:
                found.append(Variable(f"{name}.{part}", "rad" if part.startswith("r") else "m", part, element=str(link.joint)))
    return tuple(found)


def linearized(found: Trees, point: OperatingPoint) -> StateSpace:
    """The linear system at an operating point: states are displacements and velocities from there, inputs count from what holds it.

    Derivatives are exact (casadi's). States of motors count from what they are there. Coulomb friction is left out.
    """
    import numpy as np

    links = independent(found.tree, found.followers)
    by_step, by_v, by_a, by_u, rest = _slopes(found, links, point)
    width, lagging = by_v.shape[1], len(point.activations)
    kept, basis = reduction(found, point.positions)
    count, rows = len(kept), [*kept, *range(width, width + lagging)]
    a = np.block(
        [[np.zeros((count, count)), np.eye(count), np.zeros((count, lagging))], [(by_step @ basis)[rows], (by_v @ basis)[rows], by_a[rows]]]
    )
    b = np.vstack([np.zeros((count, len(point.inputs))), by_u[rows]])
    positions = displacements(links)
    outputs = [number for number, variable in enumerate(positions) if variable.name.endswith(".position")]
    c = np.hstack([basis[outputs], np.zeros((len(outputs), count + lagging))])
    rest[np.abs(rest) <= _HELD] = 0.0
    offset = np.concatenate([np.zeros(count), rest[rows]])
    states = tuple(positions[k] for k in kept)
    velocities = tuple(Variable(_rate_name(v.name), f"{v.unit}/s", rf"\dot {v.symbol}") for v in states)
    matrices = map(sympy_matrix, (a, b, c, np.zeros((len(outputs), b.shape[1])), offset[:, None]))
    whole = (*states, *velocities, *map(activation, remembering(found.motors)))
    return StateSpace(whole, found.system.inputs, tuple(positions[k] for k in outputs), *matrices)


def _slopes(found: Trees, links: Sequence[Link], point: OperatingPoint) -> list[Floats]:
    """Accelerations and the rates of motors' states: derivatives by displacements, velocities, these states and inputs; and values."""
    import casadi
    import numpy as np

    sizes = sum(link.velocities for link in links), len(point.activations), len(point.inputs)
    step, v, a, u = (casadi.SX.sym(name, size) for name, size in zip("dvau", (sizes[0], *sizes), strict=True))
    z = moved(links, point.positions, [step[k] for k in range(sizes[0])])
    rates = found.frictionless.graph(casadi.vertcat(*z, v, a), u)[len(z) :]
    slopes = casadi.Function("f", [step, v, a, u], [casadi.jacobian(rates, part) for part in (step, v, a, u)] + [rates])
    values = slopes(np.zeros(sizes[0]), np.zeros(sizes[0]), np.array(point.activations), np.array(point.inputs))
    return [*(np.array(block, dtype=float).reshape(sum(sizes[:2]), -1) for block in values[:-1]), np.array(values[-1], dtype=float)[:, 0]]


def _rate_name(name: str) -> str:
    return name.removesuffix(".position") + ".velocity" if name.endswith(".position") else f"{name}'"


def sympy_matrix(rows: Any) -> Any:
    """A matrix of floats for sympy."""
    import numpy as np
    import sympy

    array = np.array(rows, dtype=float)
    return sympy.Matrix(*array.shape, [_plain(x) for x in array.reshape(-1)])


def _plain(value: float) -> Any:
    """A float as sympy's number; whole numbers as integers."""
    import sympy

    return sympy.Integer(int(value)) if float(value).is_integer() and abs(value) < 1e15 else sympy.Float(float(value))
