"""Shapes as gprims below their bodies: colliders have the collision API; those that are only for that, the purpose guide."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pxr import Gf, Vt

from hymeko_x.backends.usd.materials import bind
from hymeko_x.backends.usd.meshes import has_own, write_mesh_shape, write_normals, write_subsets, write_triangles
from hymeko_x.backends.usd.sheet import T, apply, put
from hymeko_x.formats import usd as words
from hymeko_x.formats.usd import shapes as gprims
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import MeshShape, Role
from hymeko_x.ir.values import NO_ROTATION, Pose, compose, quat_inverse
from hymeko_x.ir.written import clean_pose

if TYPE_CHECKING:
    from hymeko_x.backends.usd.sheet import UsdSheet
    from hymeko_x.ir.mechanism import Id, Mechanism, ShapeView
    from hymeko_x.ir.values import Vec3


def write_shapes(sheet: UsdSheet) -> None:
    """Every shape of every body and of the world; a mesh that is shown more than once is authored once and referred to."""
    users = {mesh: len(views) for mesh, views in sheet.mechanism.shapes_by_mesh().items()}
    shared: dict[Id, Any] = {}
    for view in sheet.mechanism.every_shape():
        write_shape(sheet, view, users, shared)


def gprim_pose(view: ShapeView, prim: gprims.Gprim | None) -> Pose:
    """Where the prim of a shape is in its body: a primitive along another axis than z is turned back."""
    turn = NO_ROTATION if prim is None else gprims.geometry_of(prim).turn
    return view.pose if turn == NO_ROTATION else clean_pose(compose(view.pose, Pose(quat=quat_inverse(turn))))


def _unless_one(scale: Vec3) -> Vec3 | None:
    return None if scale == (1.0, 1.0, 1.0) else scale


def write_shape(sheet: UsdSheet, view: ShapeView, users: dict[Id, int], shared: dict[Id, Any]) -> None:
    """One gprim with its pose, size, purpose, colour and material."""
    body = sheet.root if view.body == WORLD else sheet.paths[view.body]
    prim = gprim_of(sheet.mechanism, view)
    is_body = sheet.body_shapes.get(view.body) == view.id
    if is_body:
        spec = sheet.prims[body]
        sheet.paths[view.id] = body
    else:
        spec = sheet.add_prim(view.id, body, "Xform", view.shape.name or view.shape.role.value, below=view.body != WORLD)
        if view.shape.name is None:  # it is not its name
            spec.info.pop("displayName", None)
    if prim is not None:
        _write_primitive(spec, prim)
    if prim is not None and prim.kind == "Mesh" and has_own(sheet.mechanism, view.id, words.NORMALS):
        write_normals(spec, gprims.ball())
    scale = write_mesh_shape(sheet, spec, view, users, shared) if isinstance(view.shape.geometry, MeshShape) else None
    if not is_body:
        sheet.set_pose(spec, gprim_pose(view, prim), scale if prim is None else _unless_one(prim.scale), on=view.body)
    if view.shape.role is not Role.VISUAL:
        apply(spec, "PhysicsCollisionAPI")
        if _is_hull(sheet.mechanism, view, prim):
            apply(spec, "PhysicsMeshCollisionAPI")
            put(spec, "physics:approximation", T.Token, "convexHull")
    if view.shape.role is Role.COLLISION:
        put(spec, "purpose", T.Token, "guide")
    _write_looks(sheet, spec, view)
    write_subsets(sheet, spec, view)


def _is_hull(mechanism: Mechanism, view: ShapeView, prim: gprims.Gprim | None) -> bool:
    """Whether the hull of a mesh collides: of new prims it does, those from a stage have an attribute for it."""
    if prim is not None:
        return prim.kind == "Mesh"
    return isinstance(view.shape.geometry, MeshShape) and mechanism.notation(view.id, words.PATH) is None


def gprim_of(mechanism: Mechanism, view: ShapeView) -> gprims.Gprim | None:
    """The primitive of a shape: as its author wrote it where that still means the same, else the plainest one."""
    noted = mechanism.notation(view.id, gprims.GPRIM)
    if noted is not None and gprims.geometry_of(noted).geometry == view.shape.geometry:
        return noted
    return gprims.default_gprim(view.shape.geometry, view.shape.role)


def _write_primitive(spec: Any, prim: gprims.Gprim) -> None:
    """Type, sizes, axis and the box around it."""
    if prim.kind == "Mesh":
        return write_triangles(spec, gprims.ball())
    spec.kind = prim.kind
    for (name, _), value in zip(gprims.SIZES[prim.kind], prim.sizes, strict=True):
        put(spec, name, T.Double, value)
    if prim.is_axial:
        put(spec, "axis", T.Token, prim.axis)
    half = gprims.half_extent(prim)
    put(spec, "extent", T.Float3Array, Vt.Vec3fArray([Gf.Vec3f(*(-value for value in half)), Gf.Vec3f(*half)]))
    return None


# ---- appearance ------------------------------------------------------------------------------------------------------------------


def _write_looks(sheet: UsdSheet, spec: Any, view: ShapeView) -> None:
    rgba = view.shape.rgba
    if rgba is not None:
        put(spec, "primvars:displayColor", T.Color3fArray, Vt.Vec3fArray([Gf.Vec3f(*rgba[:3])]))
        if rgba[3] != 1.0:
            put(spec, "primvars:displayOpacity", T.FloatArray, Vt.FloatArray([rgba[3]]))
    if view.material is not None and view.material in sheet.paths:
        bind(sheet, spec, view.material)
