"""Actuators: what they act along, and what they do under their controls, by their laws."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x.dynamics.laws import Law, damped, law_of
from hymeko_x.dynamics.lines import ActionLine, act, geared, line_of, push_of, seats_of, stretches, terms_of
from hymeko_x.dynamics.numbers import add, dot, factorize, floats, solve, times
from hymeko_x.dynamics.recursion import Constants, mass_matrix
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import numbers_weight
from hymeko_x.ir.parts import DofKind

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from hymeko_x.dynamics.lines import Seats
    from hymeko_x.dynamics.numbers import Matrix, Number, Numbers
    from hymeko_x.dynamics.tree import LinkTree
    from hymeko_x.ir.ids import Id
    from hymeko_x.ir.mechanism import Mechanism, RobotArc

    Left = list[tuple[Id, str]]
    """Elements that are not in the equations, each with the reason."""


class Motor(Struct, frozen=True):
    """An actuator that acts along a line by its law; ``unit`` is that of its control, "" where it follows from nothing."""

    id: Id
    line: ActionLine
    law: Law
    unit: str


# ---- from the mechanism ------------------------------------------------------------------------------------------------------------


def motors_of(mechanism: Mechanism, tree: LinkTree) -> tuple[tuple[Motor, ...], Left]:
    """The actuators that act along a line by a law; and all others."""
    driven = {arc.target: arcs for _, _, arcs in mechanism.edges(parts.Drive) for arc in arcs if arc.sign > 0}
    seats = seats_of(mechanism, tree)
    found, left = [], []
    for key, actuator in mechanism.vertices(parts.Actuator):
        law = law_of(actuator)
        line = _driven_line(mechanism, tree, driven[key], seats) if key in driven else "drives nothing"
        if isinstance(law, str) or isinstance(line, str):
            left.append((key, law if isinstance(law, str) else str(line)))
        elif line.push is not None and any(law.gain[1:] + law.bias[1:]):
            left.append((key, "depends on the length of what it drives, which has none"))
        else:
            found.append(Motor(key, line, law, _unit(actuator, line, tree)))
    return _with_damping(found, tree), left


def _driven_line(mechanism: Mechanism, tree: LinkTree, arcs: Sequence[RobotArc], seats: Seats) -> ActionLine | str:
    """What an actuator acts along; as text the reason why there is no such line."""
    ends = [arc for arc in arcs if arc.sign < 0]
    if len(ends) != 1:
        return "drives between two frames"
    edge = mechanism.graph.edges.get(ends[0].target)
    if edge is not None and isinstance(edge.data, parts.Tendon):
        line = line_of(mechanism, tree, edge.data, edge.arcs, seats)
        gear = (numbers_weight(ends[0]) or (1.0,))[0]
        return f"pulls {ends[0].target}, which {line}" if isinstance(line, str) else geared(line, gear)
    if ends[0].target.kind == "frame":
        return push_of(ends[0], seats)
    terms = terms_of(mechanism, tree, ends)
    return f"drives {ends[0].target}, which has more than one coordinate or none" if terms is None else ActionLine(terms)


def _with_damping(motors: Sequence[Motor], tree: LinkTree) -> tuple[Motor, ...]:
    """The motors with damping ratios as damping: at the mass 1 / (r M^-1 r') that each feels in the configuration of reference."""
    if not any(motor.law.damping_ratio for motor in motors):
        return tuple(motors)
    constants = Constants(tree, floats())
    factors = factorize(mass_matrix(constants, tree.rest))
    rows = [stretch.row for stretch in stretches([motor.line for motor in motors], constants, tree.rest)]
    return tuple(_damped(motor, [row.get(k, 0) for k in range(tree.nv)], factors) for motor, row in zip(motors, rows, strict=True))


def _damped(motor: Motor, row: list[Number], factors: tuple[Matrix, list[Number]]) -> Motor:
    ease = float(dot(row, solve(factors, row))) if motor.law.damping_ratio else 0.0
    return replace(motor, law=damped(motor.law, 1.0 / ease)) if ease > 0.0 else motor


def _unit(actuator: parts.Actuator, line: ActionLine, tree: LinkTree) -> str:
    """The unit of the control of a joint's actuator; "" where it follows from nothing."""
    if len(line.terms) != 1 or actuator.kind in ("general", "damper", "cylinder"):
        return ""
    slides = tree.links[line.terms[0][0]].dof.kind is DofKind.SLIDE
    effort, position = ("N", "m") if slides else ("N*m", "rad")
    return {"position": position, "velocity": f"{position}/s", "intvelocity": f"{position}/s"}.get(actuator.kind, effort)


# ---- forces ------------------------------------------------------------------------------------------------------------------------


def drive(
    forces: list[Number],
    motors: Sequence[Motor],
    signals: Sequence[Number],
    constants: Constants,
    q: Sequence[Number],
    v: Sequence[Number],
) -> None:
    """Add what the actuators do under their signals to the forces of all coordinates."""
    numbers = constants.numbers
    found = stretches([motor.line for motor in motors], constants, q)
    for motor, signal, stretch in zip(motors, signals, found, strict=True):
        along = (1, stretch.length, stretch.rate(v))
        gain, bias = (dot([numbers.exact(x) if x else 0 for x in part], along) for part in (motor.law.gain, motor.law.bias))
        act(forces, stretch, add(times(gain, signal), bias))


# ---- states ------------------------------------------------------------------------------------------------------------------------


def remembering(motors: Sequence[Motor] | None) -> list[Motor]:
    """The motors with a state of their own."""
    return [motor for motor in motors or () if motor.law.lag is not None]


def signals_of(motors: Sequence[Motor], states: Sequence[Number], controls: Sequence[Number]) -> list[Number]:
    """What the force of each motor follows: its state, or its control where it has none."""
    rest: Iterator[Number] = iter(states)
    return [control if motor.law.lag is None else next(rest) for motor, control in zip(motors, controls, strict=True)]


def state_rates(motors: Sequence[Motor], states: Sequence[Number], controls: Sequence[Number], numbers: Numbers) -> list[Number]:
    """How the states of motors change under all controls."""
    own: Mapping[Id, Number] = {motor.id: control for motor, control in zip(motors, controls, strict=True)}
    return [_state_rate(motor.law, state, own[motor.id], numbers) for motor, state in zip(remembering(motors), states, strict=True)]


def _state_rate(law: Law, state: Number, control: Number, numbers: Numbers) -> Number:
    return (control - state) / numbers.exact(law.lag) if law.lag else control
