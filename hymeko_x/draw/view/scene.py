"""What the viewer shows of a robot: its bodies with their shapes, and what moves them."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct

from hymeko_x.assets.companions import companion_reader
from hymeko_x.assets.shelf import read_file
from hymeko_x.draw.view.motion import PosedRobot
from hymeko_x.ir.geometry import Box, Capsule, Cylinder, Ellipsoid, MeshShape, NoShape, Sphere
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Material, Mesh, Role
from hymeko_x.meshes.reader import inline_part, read_parts
from hymeko_x.meshes.submesh import Submesh, Unreadable
from hymeko_x.residue.originals import files_of
from hymeko_x.source import suffix_of
from hymeko_x.verify import model_of
from hymeko_x.verify.model import WORLD as GROUND

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from hymeko_x.ir.geometry import Geometry
    from hymeko_x.ir.mechanism import Mechanism, ShapeView
    from hymeko_x.ir.values import Pose
    from hymeko_x.robot import Robot
    from hymeko_x.source import Files
    from hymeko_x.verify.model import Array, Index, KinematicModel

_GREY = (0.7, 0.7, 0.7, 1.0)
_COLLISION = (0.2, 0.6, 0.9, 0.4)
_LEAST_MASS = 1e-9


class Item(Struct, frozen=True, eq=False):
    """One drawn shape: ``pose`` in the frame of the body with this number, ``rgba`` from 0 to 1. A mesh has ``points`` and ``faces``."""

    body: int
    pose: Pose
    geometry: Geometry
    rgba: tuple[float, float, float, float]
    is_collision: bool
    points: Array | None = None
    faces: Index | None = None


class Scene(Struct, frozen=True, eq=False):
    """A robot: its kinematics, the shapes on its bodies, and what could not be drawn, with the reason.

    ``reach`` is about how large it is, in m: half of the diagonal of a box around its bodies and their shapes at rest,
    at least 0.1.
    """

    name: str
    model: KinematicModel
    items: tuple[Item, ...]
    missing: tuple[str, ...]
    reach: float


def scene_of(robot: Robot) -> Scene:
    """The scene of a robot, with what only the engine of its format computes, such as inertias from shapes."""
    mechanism = robot.completed
    model = model_of(mechanism)
    files = files_of(mechanism, robot.files)
    items: list[Item] = []
    missing: list[str] = []
    for key, views in mechanism.shapes.items():
        body = GROUND if key == WORLD else model.index.get(key.name, GROUND)
        for view in views:
            found = [*_items(mechanism, view, body, files)]
            items += found
            if not found and not isinstance(view.shape.geometry, NoShape):
                missing.append(f"{view.id}: its mesh cannot be read")
    return Scene(mechanism.name, model, tuple(items), tuple(missing), _reach(model, items))


def _reach(model: KinematicModel, items: Sequence[Item]) -> float:
    """See :class:`Scene`. Shapes of the world, such as a floor, are no part of the robot."""
    poses = PosedRobot(model).poses()
    shapes = [item for item in items if item.body != GROUND]
    centres = [poses[item.body][:3] @ (*item.pose.xyz, 1.0) for item in shapes]
    places = np.array([*poses[1:, :3, 3], *centres]).reshape(-1, 3)
    if not len(places):
        return 0.1
    sizes = np.array([0.0] * (len(poses) - 1) + [_radius(item) for item in shapes])[:, None]
    return max(float(np.linalg.norm((places + sizes).max(axis=0) - (places - sizes).min(axis=0))) / 2.0, 0.1)


def _radius(item: Item) -> float:
    """The radius of a sphere around the origin of a shape that contains it, in m."""
    match item.geometry:
        case Box(size):
            return float(np.linalg.norm(size)) / 2.0
        case Sphere(radius):
            return radius
        case Cylinder(radius, length) | Capsule(radius, length):
            return radius + length / 2.0
        case Ellipsoid(radii):
            return max(radii)
    return 0.0 if item.points is None else float(np.linalg.norm(item.points, axis=1).max(initial=0.0))


def _items(mechanism: Mechanism, view: ShapeView, body: int, files: Files) -> Iterator[Item]:
    """A shape as it is drawn; one that is both visual and for collision is in both layers."""
    geometry, role = view.shape.geometry, view.shape.role
    layers = {Role.VISUAL: (False,), Role.COLLISION: (True,)}.get(role, (False, True))
    colour = _colour(mechanism, view)
    for is_collision in layers:
        rgba = _COLLISION if is_collision else colour or _GREY
        if isinstance(geometry, NoShape):
            continue
        if not isinstance(geometry, MeshShape):
            yield Item(body, view.pose, geometry, rgba, is_collision)
            continue
        for part in _submeshes(mechanism, view, files):
            own = part.appearance.rgba if part.appearance is not None else None
            shown = rgba if is_collision or colour is not None or own is None else own
            yield Item(body, view.pose, geometry, shown, is_collision, part.points * _scale(mechanism, view), part.faces)


def _colour(mechanism: Mechanism, view: ShapeView) -> tuple[float, float, float, float] | None:
    """The colour of a shape, else of its material, else of the first part of its mesh that has one."""
    if view.shape.rgba is not None:
        return view.shape.rgba
    for key in (view.material, *(subset.material for subset in mechanism.subsets.get(view.id, ()))):
        material = mechanism.part(key, Material)
        if material is not None and material.rgba is not None:
            return material.rgba
    return None


def _scale(mechanism: Mechanism, view: ShapeView) -> Array:
    mesh = mechanism.part(view.mesh, Mesh)
    return np.array((1.0, 1.0, 1.0) if mesh is None else mesh.scale)


def _submeshes(mechanism: Mechanism, view: ShapeView, files: Files) -> tuple[Submesh, ...]:
    """The triangles of a shape's mesh; nothing where they cannot be read."""
    mesh = mechanism.part(view.mesh, Mesh)
    if mesh is None:
        return ()
    if mesh.vertices and mesh.uri is None:
        return (inline_part(mesh),) if mesh.faces else ()
    found = None if mesh.uri is None else read_file(files, mesh.uri)
    with suppress(Unreadable):
        if mesh.uri is not None and found is not None:
            return read_parts(found[1], suffix_of(mesh.uri), companion_reader(files, mesh.uri))
    return ()


def ellipsoid_of(model: KinematicModel, body: int) -> tuple[Array, Array, Array] | None:
    """The even ellipsoid with the inertia of a body: half axes (3) in m, the rotation (3, 3) to them, the centre (3) in the body's frame.

    None where there is no mass or no tensor.
    """
    found = model.bodies[body]
    if found.mass < _LEAST_MASS or not found.tensor.any():
        return None
    moments, turn = np.linalg.eigh(found.tensor)
    if np.linalg.det(turn) < 0.0:
        turn[:, 0] *= -1.0
    squares = 2.5 / found.mass * (moments.sum() - 2.0 * moments)
    return np.sqrt(np.maximum(squares, 0.0)), turn, found.com
