"""Limits in the form of closed intervals: lower < upper, symmetric positive efforts, and no infinities."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.ir.graph import Edge
from hymeko_x.ir.parts import Dof, DofKind, Joint, Limits

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge
    from hymeko_x.rewrite.context import Context

FAR = 1e10
"""Stands for "no bound" on the other side of a one-sided limit, in rad or m."""
_PLAY = 1e-9
"""The width of the interval that stands for a locked coordinate, in rad or m."""

Said = list[tuple[bool, str]]
"""What was changed: whether it deserves a warning, and the words."""


def make_limits_intervals(mechanism: Mechanism, context: Context) -> Mechanism:
    """Every dof has either no position limits or lower < upper, and either no effort limit or a positive one."""
    edges: dict[Id, RobotEdge] = {}
    for view in mechanism.joints.values():
        said: Said = []
        dofs = tuple(_legal_dof(dof, said) for dof in view.joint.dofs)
        for serious, words in said:
            say = context.report.warn if serious else context.report.note
            say(codes.REWRITTEN, f"{view.id}: {words}", mechanism.origin(view.id), element=str(view.id))
        if dofs != view.joint.dofs:
            edges[view.id] = Edge(Joint(dofs), mechanism.graph.edges[view.id].arcs)
    return mechanism.with_graph(mechanism.graph.replace(edges=edges)) if edges else mechanism


def _legal_dof(dof: Dof, said: Said) -> Dof:
    lower, upper = _interval(dof, said)
    old, effort = dof.limits, _effort(dof.limits, said)
    if (lower, upper, effort) == (old.lower, old.upper, old.effort):
        return dof
    return replace(dof, limits=replace(old, lower=lower, upper=upper, effort=effort))


def _interval(dof: Dof, said: Said) -> tuple[float | None, float | None]:
    lower, upper = _finite(dof.limits.lower), _finite(dof.limits.upper)
    if dof.kind is DofKind.FREE and not (lower is None and upper is None):
        said.append((True, "position limits on a free joint have no meaning; they are left out"))
        return None, None
    if dof.kind is DofKind.BALL:
        return None if lower else lower, upper  # the angle from straight, of which MJCF says the lower bound 0
    return interval(dof.limits, said)


def interval(limits: Limits, said: Said) -> tuple[float | None, float | None]:
    """The bounds of one coordinate with lower < upper, or none."""
    lower, upper = _finite(limits.lower), _finite(limits.upper)
    if lower is None and upper is None:
        return None, None
    if lower is None or upper is None:
        side = "lower" if lower is None else "upper"
        said.append((False, f"has no {side} limit; {FAR:g} stands for the missing bound"))
        return _below(upper) if lower is None else lower, _above(lower) if upper is None else upper
    if lower > upper:
        said.append((True, f"lower limit {lower!r} is above upper limit {upper!r}; it is written without position limits"))
        return None, None
    if lower == upper == 0.0:
        said.append((True, "both limits are 0, as where URDF leaves them out; it is written without position limits"))
        return None, None
    if lower == upper:
        said.append((False, f"both limits are {lower!r}; {_PLAY:g} of play stands for a locked joint"))
        return lower, max(lower + _PLAY, math.nextafter(lower, math.inf))
    return lower, upper


def _effort(limits: Limits, said: Said) -> float | None:
    effort = _finite(limits.effort)
    if effort is None:
        return None
    if effort == 0.0:
        said.append((False, "effort limit 0 cannot be told from no limit; it is left out"))
        return None
    if effort < 0.0:
        said.append((True, f"effort limit {effort!r} is negative; {-effort!r} is written"))
    return abs(effort)


def _below(upper: float | None) -> float:
    return -FAR if upper is None else min(-FAR, math.nextafter(upper, -math.inf))


def _above(lower: float | None) -> float:
    return FAR if lower is None else max(FAR, math.nextafter(lower, math.inf))


def _finite(value: float | None) -> float | None:
    """The bound, or None where it says that there is none: infinite, or beyond what stands for no bound."""
    return value if value is not None and abs(value) <= 2.0 * FAR else None
