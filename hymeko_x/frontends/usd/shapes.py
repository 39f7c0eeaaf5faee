"""Gprims as shapes on bodies or the world, in metres: geometry, role, colour."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.formats import usd as words
from hymeko_x.formats.usd import shapes as gprims
from hymeko_x.formats.usd import single
from hymeko_x.frontends.usd.bodies import ReadShape, body_at
from hymeko_x.frontends.usd.contacts import friction_of
from hymeko_x.frontends.usd.materials import bound_material
from hymeko_x.frontends.usd.meshes import read_mesh, read_subsets, says_normals, says_places
from hymeko_x.frontends.usd.transforms import numbers_of
from hymeko_x.ir.mechanism import WORLD, Id, shape_edge
from hymeko_x.ir.parts import MeshShape, Role, Shape, World
from hymeko_x.ir.values import IDENTITY, NO_ROTATION, Pose, Vec3, compose

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.builder import Draft
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.ir.parts import Geometry, Rgba

COLLISION = "PhysicsCollisionAPI"
TYPES = ("Cube", "Sphere", "Cylinder", "Capsule", "Plane", "Mesh")
_XFORM = "xformOp"
_HULL = "PhysicsMeshCollisionAPI"
_APPROXIMATION = "physics:approximation"


def is_shape(prim: Prim) -> bool:
    """Whether a prim is a geometry that the IR has, and no site."""
    return prim.kind in TYPES and not any(prim.has_api(site) for site in words.SITES)


def read_shape(prim: Prim, draft: Draft) -> tuple[Id, ReadShape] | None:
    """Add the shape of a gprim; returns the body (or the world) that it is on with what was read. None where it cannot be one."""
    found = body_at(prim, draft)
    body, owner = found if found is not None else (None, WORLD)
    at = draft.places.seen_from(prim, body)
    pose, points, mesh, said = IDENTITY if prim is body else at.pose, None, None, None
    geometry: Geometry = MeshShape()
    if prim.kind == "Mesh" and not _is_ball(prim, draft):
        points, mesh = read_mesh(prim, draft, at.scale)
        if mesh is None:
            return None
    else:
        said = _primitive(prim, at.scale, draft)
        geometry, turn = gprims.meaning(said)
        pose = pose if turn == NO_ROTATION else compose(pose, Pose(quat=turn))
        _take_extent(prim, gprims.half_extent(said), draft)
    if owner == WORLD:
        draft.vertices.setdefault(WORLD, World())
    draft.take(prim, "@type", *(name for name in prim.properties if name.startswith(_XFORM)))
    role = _role(prim, draft)
    friction = friction_of(prim, draft) if role is not Role.VISUAL else ()
    shape = Shape(geometry, role, name=draft.part_name(prim), rgba=_colour(prim, draft), friction=friction)
    key = draft.own(prim, "shape")
    if said is not None and said != gprims.chosen(geometry, role):
        draft.note(key, gprims.NOTATION, str(said))
    if points is not None and says_normals(prim, draft):
        draft.note(key, words.NORMALS, "faces")
    if points is not None and says_places(prim, draft):
        draft.note(key, words.TEXCOORDS, "corners")
    draft.edges[key] = shape_edge(shape, owner, pose, mesh, bound_material(prim, draft))
    if points is not None:
        read_subsets(prim, key, draft)
    return owner, ReadShape(prim, shape, pose, points)


# ---- primitives ------------------------------------------------------------------------------------------------------------------


def _primitive(prim: Prim, scale: Vec3, draft: Draft) -> gprims.Gprim:
    """What the prim of a primitive says."""
    kind = prim.kind
    sizes = tuple(draft.number(prim, name, default) for name, default in gprims.SIZES[kind])
    return gprims.Gprim(kind, sizes, draft.axis(prim, "axis", "Z"), scale)


def _is_ball(prim: Prim, draft: Draft) -> bool:
    """Whether a mesh is the one that stands for an ellipsoid, of which it then says nothing else."""
    import numpy as np

    points, faces = gprims.ball()
    said, indices = prim.value("points"), prim.value("faceVertexIndices")
    if said is None or indices is None or len(said) != len(points) or len(indices) != len(faces) or not prim.has_api(_HULL):
        return False
    if prim.value(_APPROXIMATION) != "convexHull" or not np.array_equal(said, points) or not np.array_equal(indices, faces):
        return False
    draft.take(prim, "points", "faceVertexCounts", "faceVertexIndices", "subdivisionScheme", f"@{_HULL}", _APPROXIMATION)
    return True


def _take_extent(prim: Prim, half: Vec3, draft: Draft) -> None:
    """A box around the prim that follows from its sizes is no news."""
    said = prim.value("extent")
    box = (*(-value for value in half), *half)
    if said is None or len(said) != 2:
        return
    low, high = numbers_of(said)
    if all(abs(a - b) <= 1e-6 * max(half) for a, b in zip((*low, *high), box, strict=True)):
        draft.take(prim, "extent")


# ---- looks and purpose -----------------------------------------------------------------------------------------------------------


def _role(prim: Prim, draft: Draft) -> Role:
    """Without a collider a shape is for looking; a collider that is only a guide or a proxy is for colliding alone."""
    collides = prim.has_api(COLLISION) and prim.value("physics:collisionEnabled") is not False
    if not collides:
        return Role.VISUAL
    draft.take(prim, f"@{COLLISION}")
    purpose = _purpose(prim)
    if purpose == "guide":
        draft.get(prim, "purpose")
    return Role.COLLISION if purpose in ("guide", "proxy") else Role.BOTH


def _purpose(prim: Prim) -> str:
    """What a prim is for: its own purpose, else that of the nearest one above that says it."""
    if not any("purpose" in above.types for above in prim.above()):
        return "default"
    from pxr import UsdGeom

    return str(UsdGeom.Imageable(prim.composed).ComputePurpose())


def _colour(prim: Prim, draft: Draft) -> Rgba | None:
    """One colour for all of the shape; colours per point or face stay extras."""
    shown, alpha = prim.value("primvars:displayColor"), prim.value("primvars:displayOpacity")
    if shown is None or len(shown) != 1 or prim.is_animated("primvars:displayColor"):
        return None
    if alpha is not None and len(alpha) == 1:
        draft.take(prim, "primvars:displayOpacity")
    draft.take(prim, "primvars:displayColor")
    r, g, b = map(single, numbers_of(shown)[0])
    return (r, g, b, single(float(alpha[0])) if alpha is not None and len(alpha) == 1 else 1.0)
