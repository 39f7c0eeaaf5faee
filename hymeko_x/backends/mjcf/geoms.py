"""Geoms."""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

from hymeko_x.backends.mjcf.text import Attributes, Text, number, numbers, pose_attributes
from hymeko_x.formats.mjcf import CLASSES
from hymeko_x.ir.parts import Box, Capsule, Cylinder, Ellipsoid, Geometry, MeshShape, NoShape, Plane, Sphere

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.names import Printed
    from hymeko_x.ir.mechanism import ShapeView

_GRID = 0.05
"""Spacing in m of the lines with which MuJoCo draws a plane; it has to be positive."""


def write_geom(text: Text, view: ShapeView, names: Printed) -> None:
    """A shape on its body."""
    shape = view.shape
    attributes: Attributes = {
        "name": shape.name or None,
        "class": CLASSES.get(shape.role),
        **geometry_attributes(shape.geometry),
        **pose_attributes(view.pose),
        "mesh": names.of(view.mesh) if view.mesh else None,
        "material": names.of(view.material) if view.material else None,
        "rgba": None if shape.rgba is None else numbers(*shape.rgba),
        "mass": number(shape.mass),
        "density": number(shape.density),
        "friction": numbers(*shape.friction) if shape.friction else None,
    }
    text.later("geom", attributes, view.body.name)


def geometry_attributes(geometry: Geometry) -> Attributes:
    """``type`` and ``size``; MuJoCo counts half lengths."""
    match geometry:
        case Box():
            return {"type": "box", "size": numbers(*(length / 2.0 for length in geometry.size))}
        case Sphere():
            return {"type": "sphere", "size": numbers(geometry.radius)}
        case Cylinder():
            return {"type": "cylinder", "size": numbers(geometry.radius, geometry.length / 2.0)}
        case Capsule():
            return {"type": "capsule", "size": numbers(geometry.radius, geometry.length / 2.0)}
        case Ellipsoid():
            return {"type": "ellipsoid", "size": numbers(*geometry.radii)}
        case Plane():
            return {"type": "plane", "size": numbers(*geometry.half_size, _GRID)}
        case MeshShape():
            return {"type": "mesh"}
        case NoShape():
            raise ValueError("a shape without geometry is not legal MJCF")
        case _:
            assert_never(geometry)
