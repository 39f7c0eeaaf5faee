"""Mass, centre of mass and inertia tensor of solids: of primitives, of points, of several together, and of the shapes of a body."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x.ir.parts import Box, Capsule, Cylinder, Ellipsoid, Inertial, Role, Sphere
from hymeko_x.ir.values import ZERO, add, apply, rotate_tensor, scaled

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from hymeko_x.ir.mechanism import ShapeView
    from hymeko_x.ir.parts import Geometry
    from hymeko_x.ir.values import Pose, Tensor, Vec3


class Solid(Struct, frozen=True):
    """Mass in kg, centre of mass in m, and tensor in kg m^2 about it. Of density 1 kg/m^3, the mass is the volume in m^3."""

    mass: float
    com: Vec3
    tensor: Tensor

    def times(self, factor: float) -> Solid:
        """The same solid with this multiple of its density."""
        xx, yy, zz, xy, xz, yz = (factor * value for value in self.tensor)
        return Solid(factor * self.mass, self.com, (xx, yy, zz, xy, xz, yz))

    def at(self, pose: Pose) -> Solid:
        """The solid in the frame in which its own has this pose."""
        return Solid(self.mass, apply(pose, self.com), rotate_tensor(pose.quat, self.tensor))

    def inertial(self) -> Inertial:
        """The same as a part of a body."""
        return Inertial(self.mass, self.com, self.tensor)


def joined(solids: Sequence[Solid]) -> Solid:
    """Several solids in one frame as one; without mass its centre is that of the first. Source: the parallel axis theorem."""
    mass = sum(solid.mass for solid in solids)
    com = ZERO if mass else solids[0].com
    for solid in solids if mass else ():
        com = add(com, scaled(solid.com, solid.mass / mass))
    total = [0.0] * 6
    for solid in solids:
        x, y, z = add(solid.com, scaled(com, -1.0))
        arm = (y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z)
        total = [value + own + solid.mass * far for value, own, far in zip(total, solid.tensor, arm, strict=True)]
    xx, yy, zz, xy, xz, yz = total
    return Solid(mass, com, (xx, yy, zz, xy, xz, yz))


def solid_of(geometry: Geometry) -> Solid | None:
    """A primitive of density 1 about its own frame; None for planes and meshes."""
    spread = _spread(geometry)
    return None if spread is None else _unit(spread[1]).times(spread[0])


def _unit(moments: Vec3) -> Solid:
    return Solid(1.0, ZERO, (*moments, 0.0, 0.0, 0.0))


_MOST = 1e120
"""Solids of a greater volume in m^3, or greater moments in m^2, have tensors that doubles cannot hold."""


def _spread(geometry: Geometry) -> tuple[float, Vec3] | None:
    """The volume in m^3 of a primitive, and its principal moments in m^2 per kg; None for what is none, and for sizes beyond measure."""
    found = _measures(geometry)
    return found if found is not None and all(measure < _MOST for measure in (found[0], *found[1])) else None


def _measures(geometry: Geometry) -> tuple[float, Vec3] | None:
    match geometry:
        case Box((x, y, z)):
            return x * y * z, ((y * y + z * z) / 12.0, (x * x + z * z) / 12.0, (x * x + y * y) / 12.0)
        case Sphere(r):
            return 4.0 / 3.0 * math.pi * r * r * r, (0.4 * r * r,) * 3
        case Ellipsoid((a, b, c)):
            return 4.0 / 3.0 * math.pi * a * b * c, ((b * b + c * c) / 5.0, (a * a + c * c) / 5.0, (a * a + b * b) / 5.0)
        case Cylinder(r, length):
            across = (3.0 * r * r + length * length) / 12.0
            return math.pi * r * r * length, (across, across, r * r / 2.0)
        case Capsule(r, length):
            return _capsule(r, length)
        case _:
            return None


def _capsule(r: float, length: float) -> tuple[float, Vec3]:
    """A cylinder between two half balls, whose own centres are 3/8 of the radius above the cylinder's ends."""
    middle, ends = math.pi * r * r * length, 4.0 / 3.0 * math.pi * r * r * r
    whole = middle + ends
    if whole <= 0.0:
        return 0.0, ZERO
    along = (middle * r * r / 2.0 + ends * 0.4 * r * r) / whole
    far = 0.4 * r * r + length * length / 4.0 + 3.0 / 8.0 * r * length
    across = (middle * (3.0 * r * r + length * length) / 12.0 + ends * far) / whole
    return whole, (across, across, along)


# ---- the shapes of a body ------------------------------------------------------------------------------------------------


def evenly_spread(views: Iterable[ShapeView]) -> Solid | None:
    """A mass of 1 kg spread evenly over the primitives among the shapes, in the frame of the body; None without one.

    The shapes are those that collide, else those that are seen.
    """
    solids = [(view, spread) for view in views if (spread := _spread(view.shape.geometry)) is not None]
    chosen = [item for item in solids if item[0].shape.role is not Role.VISUAL] or solids
    return _shared([(volume, _unit(moments).at(view.pose)) for view, (volume, moments) in chosen], 1.0)


def with_tensor_of(views: Iterable[ShapeView], inertial: Inertial) -> Inertial | None:
    """An inertial with the tensor of its mass spread evenly over the shapes, and their centre where it has none; None without a solid."""
    solid = evenly_spread(views)
    if solid is None or inertial.mass is None:
        return None
    com = inertial.com if any(inertial.com) else solid.com
    return replace(inertial, com=com, tensor=solid.times(inertial.mass).tensor)


def solid_of_colliders(views: Iterable[ShapeView], density: float) -> Solid | None:
    """The shapes that collide as one solid, each of its own density in kg/m^3 or of the given one.

    None where one of them is no primitive solid, or they weigh nothing.
    """
    parts = []
    for view in views:
        if view.shape.role is Role.VISUAL:
            continue
        spread = _spread(view.shape.geometry)
        if spread is None:
            return None
        mass = spread[0] * (density if view.shape.density is None else view.shape.density)
        parts.append((mass, _unit(spread[1]).at(view.pose)))
    return _shared(parts, sum(mass for mass, _ in parts))


def _shared(parts: Sequence[tuple[float, Solid]], mass: float) -> Solid | None:
    """A mass in kg that solids of 1 kg share by their weights; None without weight. Whatever the weights are, nothing overflows."""
    whole = sum(weight for weight, _ in parts)
    return joined([solid.times(weight / whole) for weight, solid in parts]).times(mass) if whole > 0.0 else None
