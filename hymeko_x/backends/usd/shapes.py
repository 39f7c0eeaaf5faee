"""Shapes as gprims below their bodies: what collides has the collision API, and what is only for that the purpose guide."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pxr import Gf, Sdf, Vt

from hymeko_x.backends.usd.sheet import T, apply, point, put, transform
from hymeko_x.formats import usd as words
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Box, Capsule, Cylinder, Ellipsoid, Mesh, MeshShape, NoShape, Plane, Role, Sphere

if TYPE_CHECKING:
    from hymeko_x.backends.usd.sheet import Sheet
    from hymeko_x.ir.mechanism import Id, ShapeView
    from hymeko_x.ir.values import Vec3


def write_shapes(sheet: Sheet) -> None:
    """Every shape of every body and of the world; a mesh that is shown more than once is authored once and referred to."""
    users: dict[Id, int] = {}
    views = [view for found in sheet.mechanism.shapes.values() for view in found]
    for view in views:
        if view.mesh is not None:
            users[view.mesh] = users.get(view.mesh, 0) + 1
    shared: dict[Id, Any] = {}
    for view in views:
        write_shape(sheet, view, users, shared)


def write_shape(sheet: Sheet, view: ShapeView, users: dict[Id, int], shared: dict[Id, Any]) -> None:
    """One gprim with its pose, size, purpose, colour and material."""
    body = sheet.root if view.body == WORLD else sheet.homes[view.body]
    spec = sheet.place(view.id, body, "Xform", view.shape.name or view.shape.role.value, below=view.body != WORLD)
    scale = _write_geometry(sheet, spec, view, users, shared)
    transform(spec, view.pose, scale)
    if spec.typeName == "Xform":
        sheet.made[spec.path].append("@spec")
    if view.shape.role is not Role.VISUAL:
        apply(spec, "PhysicsCollisionAPI")
        if isinstance(view.shape.geometry, MeshShape) and sheet.mechanism.notation(view.id, words.PATH) is None:
            apply(spec, "PhysicsMeshCollisionAPI")
            put(spec, "physics:approximation", T.Token, "convexHull")
            sheet.made[spec.path] += ["@PhysicsMeshCollisionAPI", "physics:approximation"]
    if view.shape.role is Role.COLLISION:
        put(spec, "purpose", T.Token, "guide")
    _write_looks(sheet, spec, view)


def _write_geometry(sheet: Sheet, spec: Any, view: ShapeView, users: dict[Id, int], shared: dict[Id, Any]) -> Vec3 | None:
    """The type and sizes of the gprim; returns the scale that its transformation needs. Sizes in m."""
    match view.shape.geometry:
        case Box(size):
            spec.typeName = "Cube"
            put(spec, "size", T.Double, 1.0)
            _extent(spec, (0.5, 0.5, 0.5))
            return size
        case Sphere(radius):
            spec.typeName = "Sphere"
            put(spec, "radius", T.Double, radius)
            _extent(spec, (radius, radius, radius))
        case Ellipsoid(radii):
            spec.typeName = "Sphere"
            put(spec, "radius", T.Double, 1.0)
            _extent(spec, (1.0, 1.0, 1.0))
            return radii
        case Cylinder(radius, length) | Capsule(radius, length) as round_:
            is_capsule = isinstance(round_, Capsule)
            spec.typeName = "Capsule" if is_capsule else "Cylinder"
            put(spec, "axis", T.Token, "Z")
            put(spec, "radius", T.Double, radius)
            put(spec, "height", T.Double, length)
            _extent(spec, (radius, radius, length / 2 + (radius if is_capsule else 0.0)))
        case Plane((x, y)):
            spec.typeName = "Plane"
            put(spec, "axis", T.Token, "Z")
            put(spec, "width", T.Double, 2 * x)
            put(spec, "length", T.Double, 2 * y)
            _extent(spec, (x, y, 0.0))
        case MeshShape():
            return _write_mesh_shape(sheet, spec, view, users, shared)
        case NoShape():
            pass
    return None


def _extent(spec: Any, half: Vec3) -> None:
    put(spec, "extent", T.Float3Array, Vt.Vec3fArray([Gf.Vec3f(*(-value for value in half)), Gf.Vec3f(*half)]))


# ---- meshes --------------------------------------------------------------------------------------------------------------------


def _write_mesh_shape(sheet: Sheet, spec: Any, view: ShapeView, users: dict[Id, int], shared: dict[Id, Any]) -> Vec3 | None:
    """The mesh itself, or a reference to where it is; without points the prim stays a mere place."""
    mesh = sheet.mechanism.graph.vertices.get(view.mesh) if view.mesh is not None else None
    if view.mesh is None or not isinstance(mesh, Mesh):
        return None
    if users[view.mesh] == 1 or not is_drawable(mesh):
        _carry_mesh(sheet, spec, view.mesh)
        _write_points(spec, mesh)
    else:
        if view.mesh not in shared:
            shared[view.mesh] = _write_prototype(sheet, view.mesh, mesh)
            _carry_mesh(sheet, spec, view.mesh)
        spec.typeName = "Mesh"
        spec.referenceList.prependedItems = [Sdf.Reference(primPath=shared[view.mesh])]
    sheet.made[spec.path].append("subdivisionScheme")
    return None if mesh.scale == (1.0, 1.0, 1.0) or not is_drawable(mesh) else mesh.scale


def _carry_mesh(sheet: Sheet, spec: Any, mesh: Id) -> None:
    """The prim of a mesh carries it; it says nothing about subdivision but that there is none."""
    sheet.homes[mesh] = spec.path
    sheet.carried[spec.path]["mesh"] = mesh


def _write_prototype(sheet: Sheet, key: Id, mesh: Mesh) -> Any:
    """A mesh that is shown several times: a class, which is seen only through references to it."""
    scope = sheet.root.AppendChild("meshes")
    if not sheet.layer.GetPrimAtPath(scope):
        group = sheet.define(scope, "Scope")
        group.specifier = Sdf.SpecifierClass
        put(group, f"{words.PREFIX}scope", T.Bool, True)
    spec = sheet.define(sheet.free_path(scope, key.name), "Mesh")
    _write_points(spec, mesh)
    return spec.path


def is_drawable(mesh: Mesh) -> bool:
    """Whether a mesh has points, all of them finite in single precision, and triangles between them."""
    import numpy as np

    if not mesh.vertices or len(mesh.vertices) % 3 or len(mesh.faces) % 3:
        return False
    points, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces, dtype=np.int64)
    if np.abs(points).max() > 3e38 or not np.isfinite(points).all():
        return False
    return not faces.size or bool(faces.min() >= 0 and faces.max() < len(points) // 3)


def _write_points(spec: Any, mesh: Mesh) -> None:
    """Points in single precision, triangles, and no subdivision. Nothing for a mesh whose file was not there."""
    import numpy as np

    if not is_drawable(mesh):
        return
    points = np.asarray(mesh.vertices, dtype=np.float32).reshape(-1, 3)
    faces = np.asarray(mesh.faces, dtype=np.int32)
    spec.typeName = "Mesh"
    put(spec, "points", T.Point3fArray, Vt.Vec3fArray.FromNumpy(points))
    put(spec, "faceVertexCounts", T.IntArray, Vt.IntArray.FromNumpy(np.full(len(faces) // 3, 3, dtype=np.int32)))
    put(spec, "faceVertexIndices", T.IntArray, Vt.IntArray.FromNumpy(faces))
    put(spec, "subdivisionScheme", T.Token, "none")
    box = np.stack([points.min(axis=0), points.max(axis=0)])
    put(spec, "extent", T.Float3Array, Vt.Vec3fArray.FromNumpy(box))


# ---- looks ---------------------------------------------------------------------------------------------------------------------


def _write_looks(sheet: Sheet, spec: Any, view: ShapeView) -> None:
    rgba = view.shape.rgba
    if rgba is not None:
        put(spec, "primvars:displayColor", T.Color3fArray, Vt.Vec3fArray([Gf.Vec3f(*rgba[:3])]))
        put(spec, "primvars:displayOpacity", T.FloatArray, Vt.FloatArray([rgba[3]]))
    if view.material is not None and view.material in sheet.homes:
        apply(spec, "MaterialBindingAPI")
        point(spec, "material:binding", sheet.homes[view.material])
