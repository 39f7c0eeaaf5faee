"""What acts on joints and what sits on bodies: drives, mimics, sites, cameras."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.formats import usd as words
from hymeko_x.frontends.usd.bodies import body_at
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import WORLD, mount_edge
from hymeko_x.ir.parts import Actuator, Camera, Coupling, DofKind, Drive, Frame, Joint, World

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.draft import Draft
    from hymeko_x.frontends.usd.joints import ReadJoint
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.ir.parts import Dof

DRIVE = "PhysicsDriveAPI"
MIMIC = "NewtonMimicAPI"
EQUALITY = "MjcEqualityJointAPI"


# ---- drives --------------------------------------------------------------------------------------------------------------------


class Driven(NamedTuple):
    """A joint, or by its name one dof of a joint that was made of several."""

    joint: Id
    dof: str


def driven_ends(joint: ReadJoint) -> list[tuple[Prim, Driven]]:
    """Each prim of a joint with what it moves."""
    if not joint.merged:
        return [(joint.prim, Driven(joint.id, ""))]
    return [(prim, Driven(joint.id, dof.name or "")) for prim, dof in zip(joint.merged, joint.dofs, strict=True)]


def read_drives(prim: Prim, end: Driven, draft: Draft) -> None:
    """Each DriveAPI of a joint as an actuator: position with a stiffness, velocity with damping alone, else motor."""
    edge = draft.edges.get(end.joint)
    if edge is None or not isinstance(edge.data, Joint):
        return
    for schema in prim.schemas:
        instance = schema.removeprefix(f"{DRIVE}:")
        number = _driven(instance, end.dof, edge.data) if instance != schema else None
        if number is not None:
            draft.take(prim, f"@{schema}")
            _add_drive(prim, end.joint, instance, number, edge.data, draft)


def _driven(instance: str, name: str, joint: Joint) -> int | None:
    """Which dof a drive moves; None where the joint has no such axis or the drive is for another kind of motion."""
    kinds = {"angular": DofKind.HINGE, "linear": DofKind.SLIDE}
    for number, dof in enumerate(joint.dofs):
        if instance in kinds:
            if (dof.name == name if name else len(joint.dofs) == 1) and dof.kind is kinds[instance]:
                return number
        elif instance in words.D6_AXES:
            kind, axis = words.d6_axis(instance)
            if dof.kind is kind and tuple(map(abs, dof.axis)) == axis:
                return number
    return None


def _add_drive(prim: Prim, key: Id, instance: str, number: int, joint: Joint, draft: Draft) -> None:
    """Gains per degree become gains per radian; what a drive aims at stays an extra."""
    scene, turns = draft.scene, joint.dofs[number].kind is DofKind.HINGE
    gain = scene.kilograms * (scene.metres**2 * 180.0 / math.pi if turns else 1.0)
    effort = scene.kilograms * scene.metres * (scene.metres if turns else 1.0)
    prefix = f"drive:{instance}:physics"
    kp = draft.number(prim, f"{prefix}:stiffness", 0.0) * gain
    kv = draft.number(prim, f"{prefix}:damping", 0.0) * gain
    most = draft.number(prim, f"{prefix}:maxForce", math.inf) * effort
    kind = "position" if kp else "velocity" if kv else "motor"
    gains = [(name, value) for name, value in (("kp", kp), ("kv", kv)) if value]
    limits: list[tuple[str, float | str | tuple[float, ...]]] = [("forcerange", (-most, most))] if math.isfinite(most) else []
    own = joint.dofs[number].name
    name = own or (key.name if len(joint.dofs) == 1 else f"{key.name}_{instance}")
    actuator = draft.own(prim, "actuator", name)
    draft.vertices[actuator] = Actuator(kind, (*gains, *limits))
    draft.note(actuator, words.TYPE, instance)
    role = "" if len(joint.dofs) == 1 else own or str(number)
    draft.edges[draft.own(prim, "drive", name)] = Edge(Drive(), (Arc(actuator, 1), Arc(key, -1, None, role)))


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


# ---- things that sit somewhere -------------------------------------------------------------------------------------------------


def read_site(prim: Prim, draft: Draft) -> None:
    """A frame at the prim, which is no more than that if it says all that we would say; the shape by which it is shown stays an extra."""
    key = draft.own(prim, "frame")
    draft.vertices[key] = Frame()
    if prim.kind == "Xform" and all(map(prim.has_api, words.SITES)):
        draft.take(prim, "@type", *(f"@{schema}" for schema in words.SITES))
    mount(prim, key, draft)


def read_camera(prim: Prim, draft: Draft) -> None:
    """A camera with its vertical field of view, 2 atan(aperture / 2 f); the rest of its lens stays extras."""
    key = draft.own(prim, "camera")
    focal = words.single(prim.value("focalLength") or 50.0)
    aperture = words.single(prim.value("verticalAperture") or words.APERTURE)
    fovy = 2.0 * math.atan(aperture / (2.0 * focal))
    draft.vertices[key] = Camera(fovy)
    draft.take(prim, "@type")
    if aperture == words.APERTURE and 0.0 < fovy < math.pi:  # as we say it
        draft.take(prim, *(name for name in ("focalLength", "verticalAperture") if not prim.is_animated(name)))
    mount(prim, key, draft)


def mount(prim: Prim, key: Id, draft: Draft) -> None:
    """The edge that puts a thing where its prim is, on the body above or on the world."""
    found = body_at(prim, draft)
    body, owner = found if found is not None else (None, WORLD)
    if owner == WORLD:
        draft.vertices.setdefault(WORLD, World())
    pose = draft.places.seen_from(prim, body).pose
    draft.edges[draft.own(prim, "mount", key.name)] = mount_edge(owner, key, pose)
    ops = [name for name in prim.properties if name.startswith("xformOp")]
    draft.take(prim, *(name for name in ops if "scale" not in name or name == words.WITHIN))
