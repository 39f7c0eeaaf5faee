"""Joints of several bodies: one edge with one parent and several children, which all move by the joint's one coordinate.

The joint of the first child has the name of the edge. Every other child has a joint of its own, ``NAME_2``, ``NAME_3``, .., and a coupling
by which that follows the first one: its coordinate is the first one's times the ratio on the arc of its child.
"""

from __future__ import annotations

from msgspec.structs import replace

from hymeko_x.ir.parts import Dof, Limits

RATIO = "ratio"
"""The field in the block of a child's arc."""


def follower_name(name: str, number: int) -> str:
    """The name of the joint of the second child, and of the later ones."""
    return f"{name}_{number}"


def follower_dof(dof: Dof, ratio: float) -> Dof:
    """The dof of a joint that follows by this ratio: the bounds of its coordinate are those of the first joint times the ratio."""
    limits = dof.limits
    lower, upper = (limits.lower, limits.upper) if ratio > 0 else (limits.upper, limits.lower)
    bounds = Limits(
        _times(lower, ratio),
        _times(upper, ratio),
        _times(limits.velocity, abs(ratio)),
        limits.effort,
        _times(limits.acceleration, abs(ratio)),
        _times(limits.jerk, abs(ratio)),
    )
    spring, ref = dof.spring_ref * ratio + 0.0, dof.ref * ratio + 0.0
    return replace(dof, limits=bounds, spring_ref=spring, ref=ref, safety=None, calibration=None, name=None)


def _times(value: float | None, ratio: float) -> float | None:
    return None if value is None else value * ratio + 0.0
