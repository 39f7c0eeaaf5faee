"""Shapes that a format cannot represent as they are."""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING, assert_never

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import with_article
from hymeko_x.formats import native_format
from hymeko_x.ir.graph import Edge
from hymeko_x.ir.mechanism import WORLD, Id, Mechanism, ShapeView, shape_edge
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.parts import Box, Capsule, Cylinder, Ellipsoid, Geometry, Mesh, MeshShape, NoShape, Plane, Role, Shape, Sphere
from hymeko_x.ir.values import Pose, compose

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge
    from hymeko_x.ir.names import Names
    from hymeko_x.ir.parts import Geometry
    from hymeko_x.rewrite.context import Context


# ---- sizes, names and engines ------------------------------------------------------------------------------------------


THINNEST = 1e-6
"""The length in m that stands for a length of zero."""
_NO_LENGTH = 1e-12


def _never(_: Id) -> bool:
    return False


def drop_empty_shapes(mechanism: Mechanism, context: Context, has_own_geometry: Callable[[Id], bool] = _never) -> Mechanism:
    """A shape without a geometry, or of a mesh that is not there, is left out, unless it has a geometry that only the target has."""
    gone = []
    for view in mechanism.every_shape():
        lost = isinstance(view.shape.geometry, MeshShape) and view.mesh not in mechanism.graph.vertices
        if not lost and (not isinstance(view.shape.geometry, NoShape) or has_own_geometry(view.id)):
            continue
        gone.append(view.id)
        reason = "has no mesh" if lost else "has no geometry that the target can represent"
        context.report.note(codes.NOT_REPRESENTED, f"{view.id} {reason}; it is left out", mechanism.origin(view.id), element=str(view.id))
    return mechanism.replace(without=gone)


def drop_engine_shapes(mechanism: Mechanism, context: Context) -> Mechanism:
    """Shapes whose geometry only the engine of the robot's own format has: height fields, distance functions, fitted primitives."""
    native = native_format(mechanism)
    if native is None:
        return mechanism
    gone = [view.id for view in mechanism.every_shape() if isinstance(view.shape.geometry, NoShape)]
    for key in gone:
        message = f"{key} has a geometry that only {native.title} can represent; it is left out"
        context.report.warn(codes.NOT_REPRESENTED, message, mechanism.origin(key), element=str(key))
    return mechanism.replace(without=gone)


def drop_unused_assets(mechanism: Mechanism, _context: Context) -> Mechanism:
    """Meshes of no shape and images of no material have no place in the target; the ledger names them."""
    used = {arc.target for edge in mechanism.graph.edges.values() for arc in edge.arcs}
    gone = [key for key, _ in mechanism.assets() if key not in used]
    return mechanism.replace(without=gone)


def make_sizes_positive(mechanism: Mechanism, context: Context) -> Mechanism:
    """Lengths of zero become very small ones, negative lengths lose their sign."""
    changed: dict[Id, RobotEdge] = {}
    for key, shape, arcs in mechanism.edges(Shape):
        geometry = _sized(shape.geometry)
        if geometry == shape.geometry:
            continue
        changed[key] = replace(mechanism.graph.edges[key], data=replace(shape, geometry=geometry), arcs=arcs)
        context.report.warn(
            codes.REWRITTEN,
            f"{key} has the size {_words(shape.geometry)}; {_words(geometry)} is written",
            mechanism.origin(key),
            element=str(key),
        )
    return mechanism.replace(edges=changed)


def keep_planes_static(mechanism: Mechanism, context: Context) -> Mechanism:
    """A plane on a body that can move becomes a thin box; an infinite one is left out."""
    if not any(isinstance(shape.geometry, Plane) for _, shape, _ in mechanism.edges(Shape)):
        return mechanism
    static = _static_bodies(mechanism)
    changed: dict[Id, RobotEdge] = {}
    gone: list[Id] = []
    for key, shape, arcs in mechanism.edges(Shape):
        if not isinstance(shape.geometry, Plane) or arcs[0].target in static:
            continue
        if not all(shape.geometry.half_size):
            gone.append(key)
            context.report.warn(
                codes.NOT_REPRESENTED,
                f"{key} is an infinite plane on a body that moves; it is left out",
                mechanism.origin(key),
                element=str(key),
            )
            continue
        x, y = shape.geometry.half_size
        changed[key] = replace(mechanism.graph.edges[key], data=replace(shape, geometry=Box((2.0 * x, 2.0 * y, THINNEST))))
        context.report.note(
            codes.REWRITTEN, f"{key} is a plane on a body that moves; it is written as a thin box", mechanism.origin(key), element=str(key)
        )
    pairs = [edge for key in gone for edge, _, _ in mechanism.graph.edges_at(key) if edge.kind == "contact"]
    return mechanism.replace(edges=changed, without=[*gone, *pairs])


def name_shapes_once(mechanism: Mechanism, context: Context) -> Mechanism:
    """The first shape of a name keeps it, later ones are written without a name."""
    seen: set[str] = set()
    changed: dict[Id, RobotEdge] = {}
    for key, shape, _ in mechanism.edges(Shape):
        if shape.name is None:
            continue
        if shape.name and shape.name not in seen:
            seen.add(shape.name)
            continue
        changed[key] = replace(mechanism.graph.edges[key], data=replace(shape, name=None))
        if shape.name:
            context.report.note(
                codes.RENAMED,
                f"another shape is called '{shape.name}' already; this one is written without a name",
                mechanism.origin(key),
                element=str(key),
            )
    return mechanism.replace(edges=changed)


# ---- parts of the rules ----------------------------------------------------------------------------------------------------


def _sized(geometry: Geometry) -> Geometry:
    match geometry:
        case Box():
            x, y, z = geometry.size
            return Box((_length(x), _length(y), _length(z)))
        case Sphere():
            return Sphere(_length(geometry.radius))
        case Cylinder():
            return Cylinder(_length(geometry.radius), _length(geometry.length))
        case Capsule():
            return Capsule(_length(geometry.radius), _length(geometry.length))
        case Ellipsoid():
            x, y, z = geometry.radii
            return Ellipsoid((_length(x), _length(y), _length(z)))
        case Plane() | MeshShape() | NoShape():
            return geometry
        case _:
            assert_never(geometry)


def _length(value: float) -> float:
    return abs(value) if abs(value) >= _NO_LENGTH else THINNEST


def _words(geometry: Geometry) -> str:
    match geometry:
        case Box():
            return "[{!r} {!r} {!r}]".format(*geometry.size)
        case Ellipsoid():
            return "[{!r} {!r} {!r}]".format(*geometry.radii)
        case Cylinder() | Capsule():
            return f"radius {geometry.radius!r}, length {geometry.length!r}"
        case Sphere():
            return f"radius {geometry.radius!r}"
        case _:
            return "none"


def _static_bodies(mechanism: Mechanism) -> set[Id]:
    """The world and the bodies with no dof between them and the world (or their open base)."""
    static = {WORLD}
    for body in mechanism.depth_first():
        joint = mechanism.parent_joint.get(body)
        if joint is None or (not joint.joint.dofs and joint.parent in static):
            static.add(body)
    return static


# ---- in primitives of another format -----------------------------------------------------------------------------------


PLANE_SIZE = 100.0
"""The edge length in m of the box that stands for an infinite plane."""
_THICKNESS = 1e-3
FACETS = (40, 24)
"""Facets of a sphere around its axis and along it. So drawn, a capsule differs from a cylinder and two spheres in 0.4 % of its picture."""

_ENDS = ("_top", "_bottom")
"""Behind the name of a capsule that of the balls at its ends."""

Piece = tuple[str, "Geometry", Pose]
"""What stands behind the name of the shape, the geometry, and where it is in the frame of the shape."""


def split_shared_shapes(mechanism: Mechanism, _context: Context, *, ending: str = "") -> Mechanism:
    """A shape that is seen and collides becomes a visual, and a collision without its appearance, whose name has the ending."""
    shared = [view for view in mechanism.every_shape() if view.shape.role is Role.BOTH]
    if not shared:
        return mechanism
    names = names_in_use(mechanism)
    edges: dict[Id, RobotEdge] = {}
    for view in shared:
        arcs, twin = mechanism.graph.edges[view.id].arcs, names.take("shape", f"{view.body.name}/collision")
        collision = replace(_shape_as(view.shape, view.shape.geometry, Role.COLLISION), rgba=None)
        plain = tuple([arc for arc in arcs if arc.target != view.material])
        edges[view.id] = Edge(_shape_as(view.shape, view.shape.geometry, Role.VISUAL), arcs)
        edges[twin] = Edge(replace(collision, name=view.shape.name and view.shape.name + ending), plain)
    return mechanism.replace(edges=edges)


def prefer_own_colours(mechanism: Mechanism, context: Context) -> Mechanism:
    """A shape with a colour of its own beside a material keeps the colour, which is the one that is seen."""
    edges: dict[Id, RobotEdge] = {}
    for view in mechanism.every_shape():
        if view.shape.rgba is None or view.material is None:
            continue
        edges[view.id] = shape_edge(view.shape, view.body, view.pose, view.mesh)
        message = f"{view.id} has a colour of its own and {view.material}; only its colour is written"
        context.report.note(codes.REWRITTEN, message, mechanism.origin(view.id), element=str(view.id))
    return mechanism.replace(edges=edges)


def approximate_shapes(mechanism: Mechanism, context: Context, kinds: tuple[type, ...]) -> Mechanism:
    """Of these kinds, capsules become a cylinder and two spheres, planes thin boxes, ellipsoids stretched sphere meshes."""
    found = [view for view in mechanism.every_shape() if isinstance(view.shape.geometry, kinds)]
    if not found:
        return mechanism
    names = names_in_use(mechanism)
    edges: dict[Id, RobotEdge] = {}
    meshes: dict[Id, Mesh] = {}
    for view in found:
        geometry = view.shape.geometry
        if isinstance(geometry, Ellipsoid):
            meshes[names.take("mesh", f"{view.body.name}_ellipsoid")] = Mesh(None, geometry.radii, None, *_unit_sphere())
            edges[view.id] = _in_place(view, view.shape.name, MeshShape(), view.pose, next(reversed(meshes)))
        else:
            edges |= _pieces(view, names)
        kind = type(geometry).__name__.lower()
        message = f"{view.id} is {with_article(kind)}, which the format cannot represent; it is written as {_INSTEAD[kind]}"
        context.report.note(codes.REWRITTEN, message, mechanism.origin(view.id), element=str(view.id))
    return mechanism.replace(vertices=meshes, edges=edges)


_INSTEAD = {"capsule": "a cylinder and two spheres", "plane": "a thin box", "ellipsoid": "a mesh"}


def pieces_of(geometry: Geometry) -> list[Piece]:
    """What stands for a capsule or a plane, the first piece in its middle; nothing for other geometries."""
    match geometry:
        case Capsule(radius, length):
            ends = [(end, Sphere(radius), Pose((0.0, 0.0, z))) for end, z in zip(_ENDS, (length / 2.0, -length / 2.0), strict=True)]
            return [("", Cylinder(radius, length), Pose()), *ends]
        case Plane((x, y)):
            size = (2.0 * x or PLANE_SIZE, 2.0 * y or PLANE_SIZE, _THICKNESS)
            return [("", Box(size), Pose((0.0, 0.0, -_THICKNESS / 2.0)))]
        case _:
            return []


def _pieces(view: ShapeView, names: Names) -> dict[Id, RobotEdge]:
    """The shapes that stand for a capsule or a plane; the first one keeps the id and the name."""
    found: dict[Id, RobotEdge] = {}
    role = view.shape.role
    for end, geometry, pose in pieces_of(view.shape.geometry):
        key = view.id if not found else names.take("shape", f"{view.body.name}/{'shape' if role is Role.BOTH else role.value}")
        place = compose(view.pose, pose)
        name = view.shape.name and view.shape.name + end
        found[key] = _in_place(view, name, geometry, Pose(place.xyz) if isinstance(geometry, Sphere) else place, None)
    return found


def _in_place(view: ShapeView, name: str | None, geometry: Geometry, pose: Pose, mesh: Id | None) -> RobotEdge:
    shape = replace(_shape_as(view.shape, geometry, view.shape.role), name=name)
    return shape_edge(shape, view.body, pose, mesh, view.material)


def _shape_as(shape: Shape, geometry: Geometry, role: Role) -> Shape:
    """The shape with another geometry or role."""
    return Shape(geometry, role, shape.name, shape.rgba, shape.mass, shape.density, shape.friction)


@cache
def _unit_sphere() -> tuple[tuple[float, ...], tuple[int, ...]]:
    """Points and triangles of a sphere of radius 1 m, in rings about z; a pole is a point."""
    around, rings = FACETS
    points = [(0.0, 0.0, 1.0)]
    for ring in range(1, rings):
        height, radius = math.cos(math.pi * ring / rings), math.sin(math.pi * ring / rings)
        turns = (2.0 * math.pi * step / around for step in range(around))
        points += [(radius * math.cos(turn), radius * math.sin(turn), height) for turn in turns]
    points.append((0.0, 0.0, -1.0))
    last = len(points) - 1
    faces = []
    for step in range(around):
        after = (step + 1) % around
        faces += [(0, 1 + step, 1 + after), (last, last - around + after, last - around + step)]
        for ring in range(rings - 2):
            upper, lower = 1 + ring * around, 1 + (ring + 1) * around
            faces += [(upper + step, lower + step, lower + after), (upper + step, lower + after, upper + after)]
    return tuple(value for point in points for value in point), tuple(corner for face in faces for corner in face)
