"""Couplings of joints: NewtonMimicAPI, and the polynomials of MjcEqualityJointAPI."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hymeko_x.formats import usd as words
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.parts import Coupling, DofKind, Joint

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.builder import UsdBuilder
    from hymeko_x.frontends.usd.joints import DofRef
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.ir.mechanism import RobotArc
    from hymeko_x.ir.parts import Dof

MIMIC = "NewtonMimicAPI"
EQUALITY = "MjcEqualityJointAPI"


# ---- mimics --------------------------------------------------------------------------------------------------------------------


def read_mimic(prim: Prim, end: DofRef, ends: dict[str, DofRef], builder: UsdBuilder) -> None:
    """This joint follows another one by NewtonMimicAPI, with the higher powers of MjcEqualityJointAPI.

    The constant is a coordinate of the follower, in degrees for a hinge; factors are dimensionless. Where Newton's names are
    not there, MuJoCo's older ones count (radians).
    """
    by = next((name for name in ("newton:mimicJoint", "mjc:target") if prim.targets(name)), None)
    leader = ends.get(prim.targets(by)[0]) if by is not None and _follows(prim) else None
    follower = builder.edges.get(end.joint)
    if by is None or leader is None or follower is None or not isinstance(follower.data, Joint):
        return
    dof = next((dof for dof in follower.data.dofs if dof.name == end.dof or not end.dof), None)
    if dof is None or dof.kind not in (DofKind.HINGE, DofKind.SLIDE):
        return
    enabled = prim.value("newton:mimicEnabled")
    builder.mark_read(prim, f"@{MIMIC}", by, "newton:mimicEnabled")
    coupling = builder.new_id(prim, "coupling", end.dof or end.joint.name)
    if by == "mjc:target":
        builder.note(coupling, words.EQUALITY, True)
    arcs: tuple[RobotArc, ...] = (Arc(end.joint, 1, (1.0,), end.dof), Arc(leader.joint, -1, _polynomial(prim, dof, builder), leader.dof))
    builder.edges[coupling] = Edge(Coupling(enabled is not False), arcs)


def _follows(prim: Prim) -> bool:
    """Whether a schema makes the joint a follower; other schemas have a target, too."""
    return any(schema in (MIMIC, EQUALITY) for schema in prim.schemas)


def _polynomial(prim: Prim, dof: Dof, builder: UsdBuilder) -> tuple[float, ...]:
    unit = math.pi / 180.0 if dof.kind is DofKind.HINGE else builder.scene.metres
    authored, factor = builder.get(prim, "newton:mimicCoef0"), builder.get(prim, "newton:mimicCoef1")
    older = builder.scene.metres if dof.kind is DofKind.SLIDE else 1.0
    constant = builder.number(prim, "mjc:coef0", 0.0) * older if authored is None else authored * unit
    factor = builder.number(prim, "mjc:coef1", 1.0) if factor is None else factor
    higher = [builder.number(prim, f"mjc:coef{power}", 0.0) for power in (2, 3, 4)] if EQUALITY in prim.schemas else []
    while higher and higher[-1] == 0.0:
        higher.pop()
    if (higher or "newton:mimicCoef1" not in prim.types) and not _has_solver_parameters(prim):
        builder.mark_read(prim, f"@{EQUALITY}")
    return (constant, factor, *higher)


def _has_solver_parameters(prim: Prim) -> bool:
    return any(prim.has_value(f"mjc:{name}") for name in ("solimp", "solref"))
