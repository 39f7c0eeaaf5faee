"""Shapes as gprims below their bodies: what collides has the collision API, and what is only for that the purpose guide."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pxr import Gf, Sdf, Vt

from hymeko_x.backends.usd.prims import T
from hymeko_x.backends.usd.sheet import apply, point, put
from hymeko_x.backends.usd.surfaces import places_of, surface_of
from hymeko_x.formats import usd as words
from hymeko_x.formats.usd import gprims
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Mesh, MeshShape, Role
from hymeko_x.ir.values import NO_ROTATION, Pose, compose, quat_inverse
from hymeko_x.meshes.measures import face_normals

if TYPE_CHECKING:
    from hymeko_x.backends.usd.prims import Prim
    from hymeko_x.backends.usd.sheet import Sheet
    from hymeko_x.backends.usd.surfaces import Surface
    from hymeko_x.ir.mechanism import Id, Mechanism, ShapeView
    from hymeko_x.ir.values import Vec3

_ST = "primvars:st"


def write_shapes(sheet: Sheet) -> None:
    """Every shape of every body and of the world; a mesh that is shown more than once is authored once and referred to."""
    users = {mesh: len(views) for mesh, views in sheet.mechanism.shapes_by_mesh().items()}
    shared: dict[Id, Any] = {}
    for view in sheet.mechanism.every_shape():
        write_shape(sheet, view, users, shared)


def skin_pose(view: ShapeView, prim: gprims.Gprim | None) -> Pose:
    """Where the prim of a shape is in its body: a primitive along another axis than z is turned back."""
    turn = NO_ROTATION if prim is None else gprims.meaning(prim).turn
    return view.pose if turn == NO_ROTATION else compose(view.pose, Pose(quat=quat_inverse(turn)))


def _unless_one(scale: Vec3) -> Vec3 | None:
    return None if scale == (1.0, 1.0, 1.0) else scale


def write_shape(sheet: Sheet, view: ShapeView, users: dict[Id, int], shared: dict[Id, Any]) -> None:
    """One gprim with its pose, size, purpose, colour and material."""
    body = sheet.root if view.body == WORLD else sheet.homes[view.body]
    prim = gprim_of(sheet.mechanism, view)
    is_body = sheet.skins.get(view.body) == view.id
    if is_body:
        spec = sheet.prims[body]
        sheet.homes[view.id] = body
    else:
        spec = sheet.place(view.id, body, "Xform", view.shape.name or view.shape.role.value, below=view.body != WORLD)
        if view.shape.name is None:  # nobody calls it so
            spec.info.pop("displayName", None)
    if prim is not None:
        _write_primitive(spec, prim)
    scale = _write_mesh_shape(sheet, spec, view, users, shared) if isinstance(view.shape.geometry, MeshShape) else None
    if not is_body:
        sheet.move(spec, skin_pose(view, prim), scale if prim is None else _unless_one(prim.scale), on=view.body)
    if view.shape.role is not Role.VISUAL:
        apply(spec, "PhysicsCollisionAPI")
        if _is_hull(sheet.mechanism, view, prim):
            apply(spec, "PhysicsMeshCollisionAPI")
            put(spec, "physics:approximation", T.Token, "convexHull")
    if view.shape.role is Role.COLLISION:
        put(spec, "purpose", T.Token, "guide")
    _write_looks(sheet, spec, view)
    _write_subsets(sheet, spec, view)


def _is_hull(mechanism: Mechanism, view: ShapeView, prim: gprims.Gprim | None) -> bool:
    """Whether the hull of a mesh collides: of ours it does, those of others say for themselves."""
    if prim is not None:
        return prim.kind == "Mesh"
    return isinstance(view.shape.geometry, MeshShape) and mechanism.notation(view.id, words.PATH) is None


def gprim_of(mechanism: Mechanism, view: ShapeView) -> gprims.Gprim | None:
    """The primitive of a shape: as its author wrote it where that still means the same, else the plainest one."""
    noted = gprims.parse(mechanism.notation(view.id, gprims.NOTATION))
    if noted is not None and gprims.meaning(noted).geometry == view.shape.geometry:
        return noted
    return gprims.chosen(view.shape.geometry, view.shape.role)


def _write_primitive(spec: Any, prim: gprims.Gprim) -> None:
    """Type, sizes, axis and the box around it."""
    if prim.kind == "Mesh":
        return _write_surface(spec, gprims.ball())
    spec.kind = prim.kind
    for (name, _), value in zip(gprims.SIZES[prim.kind], prim.sizes, strict=True):
        put(spec, name, T.Double, value)
    if prim.is_axial:
        put(spec, "axis", T.Token, prim.axis)
    half = gprims.half_extent(prim)
    put(spec, "extent", T.Float3Array, Vt.Vec3fArray([Gf.Vec3f(*(-value for value in half)), Gf.Vec3f(*half)]))
    return None


# ---- meshes --------------------------------------------------------------------------------------------------------------------


def _write_mesh_shape(sheet: Sheet, spec: Any, view: ShapeView, users: dict[Id, int], shared: dict[Id, Any]) -> Vec3 | None:
    """The mesh itself, or a reference to where it is; without points the prim stays a mere place."""
    mesh = sheet.mechanism.graph.vertices.get(view.mesh) if view.mesh is not None else None
    if view.mesh is None or not isinstance(mesh, Mesh):
        return None
    if view.mesh not in sheet.surfaces:
        sheet.surfaces[view.mesh] = surface_of(mesh)
    surface = sheet.surfaces[view.mesh]
    if users[view.mesh] == 1 or surface is None:
        _carry_mesh(sheet, spec, view.mesh)
        if surface is not None:
            _write_surface(spec, surface)
            if _says(sheet.mechanism, view.id, words.NORMALS):
                _write_normals(spec, surface)
            if _says(sheet.mechanism, view.id, words.TEXCOORDS):
                _write_places(spec, mesh)
    else:
        if view.mesh not in shared:
            shared[view.mesh] = _write_prototype(sheet, view.mesh, mesh, surface)
            _carry_mesh(sheet, spec, view.mesh)
        spec.kind = "Mesh"
        spec.reference = shared[view.mesh]
    return None if mesh.scale == (1.0, 1.0, 1.0) or surface is None else mesh.scale


def _says(mechanism: Mechanism, shape: Id, notation: str) -> bool:
    """Whether a mesh says this of its triangles as we do: ours do, those of others where they did."""
    return mechanism.notation(shape, words.PATH) is None or mechanism.notation(shape, notation) is not None


def _carry_mesh(sheet: Sheet, spec: Any, mesh: Id) -> None:
    """The prim of a mesh carries it; it says nothing about subdivision but that there is none."""
    sheet.homes[mesh] = spec.path


def _write_prototype(sheet: Sheet, key: Id, mesh: Mesh, surface: Surface) -> Any:
    """A mesh that is shown several times: a class, which is seen only through references to it."""
    scope = sheet.root.AppendChild("meshes")
    if scope not in sheet.prims:
        group = sheet.define(scope, "Scope")
        group.specifier = Sdf.SpecifierClass
        put(group, f"{words.PREFIX}scope", T.Bool, True)
    spec = sheet.define(sheet.free_path(scope, key.name), "Mesh")
    _write_surface(spec, surface)
    _write_normals(spec, surface)
    _write_places(spec, mesh)
    return spec.path


def _write_surface(prim: Prim, surface: Surface) -> None:
    """Points in single precision, triangles, and no subdivision."""
    import numpy as np

    points, faces = surface
    prim.kind = "Mesh"
    put(prim, "points", T.Point3fArray, Vt.Vec3fArray.FromNumpy(points))
    put(prim, "faceVertexCounts", T.IntArray, Vt.IntArray(len(faces) // 3, 3))
    put(prim, "faceVertexIndices", T.IntArray, Vt.IntArray.FromNumpy(faces))
    put(prim, "subdivisionScheme", T.Token, "none")
    axes = np.ascontiguousarray(points.T)  # of which a least value is found much faster
    box = np.stack([axes.min(axis=1), axes.max(axis=1)])
    put(prim, "extent", T.Float3Array, Vt.Vec3fArray.FromNumpy(box))


def _write_normals(prim: Prim, surface: Surface) -> None:
    """One normal for each triangle, for programs that compute none of their own; a degenerate triangle has some unit vector."""
    put(prim, "normals", T.Normal3fArray, Vt.Vec3fArray.FromNumpy(face_normals(*surface)))
    prim.spread["normals"] = "uniform"


def _write_places(prim: Prim, mesh: Mesh) -> None:
    """Where the corners of the triangles are in the image of the material."""
    found = places_of(mesh)
    if found is None:
        return
    put(prim, _ST, T.TexCoord2fArray, Vt.Vec2fArray.FromNumpy(found[0]))
    put(prim, f"{_ST}:indices", T.IntArray, Vt.IntArray.FromNumpy(found[1]))
    prim.spread[_ST] = "faceVarying"


# ---- looks ---------------------------------------------------------------------------------------------------------------------


def _write_looks(sheet: Sheet, spec: Any, view: ShapeView) -> None:
    rgba = view.shape.rgba
    if rgba is not None:
        put(spec, "primvars:displayColor", T.Color3fArray, Vt.Vec3fArray([Gf.Vec3f(*rgba[:3])]))
        put(spec, "primvars:displayOpacity", T.FloatArray, Vt.FloatArray([rgba[3]]))
    if view.material is not None and view.material in sheet.homes:
        _bind(sheet, spec, view.material)


def _bind(sheet: Sheet, spec: Prim, material: Id) -> None:
    apply(spec, "MaterialBindingAPI")
    point(spec, "material:binding", sheet.homes[material])


def _write_subsets(sheet: Sheet, spec: Prim, view: ShapeView) -> None:
    """The triangles of a mesh that show other materials, each a prim below it."""
    surface = sheet.surfaces.get(view.mesh) if view.mesh is not None else None
    count = 0 if surface is None else len(surface[1]) // 3
    for subset in sheet.mechanism.subsets.get(view.id, ()):
        if not subset.faces or min(subset.faces) < 0 or max(subset.faces) >= count or subset.material not in sheet.homes:
            continue
        prim = sheet.place(subset.id, spec.path, "GeomSubset", subset.id.name.partition("#")[0], below=True)
        put(prim, "elementType", T.Token, words.FACE)
        put(prim, "familyName", T.Token, words.LOOKS)
        put(prim, "indices", T.IntArray, Vt.IntArray(subset.faces))
        _bind(sheet, prim, subset.material)
        put(spec, words.FAMILY, T.Token, words.APART)
