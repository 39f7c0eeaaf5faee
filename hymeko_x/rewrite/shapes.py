"""Shapes that an engine can compile: a geometry each, positive sizes, planes only where nothing moves, names used once."""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.formats import native_format
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Box, Capsule, Cylinder, Ellipsoid, Geometry, MeshShape, NoShape, Plane, Shape, Sphere

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge
    from hymeko_x.rewrite.context import Context

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
        context.report.note(codes.NOT_SAID, f"{view.id} {reason}; it is left out", mechanism.origin(view.id), element=str(view.id))
    return mechanism.with_graph(mechanism.graph.replace(without=gone)) if gone else mechanism


def drop_engine_shapes(mechanism: Mechanism, context: Context) -> Mechanism:
    """Shapes whose geometry only the engine of the robot's own format has: height fields, distance functions, fitted primitives."""
    native = native_format(mechanism)
    if native is None:
        return mechanism
    gone = [view.id for view in mechanism.every_shape() if isinstance(view.shape.geometry, NoShape)]
    for key in gone:
        message = f"{key} has a geometry that only {native.title} can represent; it is left out"
        context.report.warn(codes.NOT_SAID, message, mechanism.origin(key), element=str(key))
    return mechanism.with_graph(mechanism.graph.replace(without=gone)) if gone else mechanism


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
    return mechanism.with_graph(mechanism.graph.replace(edges=changed)) if changed else mechanism


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
                codes.NOT_SAID, f"{key} is an infinite plane on a body that moves; it is left out", mechanism.origin(key), element=str(key)
            )
            continue
        x, y = shape.geometry.half_size
        changed[key] = replace(mechanism.graph.edges[key], data=replace(shape, geometry=Box((2.0 * x, 2.0 * y, THINNEST))))
        context.report.note(
            codes.REWRITTEN, f"{key} is a plane on a body that moves; it is written as a thin box", mechanism.origin(key), element=str(key)
        )
    return mechanism.with_graph(mechanism.graph.replace(edges=changed, without=gone)) if changed or gone else mechanism


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
    return mechanism.with_graph(mechanism.graph.replace(edges=changed)) if changed else mechanism


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
