"""URDF as urdfdom sees it through Pinocchio, with yourdfpy as a second, independent reader.

Bodies, joints, limits and inertia come from Pinocchio. What it leaves out (shapes), and mimic joints where it cannot
build them, come from yourdfpy. Both must see the same kinematics, or the file is not comparable.
Source: pinocchio ``buildModelFromXML``; yourdfpy ``URDF.load``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin
from msgspec import Struct
from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.verify.model import INF, WORLD, Array, Body, Coupling, Dof, Feature, Joint, Kind, KinematicModel, grounded
from hymeko_x.verify.readers import overheard
from hymeko_x.verify.readers.urdf.yourdfpy import Mimic, Second, disagreement, load
from hymeko_x.verify.spatial import inverse

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from hymeko_x.verify.readers import Places

SAYS = frozenset(Feature) - {
    Feature.ARMATURE,
    Feature.SPRINGS,
    Feature.REFS,
    Feature.ACTUATORS,
    Feature.TENDONS,
    Feature.TIED_TENDONS,
    Feature.LOOPS,
    Feature.CURVES,
}
MUTE = frozenset((feature, Kind.FREE) for feature in (Feature.DAMPING, Feature.FRICTION, Feature.VELOCITY_LIMITS, Feature.EFFORT_LIMITS))
"""urdfdom's <dynamics> and <limit> are those of one coordinate; a floating joint has six, and Pinocchio gives them none."""


def read(path: Path, places: Places) -> KinematicModel:
    """The robot that urdfdom sees. Raises: Refusal HX302 in urdfdom's words, or where yourdfpy sees another robot."""
    return read_text(path.read_bytes(), path, places)


def read_text(data: bytes, path: Path, places: Places) -> KinematicModel:
    """The same for a text that stands for the file at ``path``. Raises: Refusal HX302."""
    text = data.decode("utf-8", "replace").replace("\x00", "")
    model = _build(text, str(path), mimic=False)
    second = load(text.encode(), path, places)
    if second.still:
        words = f"joint '{second.still}' has an axis of zero, about which nothing can move"
        raise refuse(codes.ENGINE_REFUSED, words, Origin(str(path)))
    found = KinematicModel(
        name=model.name,
        format="urdf",
        engine=f"urdfdom in Pinocchio {pin.__version__}, yourdfpy",
        bodies=_bodies(model, second),
        says=SAYS if second.shapes is not None else SAYS - {Feature.VISUALS, Feature.COLLISIONS},
        mute=MUTE,
        notes=second.notes,
    )
    couplings, said = _couplings(text, str(path), found, second)
    found = replace(found, couplings=couplings, notes=(*found.notes, *said))
    difference = disagreement(found, second)
    if difference:
        raise refuse(codes.ENGINE_REFUSED, f"urdfdom and yourdfpy see different robots: {difference}", Origin(str(path)))
    return found


def _build(text: str, file: str, *, mimic: bool) -> Any:
    """Pinocchio's model. Raises: Refusal HX302."""
    with overheard() as said:
        try:
            return pin.buildModelFromXML(text, mimic)
        except (ValueError, RuntimeError, IndexError) as error:
            words = said() or " ".join(str(error).split())
            raise refuse(codes.ENGINE_REFUSED, f"urdfdom refuses the file: {words}", Origin(file)) from error


# ---- bodies and joints -----------------------------------------------------------------------------------------------


class _Link(Struct, frozen=True, eq=False):
    """A BODY frame of Pinocchio with the frame of the joint above it and the index of its parent's BODY frame."""

    frame: Any
    above: Any | None
    parent: int


def _links(model: Any) -> dict[int, _Link]:
    """By the index of their BODY frame, parents first."""
    body_type = pin.FrameType.BODY
    found: dict[int, _Link] = {}
    waiting = [(i, frame) for i, frame in enumerate(model.frames) if frame.type == body_type]
    for index, frame in waiting:
        above = model.frames[frame.parentFrame]
        rooted = frame.parentFrame == 0
        found[index] = _Link(frame, None if rooted else above, -1 if rooted else above.parentFrame)
    return found


def _parents_first(links: dict[int, _Link]) -> list[int]:
    below: dict[int, list[int]] = {}
    for index, link in links.items():
        below.setdefault(link.parent, []).append(index)
    order: list[int] = []
    stack = list(reversed(below.get(-1, [])))
    while stack:
        index = stack.pop()
        order.append(index)
        stack.extend(reversed(below.get(index, [])))
    return order


def _bodies(model: Any, second: Second) -> tuple[Body, ...]:
    """The links as bodies under the world. A massless root link called ``world`` is the world itself."""
    links = _links(model)
    moving = _moving_inertias(model, links)
    places: dict[int, int] = {}
    bodies: list[Body] = [grounded()]
    for index in _parents_first(links):
        link = links[index]
        name = str(link.frame.name)
        mass, com, tensor = moving.get(index) or _split(link.above.inertia if link.above is not None else link.frame.inertia)
        shapes = (second.shapes or {}).get(name, ())
        if link.above is None and name == "world" and mass == 0.0:
            places[index] = WORLD
            bodies[WORLD] = grounded(shapes=shapes)
            continue
        joint = Joint(open=True) if link.above is None else _joint(model, link, links)
        places[index] = len(bodies)
        bodies.append(Body(name, places.get(link.parent, WORLD), joint, mass, com, tensor, shapes))
    return tuple(bodies)


def _joint(model: Any, link: _Link, links: dict[int, _Link]) -> Joint:
    parent = links[link.parent].frame
    above = link.above
    assert above is not None
    if above.type == pin.FrameType.FIXED_JOINT:
        return Joint(str(above.name), inverse(parent.placement.homogeneous) @ above.placement.homogeneous)
    number = above.parentJoint
    placement = inverse(parent.placement.homogeneous) @ model.jointPlacements[number].homogeneous
    return Joint(str(above.name), placement, _dofs(model, number))


def _dofs(model: Any, number: int) -> tuple[Dof, ...]:
    """The dofs of one of Pinocchio's joints; unbounded ones are coordinates on a circle there."""
    joint = model.joints[number]
    kind = joint.shortname().removeprefix("JointModel")
    if kind == "FreeFlyer":
        return (Dof(Kind.FREE, np.array([0.0, 0.0, 1.0])),)
    if kind == "Planar":
        x, y, z = np.eye(3)
        return (Dof(Kind.SLIDE, x), Dof(Kind.SLIDE, y), Dof(Kind.HINGE, z))
    axis = _axis(model, joint)
    q, v = joint.idx_q, joint.idx_v
    bounded = joint.nq == 1
    return (
        Dof(
            Kind.SLIDE if kind.startswith("P") else Kind.HINGE,
            axis,
            name=str(model.names[number]),
            lower=float(model.lowerPositionLimit[q]) if bounded else -INF,
            upper=float(model.upperPositionLimit[q]) if bounded else INF,
            velocity=float(model.velocityLimit[v]),
            effort=(float(model.lowerEffortLimit[v]), float(model.upperEffortLimit[v])),
            damping=float(model.damping[v]),
            friction=float(model.upperDryFrictionLimit[v]),
        ),
    )


def _axis(model: Any, joint: Any) -> Array:
    """The unit axis of a joint with one dof, from its motion subspace: not every type tells its axis by name."""
    data = joint.createData()
    joint.calc(data, pin.neutral(model))
    motion = np.array(data.S, dtype=float).reshape(6)
    axis = motion[:3] + motion[3:]  # one half is zero: a joint with one dof turns or slides
    length = float(np.linalg.norm(axis))
    unit: Array = axis / length if length > 0 else axis
    return unit


# ---- inertia ---------------------------------------------------------------------------------------------------------


def _split(inertia: Any) -> tuple[float, Array, Array]:
    return float(inertia.mass), np.array(inertia.lever, dtype=float), np.array(inertia.inertia, dtype=float)


def _weighs(inertia: Any) -> bool:
    """A link may have a tensor and no mass, which Pinocchio adds up all the same."""
    return bool(inertia.mass != 0.0 or inertia.inertia.any())


def _moving_inertias(model: Any, links: dict[int, _Link]) -> dict[int, tuple[float, Array, Array]]:
    """The inertia of each link below a moving joint: Pinocchio's sum for the joint without the links fixed to it."""
    fixed: dict[int, list[Any]] = {}
    for link in links.values():
        if link.above is not None and link.above.type == pin.FrameType.FIXED_JOINT and _weighs(link.above.inertia):
            fixed.setdefault(link.above.parentJoint, []).append(link.above.placement.act(link.above.inertia))
    found: dict[int, tuple[float, Array, Array]] = {}
    for index, link in links.items():
        if link.above is None or link.above.type != pin.FrameType.JOINT:
            continue
        number = link.above.parentJoint
        found[index] = _without(_split(model.inertias[number]), [_split(part) for part in fixed.get(number, [])])
    return found


def _without(total: tuple[float, Array, Array], parts: list[tuple[float, Array, Array]]) -> tuple[float, Array, Array]:
    """What is left of a rigid body's mass, centre and tensor without its parts; rounding dust counts as nothing."""
    if not parts:
        return total
    mass = total[0] - sum(part[0] for part in parts)
    about_origin = _about_origin(*total) - sum((_about_origin(*part) for part in parts), np.zeros((3, 3)))
    if abs(mass) <= 1e-13 * total[0]:
        dust = 1e-13 * np.abs(_about_origin(*total)).max(initial=0.0)
        return 0.0, np.zeros(3), np.where(np.abs(about_origin) <= dust, 0.0, about_origin)
    com = (total[0] * total[1] - sum((part[0] * part[1] for part in parts), np.zeros(3))) / mass
    return mass, com, about_origin - _point(mass, com)


def _about_origin(mass: float, com: Array, tensor: Array) -> Array:
    return tensor + _point(mass, com)


def _point(mass: float, com: Array) -> Array:
    """The tensor of a point mass about the origin."""
    tensor: Array = mass * (np.dot(com, com) * np.eye(3) - np.outer(com, com))
    return tensor


# ---- mimic -----------------------------------------------------------------------------------------------------------


def _couplings(text: str, file: str, found: KinematicModel, second: Second) -> tuple[tuple[Coupling, ...], list[str]]:
    """The mimic joints by urdfdom; by yourdfpy where Pinocchio cannot build them (a leader below or behind its follower)."""
    if not second.mimics and "<mimic" not in text:
        return (), []
    dofs = {dof.name: index for index, dof in enumerate(found.dofs) if dof.name is not None}
    try:
        model = pin.buildModelFromXML(text, True)
    except (ValueError, RuntimeError, IndexError) as error:
        words = " ".join(str(error).split())
        known = [coupling for mimic in second.mimics if (coupling := _second_coupling(mimic, found, dofs)) is not None]
        return tuple(known), [f"mimic joints are read by yourdfpy alone: Pinocchio says '{words}'"]
    return tuple(_coupling(model, pair, dofs) for pair in zip(model.mimicking_joints, model.mimicked_joints, strict=True)), []


def _second_coupling(mimic: Mimic, found: KinematicModel, dofs: Mapping[str, int]) -> Coupling | None:
    """By yourdfpy's word. The coordinate of a fixed leader is 0; a follower that is fixed follows nothing."""
    follower = dofs.get(mimic.follower)
    if follower is None:
        return None
    if mimic.leader in dofs:
        return Coupling(follower, mimic.offset, ((dofs[mimic.leader], (mimic.multiplier,)),))
    fixed = any(body.joint.name == mimic.leader for body in found.bodies)
    return Coupling(follower, mimic.offset) if fixed else None


def _coupling(model: Any, pair: tuple[int, int], dofs: Mapping[str, int]) -> Coupling:
    follower, leader = (dofs[str(model.names[number])] for number in pair)
    mimic = model.joints[pair[0]].extract()
    return Coupling(follower, float(mimic.offset), ((leader, (float(mimic.scaling),)),))
