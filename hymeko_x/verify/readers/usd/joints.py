"""Joints of UsdPhysics: two bodies, a frame on each, and the dofs between the frames."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from pxr import UsdPhysics

from hymeko_x.verify.model import INF, Array, Coupling, Dof, Joint, Kind, KinematicModel, Loop, between_frames
from hymeko_x.verify.readers.usd.scene import number_of, targets_of, value_of
from hymeko_x.verify.spatial import frame_with_z, rigid, rotation_from_quat

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.verify.readers.usd.scene import MeasuredStage

_AXES = {UsdPhysics.Axis.X: 0, UsdPhysics.Axis.Y: 1, UsdPhysics.Axis.Z: 2}
_DOF = UsdPhysics.JointDOF
_SAME_REST = 1e-5  # m and as a matrix entry; frames are stored as floats
_D6 = (
    (_DOF.TransX, Kind.SLIDE, 0),
    (_DOF.TransY, Kind.SLIDE, 1),
    (_DOF.TransZ, Kind.SLIDE, 2),
    (_DOF.RotX, Kind.HINGE, 0),
    (_DOF.RotY, Kind.HINGE, 1),
    (_DOF.RotZ, Kind.HINGE, 2),
)


class JointEdge(Struct, frozen=True, eq=False):
    """One joint: bodies by path ("" is the world), the joint's frame on each, and dofs in that frame.

    ``more`` are joints that add their dofs to it. ``closes`` marks a joint that the file leaves out of the articulation;
    ``closure`` is its kind as a loop.
    """

    path: str
    name: str
    parent: str
    child: str
    parent_pose: Array
    child_pose: Array
    dofs: tuple[Dof, ...]
    closes: bool
    closure: str
    more: tuple[JointEdge, ...] = ()

    def stacks(self, other: JointEdge) -> bool:
        """Whether another joint adds its dofs to this one: between the same bodies, in the same pose at rest.

        UsdPhysics has no joint with several free axes in a given order; this is how mujoco-usd-converter and Newton write one.
        """
        if (self.parent, self.child) != (other.parent, other.child) or not (self.dofs and other.dofs) or other.closes:
            return False
        rest = self.parent_pose @ np.linalg.inv(self.child_pose), other.parent_pose @ np.linalg.inv(other.child_pose)
        return bool(np.abs(rest[0] - rest[1]).max() < _SAME_REST)

    def with_more(self, other: JointEdge) -> JointEdge:
        """The same joint with the dofs of another one behind its own."""
        return replace(self, more=(*self.more, other))

    def turned(self) -> JointEdge:
        """The same joint seen from the other body: motion and axes change sense."""
        dofs = tuple(_reversed(dof) for dof in reversed(self.dofs))
        return replace(self, parent=self.child, child=self.parent, parent_pose=self.child_pose, child_pose=self.parent_pose, dofs=dofs)

    def joint(self) -> Joint:
        """The joint with its dofs in the frame of the child body."""
        own = between_frames(self.name, self.parent_pose, self.dofs, self.child_pose)
        others = [between_frames(edge.name, edge.parent_pose, edge.dofs, edge.child_pose) for edge in self.more]
        name = self.name if not others else None
        return replace(own, name=name, dofs=(*own.dofs, *(dof for joint in others for dof in joint.dofs)))


def _reversed(dof: Dof) -> Dof:
    """M(q)^-1 is a motion by q about the opposite axis."""
    return replace(dof, axis=-dof.axis)


def read_joint(scene: MeasuredStage, desc: Any, name: str) -> JointEdge:
    """A joint of the parser, in SI units."""
    parent, child = _path(desc.body0), _path(desc.body1)
    poses = (
        _local(scene, desc.localPose0Position, desc.localPose0Orientation, not parent),
        _local(scene, desc.localPose1Position, desc.localPose1Orientation, not child),
    )
    dofs, closure = _dofs(scene, desc, name)
    return JointEdge(str(desc.primPath), name, parent, child, *poses, dofs, bool(desc.excludeFromArticulation), closure)


def _path(path: Any) -> str:
    return "" if path.isEmpty else str(path)


def _local(scene: MeasuredStage, position: Any, orientation: Any, in_world: bool) -> Array:
    quat = np.array([orientation.GetReal(), *orientation.GetImaginary()], dtype=float)
    frame = rigid(rotation_from_quat(quat), np.array(position, dtype=float) * scene.metres)
    return rigid(scene.upright, np.zeros(3)) @ frame if in_world else frame


def _dofs(scene: MeasuredStage, desc: Any, name: str) -> tuple[tuple[Dof, ...], str]:
    """The dofs, and the kind of closure that the joint would be."""
    kinds = UsdPhysics.ObjectType
    match desc.type:
        case kinds.FixedJoint:
            return (), "weld"
        case kinds.RevoluteJoint:
            dof = _scalar(Kind.HINGE, _AXES[desc.axis], desc.limit, math.radians(1.0), name)
            return (_counted(scene, desc, dof, math.radians(1.0)),), "hinge"
        case kinds.PrismaticJoint:
            dof = _scalar(Kind.SLIDE, _AXES[desc.axis], desc.limit, scene.metres, name)
            return (_counted(scene, desc, dof, scene.metres),), "slide"
        case kinds.SphericalJoint:
            return (Dof(Kind.BALL, np.eye(3)[_AXES[desc.axis]], name=name),), "connect"
        case kinds.D6Joint:
            return _d6(scene, desc, name)
        case _:
            return (), "other"


def _counted(scene: MeasuredStage, desc: Any, dof: Dof, unit: float) -> Dof:
    """The dof with the coordinate that it has where both frames coincide, by MjcJointAPI; its limits are coordinates of that kind.

    Source: Newton's importer, which takes `mjc:ref` off the limits; mujoco-usd-converter, which writes them so.
    """
    attribute = scene.stage.GetPrimAtPath(desc.primPath).GetAttribute("mjc:ref")
    return replace(dof, ref=float(attribute.Get() or 0.0) * unit) if attribute else dof


def _scalar(kind: Kind, axis: int, limit: Any, unit: float, name: str | None) -> Dof:
    lower, upper = float(limit.lower), float(limit.upper)  # ``enabled`` is only set where both are finite; the schema allows one
    if lower > upper:
        lower, upper = -INF, INF
    return Dof(kind, np.eye(3)[axis], name=name, lower=lower * unit, upper=upper * unit)


def _d6(scene: MeasuredStage, desc: Any, name: str) -> tuple[tuple[Dof, ...], str]:
    """Free and limited axes as slides and hinges in the order x, y, z; three free turns are a ball."""
    limits = {pair.first: pair.second for pair in desc.jointLimits}
    free = [item for item in _D6 if not (item[0] in limits and limits[item[0]].lower > limits[item[0]].upper)]
    turns = [item for item in free if item[1] is Kind.HINGE]
    ball = len(turns) == 3 and not any(item[0] in limits for item in turns)
    if ball and len(free) == 3:
        return (Dof(Kind.BALL, np.eye(3)[0], name=name),), "connect"
    if ball and len(free) == 6 and not limits:
        return (Dof(Kind.FREE, np.eye(3)[2], name=name),), "other"
    single = name if len(free) == 1 else None
    dofs = [_d6_dof(scene, item, limits.get(item[0]), single) for item in free if not (ball and item[1] is Kind.HINGE)]
    dofs += [Dof(Kind.BALL, np.eye(3)[0])] if ball else []
    return tuple(dofs), {0: "weld", 1: "hinge" if turns else "slide"}.get(len(free), "other")


def _d6_dof(scene: MeasuredStage, item: tuple[Any, Kind, int], limit: Any, name: str | None) -> Dof:
    _, kind, axis = item
    if limit is None:
        return Dof(kind, np.eye(3)[axis], name=name)
    return _scalar(kind, axis, limit, scene.metres if kind is Kind.SLIDE else math.radians(1.0), name)


# ---- loops -----------------------------------------------------------------------------------------------------------


def read_loop(edge: JointEdge, body_a: int, body_b: int) -> Loop:
    """A joint that closes a cycle; z of its frames is the axis that stays free."""
    axis = edge.dofs[0].axis if edge.closure in ("hinge", "slide") else np.array([0.0, 0.0, 1.0])
    along = frame_with_z(axis)
    words = " ".join(dof.kind.value for dof in edge.dofs) if edge.closure == "other" else ""
    return Loop(edge.closure, body_a, edge.parent_pose @ along, body_b, edge.child_pose @ along, edge.name, words)


# ---- couplings -------------------------------------------------------------------------------------------------------


def read_couplings(scene: MeasuredStage, model: KinematicModel, tree: Mapping[str, JointEdge]) -> KinematicModel:
    """The model with the couplings by NewtonMimicAPI and MjcEqualityJointAPI.

    Source: Newton's importer, where MjcEqualityJointAPI adds the powers above the first; its names of leader and lower coefficients
    are older, and are read where NewtonMimicAPI has none.
    """
    paths = {edge.path: edge for first in tree.values() for edge in (first, *first.more)}
    dofs = dof_names(model)
    found = [coupling for path in paths if (coupling := _coupling(scene, path, paths, dofs)) is not None]
    return replace(model, couplings=tuple(found))


def dof_names(model: KinematicModel) -> dict[str, int]:
    """The dof of each name."""
    return {dof.name: index for index, dof in enumerate(model.dofs) if dof.name is not None}


def _coupling(scene: MeasuredStage, path: str, paths: Mapping[str, JointEdge], dofs: Mapping[str, int]) -> Coupling | None:
    prim = scene.stage.GetPrimAtPath(path)
    follower = dofs.get(paths[path].name)
    if follower is None:
        return None
    leader = _leader(prim, "newton:mimicJoint", paths, dofs) or _leader(prim, "mjc:target", paths, dofs)
    if leader is None or value_of(prim, "newton:mimicEnabled") is False:
        return None
    others = [_first(prim, ("newton:mimicCoef1", "mjc:coef1"), 1.0), *(number_of(prim, f"mjc:coef{k}", 0.0) for k in (2, 3, 4))]
    while len(others) > 1 and others[-1] == 0.0:
        others.pop()
    return Coupling(follower, _constant(scene, prim, paths[path]), ((leader[1], tuple(others)),))


def _constant(scene: MeasuredStage, prim: Any, edge: JointEdge) -> float:
    """The constant of a coupling: Newton's is a coordinate of the follower in the file, MuJoCo's in rad or m."""
    if not prim.HasAttribute("newton:mimicCoef0"):
        return number_of(prim, "mjc:coef0", 0.0)
    unit = scene.metres if edge.dofs[0].kind is Kind.SLIDE else math.radians(1.0)
    return number_of(prim, "newton:mimicCoef0", 0.0) * unit


def _first(prim: Any, names: tuple[str, ...], default: float) -> float:
    return next((number_of(prim, name, default) for name in names if prim.HasAttribute(name)), default)


def _leader(prim: Any, name: str, paths: Mapping[str, JointEdge], dofs: Mapping[str, int]) -> tuple[str, int] | None:
    known = [target for target in targets_of(prim, name) if target in paths and paths[target].name in dofs]
    return (known[0], dofs[paths[known[0]].name]) if known else None
