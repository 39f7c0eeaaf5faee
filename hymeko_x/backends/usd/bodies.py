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
    from collections.abc import Iterator, Mapping

    from hymeko_x.backends.usd.sheet import UsdSheet
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.ir.parts import Inertial
    from hymeko_x.ir.values import Quat, Tensor, Vec3

    Diagonal = tuple[Vec3, Quat]
    """The principal moments of a tensor, and the rotation of their axes."""

_NEAR = 1e-9


def write_bodies(sheet: UsdSheet) -> None:
    """Every body: flat below the robot's prim, inside of its parent where that is wanted, or where it was before.

    One inside of another for another reason starts again from the world.
    """
    poses = reference_poses(sheet.mechanism)
    note_body_shapes(sheet)
    placed: set[Any] = set()
    kinematic = grounds(sheet.mechanism)
    diagonal = _diagonal_of(sheet.mechanism)
    home = sheet.authors_group("body") or sheet.root
    for key in _parents_first(sheet.mechanism) if sheet.is_nested else [key for key, _ in sheet.mechanism.vertices(Body)]:
        spec = _place_nested(sheet, key) if sheet.is_nested else sheet.add_prim(key, home, "Xform")
        placed.add(spec.path)
        _write_body(sheet, spec, key, diagonal)
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


def _write_body(sheet: UsdSheet, spec: Any, key: Id, diagonal: Mapping[Tensor, Diagonal]) -> None:
    apply(spec, "PhysicsRigidBodyAPI")
    inertial = sheet.mechanism.vertex(key, Body).inertial
    if inertial is not None:
        _write_inertial(spec, inertial, sheet.in_prim_space(key, inertial.com), diagonal, is_neutral=sheet.is_neutral)


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


_ROWS = [[0, 3, 4], [3, 1, 5], [4, 5, 2]]
"""The places of the numbers of a tensor in its matrix."""
_ROUNDING = 1e-12
"""Of the largest moment: a thin rod has no other about its axis, where the rules of USD demand one above 0."""


def _write_inertial(spec: Any, inertial: Inertial, com: Vec3, diagonal: Mapping[Tensor, Diagonal], *, is_neutral: bool) -> None:
    """Mass, centre of mass (in the prim's space), and the tensor both as principal moments and as Newton's six doubles.

    The neutral form is principal moments alone.
    """
    apply(spec, "PhysicsMassAPI")
    if inertial.mass:  # a mass of 0 means that nothing was authored
        put(spec, "physics:mass", T.Float, inertial.mass)
    put(spec, "physics:centerOfMass", T.Point3f, Gf.Vec3f(*com))
    if inertial.tensor is None:
        return
    moments, quat = _diagonal_as_given(inertial) or diagonal[inertial.tensor]
    least = _ROUNDING * max(moments)
    if least > 0.0 and min(moments) >= -least:  # UsdPhysics takes three zeros for "not authored"
        put(spec, "physics:diagonalInertia", T.Float3, Gf.Vec3f(*(max(moment, least) for moment in moments)))
        put(spec, "physics:principalAxes", T.Quatf, quatf(quat))
    if is_neutral:
        return
    apply(spec, "NewtonMassAPI")
    put(spec, "newton:inertia", T.DoubleArray, Vt.DoubleArray(list(inertial.tensor)))


def _diagonal_as_given(inertial: Inertial) -> Diagonal | None:
    """The principal moments and axes that an author gave, or that a tensor without products shows; else None."""
    written, tensor = inertial.written, inertial.tensor
    if written is not None and not any(written.tensor[3:]):
        return written.tensor[:3], written.frame.quat
    return (tensor[:3], NO_ROTATION) if tensor is not None and not any(tensor[3:]) else None


def _diagonal_of(mechanism: Mechanism) -> dict[Tensor, Diagonal]:
    """The principal moments and axes of all other tensors, computed at once: one call for each takes up to 8 % of a conversion."""
    inertials = [body.inertial for _, body in mechanism.vertices(Body) if body.inertial is not None]
    tensors = {inertial.tensor for inertial in inertials if inertial.tensor is not None and _diagonal_as_given(inertial) is None}
    finite = [tensor for tensor in tensors if all(map(math.isfinite, tensor))]
    return {tensor: (tensor[:3], NO_ROTATION) for tensor in tensors} | dict(zip(finite, _eigen(finite), strict=True))


def _eigen(tensors: list[Tensor]) -> Iterator[Diagonal]:
    if not tensors:
        return
    import numpy as np

    moments, axes = np.linalg.eigh(np.array(tensors)[:, _ROWS])
    axes[np.linalg.det(axes) < 0.0, :, 0] *= -1.0
    for (a, b, c), rows in zip(moments.tolist(), axes.transpose(0, 2, 1).reshape(-1, 9).tolist(), strict=True):
        turn = Gf.Matrix3d(*rows).ExtractRotation().GetQuat()
        x, y, z = turn.GetImaginary()
        yield (a, b, c), (turn.GetReal(), x, y, z)
