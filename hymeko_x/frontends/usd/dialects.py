"""What other converters say in attributes of their own where the public schemas have no word.

urdf-usd-converter puts what is left of an element in ``urdf:`` attributes. cyberwave-robot-format repeats everything in
``cyberwave:`` attributes, in SI units, radians and double precision.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.parts import Coupling, DofKind

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.draft import Draft
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.frontends.usd.relations import Driven
    from hymeko_x.ir.mechanism import RobotArc
    from hymeko_x.ir.parts import Dof, Limits

_JOINT = "cyberwave:joint:"


# ---- dofs ----------------------------------------------------------------------------------------------------------------------


def with_dialect(prim: Prim, dof: Dof, draft: Draft) -> Dof:
    """The dof with what a converter says about it in its own attributes where the public ones say nothing."""
    if dof.kind not in (DofKind.HINGE, DofKind.SLIDE):
        return dof
    effort = draft.get(prim, "urdf:limit:effort")
    if effort is not None and dof.limits.effort is None:
        dof = replace(dof, limits=replace(dof.limits, effort=effort))
    return _cyberwave_dof(prim, dof, draft) if f"{_JOINT}type" in prim.types else dof


def _cyberwave_dof(prim: Prim, dof: Dof, draft: Draft) -> Dof:
    draft.take(prim, f"{_JOINT}type", f"{_JOINT}hasLimits", f"{_JOINT}hasDynamics")
    return replace(
        dof,
        limits=_cyberwave_limits(prim, dof.limits, draft),
        damping=draft.number(prim, f"{_JOINT}dynamicsDamping", dof.damping),
        friction=draft.number(prim, f"{_JOINT}dynamicsFriction", dof.friction),
        stiffness=draft.number(prim, f"{_JOINT}dynamicsSpringStiffness", dof.stiffness),
        spring_ref=draft.number(prim, f"{_JOINT}dynamicsSpringReference", dof.spring_ref),
    )


def _cyberwave_limits(prim: Prim, limits: Limits, draft: Draft) -> Limits:
    """Speed and effort, which UsdPhysics has not, and bounds in double precision where they still are those of the joint."""
    lower, upper = (draft.number(prim, f"{_JOINT}limit{name}", math.nan) for name in ("Lower", "Upper"))
    velocity, effort = (draft.number(prim, f"{_JOINT}limit{name}", math.inf) for name in ("Velocity", "Effort"))
    return replace(
        limits,
        lower=_sharper(limits.lower, lower),
        upper=_sharper(limits.upper, upper),
        velocity=velocity if math.isfinite(velocity) else limits.velocity,
        effort=effort if math.isfinite(effort) else limits.effort,
    )


def _sharper(native: float | None, double: float) -> float | None:
    """The double that a single-precision value was made from; the latter where somebody has edited it."""
    is_same = native is not None and math.isclose(native, double, rel_tol=1e-5, abs_tol=1e-6)
    return double if is_same else native


def is_passive_drive(prim: Prim) -> bool:
    """Whether a joint's drive only repeats its damping and spring."""
    return f"{_JOINT}hasDynamics" in prim.types


# ---- mimics --------------------------------------------------------------------------------------------------------------------


def read_named_mimic(prim: Prim, end: Driven, named: dict[str, Driven], draft: Draft) -> None:
    """cyberwave-robot-format's mimic: the name of the leader, in SI units."""
    name = draft.get(prim, f"{_JOINT}mimicJoint")
    leader = named.get(name) if isinstance(name, str) else None
    if leader is None:
        return
    constant = draft.number(prim, f"{_JOINT}mimicOffset", 0.0)
    factor = draft.number(prim, f"{_JOINT}mimicMultiplier", 1.0)
    arcs: tuple[RobotArc, ...] = (Arc(end.joint, 1, (1.0,), end.dof), Arc(leader.joint, -1, (constant, factor), leader.dof))
    draft.edges[draft.own(prim, "coupling", end.dof or end.joint.name)] = Edge(Coupling(True), arcs)


# ---- the world -----------------------------------------------------------------------------------------------------------------


def is_world(prim: Prim, draft: Draft) -> bool:
    """Whether a rigid body is what cyberwave-robot-format makes of the world body of an MJCF."""
    return prim.name == "world" and any("cyberwave" in top.custom_data for top in draft.scene.prims.values() if top.parent is None)
