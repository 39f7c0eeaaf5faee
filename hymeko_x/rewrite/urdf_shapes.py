"""Shapes that URDF has no word for, rewritten into boxes, cylinders, spheres and meshes."""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats.urdf.notations import STYLE, Explicit, Style
from hymeko_x.ir.graph import Edge
from hymeko_x.ir.mechanism import ROOT, Id, Mechanism, ShapeView, shape_edge
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.parts import Box, Capsule, Cylinder, Ellipsoid, Mesh, MeshShape, Plane, Role, Shape, Sphere
from hymeko_x.ir.values import Pose, compose

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import RobotEdge
    from hymeko_x.ir.names import Names
    from hymeko_x.ir.parts import Geometry
    from hymeko_x.rewrite.context import Context

PLANE_SIZE = 100.0
"""The edge length in m of the box that stands for an infinite plane."""
_THICKNESS = 1e-3
_RINGS = 12

Piece = tuple["Geometry", Pose]


def split_shared_shapes(mechanism: Mechanism, _context: Context) -> Mechanism:
    """A shape that is seen and collides becomes a visual and a collision."""
    shared = [view for view in mechanism.every_shape() if view.shape.role is Role.BOTH]
    if not shared:
        return mechanism
    names = names_in_use(mechanism)
    edges: dict[Id, RobotEdge] = {}
    for view in shared:
        for key, role in ((view.id, Role.VISUAL), (names.take("shape", f"{view.body.name}/collision"), Role.COLLISION)):
            edges[key] = Edge(_shape_as(view.shape, view.shape.geometry, role), mechanism.graph.edges[view.id].arcs)
    return mechanism.with_graph(mechanism.graph.replace(edges=edges))


def prefer_own_colours(mechanism: Mechanism, context: Context) -> Mechanism:
    """A shape with a colour of its own beside a material keeps the colour, which is the one that is seen."""
    edges: dict[Id, RobotEdge] = {}
    for view in mechanism.every_shape():
        if view.shape.rgba is None or view.material is None:
            continue
        edges[view.id] = shape_edge(view.shape, view.body, view.pose, view.mesh)
        said = f"{view.id} has a colour of its own and {view.material}; only its colour is written"
        context.report.note(codes.REWRITTEN, said, mechanism.origin(view.id), element=str(view.id))
    return mechanism.with_graph(mechanism.graph.replace(edges=edges)) if edges else mechanism


def approximate_shapes(mechanism: Mechanism, context: Context) -> Mechanism:
    """Capsules become a cylinder and two spheres, planes thin boxes, ellipsoids stretched sphere meshes."""
    keeps_capsules = Explicit.CAPSULE in (mechanism.notation(ROOT, STYLE) or Style()).explicit
    unsayable = (Ellipsoid, Plane) if keeps_capsules else (Ellipsoid, Plane, Capsule)
    found = [view for view in mechanism.every_shape() if isinstance(view.shape.geometry, unsayable)]
    if not found:
        return mechanism
    names = names_in_use(mechanism)
    edges: dict[Id, RobotEdge] = {}
    meshes: dict[Id, Mesh] = {}
    for view in found:
        geometry = view.shape.geometry
        if isinstance(geometry, Ellipsoid):
            meshes[names.take("mesh", f"{view.body.name}_ellipsoid")] = Mesh(None, geometry.radii, None, *_unit_sphere())
            edges[view.id] = _in_place(view, MeshShape(), view.pose, next(reversed(meshes)))
        else:
            edges |= _pieces(view, names)
        kind = type(geometry).__name__.lower()
        said = f"{view.id} is {'an' if kind[0] in 'aeiou' else 'a'} {kind}, for which URDF has no word; it is written as {_INSTEAD[kind]}"
        context.report.note(codes.REWRITTEN, said, mechanism.origin(view.id), element=str(view.id))
    return mechanism.with_graph(mechanism.graph.replace(vertices=meshes, edges=edges))


_INSTEAD = {"capsule": "a cylinder and two spheres", "plane": "a thin box", "ellipsoid": "a mesh"}


def _pieces(view: ShapeView, names: Names) -> dict[Id, RobotEdge]:
    """The shapes that stand for a capsule or a plane; the first one keeps the id."""
    match view.shape.geometry:
        case Capsule(radius, length):
            ends = [(Sphere(radius), Pose((0.0, 0.0, z))) for z in (length / 2.0, -length / 2.0)]
            pieces: list[Piece] = [(Cylinder(radius, length), Pose()), *ends]
        case Plane((x, y)):
            size = (2.0 * x or PLANE_SIZE, 2.0 * y or PLANE_SIZE, _THICKNESS)
            pieces = [(Box(size), Pose((0.0, 0.0, -_THICKNESS / 2.0)))]
        case _:
            pieces = []
    found: dict[Id, RobotEdge] = {}
    role = view.shape.role
    for geometry, pose in pieces:
        key = view.id if not found else names.take("shape", f"{view.body.name}/{'shape' if role is Role.BOTH else role.value}")
        found[key] = _in_place(view, geometry, compose(view.pose, pose), None)
    return found


def _in_place(view: ShapeView, geometry: Geometry, pose: Pose, mesh: Id | None) -> RobotEdge:
    return shape_edge(_shape_as(view.shape, geometry, view.shape.role), view.body, pose, mesh, view.material)


def _shape_as(shape: Shape, geometry: Geometry, role: Role) -> Shape:
    """The shape with another geometry or role."""
    return Shape(geometry, role, shape.name, shape.rgba, shape.mass, shape.density, shape.friction)


@cache
def _unit_sphere() -> tuple[tuple[float, ...], tuple[int, ...]]:
    """Points and triangles of a sphere of radius 1 m, in rings about z; a pole is a point, a ring has twice as many as rings."""
    around = 2 * _RINGS
    points = [(0.0, 0.0, 1.0)]
    for ring in range(1, _RINGS):
        height, radius = math.cos(math.pi * ring / _RINGS), math.sin(math.pi * ring / _RINGS)
        turns = (2.0 * math.pi * step / around for step in range(around))
        points += [(radius * math.cos(turn), radius * math.sin(turn), height) for turn in turns]
    points.append((0.0, 0.0, -1.0))
    last = len(points) - 1
    faces = []
    for step in range(around):
        after = (step + 1) % around
        faces += [(0, 1 + step, 1 + after), (last, last - around + after, last - around + step)]
        for ring in range(_RINGS - 2):
            upper, lower = 1 + ring * around, 1 + (ring + 1) * around
            faces += [(upper + step, lower + step, lower + after), (upper + step, lower + after, upper + after)]
    return tuple(value for point in points for value in point), tuple(corner for face in faces for corner in face)
