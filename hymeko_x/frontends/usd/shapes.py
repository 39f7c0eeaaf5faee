"""Geometry: gprims as shapes on bodies or the world, in metres; what is for looking and what for colliding."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

from hymeko_x import codes
from hymeko_x.formats import usd as words
from hymeko_x.formats.usd import gprims, single
from hymeko_x.frontends.usd.bodies import body_at
from hymeko_x.frontends.usd.contacts import friction_of
from hymeko_x.frontends.usd.materials import bound_material
from hymeko_x.frontends.usd.places import numbers_of
from hymeko_x.frontends.usd.subsets import read_subsets
from hymeko_x.frontends.usd.texcoords import read_places, says_places
from hymeko_x.ir.mechanism import WORLD, Id, shape_edge
from hymeko_x.ir.parts import Mesh, MeshShape, Role, Shape, World
from hymeko_x.ir.values import IDENTITY, NO_ROTATION, Pose, Vec3, compose

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hymeko_x.frontends.usd.draft import Draft
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.frontends.usd.texcoords import Places
    from hymeko_x.ir.parts import Geometry, Rgba

COLLISION = "PhysicsCollisionAPI"
TYPES = ("Cube", "Sphere", "Cylinder", "Capsule", "Plane", "Mesh")
_XFORM = "xformOp"
_HULL = "PhysicsMeshCollisionAPI"
_APPROXIMATION = "physics:approximation"
_OF_NORMALS = frozenset(("typeName", "variability", "custom", "default", "interpolation"))

Read = tuple["Prim", Shape, Pose, "NDArray[Any] | None"]
"""A shape that was read: its prim, part, pose in the body, and for a mesh its points in the shape's frame (n x 3)."""


def is_shape(prim: Prim) -> bool:
    """Whether a prim is a geometry that the IR has, and no site."""
    return prim.kind in TYPES and not any(prim.has_api(site) for site in words.SITES)


def read_shape(prim: Prim, draft: Draft) -> tuple[Id, Read] | None:
    """Add the shape of a gprim; returns the body (or the world) that it is on with what was read. None where it cannot be one."""
    found = body_at(prim, draft)
    body, owner = found if found is not None else (None, WORLD)
    at = draft.places.seen_from(prim, body)
    pose, points, mesh, said = IDENTITY if prim is body else at.pose, None, None, None
    geometry: Geometry = MeshShape()
    if prim.kind == "Mesh" and not _is_ball(prim, draft):
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
    draft.take(prim, "@type", *(name for name in prim.properties if name.startswith(_XFORM)))
    role = _role(prim, draft)
    friction = friction_of(prim, draft) if role is not Role.VISUAL else ()
    shape = Shape(geometry, role, name=draft.part_name(prim), rgba=_colour(prim, draft), friction=friction)
    key = draft.own(prim, "shape")
    if said is not None and said != gprims.chosen(geometry, role):
        draft.note(key, gprims.NOTATION, str(said))
    if points is not None and _says_normals(prim, draft):
        draft.note(key, words.NORMALS, "faces")
    if points is not None and says_places(prim, draft):
        draft.note(key, words.TEXCOORDS, "corners")
    draft.edges[key] = shape_edge(shape, owner, pose, mesh, bound_material(prim, draft))
    if points is not None:
        read_subsets(prim, key, draft)
    return owner, (prim, shape, pose, points)


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


# ---- meshes --------------------------------------------------------------------------------------------------------------------


def _read_mesh(prim: Prim, draft: Draft, scale: Vec3) -> tuple[NDArray[Any] | None, Id | None]:
    """The points of a mesh prim in metres with the mesh's id. Equal meshes at equal scale share one; polygons become fans."""
    import numpy as np

    from hymeko_x.meshes.polygons import fans

    points, counts, indices = (prim.value(name) for name in ("points", "faceVertexCounts", "faceVertexIndices"))
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
    faces = fans(sizes, corners)
    if not prim.is_animated("points"):
        draft.take(prim, "points")
    _take_mesh_extent(prim, vertices, draft)
    if prim.value("subdivisionScheme") == "none":  # which is what we say of every mesh
        draft.take(prim, "subdivisionScheme")
    if (sizes == 3).all():
        draft.take(prim, "faceVertexCounts", "faceVertexIndices")
    key = _shared_mesh(prim, vertices, faces, read_places(prim, sizes, corners), scale, draft)
    return vertices * np.asarray(scale), key


def _take_mesh_extent(prim: Prim, vertices: NDArray[Any], draft: Draft) -> None:
    import numpy as np

    said = prim.value("extent")
    if said is not None and len(said) == 2 and len(vertices):
        box = np.stack([vertices.min(axis=0), vertices.max(axis=0)])
        if np.allclose(np.asarray(said, dtype=np.float64), box, rtol=1e-6, atol=1e-6 * float(np.abs(box).max())):
            draft.take(prim, "extent")


def _says_normals(prim: Prim, draft: Draft) -> bool:
    """Whether the normals of a mesh are those of its triangles, which nobody has to keep."""
    normals, counts = prim.value("normals"), prim.value("faceVertexCounts")
    if normals is None or len(normals) != len(counts) or "faceVertexCounts" not in draft.taken.get(prim.path, ()):
        return False
    import numpy as np

    from hymeko_x.meshes.measures import face_normals

    spec = prim.spec.attributes["normals"]
    is_plain = set(spec.ListInfoKeys()) <= _OF_NORMALS and spec.GetInfo("interpolation") == "uniform" and not prim.is_animated("normals")
    points, corners = (np.asarray(prim.value(name)) for name in ("points", "faceVertexIndices"))
    if not is_plain or not np.array_equal(np.asarray(normals), face_normals(points, corners)):
        return False
    draft.take(prim, "normals")
    return True


def _refused(prim: Prim, why: str, draft: Draft) -> tuple[None, None]:
    said = f"mesh '{prim.path}' {why}; it is kept as written"
    draft.report.error(codes.ASSET_UNREADABLE, said, draft.origin, element=prim.path)
    return None, None


def _shared_mesh(prim: Prim, vertices: NDArray[Any], faces: NDArray[Any], places: Places, scale: Vec3, draft: Draft) -> Id:
    about = tuple(f"{factor:.12g}" for factor in scale)  # computed from what is above the prim: its last bits are those of no author
    said = repr((about, places) if places[0] else about)
    content = hashlib.sha256(vertices.tobytes() + b"|" + faces.tobytes() + said.encode()).hexdigest()
    known = draft.meshes.get(content)
    if known is not None:
        return known
    key = draft.own(prim, "mesh", prim.name)
    draft.meshes[content] = key
    draft.vertices[key] = Mesh(None, scale, None, tuple(vertices.ravel().tolist()), tuple(faces.ravel().tolist()), *places)
    return key


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
