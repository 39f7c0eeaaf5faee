"""Shapes whose points or sizes only MuJoCo computes: meshes in its own file type, of formulas or moved, and primitives fitted to meshes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from hymeko_x.formats.mjcf.words import NAME
from hymeko_x.ir.mechanism import file_stem, shape_edge
from hymeko_x.ir.parts import Box, Capsule, Cylinder, Ellipsoid, Mesh, NoShape, Sphere
from hymeko_x.ir.values import pose

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge, ShapeView
    from hymeko_x.ir.parts import Geometry

_MADE = ("@builtin", "@refpos", "@refquat")


def unsolid(mechanism: Mechanism) -> tuple[list[Id], list[ShapeView]]:
    """The meshes and the shapes of a mechanism from MJCF that MuJoCo has to be asked about."""
    meshes = [key for key, mesh in mechanism.vertices(Mesh) if _is_made(mechanism, key, mesh)]
    shapes = [view for view in mechanism.every_shape() if _is_fitted(mechanism, view)]
    return meshes, shapes


def _is_made(mechanism: Mechanism, key: Id, mesh: Mesh) -> bool:
    if any(extra.format == NAME and extra.path in _MADE for extra in mechanism.extras.get(key, ())):
        return True
    return mesh.uri.lower().endswith(".msh") if mesh.uri is not None else bool(mesh.vertices and not mesh.faces)


def _is_fitted(mechanism: Mechanism, view: ShapeView) -> bool:
    """Whether a shape is a primitive that MuJoCo fits to a mesh."""
    if not isinstance(view.shape.geometry, NoShape):
        return False
    return any(extra.format == NAME and extra.path == "@mesh" for extra in mechanism.extras.get(view.id, ()))


def solid_mesh(mechanism: Mechanism, mujoco: Any, model: Any, key: Id) -> Mesh:
    """A mesh with its points and triangles where MuJoCo has them, in the frame that poses of shapes mean."""
    mesh = mechanism.vertex(key, Mesh)
    names = [mesh.name, key.name, file_stem(mesh.uri or "")]
    found = (mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_MESH, name) for name in names if name)
    number = next((number for number in found if number >= 0), -1)
    if number < 0:
        return mesh
    points, faces = int(model.mesh_vertadr[number]), int(model.mesh_faceadr[number])
    centred = model.mesh_vert[points : points + int(model.mesh_vertnum[number])].astype(float)
    vertices = centred @ _turn(mujoco, model.mesh_quat[number]).T + model.mesh_pos[number]
    corners = model.mesh_face[faces : faces + int(model.mesh_facenum[number])]
    return replace(mesh, uri=None, scale=(1.0, 1.0, 1.0), vertices=tuple(vertices.ravel().tolist()), faces=tuple(corners.ravel().tolist()))


def _turn(mujoco: Any, quat: Any) -> Any:
    import numpy as np

    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, quat)
    return turn.reshape(3, 3)


def fitted_shape(mujoco: Any, model: Any, view: ShapeView, geom: int) -> RobotEdge | None:
    """A shape as the primitive that MuJoCo made of it; None where that is none of ours."""
    geometry = _geometry(mujoco, model, geom)
    if geometry is None:
        return None
    x, y, z = model.geom_pos[geom].tolist()
    place = pose((x, y, z), tuple(model.geom_quat[geom].tolist()))
    return shape_edge(replace(view.shape, geometry=geometry), view.body, place, None, view.material)


def _geometry(mujoco: Any, model: Any, geom: int) -> Geometry | None:
    a, b, c = model.geom_size[geom].tolist()
    kinds = mujoco.mjtGeom
    match int(model.geom_type[geom]):
        case kinds.mjGEOM_SPHERE:
            return Sphere(a)
        case kinds.mjGEOM_CAPSULE:
            return Capsule(a, 2.0 * b)
        case kinds.mjGEOM_CYLINDER:
            return Cylinder(a, 2.0 * b)
        case kinds.mjGEOM_BOX:
            return Box((2.0 * a, 2.0 * b, 2.0 * c))
        case kinds.mjGEOM_ELLIPSOID:
            return Ellipsoid((a, b, c))
        case _:
            return None
