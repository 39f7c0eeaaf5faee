"""Couplings of joints: NewtonMimicAPI, its neutral twin of REP 158, and the polynomials of MjcEqualityJointAPI."""

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

EQUALITY = "MjcEqualityJointAPI"
_NEWTON, _NEUTRAL = words.NEWTON_MIMIC, words.NEUTRAL_MIMIC
_DEFAULTS = (0.0, 1.0, True)
"""Of offset, factor and enabled."""


# ---- mimics --------------------------------------------------------------------------------------------------------------------


def read_mimic(prim: Prim, end: DofRef, ends: dict[str, DofRef], builder: UsdBuilder) -> None:
    """This joint follows another one by NewtonMimicAPI, with the higher powers of MjcEqualityJointAPI.

    The constant is a coordinate of the follower, in degrees for a hinge; factors are dimensionless. Where Newton's names are
    not there, those of REP 158 count, and then MuJoCo's older ones (radians).
    """
    by = next((name for name in (_NEWTON.leader, _NEUTRAL.leader, "mjc:target") if prim.targets(name)), None)
    leader = ends.get(prim.targets(by)[0]) if by is not None and _follows(prim) else None
    follower = builder.edges.get(end.joint)
    if by is None or leader is None or follower is None or not isinstance(follower.data, Joint):
        return
    dof = next((dof for dof in follower.data.dofs if dof.name == end.dof or not end.dof), None)
    if dof is None or dof.kind not in (DofKind.HINGE, DofKind.SLIDE):
        return
    names = _NEUTRAL if by == _NEUTRAL.leader else _NEWTON
    enabled = prim.value(names.enabled)
    if _are_equal(prim):
        builder.mark_read(prim, f"@{_NEUTRAL.schema}", *_NEUTRAL[1:])
    builder.mark_read(prim, f"@{names.schema}", by, names.enabled)
    coupling = builder.new_id(prim, "coupling", end.dof or end.joint.name)
    if by == "mjc:target":
        builder.note(coupling, words.EQUALITY, True)
    arcs: tuple[RobotArc, ...] = (
        Arc(end.joint, 1, (1.0,), end.dof),
        Arc(leader.joint, -1, _polynomial(prim, dof, names, builder), leader.dof),
    )
    builder.edges[coupling] = Edge(Coupling(enabled is not False), arcs)


def _are_equal(prim: Prim) -> bool:
    """Whether the neutral schema has the same coupling as Newton's."""
    if prim.targets(_NEWTON.leader) != prim.targets(_NEUTRAL.leader):
        return False
    both = [[prim.value(name) for name in names[2:]] for names in (_NEWTON, _NEUTRAL)]
    newton, neutral = ([default if value is None else value for value, default in zip(found, _DEFAULTS, strict=True)] for found in both)
    return newton == neutral


def _follows(prim: Prim) -> bool:
    """Whether a schema makes the joint a follower; other schemas have a target, too."""
    return any(schema in (_NEWTON.schema, _NEUTRAL.schema, EQUALITY) for schema in prim.schemas)


def _polynomial(prim: Prim, dof: Dof, names: words.MimicSchema, builder: UsdBuilder) -> tuple[float, ...]:
    unit = math.pi / 180.0 if dof.kind is DofKind.HINGE else builder.scene.metres
    authored, factor = builder.get(prim, names.offset), builder.get(prim, names.factor)
    older = builder.scene.metres if dof.kind is DofKind.SLIDE else 1.0
    constant = builder.number(prim, "mjc:coef0", 0.0) * older if authored is None else authored * unit
    factor = builder.number(prim, "mjc:coef1", 1.0) if factor is None else factor
    higher = [builder.number(prim, f"mjc:coef{power}", 0.0) for power in (2, 3, 4)] if EQUALITY in prim.schemas else []
    while higher and higher[-1] == 0.0:
        higher.pop()
    if (higher or names.factor not in prim.types) and not _has_solver_parameters(prim):
        builder.mark_read(prim, f"@{EQUALITY}")
    return (constant, factor, *higher)


def _has_solver_parameters(prim: Prim) -> bool:
    return any(prim.has_value(f"mjc:{name}") for name in ("solimp", "solref"))
