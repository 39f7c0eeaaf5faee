"""Transmissions of two motors and two joints as actuators on linear combinations of the joints."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x import codes
from hymeko_x.diagnostics import counted, listed
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import numbers_weight
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.parts import Actuator, Drive, Tendon
from hymeko_x.ir.tendons import FIXED
from hymeko_x.rewrite.servos import loads, parameters_of
from hymeko_x.rewrite.transmissions import HARDWARE_INTERFACE, KINDS, is_scalar, is_transmission, moved_otherwise

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc, RobotEdge
    from hymeko_x.ir.parts import Parameters
    from hymeko_x.rewrite.context import Context

_SHARES: Mapping[str, tuple[tuple[float, float], tuple[float, float]]] = MappingProxyType(
    {"DifferentialTransmission": ((1.0, 1.0), (1.0, -1.0)), "FourBarLinkageTransmission": ((1.0, 0.0), (1.0, 1.0))}
)
"""By which factors the two joints, each times its reduction, make the position of each motor without its own reduction.

In a four-bar linkage the second motor moves the second joint relative to the base, so that the first joint counts without a reduction.
Source: ros_control, transmission_interface, differential_transmission.h and four_bar_linkage_transmission.h.
"""
_SHOWN = 3


class _Differential(Struct, frozen=True):
    """A transmission of two joints: the kind of its actuators, and by actuator the gear and the coefficients of the joints."""

    key: Id
    kind: str
    joints: tuple[Id, Id]
    motors: list[tuple[Id, float, tuple[float, float]]]


def drive_by_differentials(mechanism: Mechanism, context: Context) -> Mechanism:
    """A differential or a four-bar linkage becomes two actuators, each on the combination of the joints that its motor moves."""
    found = [*_differentials(mechanism)]
    if not found:
        return mechanism
    carried = loads(mechanism) if any(one.kind == "position" for one in found) else {}
    names = names_in_use(mechanism)
    vertices: dict[Id, Actuator] = {}
    edges: dict[Id, RobotEdge] = {}
    for one in found:
        own = [parameters_of(one.kind, mechanism.joints[key].joint.dofs[0], carried.get((key, 0))) for key in one.joints]
        for motor, gear, shares in one.motors:
            tendon = names.take("tendon", motor.name)
            edges[tendon] = Edge(Tendon(FIXED), _combination(one, shares))
            vertices[motor] = Actuator(one.kind, tuple(_parameters(one.kind, own, gear, shares)))
            edges[names.take("drive", motor.name)] = Edge(Drive(), (Arc(motor, 1), Arc(tendon, -1, (gear,))))
    shown = listed([f"'{one.key.name}' {one.kind}" for one in found], _SHOWN)
    message = f"{counted(len(found), 'transmission')} of two joints written as actuators on combinations of them: {shown}"
    context.report.note(codes.REWRITTEN, message, element=str(found[0].key))
    return mechanism.replace(vertices=vertices, edges=edges, without=[one.key for one in found])


def combinations(mechanism: Mechanism) -> dict[Id, tuple[RobotArc, ...]]:
    """The actuators of transmissions that are written on combinations of joints, with these."""
    return {motor: _combination(one, shares) for one in _differentials(mechanism) for motor, _, shares in one.motors}


def _combination(one: _Differential, shares: tuple[float, float]) -> tuple[RobotArc, ...]:
    return tuple([Arc(joint, 1, (share,)) for joint, share in zip(one.joints, shares, strict=True) if share])


def _differentials(mechanism: Mechanism) -> Iterator[_Differential]:
    """The transmissions of two motors and two joints that nothing else drives."""
    taken = moved_otherwise(mechanism)
    for key, drive, arcs in mechanism.edges(Drive):
        shares = _SHARES.get(drive.kind.rpartition("/")[2])
        motors, joints = (sorted((arc for arc in arcs if arc.sign == sign), key=lambda arc: arc.role) for sign in (1, -1))
        if shares is None or not len(motors) == len(joints) == 2 or taken & {arc.target for arc in arcs}:
            continue
        views = [mechanism.joints.get(arc.target) for arc in joints]
        kind = _kind(mechanism, key)
        if kind is None or not all(is_transmission(mechanism, arc.target) for arc in motors):
            continue
        if any(view is None or not is_scalar(view.joint) for view in views) or not all(_reduction(arc) for arc in (*motors, *joints)):
            continue
        first, second = (_reduction(arc) for arc in joints)
        coefficients = [(a * first, b * second) for a, b in shares]
        if shares[0][1] == 0.0:
            coefficients[1] = (1.0, second)
        made = [(arc.target, _reduction(arc), pair) for arc, pair in zip(motors, coefficients, strict=True)]
        yield _Differential(key, kind, (joints[0].target, joints[1].target), made)
        taken |= {arc.target for arc in arcs}


def _reduction(arc: RobotArc) -> float:
    return (*numbers_weight(arc), 1.0)[0]


def _kind(mechanism: Mechanism, key: Id) -> str | None:
    """The actuator of the first interface of the joints that takes commands; a motor where there is no interface."""
    names = [found[1] for extra in mechanism.extras.get(key, ()) if (found := HARDWARE_INTERFACE.search(extra.text))]
    return next((KINDS[name] for name in names if name in KINDS), None) if names else "motor"


def _parameters(
    kind: str, own: list[Parameters], gear: float, shares: tuple[float, float]
) -> Iterator[tuple[str, float | tuple[float, ...]]]:
    """Gains by which each joint is at least as stiff as alone, and the range of the motor in which both joints reach theirs."""
    ends = [(dict(parameters), share) for parameters, share in zip(own, shares, strict=True) if share]
    for name in ("kp", "kv"):
        values = [value / share**2 for given, share in ends if isinstance(value := given.get(name), float)]
        if len(values) == len(ends):
            yield name, max(values) / (len(ends) * gear**2)
    spans = [(share * low, share * high) for given, share in ends for low, high in [_span(given)]]
    if not all(low or high for low, high in spans):
        return
    if kind == "motor":
        most = max(abs(high) / share**2 for (_, high), (_, share) in zip(spans, ends, strict=True)) / abs(len(ends) * gear)
        yield "ctrlrange", (-most, most)
    else:
        sides = [sorted((gear * low, gear * high)) for low, high in spans]
        yield "ctrlrange", (sum(low for low, _ in sides), sum(high for _, high in sides))


def _span(given: Mapping[str, object]) -> tuple[float, float]:
    """The range of commands of a joint alone; zeros where it has none."""
    match given.get("ctrlrange"):
        case (float(low), float(high)):
            return low, high
    return 0.0, 0.0
