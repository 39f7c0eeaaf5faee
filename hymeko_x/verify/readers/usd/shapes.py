"""Shapes in a stage: the colliders of UsdPhysics, and every other prim of geometry in a body, which is only drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from pxr import Usd, UsdGeom, UsdPhysics

from hymeko_x.verify.model import Array, Role, Shape, Surface
from hymeko_x.verify.readers.usd.scene import owner
from hymeko_x.verify.spatial import rigid

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.verify.readers.usd.scene import MeasuredStage

_ALONG = {
    "X": np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]),
    "Y": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
    "Z": np.eye(3),
}
"""The rotation that takes z to each axis: a cylinder's length is along z here."""

_RINGS, _AROUND = 15, 32
"""The circles of latitude of the ball that stands for an ellipsoid, and the points on each."""

_EVEN = 1e-5  # scales this close are one: they are stored as floats


def read_shapes(scene: MeasuredStage, found: Mapping[Any, Any], bodies: set[str]) -> dict[str, tuple[Shape, ...]]:
    """The shapes of each body by its path; those of the world under ""."""
    colliding = {str(path) for paths, descs in found.values() for path, desc in zip(paths, descs, strict=True) if _collides(desc)}
    shapes: dict[str, list[Shape]] = {}
    for prim in Usd.PrimRange(scene.stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()):
        if not prim.IsA(UsdGeom.Gprim):
            continue
        path = str(prim.GetPath())
        role = _role(prim, path in colliding)
        shape = None if role is None else shape_of(scene, prim, owner(prim, bodies), role)
        if shape is not None:
            shapes.setdefault(owner(prim, bodies), []).append(shape)
    return {path: tuple(items) for path, items in shapes.items()}


def _collides(desc: Any) -> bool:
    return isinstance(desc, UsdPhysics.ShapeDesc) and bool(desc.collisionEnabled)


def _role(prim: Any, collides: bool) -> Role | None:
    """Guides and invisible prims are not drawn; None for what neither collides nor is drawn."""
    image = UsdGeom.Imageable(prim)
    drawn = image.ComputePurpose() != UsdGeom.Tokens.guide and image.ComputeVisibility() != UsdGeom.Tokens.invisible
    if collides:
        return Role.BOTH if drawn else Role.COLLISION
    return Role.VISUAL if drawn else None


def shape_of(scene: MeasuredStage, prim: Any, body: str, role: Role) -> Shape | None:
    """A primitive in the body's frame; a mesh as triangles in it."""
    pose, scale = scene.relative(body, prim)
    name = prim.GetDisplayName() or prim.GetName()
    size = np.abs(np.diag(scale))
    if prim.IsA(UsdGeom.Mesh):
        if _is_ball(prim):
            return Shape("ellipsoid", role, pose, tuple(float(x) for x in size), name)
        return Shape("mesh", role, pose, (), name, _surface(prim, scale))
    if prim.IsA(UsdGeom.Cube):
        edge = float(UsdGeom.Cube(prim).GetSizeAttr().Get())
        return Shape("box", role, pose, tuple(float(x) for x in edge * size), name)
    if prim.IsA(UsdGeom.Sphere):
        radii = float(UsdGeom.Sphere(prim).GetRadiusAttr().Get()) * size
        if np.ptp(radii) <= _EVEN * radii.max():
            return Shape("sphere", role, pose, (float(radii.mean()),), name)
        return Shape("ellipsoid", role, pose, tuple(float(x) for x in radii), name)
    if prim.IsA(UsdGeom.Plane):
        return Shape("plane", role, _turned(pose, UsdGeom.Plane(prim)), (), name)
    for kind, schema in (("cylinder", UsdGeom.Cylinder), ("capsule", UsdGeom.Capsule)):
        if prim.IsA(schema):
            return _round(kind, schema(prim), role, pose, size, name)
    return None


def _is_ball(prim: Any) -> bool:
    """Whether a mesh collides as the hull of the ball that stands for an ellipsoid, for which UsdPhysics has no collider."""
    if UsdPhysics.MeshCollisionAPI(prim).GetApproximationAttr().Get() != UsdPhysics.Tokens.convexHull:
        return False
    points = np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get() or (), dtype=float)
    return points.shape == (2 + _RINGS * _AROUND, 3) and np.allclose(points, _ball_points(), atol=1e-6)


def _ball_points() -> Array:
    """The points of the ball of radius 1: the north pole, rings of equal latitude from +x over +y, the south pole.

    Source: docs/mapping/usd.md, and nothing of the writer's, so that a fault in the writer's table is found.
    """
    latitudes = np.pi / 2 - np.pi / (_RINGS + 1) * np.arange(1, _RINGS + 1)
    longitudes = 2 * np.pi / _AROUND * np.arange(_AROUND)
    latitude, longitude = (grid.ravel() for grid in np.meshgrid(latitudes, longitudes, indexing="ij"))
    rings = np.stack([np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude)], axis=1)
    return np.vstack([[0.0, 0.0, 1.0], rings, [0.0, 0.0, -1.0]])


def _round(kind: str, schema: Any, role: Role, pose: Array, size: Array, name: str) -> Shape:
    along = "XYZ".index(schema.GetAxisAttr().Get())
    across = float(np.delete(size, along).max())
    radius, height = float(schema.GetRadiusAttr().Get()), float(schema.GetHeightAttr().Get())
    return Shape(kind, role, _turned(pose, schema), (radius * across, height * float(size[along])), name)


def _turned(pose: Array, schema: Any) -> Array:
    return pose @ rigid(_ALONG[schema.GetAxisAttr().Get()], np.zeros(3))


def _surface(prim: Any, scale: Array) -> Surface:
    """The faces as triangles (fans), at the default time."""
    mesh = UsdGeom.Mesh(prim)
    points = np.array(mesh.GetPointsAttr().Get() or [], dtype=float).reshape(-1, 3) @ scale.T
    counts = np.array(mesh.GetFaceVertexCountsAttr().Get() or [], dtype=np.intp)
    corners = np.array(mesh.GetFaceVertexIndicesAttr().Get() or [], dtype=np.intp)
    fans = np.maximum(counts - 2, 0)
    first = np.repeat(np.cumsum(counts) - counts, fans)
    step = np.arange(len(first)) - np.repeat(np.cumsum(fans) - fans, fans)
    return Surface(points, np.stack([corners[first], corners[first + step + 1], corners[first + step + 2]], axis=1))
