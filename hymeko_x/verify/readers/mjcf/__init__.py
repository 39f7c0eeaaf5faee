"""MJCF as MuJoCo compiles it: everything is read from the arrays of the mjModel.

MuJoCo's own ``mj_kinematics`` must agree with the model that is read here, or the file is not comparable.
Source: MuJoCo's mjmodel.h.
"""

from __future__ import annotations

import contextlib
import warnings
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.verify.features import Feature
from hymeko_x.verify.kinematics import disagreement
from hymeko_x.verify.model import INF, WORLD, Array, Body, Dof, Joint, Kind, KinematicModel, Role, Shape, Surface, world_body
from hymeko_x.verify.readers import in_own_thread, native_output
from hymeko_x.verify.readers.bounded import hint_for
from hymeko_x.verify.readers.mjcf.constraints import (
    SENSOR_KINDS,
    read_actuators,
    read_couplings,
    read_loops,
    read_sensors,
    read_tied_tendons,
)
from hymeko_x.verify.readers.mjcf.forces import driven_joints
from hymeko_x.verify.readers.mjcf.tendons import read_tendons
from hymeko_x.verify.spatial import pose, quat_from_rotation, rigid, rotation_from_quat

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from hymeko_x.verify.readers.lookup import Lookup

FEATURES = frozenset(Feature) - {
    Feature.VELOCITY_LIMITS,
    Feature.FIXED_JOINT_NAMES,
    Feature.FLAT_COLLISIONS,
    Feature.SLIDING_LOOPS,
    Feature.SCREW_LOOPS,
}

_KINDS = {
    int(mujoco.mjtJoint.mjJNT_FREE): Kind.FREE,
    int(mujoco.mjtJoint.mjJNT_BALL): Kind.BALL,
    int(mujoco.mjtJoint.mjJNT_SLIDE): Kind.SLIDE,
    int(mujoco.mjtJoint.mjJNT_HINGE): Kind.HINGE,
}
_HIDDEN_FROM = 3  # geom groups that the viewer does not draw by default


def read(path: Path, lookup: Lookup) -> KinematicModel:
    """The robot that MuJoCo compiles. Raises: Refusal HX302 in MuJoCo's words."""
    with native_output() as output, _without_log_file():
        try:
            compiled = in_own_thread(lambda: _compiled(path))
        except (ValueError, RuntimeError, mujoco.FatalError) as error:
            reason = " ".join(str(error).split()) or output()
            message = f"MuJoCo refuses {path.name}: {reason}"
            raise refuse(codes.ENGINE_REFUSED, message, Origin(str(path)), hint=hint_for(error)) from error
    found = from_compiled(compiled)
    difference = disagreement(found, lambda q: np.stack([_engine_poses(compiled, row) for row in engine_coordinates(found, q)]))
    if difference:
        raise refuse(codes.ENGINE_REFUSED, f"MuJoCo's own kinematics disagree with its compiled model: {difference}", Origin(str(path)))
    return found


def _compiled(path: Path) -> Any:
    """The mjModel of the whole file: bodies without joints are not fused with their parents, visual geoms are kept."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of attributes that MuJoCo is about to drop, which still work
        spec = _spec(path)
        spec.compiler.fusestatic = False
        spec.compiler.discardvisual = False
        return spec.compile()


def _spec(path: Path) -> Any:
    """The model in the file, with what it includes. MuJoCo reads no suffix but `.xml`; a file with another one is passed as text."""
    if path.suffix.lower() == ".xml":
        return mujoco.MjSpec.from_file(str(path))
    name = f"{path}.xml"
    return mujoco.MjSpec.from_file(name, include={name: path.read_bytes()})


@contextlib.contextmanager
def _without_log_file() -> Iterator[None]:
    """MuJoCo appends its warnings to MUJOCO_LOG.TXT in the current folder unless a handler is set."""
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda text: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)


def from_compiled(compiled: Any) -> KinematicModel:
    """The robot in an mjModel."""
    joint_dofs: dict[int, int] = {}
    forces = driven_joints(compiled)
    bodies = [world_body(shapes=tuple(_shapes(compiled, WORLD)))]
    for index in range(1, compiled.nbody):
        bodies.append(_body(compiled, index, joint_dofs, forces))
    return KinematicModel(
        name=compiled.names[: compiled.names.find(b"\0")].decode("utf-8", "replace"),
        format="mjcf",
        engine=f"MuJoCo {mujoco.__version__}",
        bodies=tuple(bodies),
        couplings=tuple(read_couplings(compiled, joint_dofs)),
        loops=tuple(read_loops(compiled)),
        actuators=tuple(read_actuators(compiled)),
        sensors=tuple(read_sensors(compiled)),
        sensor_kinds=SENSOR_KINDS,
        tendons=tuple(read_tendons(compiled, joint_dofs)) if compiled.ntendon else (),
        tied_tendons=tuple(read_tied_tendons(compiled)),
        features=FEATURES,
    )


def _body(compiled: Any, index: int, joint_dofs: dict[int, int], forces: Mapping[int, float]) -> Body:
    first, count = int(compiled.body_jntadr[index]), int(compiled.body_jntnum[index])
    dofs = [_dof(compiled, joint, forces) for joint in range(first, first + count)]
    number = next(reversed(joint_dofs.values()), -1) + 1
    if int(compiled.body_parentid[index]) and _floats(dofs):
        dofs = [Dof(Kind.FREE, np.array([0.0, 0.0, 1.0]))]
    joint_dofs |= {joint: number + min(joint - first, len(dofs) - 1) for joint in range(first, first + count)}
    turn = rotation_from_quat(compiled.body_iquat[index])
    name = dofs[0].name if len(dofs) == 1 else None
    return Body(
        name=compiled.body(index).name or None,
        parent=int(compiled.body_parentid[index]),
        joint=Joint(name, pose(compiled.body_pos[index], compiled.body_quat[index]), tuple(dofs)),
        mass=float(compiled.body_mass[index]),
        com=np.array(compiled.body_ipos[index]),
        tensor=turn @ np.diag(compiled.body_inertia[index]) @ turn.T,
        shapes=tuple(_shapes(compiled, index)),
    )


def _floats(dofs: list[Dof]) -> bool:
    """Whether a child of a body moves freely, which MJCF represents by three slides and a ball: the same seven coordinates."""
    if [dof.kind for dof in dofs] != [Kind.SLIDE, Kind.SLIDE, Kind.SLIDE, Kind.BALL]:
        return False
    plain = (Dof(dof.kind, axis, name=dof.name) for dof, axis in zip(dofs, (*np.eye(3), dofs[3].axis), strict=True))
    return all(repr(dof) == repr(other) for dof, other in zip(dofs, plain, strict=True))


def _dof(compiled: Any, joint: int, forces: Mapping[int, float]) -> Dof:
    kind = _KINDS[int(compiled.jnt_type[joint])]
    v, q = int(compiled.jnt_dofadr[joint]), int(compiled.jnt_qposadr[joint])
    limited, forced = bool(compiled.jnt_limited[joint]), bool(compiled.jnt_actfrclimited[joint])
    lower, upper = compiled.jnt_range[joint] if limited else (-INF, INF)
    strongest = compiled.jnt_actfrcrange[joint] if forced else (-INF, INF)
    return Dof(
        kind=kind,
        axis=np.array(compiled.jnt_axis[joint]),
        anchor=np.zeros(3) if kind is Kind.FREE else np.array(compiled.jnt_pos[joint]),
        ref=float(compiled.qpos0[q]) if kind.scalar else 0.0,
        name=compiled.joint(joint).name or None,
        lower=float(lower),
        upper=float(upper),
        effort=(float(strongest[0]), float(strongest[1])),
        driven=forces.get(joint, INF),
        damping=float(compiled.dof_damping[v]),
        friction=float(compiled.dof_frictionloss[v]),
        armature=float(compiled.dof_armature[v]),
        stiffness=float(compiled.jnt_stiffness[joint]),
        spring_ref=float(compiled.qpos_spring[q]) if kind.scalar and compiled.jnt_stiffness[joint] else 0.0,
        nonlinear=_nonlinear(compiled, joint, v),
    )


def _nonlinear(compiled: Any, joint: int, v: int) -> tuple[float, ...]:
    """The higher coefficients of damping and stiffness, or nothing when all are zero."""
    values = (*compiled.dof_dampingpoly[v], *compiled.jnt_stiffnesspoly[joint], compiled.jnt_springyield[joint])
    return tuple(float(x) for x in values) if any(values) else ()


# ---- shapes ----------------------------------------------------------------------------------------------------------


def _shapes(compiled: Any, body: int) -> Iterator[Shape]:
    first = int(compiled.body_geomadr[body])
    for geom in range(first, first + int(compiled.body_geomnum[body])):
        kind, size, mesh = _geometry(compiled, geom)
        yield Shape(
            kind,
            _role(compiled, geom),
            pose(compiled.geom_pos[geom], compiled.geom_quat[geom]),
            size,
            compiled.geom(geom).name or None,
            mesh,
        )


def _role(compiled: Any, geom: int) -> Role:
    """A geom without contact bits is only drawn (by convention); one in a hidden group only collides."""
    if not compiled.geom_contype[geom] and not compiled.geom_conaffinity[geom]:
        return Role.VISUAL
    return Role.COLLISION if compiled.geom_group[geom] >= _HIDDEN_FROM else Role.BOTH


def _geometry(compiled: Any, geom: int) -> tuple[str, tuple[float, ...], Surface | None]:
    """Kind, size in this project's terms (MuJoCo gives half lengths), and the triangles of a mesh."""
    kind = mujoco.mjtGeom(int(compiled.geom_type[geom])).name.removeprefix("mjGEOM_").lower()
    a, b, c = (float(x) for x in compiled.geom_size[geom])
    match kind:
        case "box":
            return kind, (2 * a, 2 * b, 2 * c), None
        case "sphere":
            return kind, (a,), None
        case "cylinder" | "capsule":
            return kind, (a, 2 * b), None
        case "ellipsoid":
            return kind, (a, b, c), None
        case "mesh" | "sdf":
            return "mesh", (), _surface(compiled, int(compiled.geom_dataid[geom]))
        case "hfield":
            return kind, tuple(float(x) for x in compiled.hfield_size[int(compiled.geom_dataid[geom])]), None
        case _:
            return kind, (), None


def _surface(compiled: Any, mesh: int) -> Surface:
    """The triangles as compiled: centred and turned to principal axes, which the geom's pose undoes."""
    vertices, faces = int(compiled.mesh_vertadr[mesh]), int(compiled.mesh_faceadr[mesh])
    return Surface(
        np.array(compiled.mesh_vert[vertices : vertices + int(compiled.mesh_vertnum[mesh])], dtype=float),
        np.array(compiled.mesh_face[faces : faces + int(compiled.mesh_facenum[mesh])], dtype=np.intp),
    )


# ---- the engine's own kinematics -------------------------------------------------------------------------------------


def engine_coordinates(found: KinematicModel, q: Array) -> Array:
    """The same configurations as MuJoCo's qpos: its free joints count from the world, ours from their initial pose."""
    qpos = q.copy()
    for dof, column, body in zip(found.dofs, found.columns, found.body_of_dof, strict=True):
        if dof.kind is not Kind.FREE or found.bodies[body].parent:
            continue
        placed = found.bodies[body].joint.placement @ rigid(rotation_from_quat(q[:, column + 3 : column + 7]), q[:, column : column + 3])
        qpos[:, column : column + 3] = placed[:, :3, 3]
        qpos[:, column + 3 : column + 7] = quat_from_rotation(placed[:, :3, :3])
    return qpos


def _engine_poses(compiled: Any, qpos: Array) -> Array:
    data = mujoco.MjData(compiled)
    data.qpos[:] = qpos
    mujoco.mj_kinematics(compiled, data)
    return rigid(data.xmat.reshape(-1, 3, 3).copy(), data.xpos.copy())
