"""Servos: the actuators that hold a position, and the control at which each of them does."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x.ir.mechanism import numbers_weight
from hymeko_x.ir.parts import Actuator, Drive, Tendon
from hymeko_x.ir.tendons import FIXED
from hymeko_x.rewrite.servos import dof_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc


class Servo(Struct, frozen=True):
    """An actuator whose force is ``gain * control + bias + slope * length`` at rest.

    ``lengths`` are the dofs that it measures, each with its factor (gear times coefficient).
    """

    actuator: Id
    lengths: tuple[tuple[tuple[Id, int], float], ...]
    gain: float
    bias: float
    slope: float

    def control(self, length: float) -> float:
        """The control without force at this length."""
        return -(self.bias + self.slope * length) / self.gain + 0.0


def servos(mechanism: Mechanism) -> Iterator[Servo]:
    """The servos on joints, and on linear combinations of joints."""
    for _, _, arcs in mechanism.edges(Drive):
        targets = [arc for arc in arcs if arc.sign < 0]
        for arc in arcs:
            part = mechanism.part(arc.target, Actuator)
            law = None if part is None or arc.sign < 0 else _law(part)
            lengths = _lengths(mechanism, targets[0]) if law is not None and len(targets) == 1 else ()
            if law is not None and lengths:
                yield Servo(arc.target, lengths, *law)


def _law(actuator: Actuator) -> tuple[float, float, float] | None:
    """Gain, bias and slope of a servo; None for other actuators."""
    given = dict(actuator.parameters)
    if actuator.kind == "position":
        return 1.0, 0.0, -1.0
    if actuator.kind != "general" or given.get("biastype") != "affine" or given.get("gaintype", "fixed") != "fixed":
        return None
    gain, *_ = _numbers(given.get("gainprm", 1.0))
    bias, slope, *_ = (*_numbers(given.get("biasprm", 0.0)), 0.0, 0.0)
    return (gain, bias, slope) if gain and slope else None


def _numbers(value: float | str | tuple[float, ...]) -> tuple[float, ...]:
    return value if isinstance(value, tuple) else (value,) if isinstance(value, float) else (0.0,)


def _lengths(mechanism: Mechanism, target: RobotArc) -> tuple[tuple[tuple[Id, int], float], ...]:
    """The dofs of a joint or of a fixed tendon, each with its factor; none of what has no such length."""
    gear = (*numbers_weight(target), 1.0)[0]
    if target.target in mechanism.joints:
        return ((dof_of(mechanism, target), gear),)
    edge = mechanism.graph.edges.get(target.target)
    if edge is None or not isinstance(edge.data, Tendon) or edge.data.kind != FIXED:
        return ()
    return tuple((dof_of(mechanism, arc), gear * (*numbers_weight(arc), 1.0)[0]) for arc in edge.arcs)
