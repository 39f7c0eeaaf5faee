"""Bodies with their poses in the world and their mass properties."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from pxr import Gf, Vt

from hymeko_x.backends.usd.grounds import grounds
from hymeko_x.backends.usd.shapes import gprim_of, gprim_pose
from hymeko_x.backends.usd.sheet import T, apply, put, quatf, transform
from hymeko_x.formats import usd as words
from hymeko_x.ir.kinematics import reference_poses
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Body, Mesh
from hymeko_x.ir.values import IDENTITY, NO_ROTATION, Pose, compose, inverse, rotation_angle
from hymeko_x.ir.written import clean_pose

if TYPE_CHECKING:
    from hymeko_x.backends.usd.sheet import UsdSheet
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.ir.parts import Inertial
    from hymeko_x.ir.values import Quat, Tensor, Vec3

_NEAR = 1e-9


def write_bodies(sheet: UsdSheet) -> None:
    """Every body: flat below the robot's prim, inside of its parent where that is wanted, or where it was before.

    One inside of another for another reason starts again from the world.
    """
    poses = reference_poses(sheet.mechanism)
    note_body_shapes(sheet)
    placed: set[Any] = set()
    kinematic = grounds(sheet.mechanism)
    home = sheet.authors_group("body") or sheet.root
    for key in _parents_first(sheet.mechanism) if sheet.is_nested else [key for key, _ in sheet.mechanism.vertices(Body)]:
        spec = _place_nested(sheet, key) if sheet.is_nested else sheet.add_prim(key, home, "Xform")
        placed.add(spec.path)
        _write_body(sheet, spec, key)
        if key in kinematic:
            put(spec, "physics:kinematicEnabled", T.Bool, True)
    for key, _ in sheet.mechanism.vertices(Body):
        path = sheet.paths[key]
        spec = sheet.prims[path]
        pose = _noted_pose(sheet.mechanism, key) or clean_pose(poses.get(key, IDENTITY))
        above = _parent_body(sheet.mechanism, key) if sheet.is_nested else None
        if above is not None:
            seen = compose(inverse(_noted_pose(sheet.mechanism, above) or poses.get(above, IDENTITY)), pose)
            transform(spec, clean_pose(seen), sheet.body_scales.get(key), within=sheet.body_scales.get(above))
            continue
        is_inside = any(prefix in placed for prefix in path.GetParentPath().GetPrefixes())
        transform(spec, pose, sheet.body_scales.get(key), reset=is_inside)


def _write_body(sheet: UsdSheet, spec: Any, key: Id) -> None:
    apply(spec, "PhysicsRigidBodyAPI")
    inertial = sheet.mechanism.vertex(key, Body).inertial
    if inertial is not None:
        write_inertial(spec, inertial, sheet.in_prim_space(key, inertial.com), is_neutral=sheet.is_neutral)


def _parents_first(mechanism: Mechanism) -> list[Id]:
    """Every body, those without a root last."""
    return list(dict.fromkeys((*mechanism.depth_first(), *(key for key, _ in mechanism.vertices(Body)))))


def _parent_body(mechanism: Mechanism, body: Id) -> Id | None:
    view = mechanism.parent_joint.get(body)
    return None if view is None or view.parent == WORLD else view.parent


def _place_nested(sheet: UsdSheet, key: Id) -> Any:
    above = _parent_body(sheet.mechanism, key)
    return sheet.add_prim_at(
        key, sheet.free_path(sheet.paths.get(above, sheet.root) if above is not None else sheet.root, key.name), "Xform"
    )


def note_body_shapes(sheet: UsdSheet) -> None:
    """Find the bodies whose own prim was a geometry, by their notations: it will be that again, with its scale."""
    mechanism = sheet.mechanism
    for key, _ in mechanism.vertices(Body):
        path = mechanism.notation(key, words.PATH)
        view = next((view for view in mechanism.shapes.get(key, ()) if path and mechanism.notation(view.id, words.PATH) == path), None)
        if view is None:
            continue
        prim = gprim_of(mechanism, view)
        pose = gprim_pose(view, prim)
        mesh = mechanism.part(view.mesh, Mesh)
        scale = prim.scale if prim is not None else mesh.scale if mesh is not None else (1.0, 1.0, 1.0)
        is_here = math.hypot(*pose.xyz) < _NEAR and rotation_angle(pose.quat, NO_ROTATION) < _NEAR
        if is_here and all(scale):
            sheet.body_shapes[key] = view.id
            if scale != (1.0, 1.0, 1.0):
                sheet.body_scales[key] = scale


def _noted_pose(mechanism: Mechanism, body: Id) -> Pose | None:
    """Where the body's prim stood in the stage that it was read from, if not where its joints put it."""
    return mechanism.notation(body, words.POSE)


# ---- mass --------------------------------------------------------------------------------------------------------------------


_ROUNDING = 1e-12
"""Of the largest moment: a thin rod has no other about its axis, where the rules of USD demand one above 0."""


def write_inertial(spec: Any, inertial: Inertial, com: Vec3, *, is_neutral: bool = False) -> None:
    """Mass, centre of mass (in the prim's space), and the tensor both as principal moments and as Newton's six doubles.

    The neutral form is principal moments alone.
    """
    apply(spec, "PhysicsMassAPI")
    if inertial.mass:  # a mass of 0 means that nothing was authored
        put(spec, "physics:mass", T.Float, inertial.mass)
    put(spec, "physics:centerOfMass", T.Point3f, Gf.Vec3f(*com))
    if inertial.tensor is None:
        return
    moments, quat = principal(inertial)
    least = _ROUNDING * max(moments)
    if least > 0.0 and min(moments) >= -least:  # UsdPhysics takes three zeros for "not authored"
        put(spec, "physics:diagonalInertia", T.Float3, Gf.Vec3f(*(max(moment, least) for moment in moments)))
        put(spec, "physics:principalAxes", T.Quatf, quatf(quat))
    if is_neutral:
        return
    apply(spec, "NewtonMassAPI")
    put(spec, "newton:inertia", T.DoubleArray, Vt.DoubleArray(list(inertial.tensor)))


def principal(inertial: Inertial) -> tuple[Vec3, Quat]:
    """Principal moments and the rotation of their axes: as they were given where they were, else computed."""
    written, tensor = inertial.written, inertial.tensor
    assert tensor is not None
    if written is not None and not any(written.tensor[3:]):
        return written.tensor[:3], written.frame.quat
    if not any(tensor[3:]):
        return tensor[:3], NO_ROTATION
    return _eigen(tensor)


def _eigen(tensor: Tensor) -> tuple[Vec3, Quat]:
    import numpy as np

    xx, yy, zz, xy, xz, yz = tensor
    matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if not np.isfinite(matrix).all():
        return (xx, yy, zz), NO_ROTATION
    moments, axes = np.linalg.eigh(matrix)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] = -axes[:, 0]
    turn = Gf.Matrix3d(*axes.T.ravel().tolist()).ExtractRotation().GetQuat()
    x, y, z = turn.GetImaginary()
    a, b, c = moments.tolist()
    return (a, b, c), (turn.GetReal(), x, y, z)
