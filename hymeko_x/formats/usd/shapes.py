"""Primitive prims of UsdGeom as plain values: the attributes of a prim, and the geometry that it represents.

Shared by reader and writer, so that sizes, axis and scale are written as their author wrote them.
"""

from __future__ import annotations

import re
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from msgspec import Struct

from hymeko_x.ir.notations import Notation
from hymeko_x.ir.parts import Box, Capsule, Cylinder, Ellipsoid, Plane, Role, Sphere
from hymeko_x.ir.values import NO_ROTATION, Quat, Vec3, X, Y, quat_about

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np
    from numpy.typing import NDArray

    from hymeko_x.ir.parts import Geometry

SIZES: Mapping[str, tuple[tuple[str, float], ...]] = MappingProxyType(
    {
        "Cube": (("size", 2.0),),
        "Sphere": (("radius", 1.0),),
        "Cylinder": (("radius", 1.0), ("height", 2.0)),
        "Capsule": (("radius", 0.5), ("height", 1.0)),
        "Plane": (("width", 2.0), ("length", 2.0)),
        "Mesh": (),
    }
)
"""The sizes of each primitive with UsdGeom's defaults. A mesh is a primitive where it is :func:`ball`, which represents an ellipsoid."""
TURNS: Mapping[str, Quat] = MappingProxyType(
    {"X": quat_about(Y, 1.5707963267948966), "Y": quat_about(X, -1.5707963267948966), "Z": NO_ROTATION}
)
"""The rotation that takes z to the axis."""
_AXIAL = ("Cylinder", "Capsule", "Plane")
_WRITTEN = re.compile(r"(\w+) ([XYZ]) ([^;]+); (.+)")


class Gprim(Struct, frozen=True):
    """A primitive as its prim has it: type, sizes and axis, and the scale (in m per unit) of the space that they are in."""

    kind: str
    sizes: tuple[float, ...]
    axis: str = "Z"
    scale: Vec3 = (1.0, 1.0, 1.0)

    @property
    def is_axial(self) -> bool:
        """Whether its type has an axis."""
        return self.kind in _AXIAL

    def __str__(self) -> str:
        return f"{self.kind} {self.axis} {' '.join(map(repr, self.sizes))}; {' '.join(map(repr, self.scale))}"


class PlacedGeometry(NamedTuple):
    """The geometry of a primitive, and the rotation from its own z to its axis."""

    geometry: Geometry
    turn: Quat


def _parse(text: str) -> Gprim | None:
    """The primitive of a notation; None where there is none."""
    found = _WRITTEN.fullmatch(text)
    if found is None or found[1] not in SIZES:
        return None
    try:
        sizes, (x, y, z) = tuple(map(float, found[3].split())), map(float, found[4].split())
    except ValueError:
        return None
    return Gprim(found[1], sizes, found[2], (x, y, z)) if len(sizes) == len(SIZES[found[1]]) else None


GPRIM = Notation("usd.gprim", str, _parse)
"""The notation of a shape with its primitive where that is not the one that the writer chooses."""


def geometry_of(prim: Gprim) -> PlacedGeometry:
    """A primitive with its scale in its sizes. Where a scale would bend a round shape, the largest factor counts; a sphere bends.

    Source: the shapes of UsdPhysics' parser.
    """
    x, y, z = map(abs, prim.scale)
    first, *rest = prim.sizes or (1.0,)
    turn = TURNS[prim.axis]
    match prim.kind:
        case "Cube":
            return PlacedGeometry(Box((first * x, first * y, first * z)), NO_ROTATION)
        case "Sphere":
            is_round = max(x, y, z) - min(x, y, z) < 1e-6 * max(x, y, z)
            return PlacedGeometry(Sphere(first * x) if is_round else Ellipsoid((first * x, first * y, first * z)), NO_ROTATION)
        case "Mesh":
            return PlacedGeometry(Ellipsoid((x, y, z)), NO_ROTATION)
        case "Plane":
            across, along = {"Z": (x, y), "X": (z, y), "Y": (x, z)}[prim.axis]
            return PlacedGeometry(Plane((first / 2 * across, rest[0] / 2 * along)), turn)
        case kind:
            along = (x, y, z)["XYZ".index(prim.axis)]
            across = max(value for letter, value in zip("XYZ", (x, y, z), strict=True) if letter != prim.axis)
            radius, height = first * across, rest[0] * along
            return PlacedGeometry(Capsule(radius, height) if kind == "Capsule" else Cylinder(radius, height), turn)


def default_gprim(geometry: Geometry, role: Role) -> Gprim | None:
    """The primitive that the writer chooses for a geometry; None for meshes and empty shapes.

    UsdPhysics takes a sphere whose scale is not uniform for no collider, but the hull of any mesh.
    """
    match geometry:
        case Box(size):
            return Gprim("Cube", (1.0,), scale=size)
        case Sphere(radius):
            return Gprim("Sphere", (radius,))
        case Ellipsoid(radii):
            is_hull = role is not Role.VISUAL and min(radii) != max(radii)
            return Gprim("Mesh", (), scale=radii) if is_hull else Gprim("Sphere", (1.0,), scale=radii)
        case Cylinder(radius, length):
            return Gprim("Cylinder", (radius, length))
        case Capsule(radius, length):
            return Gprim("Capsule", (radius, length))
        case Plane((x, y)):
            return Gprim("Plane", (2 * x, 2 * y))
        case _:
            return None


def half_extent(prim: Gprim) -> Vec3:
    """Half the box around a primitive in its own space."""
    first, *rest = prim.sizes or (1.0,)
    match prim.kind:
        case "Cube":
            return (first / 2, first / 2, first / 2)
        case "Sphere" | "Mesh":
            return (first, first, first)
        case "Plane":
            across, along = first / 2, rest[0] / 2
            return {"Z": (across, along, 0.0), "X": (0.0, along, across), "Y": (across, 0.0, along)}[prim.axis]
        case kind:
            along = rest[0] / 2 + (first if kind == "Capsule" else 0.0)
            x, y, z = (along if letter == prim.axis else first for letter in "XYZ")
            return (x, y, z)


@cache
def ball() -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """The points (n x 3) and triangles (flat) of a sphere of radius 1 by longitude and latitude, whose hull an ellipsoid is scaled from."""
    import numpy as np

    around, down = 32, 16
    turns, falls = np.arange(around) * (2 * np.pi / around), np.arange(1, down) * (np.pi / down)
    rings = [np.outer(np.sin(falls), np.cos(turns)), np.outer(np.sin(falls), np.sin(turns)), np.outer(np.cos(falls), np.ones(around))]
    points = np.vstack([(0.0, 0.0, 1.0), np.stack(rings, axis=-1).reshape(-1, 3), (0.0, 0.0, -1.0)])
    here, there = np.arange(around), (np.arange(around) + 1) % around
    top = np.stack([np.zeros_like(here), 1 + here, 1 + there], axis=-1)
    bands = [
        np.stack([one + here, two + here, two + there, one + here, two + there, one + there], axis=-1).reshape(-1, 3)
        for one, two in ((1 + around * row, 1 + around * (row + 1)) for row in range(down - 2))
    ]
    last = 1 + around * (down - 2)
    bottom = np.stack([last + here, np.full_like(here, last + around), last + there], axis=-1)
    return points.astype(np.float32), np.vstack([top, *bands, bottom]).ravel().astype(np.int32)
