"""The trees of a kinematic model built natively in Pinocchio: their forward kinematics, mass matrix and gravity torque.

Every dof becomes one joint of Pinocchio's, with massless links between several dofs of one joint, in
depth-first order. Couplings and loops are left out: they constrain the tree's
coordinates and do not change them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin
from msgspec import Struct

from hymeko_x.verify.model import WORLD, Array, Body, Dof, Index, Kind, KinematicModel

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

GRAVITY = (0.0, 0.0, -9.81)
"""In m/s^2, in the world."""

VELOCITIES = {Kind.HINGE: 1, Kind.SLIDE: 1, Kind.SCREW: 1, Kind.BALL: 3, Kind.FREE: 6}
"""The number of velocity coordinates of each kind of dof."""


class PinocchioModel(Struct, frozen=True, eq=False):
    """One tree of a model in Pinocchio.

    ``frames`` holds the frame of each body and ``joints`` the joint of each dof; pinned bodies have no joints.
    """

    model: Any
    data: Any
    source: KinematicModel
    frames: Mapping[int, int]
    joints: Mapping[int, int]

    def configurations(self, q: Array) -> Array:
        """Configurations (n, width) in Pinocchio's coordinates: displacements, and quaternions as (x, y, z, w)."""
        out = np.broadcast_to(pin.neutral(self.model), (len(q), self.model.nq)).copy()
        for index, joint in self.joints.items():
            dof, column = self.source.dofs[index], self.source.columns[index]
            at = self.model.joints[joint].idx_q
            if dof.kind.scalar:
                out[:, at] = q[:, column] - dof.ref
            elif dof.kind is Kind.BALL:
                out[:, at : at + 4] = _xyzw(q[:, column : column + 4])
            else:
                out[:, at : at + 3] = q[:, column : column + 3]
                out[:, at + 3 : at + 7] = _xyzw(q[:, column + 3 : column + 7])
        return out

    def poses(self, q: Array) -> Array:
        """World poses (n, bodies, 4, 4) of the tree's bodies, in the order of ``frames``, at configurations (n, width)."""
        out = np.empty((len(q), len(self.frames), 4, 4))
        for row, values in enumerate(self.configurations(q)):
            pin.framesForwardKinematics(self.model, self.data, values)
            out[row] = [self.data.oMf[frame].homogeneous for frame in self.frames.values()]
        return out

    def dynamics(self, q: Array, columns: Index) -> Iterator[tuple[Array, Array]]:
        """Mass matrix and gravity torque of these velocity columns at each configuration (n, width), without armature."""
        chosen = np.ix_(columns, columns)
        lower = np.tri(self.model.nv, k=-1, dtype=bool)
        for values in self.configurations(q):
            mass = np.array(pin.crba(self.model, self.data, values))  # only its upper triangle is filled
            np.copyto(mass, mass.T, where=lower)
            gravity = np.array(pin.computeGeneralizedGravity(self.model, self.data, values))
            yield mass[chosen], gravity[columns]

    def columns(self, dofs: Sequence[int]) -> Index:
        """The velocity columns of these dofs, in their order."""
        starts = [(self.model.joints[self.joints[dof]].idx_v, VELOCITIES[self.source.dofs[dof].kind]) for dof in dofs]
        return np.array([start + k for start, count in starts for k in range(count)], dtype=np.intp)


def _xyzw(quat: Array) -> Array:
    turned: Array = np.roll(quat / np.linalg.norm(quat, axis=-1, keepdims=True), -1, axis=-1)
    return turned


def build(
    model: KinematicModel, root: int, *, pinned: frozenset[int] = frozenset(), massless: frozenset[int] = frozenset()
) -> PinocchioModel:
    """The tree of ``root`` in Pinocchio.

    Bodies in ``pinned`` are on the world's frame without dofs, those in ``massless`` have no mass.
    """
    native = pin.Model()
    native.gravity = pin.Motion(np.array([*GRAVITY, 0.0, 0.0, 0.0]))
    at: dict[int, tuple[int, Array]] = {WORLD: (0, np.eye(4))}
    joints: dict[int, int] = {}
    frames: dict[int, int] = {}
    stack = [root]
    while stack:
        index = stack.pop()
        number, place = at[model.bodies[index].parent]
        if index not in pinned:
            number, place = _add_body_joint(native, model, index, (number, place), joints)
        at[index] = (number, place)
        frames[index] = native.addFrame(pin.Frame(str(index), number, 0, _se3(place), pin.FrameType.OP_FRAME))
        if index not in massless:
            _append_inertia(native, model.bodies[index], number, place)
        stack.extend(reversed(model.children[index]))
    return PinocchioModel(native, native.createData(), model, frames, joints)


def _add_body_joint(native: Any, model: KinematicModel, index: int, at: tuple[int, Array], joints: dict[int, int]) -> tuple[int, Array]:
    """The joint of a body, whose parent is at this place in a joint of Pinocchio's: the same for the body."""
    number, place = at
    joint = model.bodies[index].joint
    place = place @ joint.placement
    for dof, data in enumerate(joint.dofs, start=model.first_dof[index]):
        number, place = _add_joint(native, number, place, data, str(dof))
        joints[dof] = number
    return number, place


def _append_inertia(native: Any, body: Body, number: int, place: Array) -> None:
    """Field by field: Pinocchio's constructor refuses tensors that are not positive, which real files contain."""
    if body.mass == 0.0 and not body.tensor.any():
        return
    inertia = pin.Inertia.Zero()
    tensor = (body.tensor + body.tensor.T) / 2.0  # Pinocchio refuses asymmetry, and a rotated diagonal is symmetric up to rounding
    inertia.mass, inertia.lever, inertia.inertia = body.mass, body.com, tensor
    native.appendBodyToJoint(number, inertia, _se3(place))


def _add_joint(native: Any, parent: int, place: Array, dof: Dof, name: str) -> tuple[int, Array]:
    """One dof at ``place`` (in the parent joint): the new joint, and the pose of the body's frame in it."""
    anchored = place.copy()
    anchored[:3, 3] += place[:3, :3] @ dof.anchor
    number = native.addJoint(parent, _joint_model(dof), _se3(anchored), name)
    back = np.eye(4)
    back[:3, 3] = -dof.anchor
    return number, back


def _joint_model(dof: Dof) -> Any:
    match dof.kind:
        case Kind.HINGE:
            return pin.JointModelRevoluteUnaligned(dof.axis)
        case Kind.SLIDE:
            return pin.JointModelPrismaticUnaligned(dof.axis)
        case Kind.SCREW:
            return pin.JointModelHelicalUnaligned(dof.axis, dof.pitch)
        case Kind.BALL:
            return pin.JointModelSpherical()
        case Kind.FREE:
            return pin.JointModelFreeFlyer()


def _se3(transform: Array) -> Any:
    return pin.SE3(np.ascontiguousarray(transform[:3, :3]), np.ascontiguousarray(transform[:3, 3]))
