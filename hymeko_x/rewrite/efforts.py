"""What actuators can exert on the dofs that they drive: the effort limits of a joint in formats whose joints state them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import listed
from hymeko_x.ir.graph import Edge
from hymeko_x.ir.kinematics import dof_at
from hymeko_x.ir.mechanism import end_of, numbers_weight
from hymeko_x.ir.parts import Actuator, DofKind, Drive, Joint, Tendon

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc, RobotEdge
    from hymeko_x.rewrite.context import Context

Span = tuple[float, float]
_UNBOUNDED: Span = (-math.inf, math.inf)
_SCALAR = frozenset({DofKind.HINGE, DofKind.SLIDE})
_NO_MOTOR = frozenset({"transmission"})
"""Kinds of actuators that only name what drives a joint, and have no force of their own."""
_SHOWN = 4


def limit_efforts_by_actuators(mechanism: Mechanism, context: Context) -> Mechanism:
    """A dof without an effort limit has the largest force that its actuators can exert together, where that is known."""
    efforts = actuator_efforts(mechanism)
    edges: dict[Id, RobotEdge] = {}
    for key in dict.fromkeys(joint for joint, _ in efforts):
        edge = mechanism.graph.edges[key]
        assert isinstance(edge.data, Joint)
        dofs = [
            replace(dof, limits=replace(dof.limits, effort=efforts[key, number])) if (key, number) in efforts else dof
            for number, dof in enumerate(edge.data.dofs)
        ]
        edges[key] = Edge(Joint(tuple(dofs)), edge.arcs)
    if not edges:
        return mechanism
    shown = listed([f"'{joint.name}' {effort:g}" for (joint, _), effort in efforts.items()], _SHOWN)
    message = f"effort limits are what the actuators can exert: {shown}"
    context.report.note(codes.REWRITTEN, message, element=str(next(iter(edges))))
    return mechanism.replace(edges=edges)


def actuator_efforts(mechanism: Mechanism) -> Mapping[tuple[Id, int], float]:
    """The largest force in N or Nm on each hinge and slide that has no effort limit and only actuators of bounded force.

    Keys are joints and numbers of dofs. Forces of several actuators on one dof, directly or by a fixed tendon, add up.
    """
    spans: dict[tuple[Id, int], Span] = {}
    for _, _, arcs in mechanism.edges(Drive):
        actuator = mechanism.part(end_of(arcs, 1), Actuator)
        if actuator is None or actuator.kind in _NO_MOTOR:
            continue
        low, high = force_span(actuator)
        for dof, gear in _driven(mechanism, arcs):
            ends = sorted((low * gear, high * gear)) if gear else (0.0, 0.0)
            sum_low, sum_high = spans.get(dof, (0.0, 0.0))
            spans[dof] = (sum_low + ends[0], sum_high + ends[1])
    found = {dof: max(-low, high) for dof, (low, high) in spans.items()}
    return {dof: effort for dof, effort in found.items() if 0.0 < effort < math.inf and _is_open(mechanism, dof)}


def _is_open(mechanism: Mechanism, dof: tuple[Id, int]) -> bool:
    part = mechanism.joints[dof[0]].joint.dofs[dof[1]]
    return part.kind in _SCALAR and part.limits.effort is None


def _driven(mechanism: Mechanism, arcs: tuple[RobotArc, ...]) -> Iterator[tuple[tuple[Id, int], float]]:
    """The dofs that a drive acts on, each with the force on it per force of the actuator."""
    target = next((arc for arc in arcs if arc.sign < 0), None)
    if target is None:
        return
    gear = (*numbers_weight(target), 1.0)[0]
    edge = mechanism.graph.edges.get(target.target)
    if edge is not None and isinstance(edge.data, Tendon):
        for arc in edge.arcs if edge.data.kind == "fixed" else ():
            yield from _dof(mechanism, arc, gear * (*numbers_weight(arc), 1.0)[0])
    else:
        yield from _dof(mechanism, target, gear)


def _dof(mechanism: Mechanism, arc: RobotArc, gear: float) -> Iterator[tuple[tuple[Id, int], float]]:
    found = dof_at(mechanism.graph.edges, arc)
    if found is not None and arc.target in mechanism.joints:
        yield (arc.target, found[0]), gear


# ---- one actuator --------------------------------------------------------------------------------------------------------------


def force_span(actuator: Actuator) -> Span:
    """The least and the greatest force of an actuator before its gear; infinite where nothing bounds it.

    Its force range bounds it, and where it is proportional to its control (a motor) so does its control range.

    Source: MuJoCo's documentation, Computation, Actuation model: the force is clamped to ``forcerange`` before it is geared.
    """
    authored = dict(actuator.parameters)
    low, high = _span(authored, "force") or _UNBOUNDED
    control = _span(authored, "ctrl") if _is_proportional(actuator.kind, authored) else None
    if control is not None:
        gain = _number(authored.get("gainprm"), 1.0)
        ends = sorted((gain * control[0], gain * control[1]))
        low, high = max(low, ends[0]), min(high, ends[1])
    return low, high


def _is_proportional(kind: str, authored: Mapping[str, object]) -> bool:
    """Whether the force is the control times a constant, at least after a while."""
    if kind == "motor":
        return True
    words = [authored.get(name, usual) for name, usual in (("gaintype", "fixed"), ("biastype", "none"), ("dyntype", "none"))]
    return kind == "general" and words[:2] == ["fixed", "none"] and words[2] in ("none", "filter", "filterexact")


def _span(authored: Mapping[str, object], name: str) -> Span | None:
    """The range that holds for a control or a force."""
    found = authored.get(f"{name}range")
    if not isinstance(found, tuple) or len(found) != 2 or authored.get(f"{name}limited") == "false" or not found[0] < found[1]:
        return None
    return found


def _number(value: object, usual: float) -> float:
    first = value[0] if isinstance(value, tuple) and value else value
    return float(first) if isinstance(first, int | float) else usual
