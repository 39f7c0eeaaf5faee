"""The geometries of shapes, in the shape's frame."""

from __future__ import annotations

from msgspec import Struct

from hymeko_x.ir.values import Vec3  # noqa: TC001 - msgspec and hypothesis resolve the types of fields here


class _Solid(Struct, frozen=True, tag_field="type", tag=str.lower, forbid_unknown_fields=True):
    """The ``type`` tells the geometries apart where they are data of another language (JSON)."""


class Box(_Solid, frozen=True):
    """Full edge lengths in m, centred."""

    size: Vec3


class Sphere(_Solid, frozen=True):
    """Radius in m, centred."""

    radius: float


class Cylinder(_Solid, frozen=True):
    """Radius and full length in m along z, centred."""

    radius: float
    length: float


class Capsule(_Solid, frozen=True):
    """Radius and length in m along z without the caps, centred."""

    radius: float
    length: float


class Ellipsoid(_Solid, frozen=True):
    """The three half axes in m, centred."""

    radii: Vec3


class Plane(_Solid, frozen=True):
    """The xy plane with normal z; half extents in m for display, 0 = infinite."""

    half_size: tuple[float, float] = (0.0, 0.0)


class MeshShape(_Solid, frozen=True, tag="mesh"):
    """The mesh that the shape's arc of role ``mesh`` points at."""


class NoShape(_Solid, frozen=True, tag="none"):
    """A geometry that the source left empty or wrote in a way that cannot be read; its text is an Extra."""


Geometry = Box | Sphere | Cylinder | Capsule | Ellipsoid | Plane | MeshShape | NoShape
