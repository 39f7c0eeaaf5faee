"""Gprims as shapes on bodies or the world, in metres: geometry, role, colour."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hymeko_x.formats import usd as words
from hymeko_x.formats.usd import shapes as gprims
from hymeko_x.formats.usd import single
from hymeko_x.frontends.usd.bodies import ReadShape, body_at
from hymeko_x.frontends.usd.contacts import friction_of
from hymeko_x.frontends.usd.materials import bound_material
from hymeko_x.frontends.usd.meshes import NORMALS, ST, is_table_as_written, read_mesh, read_normals, read_subsets
from hymeko_x.frontends.usd.transforms import numbers_of
from hymeko_x.ir.mechanism import WORLD, Id, shape_edge
from hymeko_x.ir.parts import MeshShape, Role, Shape, World
from hymeko_x.ir.values import IDENTITY, NO_ROTATION, Pose, Vec3, compose

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.builder import UsdBuilder
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.ir.parts import Geometry, Rgba

COLLISION = "PhysicsCollisionAPI"
TYPES = ("Cube", "Sphere", "Cylinder", "Capsule", "Plane", "Mesh")
_XFORM = "xformOp"
_HULL = "PhysicsMeshCollisionAPI"
_APPROXIMATION = "physics:approximation"


def is_shape(prim: Prim) -> bool:
    """Whether a prim is a geometry that the IR has, and no site; what neither collides nor is shown is none."""
    if prim.kind not in TYPES or any(prim.has_api(site) for site in words.SITES):
        return False
    return _collides(prim) or not (_is_invisible(prim) or _purpose(prim) == "guide")


def read_shape(prim: Prim, builder: UsdBuilder) -> tuple[Id, ReadShape] | None:
    """Add the shape of a gprim; returns its body (or the world) with the shape. None where the prim is damaged."""
    found = body_at(prim, builder)
    body, owner = found if found is not None else (None, WORLD)
    at = builder.transforms.seen_from(prim, body)
    builder.check_transform(prim, at)
    pose, mesh, authored = IDENTITY if prim is body else at.pose, None, None
    geometry: Geometry = MeshShape()
    if prim.kind == "Mesh" and not _is_ball(prim, builder):
        mesh = read_mesh(prim, builder, at.scale)
        if mesh is None:
            return None
    else:
        authored = _primitive(prim, at.scale, builder)
        geometry, turn = gprims.geometry_of(authored)
        pose = pose if turn == NO_ROTATION else compose(pose, Pose(quat=turn))
        _take_extent(prim, gprims.half_extent(authored), builder)
    if owner == WORLD:
        builder.vertices.setdefault(WORLD, World())
    builder.mark_read(prim, "@type", *(name for name in prim.properties if name.startswith(_XFORM)))
    role = _role(prim, builder)
    friction = friction_of(prim, builder) if role is not Role.VISUAL else ()
    shape = Shape(geometry, role, name=builder.part_name(prim), rgba=_colour(prim, builder), friction=friction)
    key = builder.new_id(prim, "shape")
    if authored is not None and authored != gprims.default_gprim(geometry, role):
        builder.note(key, gprims.GPRIM, authored)
    if prim.kind == "Mesh" and read_normals(prim, builder):
        builder.note(key, words.NORMALS, True)
    for name, notation in ((ST, words.TEXCOORDS), (NORMALS, words.CORNER_NORMALS)) if mesh is not None else ():
        if is_table_as_written(prim, name, builder):
            builder.note(key, notation, True)
    builder.edges[key] = shape_edge(shape, owner, pose, mesh, bound_material(prim, builder))
    if mesh is not None:
        read_subsets(prim, key, builder)
    return owner, ReadShape(prim, shape, pose, None if mesh is None else at.scale)


# ---- primitives ------------------------------------------------------------------------------------------------------------------


def _primitive(prim: Prim, scale: Vec3, builder: UsdBuilder) -> gprims.Gprim:
    """The type, sizes, axis and scale of a prim."""
    kind = prim.kind
    sizes = tuple(_size(prim, name, default, builder) for name, default in gprims.SIZES[kind])
    return gprims.Gprim(kind, sizes, builder.axis(prim, "axis", "Z"), scale)


def _size(prim: Prim, name: str, default: float, builder: UsdBuilder) -> float:
    size = builder.number(prim, name, default)
    if math.isfinite(size):
        return size
    builder.refuse_value(prim, name, size, "size")
    return default


def _is_ball(prim: Prim, builder: UsdBuilder) -> bool:
    """Whether a mesh is the ball that represents an ellipsoid."""
    import numpy as np

    points, faces = gprims.ball()
    authored, indices = prim.value("points"), prim.value("faceVertexIndices")
    if authored is None or indices is None or len(authored) != len(points) or len(indices) != len(faces) or not prim.has_api(_HULL):
        return False
    if prim.value(_APPROXIMATION) != "convexHull" or not np.array_equal(authored, points) or not np.array_equal(indices, faces):
        return False
    builder.mark_read(prim, "points", "faceVertexCounts", "faceVertexIndices", "subdivisionScheme", f"@{_HULL}", _APPROXIMATION)
    return True


def _take_extent(prim: Prim, half: Vec3, builder: UsdBuilder) -> None:
    """An extent that follows from the sizes counts as read."""
    authored = prim.value("extent")
    box = (*(-value for value in half), *half)
    if authored is None or len(authored) != 2:
        return
    low, high = numbers_of(authored)
    if all(abs(a - b) <= 1e-6 * max(half) for a, b in zip((*low, *high), box, strict=True)):
        builder.mark_read(prim, "extent")


# ---- purpose and colour ----------------------------------------------------------------------------------------------------------


def _role(prim: Prim, builder: UsdBuilder) -> Role:
    """Without a collider a shape is for looking; a collider that is only a guide or a proxy, or invisible, is for colliding alone."""
    if not _collides(prim):
        return Role.VISUAL
    builder.mark_read(prim, f"@{COLLISION}")
    purpose = _purpose(prim)
    if purpose == "guide":
        builder.get(prim, "purpose")
    return Role.COLLISION if purpose in ("guide", "proxy") or _is_invisible(prim) else Role.BOTH


def _collides(prim: Prim) -> bool:
    return prim.has_api(COLLISION) and prim.value("physics:collisionEnabled") is not False


def _is_invisible(prim: Prim) -> bool:
    """Whether a prim or one above it says so."""
    if not any("visibility" in above.types for above in prim.with_ancestors()):
        return False
    from pxr import UsdGeom

    return bool(UsdGeom.Imageable(prim.composed).ComputeVisibility() == UsdGeom.Tokens.invisible)


def _purpose(prim: Prim) -> str:
    """The purpose of a prim: its own, else that of the nearest ancestor that has one."""
    if not any("purpose" in above.types for above in prim.with_ancestors()):
        return "default"
    from pxr import UsdGeom

    return str(UsdGeom.Imageable(prim.composed).ComputePurpose())


def _colour(prim: Prim, builder: UsdBuilder) -> Rgba | None:
    """One colour for all of the shape; colours per point or face stay extras."""
    shown, alpha = prim.value("primvars:displayColor"), prim.value("primvars:displayOpacity")
    if shown is None or len(shown) != 1 or prim.is_animated("primvars:displayColor"):
        return None
    if alpha is not None and len(alpha) == 1:
        builder.mark_read(prim, "primvars:displayOpacity")
    builder.mark_read(prim, "primvars:displayColor")
    r, g, b = map(single, numbers_of(shown)[0])
    return (r, g, b, single(float(alpha[0])) if alpha is not None and len(alpha) == 1 else 1.0)
