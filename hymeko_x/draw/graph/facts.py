"""What stands beside an element: the motion of a joint, the mass of a body, the weight of an arc. Angles in degrees, else SI."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hymeko_x.draw.graph.letters import cut, shown
from hymeko_x.ir import lumped, parts
from hymeko_x.ir.values import Pose, rpy_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.ir.mechanism import RobotArc

SIGNS = {1: "+", -1: "\u2212", 0: "~"}
"""How the direction of an arc is written: into the edge, out of it, without direction."""
_MOTIONS = {
    parts.DofKind.HINGE: "revolute",
    parts.DofKind.SLIDE: "prismatic",
    parts.DofKind.SCREW: "screw",
    parts.DofKind.BALL: "ball",
    parts.DofKind.FREE: "free",
}
_TURNING = frozenset({parts.DofKind.HINGE, parts.DofKind.SCREW})
_WITHOUT_AXIS = frozenset({parts.DofKind.BALL, parts.DofKind.FREE})


def symbol(part: object) -> str:
    """The name of an edge's symbol: the motion of a joint (``several`` of more than one dof), the kind of anything else."""
    if isinstance(part, parts.Joint):
        return "fixed" if not part.dofs else _MOTIONS[part.dofs[0].kind] if len(part.dofs) == 1 else "several"
    return type(part).__name__.lower()


def motion(joint: parts.Joint) -> str:
    """How a joint moves: each dof with its axis and its limits."""
    return " · ".join(dof_text(dof) for dof in joint.dofs) or "fixed"


def dof_text(dof: parts.Dof, *, with_axis: bool = True) -> str:
    """``revolute Z -90 to 90°``."""
    words = [_MOTIONS[dof.kind]]
    if with_axis and dof.kind not in _WITHOUT_AXIS:
        words.append(axis_name(dof))
    return " ".join((*words, *_limits(dof)))


def axis_name(dof: parts.Dof) -> str:
    """``X``, ``-Z``, or the direction in the joint frame."""
    for place, letter in enumerate("XYZ"):
        if abs(dof.axis[place]) > 1 - 1e-9:
            return letter if dof.axis[place] > 0 else f"-{letter}"
    return _vector(dof.axis)


def _limits(dof: parts.Dof) -> Iterable[str]:
    lower, upper = dof.limits.lower, dof.limits.upper
    if lower is None and upper is None:
        return ()
    scale, unit = (180 / math.pi, "°") if dof.kind in _TURNING else (1, " m")
    ends = ("…" if end is None else number(end * scale) for end in (lower, upper))
    return (" to ".join(ends) + unit,)


def vertex_facts(part: object) -> str:
    """What a vertex weighs or how it acts, in one line; empty where nothing is known."""
    match part:
        case parts.Body(inertial=parts.Inertial(mass=mass)) if mass is not None:
            return f"{number(mass)} kg"
        case lumped.Mass(mass=mass, domain=domain):
            return f"{number(mass)} {'kg m²' if domain == 'rotation' else 'kg'}"
        case lumped.Spring(stiffness=stiffness, domain=domain):
            return f"{number(stiffness)} {'Nm/rad' if domain == 'rotation' else 'N/m'}"
        case lumped.Damper(damping=damping, domain=domain):
            return f"{number(damping)} {'Nms/rad' if domain == 'rotation' else 'Ns/m'}"
        case lumped.Port(kind=kind) | parts.Actuator(kind=kind) | parts.Sensor(kind=kind) | parts.Light(kind=kind):
            return cut(shown(kind))
    return ""


def edge_facts(part: object) -> str:
    """What an edge means, in one line; a relation of a plain graph means nothing in particular."""
    match part:
        case parts.Joint():
            return motion(part)
        case parts.Loop(kind=kind) | parts.Tendon(kind=kind) | parts.Contact(kind=kind):
            return f"{symbol(part)} {shown(kind)}"
        case parts.Relation():
            return ""
    return symbol(part)


def weight(arc: RobotArc) -> str:
    """The weight of an arc and its role: ``[0 0 0.63] [0 0 90°]`` of a pose (turns about fixed axes), numbers as they are."""
    words = []
    if isinstance(arc.weight, Pose):
        words.append(_vector(arc.weight.xyz))
        turns = tuple(math.degrees(angle) for angle in rpy_of(arc.weight))
        if any(abs(turn) > 1e-6 for turn in turns):
            words.append(_vector(turns, "°"))
    elif arc.weight is not None:
        words.append(_value(arc.weight if len(arc.weight) != 1 else arc.weight[0]))
    if arc.role:
        words.append(shown(arc.role))
    return " ".join(words)


def _value(value: parts.DataValue) -> str:
    """A number, a text, or a list of such; ``?`` is a value that is left open."""
    if isinstance(value, tuple):
        return cut(f"[{' '.join(map(_value, value))}]")
    if value is None:
        return "?"
    return shown(value) if isinstance(value, str) else number(value)


def _vector(values: tuple[float, ...], unit: str = "") -> str:
    return cut(f"[{' '.join(map(number, values))}{unit}]")


def number(value: float) -> str:
    """Four digits, as in a data sheet, and all digits of whole numbers that are not very large."""
    if abs(value) < 1e-9:
        return "0"
    return f"{value:.0f}" if 1e3 <= abs(value) < 1e7 and value == round(value) else f"{value:.4g}"
