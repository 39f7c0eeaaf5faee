"""Tendons and actuators along linear combinations of joints: lengths, the springs and dampers of tendons, and the laws of actuators."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x.dynamics.numbers import add, times
from hymeko_x.ir import parts
from hymeko_x.ir.kinematics import dof_at
from hymeko_x.ir.mechanism import numbers_weight
from hymeko_x.ir.parts import DofKind

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from hymeko_x.dynamics.numbers import Number, Numbers
    from hymeko_x.dynamics.tree import Tree
    from hymeko_x.ir.ids import Id
    from hymeko_x.ir.mechanism import Mechanism, RobotArc

    Terms = tuple[tuple[int, float], ...]


class Cable(Struct, frozen=True):
    """A tendon with the length sum of coefficient * position over links of one coordinate: a spring and a damper along it."""

    id: Id
    terms: Terms
    stiffness: float
    damping: float
    rest: float


class Motor(Struct, frozen=True):
    """An actuator along the length of its terms: force = gain * control + bias[0] + bias[1] * length + bias[2] * rate."""

    id: Id
    terms: Terms
    gain: float
    bias: tuple[float, float, float]
    unit: str


# ---- from the mechanism ------------------------------------------------------------------------------------------------------------


def terms_of(mechanism: Mechanism, tree: Tree, arcs: Sequence[RobotArc]) -> Terms | None:
    """The links of one coordinate that arcs lead to, with the first number of their weights; None where an arc leads elsewhere."""
    found = []
    for arc in arcs:
        dof = dof_at(mechanism.graph.edges, arc)
        if dof is None or (arc.target, dof[0]) not in tree.places:
            return None
        found.append((tree.places[arc.target, dof[0]], (numbers_weight(arc) or (1.0,))[0]))
    return tuple(found)


def cables_of(mechanism: Mechanism, tree: Tree) -> tuple[tuple[Cable, ...], list[Id]]:
    """The tendons that are linear in the joints and pull, and those that pull and have no equations here."""
    found, left = [], []
    for key, tendon, arcs in mechanism.edges(parts.Tendon):
        if not tendon.stiffness and not tendon.damping:
            continue
        terms = terms_of(mechanism, tree, arcs) if tendon.kind == "fixed" else None
        rest = None if terms is None else _rest(tendon, terms, tree)
        if terms is None or rest is None:
            left.append(key)
        else:
            found.append(Cable(key, terms, tendon.stiffness, tendon.damping, rest))
    return tuple(found), left


def _rest(tendon: parts.Tendon, terms: Terms, tree: Tree) -> float | None:
    """The length at rest: ``springlength``, else that at the rests of the joints' springs, as in MuJoCo; None for an interval."""
    given = dict(tendon.parameters).get("springlength", -1.0)
    ends = {float(value) for value in (given if isinstance(given, tuple) else (given,))}
    if ends == {-1.0} or not tendon.stiffness:
        return sum(factor * tree.links[place].dof.spring_ref for place, factor in terms)
    return ends.pop() if len(ends) == 1 else None


def motors_of(mechanism: Mechanism, tree: Tree) -> tuple[tuple[Motor, ...], list[Id]]:
    """The actuators of joints and of tendons that are linear in joints, with laws of :func:`_law`; and all others."""
    tendons = {key: arcs for key, tendon, arcs in mechanism.edges(parts.Tendon) if tendon.kind == "fixed"}
    driven = {arc.target: (drive, arcs) for _, drive, arcs in mechanism.edges(parts.Drive) for arc in arcs if arc.sign > 0}
    found, left = [], []
    for key, actuator in mechanism.vertices(parts.Actuator):
        drive, arcs = driven.get(key, (None, ()))
        ends = [arc for arc in arcs if arc.sign < 0]
        law = _law(actuator)
        terms = None
        if drive is not None and not drive.kind and len(ends) == 1:
            gear = (numbers_weight(ends[0]) or (1.0,))[0]
            terms = terms_of(mechanism, tree, tendons.get(ends[0].target, ends))
            if terms is not None and ends[0].target in tendons:
                terms = tuple((place, gear * factor) for place, factor in terms)
        if terms is None or law is None:
            left.append(key)
        else:
            found.append(Motor(key, terms, *law, _unit(actuator, terms, tree)))
    return tuple(found), left


def _law(actuator: parts.Actuator) -> tuple[float, tuple[float, float, float]] | None:
    """Gain and bias of a motor, a position or velocity servo, or a general actuator without state; None for other laws."""
    given = dict(actuator.parameters)
    if actuator.kind in ("motor", "transmission"):
        return 1.0, (0.0, 0.0, 0.0)
    if actuator.kind == "position" and not {"dampratio", "timeconst", "inheritrange"} & set(given):
        kp = _number(given, "kp", 1.0)
        return kp, (0.0, -kp, -_number(given, "kv", 0.0))
    if actuator.kind == "velocity":
        kv = _number(given, "kv", 1.0)
        return kv, (0.0, 0.0, -kv)
    if actuator.kind != "general":
        return None
    kinds = tuple(given.get(name, default) for name, default in (("dyntype", "none"), ("gaintype", "fixed"), ("biastype", "none")))
    if kinds[:2] != ("none", "fixed") or kinds[2] not in ("none", "affine"):
        return None
    bias = (*_numbers(given, "biasprm"), 0.0, 0.0, 0.0)[:3] if kinds[2] == "affine" else (0.0, 0.0, 0.0)
    return _number(given, "gainprm", 1.0), bias  # type: ignore[return-value]


def _numbers(given: Mapping[str, object], name: str) -> tuple[float, ...]:
    value = given.get(name, ())
    return tuple(map(float, value)) if isinstance(value, tuple) else (float(value),)  # type: ignore[arg-type]


def _number(given: Mapping[str, object], name: str, default: float) -> float:
    return (*_numbers(given, name), default)[0]


def _unit(actuator: parts.Actuator, terms: Terms, tree: Tree) -> str:
    """The unit of the control of a joint's actuator; "" where it follows from nothing."""
    if len(terms) != 1 or actuator.kind == "general":
        return ""
    slides = tree.links[terms[0][0]].dof.kind is DofKind.SLIDE
    effort, position = ("N", "m") if slides else ("N*m", "rad")
    return {"position": position, "velocity": f"{position}/s"}.get(actuator.kind, effort)


# ---- forces ------------------------------------------------------------------------------------------------------------------------


def pull_cables(
    forces: list[Number], cables: Sequence[Cable], tree: Tree, q: Sequence[Number], v: Sequence[Number], numbers: Numbers
) -> None:
    """Add what the springs and dampers of tendons do to the forces of all coordinates."""
    for cable in cables:
        length, rate = _motion(cable.terms, tree, q, v, numbers)
        stretch = add(length, numbers.exact(-cable.rest)) if cable.rest else length
        force = add(times(numbers.exact(-cable.stiffness), stretch), times(numbers.exact(-cable.damping), rate))
        _act(forces, cable.terms, force, tree, numbers)


def drive(
    forces: list[Number],
    motors: Sequence[Motor],
    controls: Sequence[Number],
    tree: Tree,
    q: Sequence[Number],
    v: Sequence[Number],
    numbers: Numbers,
) -> None:
    """Add what the actuators do under their controls to the forces of all coordinates."""
    for motor, control in zip(motors, controls, strict=True):
        length, rate = _motion(motor.terms, tree, q, v, numbers)
        force = times(numbers.exact(motor.gain), control)
        for factor, value in zip(motor.bias, (1, length, rate), strict=True):
            force = add(force, times(numbers.exact(factor), value))
        _act(forces, motor.terms, force, tree, numbers)


def length_of(terms: Terms, tree: Tree, q: Sequence[Number], numbers: Numbers) -> Number:
    """The sum of coefficient * position."""
    length: Number = 0
    for place, factor in terms:
        length = add(length, times(numbers.exact(factor), q[tree.links[place].q]))
    return length


def _motion(terms: Terms, tree: Tree, q: Sequence[Number], v: Sequence[Number], numbers: Numbers) -> tuple[Number, Number]:
    rate: Number = 0
    for place, factor in terms:
        rate = add(rate, times(numbers.exact(factor), v[tree.links[place].v]))
    return length_of(terms, tree, q, numbers), rate


def _act(forces: list[Number], terms: Terms, force: Number, tree: Tree, numbers: Numbers) -> None:
    for place, factor in terms:
        column = tree.links[place].v
        forces[column] = add(forces[column], times(numbers.exact(factor), force))
