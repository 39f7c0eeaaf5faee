"""URDF as urdfdom reads it through Pinocchio, with yourdfpy as a second, independent reader.

Bodies, joints, limits and inertia come from Pinocchio. What it leaves out (shapes), and mimic joints where it cannot
build them, come from yourdfpy. Both must compute the same kinematics, or the file is not comparable.
Source: pinocchio ``buildModelFromXML``; yourdfpy ``URDF.load``.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin
from msgspec import Struct
from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.verify.features import Feature
from hymeko_x.verify.model import INF, WORLD, Array, Body, Coupling, Dof, Joint, Kind, KinematicModel, parents_first, world_body
from hymeko_x.verify.readers import native_output
from hymeko_x.verify.readers.urdf.yourdfpy import Mimic, Second, disagreement, load
from hymeko_x.verify.spatial import inverse, shifted_tensor

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from hymeko_x.verify.readers.lookup import Lookup

    Inertia = tuple[float, Array, Array]

FEATURES = frozenset(Feature) - {
    Feature.ARMATURE,
    Feature.SPRINGS,
    Feature.REFS,
    Feature.ACTUATORS,
    Feature.SENSORS,
    Feature.TENDONS,
    Feature.TIED_TENDONS,
    Feature.LOOPS,
    Feature.SLIDING_LOOPS,
    Feature.SCREW_LOOPS,
    Feature.OPEN_LOOPS,
    Feature.CURVES,
}
UNREPRESENTED = frozenset(
    (feature, Kind.FREE) for feature in (Feature.DAMPING, Feature.FRICTION, Feature.VELOCITY_LIMITS, Feature.EFFORT_LIMITS)
)
"""urdfdom's <dynamics> and <limit> are those of one coordinate; a floating joint has six, and Pinocchio gives them none."""

_INERTIA = re.compile(r"<inertia\s[^<>]*?(?=\s*/?>)")
_PLACE_IN_URDFDOM = re.compile(r"\s+at line \d+ in \S+\.cpp\b")
_ENTRIES = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")

_DUST = 1e-13
"""Of the whole: what is left of a mass or a tensor after subtracting its parts is zero below it, by the rounding of doubles."""


def read(path: Path, lookup: Lookup) -> KinematicModel:
    """The robot that urdfdom reads. Raises: Refusal HX302 in urdfdom's words, or where yourdfpy reads another robot."""
    return read_text(path.read_bytes(), path, lookup)


def read_text(data: bytes, path: Path, lookup: Lookup) -> KinematicModel:
    """The same for the text of the file at ``path``. Raises: Refusal HX302."""
    text, completed = _with_whole_tensors(data.decode("utf-8", "replace").replace("\x00", ""))
    model = _build(text, path)
    second = load(text.encode(), path, lookup)
    if second.axisless:
        message = f"joint '{second.axisless}' has an axis of zero, about which nothing can move"
        raise refuse(codes.ENGINE_REFUSED, message, Origin(str(path)))
    found = KinematicModel(
        name=model.name,
        format="urdf",
        engine=f"urdfdom in Pinocchio {pin.__version__}, yourdfpy",
        bodies=_bodies(model, second),
        features=FEATURES if second.shapes is not None else FEATURES - {Feature.VISUALS, Feature.COLLISIONS},
        unread=frozenset({Feature.VISUALS, Feature.COLLISIONS}),
        unrepresented=UNREPRESENTED,
        notes=(*second.notes, *completed),
    )
    couplings, notes = _couplings(text, found, second)
    found = replace(found, couplings=couplings, notes=(*found.notes, *notes))
    difference = disagreement(found, second)
    if difference:
        raise refuse(codes.ENGINE_REFUSED, f"urdfdom and yourdfpy see different robots: {difference}", Origin(str(path)))
    return found


def _with_whole_tensors(text: str) -> tuple[str, tuple[str, ...]]:
    """The text with 0 for the entries that an ``<inertia>`` leaves out, as yourdfpy reads it, with a note where there are such.

    urdfdom reads the mass of such a link and no entry of its tensor, and MuJoCo refuses the file.
    """
    whole = _INERTIA.sub(_with_all_entries, text)
    note = "an <inertia> does not have all six entries, and urdfdom reads none of it: 0 is compared for those that are missing"
    return whole, () if whole == text else (note,)


def _with_all_entries(tag: re.Match[str]) -> str:
    return tag[0] + "".join([f' {name}="0"' for name in _ENTRIES if not re.search(rf"\s{name}\s*=", tag[0])])


def _build(text: str, path: Path) -> Any:
    """Pinocchio's model. Raises: Refusal HX302."""
    with native_output() as output:
        try:
            return pin.buildModelFromXML(text, False)
        except (ValueError, RuntimeError, IndexError) as error:
            reason = _without_places(output()) or " ".join(str(error).split())
            raise refuse(codes.ENGINE_REFUSED, f"urdfdom refuses {path.name}: {reason}", Origin(str(path))) from error


def _without_places(output: str) -> str:
    """urdfdom's sentences, each once, without the lines of its own source that it names behind each."""
    sentences = [sentence.strip().removeprefix("Error:").strip() for sentence in _PLACE_IN_URDFDOM.split(output)]
    return "; ".join(dict.fromkeys(filter(None, sentences)))


# ---- bodies and joints -----------------------------------------------------------------------------------------------


class _Link(Struct, frozen=True, eq=False):
    """A BODY frame of Pinocchio with the frame of its joint and the index of its parent's BODY frame."""

    frame: Any
    joint: Any | None
    parent: int

    @property
    def is_fixed(self) -> bool:
        """Whether its joint has no dofs."""
        return self.joint is not None and bool(self.joint.type == pin.FrameType.FIXED_JOINT)


def _links(model: Any) -> dict[int, _Link]:
    """By the index of their BODY frame."""
    found: dict[int, _Link] = {}
    for index, frame in enumerate(model.frames):
        if frame.type == pin.FrameType.BODY:
            joint = model.frames[frame.parentFrame] if frame.parentFrame else None
            found[index] = _Link(frame, joint, -1 if joint is None else joint.parentFrame)
    return found


def _bodies(model: Any, second: Second) -> tuple[Body, ...]:
    """The links as bodies under the world. A massless root link called ``world`` is the world itself."""
    links = _links(model)
    moving = _moving_inertias(model, links)
    children: dict[int, list[int]] = {}
    for index, link in links.items():
        children.setdefault(link.parent, []).append(index)
    numbers: dict[int, int] = {}
    bodies: list[Body] = [world_body()]
    for index in parents_first(children.get(-1, ()), children):
        link = links[index]
        name = str(link.frame.name)
        mass, com, tensor = moving.get(index) or _split(link.joint.inertia if link.joint is not None else link.frame.inertia)
        shapes = (second.shapes or {}).get(name, ())
        if link.joint is None and name == "world" and mass == 0.0:
            numbers[index] = WORLD
            bodies[WORLD] = world_body(shapes=shapes)
            continue
        joint = Joint(open=True) if link.joint is None else _joint(model, link.joint, links[link.parent].frame)
        numbers[index] = len(bodies)
        bodies.append(Body(name, numbers.get(link.parent, WORLD), joint, mass, com, tensor, shapes))
    return tuple(bodies)


def _joint(model: Any, joint: Any, parent: Any) -> Joint:
    """A joint by its frame and the BODY frame of the parent."""
    back = inverse(parent.placement.homogeneous)
    if joint.type == pin.FrameType.FIXED_JOINT:
        return Joint(str(joint.name), back @ joint.placement.homogeneous)
    return Joint(str(joint.name), back @ model.jointPlacements[joint.parentJoint].homogeneous, _dofs(model, joint.parentJoint))


def _dofs(model: Any, number: int) -> tuple[Dof, ...]:
    """The dofs of one of Pinocchio's joints; unbounded ones are coordinates on a circle there."""
    joint = model.joints[number]
    kind = joint.shortname().removeprefix("JointModel")
    x, y, z = np.eye(3)
    if kind == "FreeFlyer":
        return (Dof(Kind.FREE, z),)
    if kind == "Planar":
        return (Dof(Kind.SLIDE, x), Dof(Kind.SLIDE, y), Dof(Kind.HINGE, z))
    q, v = joint.idx_q, joint.idx_v
    bounded = joint.nq == 1
    return (
        Dof(
            Kind.SLIDE if kind.startswith("P") else Kind.HINGE,
            _axis(model, joint),
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
    """The unit axis of a joint with one dof, from its motion subspace: not every joint type has an axis by name."""
    data = joint.createData()
    joint.calc(data, pin.neutral(model))
    motion = np.array(data.S, dtype=float).reshape(6)
    axis = motion[:3] + motion[3:]  # one half is zero: a joint with one dof turns or slides
    length = float(np.linalg.norm(axis))
    unit: Array = axis / length if length > 0 else axis
    return unit


# ---- inertia ---------------------------------------------------------------------------------------------------------


def _split(inertia: Any) -> Inertia:
    return float(inertia.mass), np.array(inertia.lever, dtype=float), np.array(inertia.inertia, dtype=float)


def _moving_inertias(model: Any, links: dict[int, _Link]) -> dict[int, Inertia]:
    """The inertia of each link with a moving joint: Pinocchio's sum for the joint without the links fixed to it."""
    fixed: dict[int, list[Inertia]] = {}
    for link in links.values():
        if link.is_fixed and link.joint is not None:
            inertia = link.joint.inertia
            if inertia.mass != 0.0 or inertia.inertia.any():  # Pinocchio adds a tensor without a mass all the same
                fixed.setdefault(link.joint.parentJoint, []).append(_split(link.joint.placement.act(inertia)))
    moving = {i: link.joint.parentJoint for i, link in links.items() if link.joint is not None and link.joint.type == pin.FrameType.JOINT}
    return {index: _without(_split(model.inertias[number]), fixed.get(number, [])) for index, number in moving.items()}


def _without(total: Inertia, parts: list[Inertia]) -> Inertia:
    """What is left of a rigid body's mass, centre and tensor without its parts; rounding dust counts as nothing."""
    if not parts:
        return total
    mass = total[0] - sum(part[0] for part in parts)
    about_origin = shifted_tensor(*total) - sum((shifted_tensor(*part) for part in parts), np.zeros((3, 3)))
    if abs(mass) <= _DUST * total[0]:
        dust = _DUST * np.abs(shifted_tensor(*total)).max(initial=0.0)
        return 0.0, np.zeros(3), np.where(np.abs(about_origin) <= dust, 0.0, about_origin)
    com = (total[0] * total[1] - sum((part[0] * part[1] for part in parts), np.zeros(3))) / mass
    return mass, com, shifted_tensor(-mass, com, about_origin)


# ---- mimic -----------------------------------------------------------------------------------------------------------


def _couplings(text: str, found: KinematicModel, second: Second) -> tuple[tuple[Coupling, ...], list[str]]:
    """The mimic joints by urdfdom; by yourdfpy where Pinocchio cannot build them (the leader is its follower's descendant, or later)."""
    if not second.mimics and "<mimic" not in text:
        return (), []
    dofs = {dof.name: index for index, dof in enumerate(found.dofs) if dof.name is not None}
    try:
        model = pin.buildModelFromXML(text, True)
    except (ValueError, RuntimeError, IndexError) as error:
        reason = " ".join(str(error).split())
        known = [coupling for mimic in second.mimics if (coupling := _second_coupling(mimic, found, dofs)) is not None]
        return tuple(known), [f"mimic joints are read by yourdfpy alone: Pinocchio refuses them with '{reason}'"]
    return tuple(_coupling(model, pair, dofs) for pair in zip(model.mimicking_joints, model.mimicked_joints, strict=True)), []


def _second_coupling(mimic: Mimic, found: KinematicModel, dofs: Mapping[str, int]) -> Coupling | None:
    """As yourdfpy reads it. The coordinate of a fixed leader is 0; a follower that is fixed follows nothing."""
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
