"""Geometry: gprims as shapes on bodies or the world, in metres; what is for looking and what for colliding."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

from pxr import UsdGeom

from hymeko_x import codes
from hymeko_x.formats import usd as words
from hymeko_x.formats import usd_gprims as gprims
from hymeko_x.formats.usd import single
from hymeko_x.frontends.usd.bodies import body_at
from hymeko_x.frontends.usd.contacts import friction_of
from hymeko_x.frontends.usd.draft import has_api
from hymeko_x.frontends.usd.materials import bound_material
from hymeko_x.ir.mechanism import WORLD, Id, shape_edge
from hymeko_x.ir.parts import Mesh, MeshShape, Role, Shape, World
from hymeko_x.ir.values import IDENTITY, NO_ROTATION, Pose, Vec3, compose

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hymeko_x.frontends.usd.draft import Draft
    from hymeko_x.ir.parts import Geometry, Rgba

COLLISION = "PhysicsCollisionAPI"
SITES = ("MjcSiteAPI", "NewtonSiteAPI")
TYPES = ("Cube", "Sphere", "Cylinder", "Capsule", "Plane", "Mesh")
_XFORM = "xformOp"

Read = tuple[Any, Shape, Pose, "NDArray[Any] | None"]
"""A shape that was read: its prim, part, pose in the body, and for a mesh its points in the shape's frame (n x 3)."""


def is_shape(prim: Any) -> bool:
    """Whether a prim is a geometry that the IR has, and no site."""
    return str(prim.GetTypeName()) in TYPES and not any(has_api(prim, site) for site in SITES)


def read_shape(prim: Any, draft: Draft) -> tuple[Id, Read] | None:
    """Add the shape of a gprim; returns the body (or the world) that it is on with what was read. None where it cannot be one."""
    found = body_at(prim, draft)
    body, owner = found if found is not None else (None, WORLD)
    at = draft.places.seen_from(prim, body)
    pose, points, mesh, said = IDENTITY if prim == body else at.pose, None, None, None
    geometry: Geometry = MeshShape()
    if prim.GetTypeName() == "Mesh":
        points, mesh = _read_mesh(prim, draft, at.scale)
        if mesh is None:
            return None
    else:
        said = _primitive(prim, at.scale, draft)
        geometry, turn = gprims.meaning(said)
        pose = pose if turn == NO_ROTATION else compose(pose, Pose(quat=turn))
        _take_extent(prim, gprims.half_extent(said), draft)
    if owner == WORLD:
        draft.vertices.setdefault(WORLD, World())
    draft.take(prim, "@type", *(name for name in prim.GetAuthoredPropertyNames() if name.startswith(_XFORM)))
    role = _role(prim, draft)
    friction = friction_of(prim) if role is not Role.VISUAL else ()
    shape = Shape(geometry, role, name=str(prim.GetName()), rgba=_colour(prim, draft), friction=friction)
    key = draft.own(prim, "shape")
    if said is not None and said != gprims.chosen(geometry):
        draft.note(key, gprims.NOTATION, str(said))
    draft.edges[key] = shape_edge(shape, owner, pose, mesh, bound_material(prim, draft))
    return owner, (prim, shape, pose, points)


# ---- primitives ------------------------------------------------------------------------------------------------------------------


def _primitive(prim: Any, scale: Vec3, draft: Draft) -> gprims.Gprim:
    """What the prim of a primitive says; a wrong axis is z."""
    kind = str(prim.GetTypeName())
    sizes = tuple(draft.number(prim, name, default) for name, default in gprims.SIZES[kind])
    axis = str(draft.get(prim, "axis") or "Z")
    return gprims.Gprim(kind, sizes, axis if axis in words.AXES else "Z", scale)


def _take_extent(prim: Any, half: Vec3, draft: Draft) -> None:
    """A box around the prim that follows from its sizes is no news."""
    said = prim.GetAttribute("extent").Get() if prim.HasAttribute("extent") else None
    box = (*(-value for value in half), *half)
    if said is not None and len(said) == 2 and all(abs(a - b) <= 1e-6 * max(half) for a, b in zip((*said[0], *said[1]), box, strict=True)):
        draft.take(prim, "extent")


# ---- meshes --------------------------------------------------------------------------------------------------------------------


def _read_mesh(prim: Any, draft: Draft, scale: Vec3) -> tuple[NDArray[Any] | None, Id | None]:
    """The points of a mesh prim in metres with the mesh's id. Equal meshes at equal scale share one; polygons become fans."""
    import numpy as np

    points, counts, indices = (prim.GetAttribute(name).Get() for name in ("points", "faceVertexCounts", "faceVertexIndices"))
    if points is None or counts is None or indices is None:
        return _refused(prim, "has no points or no faces", draft)
    vertices = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    sizes, corners = np.asarray(counts, dtype=np.int64), np.asarray(indices, dtype=np.int64)
    if sizes.size and (sizes.min() < 0 or sizes.sum() != corners.size):
        return _refused(prim, "says another number of corners than it has", draft)
    if corners.size and (corners.min() < 0 or corners.max() >= len(vertices)):
        return _refused(prim, "has a face with a point that does not exist", draft)
    if not np.isfinite(vertices).all():
        return _refused(prim, "has points that are not finite", draft)
    faces = triangles(sizes, corners)
    if prim.GetAttribute("points").GetNumTimeSamples() == 0:
        draft.take(prim, "points")
    _take_mesh_extent(prim, vertices, draft)
    if (sizes == 3).all():
        draft.take(prim, "faceVertexCounts", "faceVertexIndices")
    key = _shared_mesh(prim, vertices, faces, scale, draft)
    return vertices * np.asarray(scale), key


def _take_mesh_extent(prim: Any, vertices: NDArray[Any], draft: Draft) -> None:
    import numpy as np

    said = prim.GetAttribute("extent").Get()
    if said is not None and len(said) == 2 and len(vertices):
        box = np.stack([vertices.min(axis=0), vertices.max(axis=0)])
        if np.allclose(np.asarray(said, dtype=np.float64), box, rtol=1e-6, atol=1e-6 * float(np.abs(box).max())):
            draft.take(prim, "extent")


def _refused(prim: Any, why: str, draft: Draft) -> tuple[None, None]:
    said = f"mesh '{prim.GetPath()}' {why}; it is kept as written"
    draft.report.error(codes.ASSET_UNREADABLE, said, draft.origin, element=str(prim.GetPath()))
    return None, None


def triangles(sizes: NDArray[Any], corners: NDArray[Any]) -> NDArray[Any]:
    """Polygons as fans of triangles, n x 3."""
    import numpy as np

    if (sizes == 3).all():
        return corners.reshape(-1, 3)
    fans = np.maximum(sizes - 2, 0)
    starts = np.repeat(np.cumsum(sizes) - sizes, fans)
    step = np.arange(int(fans.sum())) - np.repeat(np.cumsum(fans) - fans, fans)
    return corners[np.stack([starts, starts + step + 1, starts + step + 2], axis=1)] if len(step) else corners[:0].reshape(0, 3)


def _shared_mesh(prim: Any, vertices: NDArray[Any], faces: NDArray[Any], scale: Vec3, draft: Draft) -> Id:
    content = hashlib.sha256(vertices.tobytes() + b"|" + faces.tobytes() + repr(scale).encode()).hexdigest()
    known = draft.meshes.get(content)
    if known is not None:
        return known
    key = draft.own(prim, "mesh", str(prim.GetName()))
    draft.meshes[content] = key
    draft.vertices[key] = Mesh(None, scale, None, tuple(vertices.ravel().tolist()), tuple(faces.ravel().tolist()))
    return key


# ---- looks and purpose -----------------------------------------------------------------------------------------------------------


def _role(prim: Any, draft: Draft) -> Role:
    """Without a collider a shape is for looking; a collider that is only a guide or a proxy is for colliding alone."""
    collides = has_api(prim, COLLISION) and prim.GetAttribute("physics:collisionEnabled").Get() is not False
    if not collides:
        return Role.VISUAL
    draft.take(prim, f"@{COLLISION}")
    purpose = UsdGeom.Imageable(prim).ComputePurpose()
    if purpose == UsdGeom.Tokens.guide:
        draft.get(prim, "purpose")
    return Role.COLLISION if purpose in (UsdGeom.Tokens.guide, UsdGeom.Tokens.proxy) else Role.BOTH


def _colour(prim: Any, draft: Draft) -> Rgba | None:
    """One colour for all of the shape; colours per point or face stay extras."""
    colour, opacity = prim.GetAttribute("primvars:displayColor"), prim.GetAttribute("primvars:displayOpacity")
    shown = colour.Get() if colour and colour.HasAuthoredValue() else None
    if shown is None or len(shown) != 1 or colour.GetNumTimeSamples():
        return None
    alpha = opacity.Get() if opacity and opacity.HasAuthoredValue() else None
    if alpha is not None and len(alpha) == 1:
        draft.take(prim, "primvars:displayOpacity")
    draft.take(prim, "primvars:displayColor")
    r, g, b = (single(float(value)) for value in shown[0])
    return (r, g, b, single(float(alpha[0])) if alpha is not None and len(alpha) == 1 else 1.0)
