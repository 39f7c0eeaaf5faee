"""Conventions of other converters, where the public schemas have no attribute.

urdf-usd-converter keeps attributes of URDF as ``urdf:`` attributes, and writes links without mass, shapes and motion as plain
Xforms: it nests prims as the URDF nests links, leaves out the fixed joints above such links, and leads joints that begin at
one past it to the nearest rigid body. Its ``creator`` in the stage's custom data marks its files.
cyberwave-robot-format repeats everything in ``cyberwave:`` attributes, in SI units, radians and double precision.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.frontends.usd.bodies import BODY, body_at
from hymeko_x.frontends.usd.joints import JointEnd, ReadJoint
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Body, Coupling, DofKind
from hymeko_x.ir.values import IDENTITY, compose, inverse

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.builder import UsdBuilder
    from hymeko_x.frontends.usd.joints import DofRef
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.ir.parts import Dof, Limits
    from hymeko_x.ir.values import Pose

_JOINT = "cyberwave:joint:"


# ---- dofs ----------------------------------------------------------------------------------------------------------------------


def with_dialect(joint: ReadJoint, builder: UsdBuilder) -> ReadJoint:
    """The joint with its dofs as a converter's own attributes describe them, where the public ones have no value."""
    return replace(joint, dofs=tuple(_with_dialect(joint.prim, dof, builder) for dof in joint.dofs))


def _with_dialect(prim: Prim, dof: Dof, builder: UsdBuilder) -> Dof:
    if dof.kind not in (DofKind.HINGE, DofKind.SLIDE):
        return dof
    effort = builder.get(prim, "urdf:limit:effort")
    if effort is not None and dof.limits.effort is None:
        dof = replace(dof, limits=replace(dof.limits, effort=effort))
    return _cyberwave_dof(prim, dof, builder) if f"{_JOINT}type" in prim.types else dof


def _cyberwave_dof(prim: Prim, dof: Dof, builder: UsdBuilder) -> Dof:
    builder.mark_read(prim, f"{_JOINT}type", f"{_JOINT}hasLimits", f"{_JOINT}hasDynamics")
    return replace(
        dof,
        limits=_cyberwave_limits(prim, dof.limits, builder),
        damping=builder.number(prim, f"{_JOINT}dynamicsDamping", dof.damping),
        friction=builder.number(prim, f"{_JOINT}dynamicsFriction", dof.friction),
        stiffness=builder.number(prim, f"{_JOINT}dynamicsSpringStiffness", dof.stiffness),
        spring_ref=builder.number(prim, f"{_JOINT}dynamicsSpringReference", dof.spring_ref),
    )


def _cyberwave_limits(prim: Prim, limits: Limits, builder: UsdBuilder) -> Limits:
    """Speed and effort, which UsdPhysics has not, and bounds in double precision where they still are those of the joint."""
    lower, upper = (builder.number(prim, f"{_JOINT}limit{name}", math.nan) for name in ("Lower", "Upper"))
    velocity, effort = (builder.number(prim, f"{_JOINT}limit{name}", math.inf) for name in ("Velocity", "Effort"))
    return replace(
        limits,
        lower=_sharper(limits.lower, lower),
        upper=_sharper(limits.upper, upper),
        velocity=velocity if math.isfinite(velocity) else limits.velocity,
        effort=effort if math.isfinite(effort) else limits.effort,
    )


def _sharper(native: float | None, double: float) -> float | None:
    """The double that a single-precision value was made from; the latter where it was edited since."""
    is_same = native is not None and math.isclose(native, double, rel_tol=1e-5, abs_tol=1e-6)
    return double if is_same else native


def is_passive_drive(prim: Prim) -> bool:
    """Whether a joint's drive only repeats its damping and spring."""
    return f"{_JOINT}hasDynamics" in prim.types


# ---- mimics --------------------------------------------------------------------------------------------------------------------


def read_named_mimic(prim: Prim, end: DofRef, named: dict[str, DofRef], builder: UsdBuilder) -> None:
    """cyberwave-robot-format's mimic: the name of the leader, in SI units."""
    name = builder.get(prim, f"{_JOINT}mimicJoint")
    leader = named.get(name) if isinstance(name, str) else None
    if leader is None:
        return
    constant = builder.number(prim, f"{_JOINT}mimicOffset", 0.0)
    factor = builder.number(prim, f"{_JOINT}mimicMultiplier", 1.0)
    arcs: tuple[RobotArc, ...] = (Arc(end.joint, 1, (1.0,), end.dof), Arc(leader.joint, -1, (constant, factor), leader.dof))
    builder.edges[builder.new_id(prim, "coupling", end.dof or end.joint.name)] = Edge(Coupling(True), arcs)


# ---- the world -----------------------------------------------------------------------------------------------------------------


def is_world(prim: Prim, builder: UsdBuilder) -> bool:
    """Whether a rigid body is the one into which cyberwave-robot-format converts the world body of an MJCF."""
    return prim.name == "world" and any("cyberwave" in top.custom_data for top in builder.scene.prims.values() if top.parent is None)


# ---- links that are plain Xforms ---------------------------------------------------------------------------------------------------

_CREATOR = "URDF USD Converter"
_LINKS = "Geometry"
FIXED_SUFFIX = "_fixed"


def read_bare_links(prims: list[Prim], builder: UsdBuilder) -> list[Prim]:
    """Add the links that are plain Xforms as bodies without mass; returns their prims."""
    stage = builder.scene.stage
    creator = stage.GetRootLayer().customLayerData.get("creator", "")
    default = stage.GetDefaultPrim()
    if not str(creator).startswith(_CREATOR) or not default:
        return []
    above = f"{default.GetPath()}/{_LINKS}/"
    bare = [prim for prim in prims if prim.path.startswith(above) and _is_bare_link(prim, above)]
    for prim in bare:
        key = builder.new_id(prim, "body")
        builder.bodies[prim.path] = key
        builder.vertices[key] = Body()
        builder.mark_read(prim, "@type", *(name for name in prim.properties if name.startswith("xformOp")))
    return bare


def _is_bare_link(prim: Prim, above: str) -> bool:
    """Whether an Xform is a link: bodies are not bare, a mesh of several parts, which is referred to, is none.

    A root called ``world`` is the world, to which the converter joins its children.
    """
    is_world = prim.path == f"{above}world"
    return prim.kind == "Xform" and not is_world and not prim.has_api(BODY) and not prim.composed.HasAuthoredReferences()


def join_bare_links(bare: list[Prim], joints: list[ReadJoint], builder: UsdBuilder) -> list[ReadJoint]:
    """The joints, with each bare link between the bodies at its prim."""
    if not bare:
        return joints
    prims = {key: builder.prim_at(path) for path, key in builder.bodies.items()}
    links = {builder.bodies[prim.path] for prim in bare}
    moved = [_from_bare_link(joint, links, prims, builder) for joint in joints]
    return [*moved, *(_fixed_above(prim, builder) for prim in bare)]


def _from_bare_link(joint: ReadJoint, links: set[Id], prims: dict[Id, Prim], builder: UsdBuilder) -> ReadJoint:
    """The joint from the bare link right above its child, if there is one; seen from the world both frames are the same."""
    first, second = joint.ends
    above = body_at(prims[second.body].parent, builder) if second.body in prims else None
    if above is None or above[1] not in links:
        return joint
    start = builder.transforms.of(prims[first.body]).pose if first.body in prims else IDENTITY
    pose = compose(inverse(builder.transforms.of(above[0]).pose), compose(start, first.pose))
    return replace(joint, ends=(JointEnd(above[1], pose), second))


def _fixed_above(prim: Prim, builder: UsdBuilder) -> ReadJoint:
    """The fixed joint that is the parent of a bare link; a bare root is fixed to the world, as its other roots are."""
    body = builder.bodies[prim.path]
    start: Pose = IDENTITY
    parent = WORLD
    above = body_at(prim.parent, builder)
    if above is not None:
        start, parent = builder.transforms.of(above[0]).pose, above[1]
    pose = compose(inverse(start), builder.transforms.of(prim).pose)
    key = builder.new_id(prim, "joint", body.name + FIXED_SUFFIX)
    return ReadJoint(prim, key, (), (JointEnd(parent, pose), JointEnd(body, IDENTITY)), is_enabled=True, is_excluded=False)
