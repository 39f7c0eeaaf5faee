"""A small writer of UsdPhysics for tests, straight from a kinematic model, so that the verifier has something to read.

It puts joint frames where the test wants them and knows nothing of this project's own backend.
"""

from __future__ import annotations

import math

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics

from hymeko_x.verify.kinematics import prepare
from hymeko_x.verify.model import WORLD, Array, Body, Dof, Kind, KinematicModel, Role, Shape
from hymeko_x.verify.spatial import quat_from_rotation

AXES = {(1.0, 0.0, 0.0): "X", (0.0, 1.0, 0.0): "Y", (0.0, 0.0, 1.0): "Z"}
KINDS = {Kind.HINGE: UsdPhysics.RevoluteJoint, Kind.SLIDE: UsdPhysics.PrismaticJoint}
SHAPES = {"box": UsdGeom.Cube, "sphere": UsdGeom.Sphere, "cylinder": UsdGeom.Cylinder}


def usd_of(model: KinematicModel, *, metres: float = 1.0, kilograms: float = 1.0) -> str:
    """The stage as text: bodies as siblings, one joint above each, bases free."""
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageMetersPerUnit(stage, metres)
    UsdPhysics.SetStageKilogramsPerUnit(stage, kilograms)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/robot").GetPrim())
    rest = np.zeros((1, model.width))
    for dof, column in zip(model.dofs, model.columns, strict=True):
        rest[0, column + dof.kind.width - 1 if dof.kind.scalar else column + dof.kind.width - 4] = dof.ref if dof.kind.scalar else 1.0
    poses = prepare(model).poses(rest)[0]
    for index, body in enumerate(model.bodies[1:], start=1):
        write_body(stage, body, poses[index], metres, kilograms)
    for body in model.bodies[1:]:
        if body.parent != WORLD:
            write_joints(stage, model, body, metres)
    for coupling in model.couplings:
        follower, (leader, (slope,)) = model.dofs[coupling.follower], coupling.leaders[0]
        prim = stage.GetPrimAtPath(f"/robot/joints/{follower.name}")
        prim.CreateRelationship("newton:mimicJoint").SetTargets([f"/robot/joints/{model.dofs[leader].name}"])
        prim.CreateAttribute("newton:mimicCoef0", Sdf.ValueTypeNames.Float).Set(coupling.constant / metres)
        prim.CreateAttribute("newton:mimicCoef1", Sdf.ValueTypeNames.Float).Set(slope)
    return str(stage.GetRootLayer().ExportToString())


def write_body(stage: Usd.Stage, body: Body, pose: Array, metres: float, kilograms: float) -> None:
    path = f"/robot/{body.name}"
    prim = UsdGeom.Xform.Define(stage, path)
    place(prim, pose, metres)
    UsdPhysics.RigidBodyAPI.Apply(prim.GetPrim())
    mass = UsdPhysics.MassAPI.Apply(prim.GetPrim())
    mass.CreateMassAttr(body.mass / kilograms)
    moments, axes = np.linalg.eigh(body.tensor)
    axes = axes * np.sign(np.linalg.det(axes))
    mass.CreateCenterOfMassAttr(Gf.Vec3f(*(body.com / metres).tolist()))
    mass.CreateDiagonalInertiaAttr(Gf.Vec3f(*(moments / kilograms / metres**2).tolist()))
    mass.CreatePrincipalAxesAttr(quatf(axes))
    for number, shape in enumerate(body.shapes):
        write_shape(stage, f"{path}/shape_{number}", shape, metres)


def write_shape(stage: Usd.Stage, path: str, shape: Shape, metres: float) -> None:
    prim = SHAPES[shape.kind].Define(stage, path)
    scale = (1.0, 1.0, 1.0)
    if shape.kind == "box":
        prim.CreateSizeAttr(1.0)
        scale = tuple(x / metres for x in shape.size)
    else:
        prim.CreateRadiusAttr(shape.size[0] / metres)
    if shape.kind == "cylinder":
        prim.CreateHeightAttr(shape.size[1] / metres)
    place(prim, shape.pose, metres, scale)
    if shape.role is not Role.VISUAL:
        UsdPhysics.CollisionAPI.Apply(prim.GetPrim())
        prim.CreatePurposeAttr(UsdGeom.Tokens.guide)


def write_joints(stage: Usd.Stage, model: KinematicModel, body: Body, metres: float) -> None:
    """One prim per dof; a fixed joint is one without."""
    for dof in body.joint.dofs or (None,):
        write_joint(stage, model, body, dof, metres)


def write_joint(stage: Usd.Stage, model: KinematicModel, body: Body, dof: Dof | None, metres: float) -> None:
    path = f"/robot/joints/{dof.name if dof else body.joint.name}"
    prim = (KINDS[dof.kind] if dof else UsdPhysics.FixedJoint).Define(stage, path)
    prim.CreateBody0Rel().SetTargets([f"/robot/{model.bodies[body.parent].name}"])
    prim.CreateBody1Rel().SetTargets([f"/robot/{body.name}"])
    frame = np.eye(4) if dof is None else joint_frame(prim, dof, metres)
    for number, local in enumerate((body.joint.placement @ frame, frame)):
        getattr(prim, f"CreateLocalPos{number}Attr")(Gf.Vec3f(*(local[:3, 3] / metres).tolist()))
        getattr(prim, f"CreateLocalRot{number}Attr")(quatf(local[:3, :3]))


def joint_frame(prim: Usd.Prim, dof: Dof, metres: float) -> Array:
    """A frame in the body below whose axis token is the dof's axis; also writes token and limits."""
    unit = metres if dof.kind is Kind.SLIDE else math.radians(1.0)
    token = AXES.get(tuple(dof.axis.tolist()))
    prim.CreateAxisAttr(token or "X")
    if math.isfinite(dof.lower):
        prim.CreateLowerLimitAttr(dof.lower / unit)
        prim.CreateUpperLimitAttr(dof.upper / unit)
    frame = np.eye(4)
    if token is None:
        x = dof.axis
        y = np.cross([0.3, 0.5, 0.7], x)
        y /= np.linalg.norm(y)
        frame[:3, :3] = np.stack([x, y, np.cross(x, y)], axis=1)
    frame[:3, 3] = dof.anchor
    return frame


def place(prim: UsdGeom.Xformable, pose: Array, metres: float, scale: tuple[float, ...] = (1.0, 1.0, 1.0)) -> None:
    prim.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(*(pose[:3, 3] / metres).tolist()))
    w, x, y, z = quat_from_rotation(pose[:3, :3]).tolist()
    prim.AddOrientOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Quatd(w, x, y, z))
    prim.AddScaleOp().Set(Gf.Vec3f(*scale))


def quatf(rotation: Array) -> Gf.Quatf:
    w, x, y, z = quat_from_rotation(rotation).tolist()
    return Gf.Quatf(w, x, y, z)
