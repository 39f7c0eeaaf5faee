"""Couplings of joints: NewtonMimicAPI, and the polynomials of MjcEqualityJointAPI."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hymeko_x.formats import usd as words
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.parts import Coupling, DofKind, Joint

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.builder import Draft
    from hymeko_x.frontends.usd.joints import Driven
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.ir.mechanism import RobotArc
    from hymeko_x.ir.parts import Dof

MIMIC = "NewtonMimicAPI"
EQUALITY = "MjcEqualityJointAPI"


# ---- mimics --------------------------------------------------------------------------------------------------------------------


def read_mimic(prim: Prim, end: Driven, ends: dict[str, Driven], draft: Draft) -> None:
    """This joint follows another one, as NewtonMimicAPI says, with the higher powers of MjcEqualityJointAPI.

    The constant is a coordinate of the follower, in degrees for a hinge; factors are dimensionless. Where Newton's names are
    not there, MuJoCo's older ones count (radians).
    """
    by = next((name for name in ("newton:mimicJoint", "mjc:target") if prim.targets(name)), None)
    leader = ends.get(prim.targets(by)[0]) if by is not None and _follows(prim) else None
    follower = draft.edges.get(end.joint)
    if by is None or leader is None or follower is None or not isinstance(follower.data, Joint):
        return
    dof = next((dof for dof in follower.data.dofs if dof.name == end.dof or not end.dof), None)
    if dof is None or dof.kind not in (DofKind.HINGE, DofKind.SLIDE):
        return
    enabled = prim.value("newton:mimicEnabled")
    draft.take(prim, f"@{MIMIC}", by, "newton:mimicEnabled")
    coupling = draft.own(prim, "coupling", end.dof or end.joint.name)
    if by == "mjc:target":
        draft.note(coupling, words.EQUALITY, "true")
    arcs: tuple[RobotArc, ...] = (Arc(end.joint, 1, (1.0,), end.dof), Arc(leader.joint, -1, _polynomial(prim, dof, draft), leader.dof))
    draft.edges[coupling] = Edge(Coupling(enabled is not False), arcs)


def _follows(prim: Prim) -> bool:
    """Whether a schema says that the joint follows; other schemas have a target, too."""
    return any(schema in (MIMIC, EQUALITY) for schema in prim.schemas)


def _polynomial(prim: Prim, dof: Dof, draft: Draft) -> tuple[float, ...]:
    unit = math.pi / 180.0 if dof.kind is DofKind.HINGE else draft.scene.metres
    said, factor = draft.get(prim, "newton:mimicCoef0"), draft.get(prim, "newton:mimicCoef1")
    older = draft.scene.metres if dof.kind is DofKind.SLIDE else 1.0
    constant = draft.number(prim, "mjc:coef0", 0.0) * older if said is None else said * unit
    factor = draft.number(prim, "mjc:coef1", 1.0) if factor is None else factor
    higher = [draft.number(prim, f"mjc:coef{power}", 0.0) for power in (2, 3, 4)] if EQUALITY in prim.schemas else []
    while higher and higher[-1] == 0.0:
        higher.pop()
    if (higher or "newton:mimicCoef1" not in prim.types) and not _says_more(prim):
        draft.take(prim, f"@{EQUALITY}")
    return (constant, factor, *higher)


def _says_more(prim: Prim) -> bool:
    return any(prim.has_value(f"mjc:{name}") for name in ("solimp", "solref"))
