"""Inertia tensors that nobody said, from geometry: bodies that have a mass and shapes are solid, and of one density."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.formats import native_format
from hymeko_x.ir.notations import WITHOUT_TENSOR
from hymeko_x.ir.parts import Body, Box, Capsule, Cylinder, Ellipsoid, Role, Sphere
from hymeko_x.ir.values import ZERO, add, rotate_tensor, scaled

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism, ShapeView
    from hymeko_x.ir.parts import Geometry
    from hymeko_x.ir.values import Tensor, Vec3
    from hymeko_x.rewrite.context import Context

_Solid = tuple[float, "Vec3"]
"""The volume in m^3 of a primitive, and its principal moments in m^2 per kg of mass."""


def fill_tensors(mechanism: Mechanism, context: Context) -> Mechanism:
    """A body with a mass and no tensor gets that of its shapes: of those that collide, else of those that are seen.

    The centre of mass stays as it is. MJCF means zero where it says nothing, and URDF no inertial at all: those stay,
    and so does what has no solid, of which the notation says so: a plane that becomes a thin box later is none.
    """
    if native_format(mechanism):
        return mechanism
    changed: dict[Id, Body] = {}
    unsaid: dict[Id, Mapping[str, str]] = {}
    for key, body in mechanism.vertices(Body):
        inertial = body.inertial
        if inertial is None or not inertial.mass or inertial.tensor is not None or mechanism.notation(key, WITHOUT_TENSOR):
            continue
        unit = unit_tensor(mechanism.shapes.get(key, ()))
        if unit is None:
            unsaid[key] = {**mechanism.notations.get(key, {}), WITHOUT_TENSOR.name: WITHOUT_TENSOR.write(True)}
            continue
        xx, yy, zz, xy, xz, yz = (inertial.mass * value for value in unit)
        changed[key] = replace(body, inertial=replace(inertial, tensor=(xx, yy, zz, xy, xz, yz)))
        said = f"{key} has a mass and no inertia tensor; that of its geometry is written"
        context.report.note(codes.REWRITTEN, said, mechanism.origin(key), element=str(key))
    if unsaid:
        mechanism = replace(mechanism, notations={**mechanism.notations, **unsaid})
    return mechanism.with_graph(mechanism.graph.replace(vertices=changed)) if changed else mechanism


def unit_tensor(views: Iterable[ShapeView]) -> Tensor | None:
    """The tensor in m^2, in body axes about the centre of the shapes, of 1 kg spread evenly over them; None without a solid."""
    solids = [(view, solid) for view in views if (solid := _solid(view.shape.geometry)) is not None]
    chosen = [item for item in solids if item[0].shape.role is not Role.VISUAL] or solids
    volume = sum(solid[0] for _, solid in chosen)
    if volume <= 0.0:
        return None
    centre = ZERO
    for view, (share, _) in chosen:
        centre = add(centre, scaled(view.pose.xyz, share / volume))
    total = [0.0] * 6
    for view, (share, moments) in chosen:
        own = rotate_tensor(view.pose.quat, (*moments, 0.0, 0.0, 0.0))
        arm = _of_point(add(view.pose.xyz, scaled(centre, -1.0)))
        total = [value + share / volume * (a + b) for value, a, b in zip(total, own, arm, strict=True)]
    xx, yy, zz, xy, xz, yz = total
    return xx, yy, zz, xy, xz, yz


def _of_point(at: Vec3) -> Tensor:
    """The tensor of 1 kg at a point, about the origin."""
    x, y, z = at
    return y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z


def _solid(geometry: Geometry) -> _Solid | None:
    match geometry:
        case Box((x, y, z)):
            return x * y * z, ((y * y + z * z) / 12.0, (x * x + z * z) / 12.0, (x * x + y * y) / 12.0)
        case Sphere(r):
            return 4.0 / 3.0 * math.pi * r**3, (0.4 * r * r,) * 3
        case Ellipsoid((a, b, c)):
            return 4.0 / 3.0 * math.pi * a * b * c, ((b * b + c * c) / 5.0, (a * a + c * c) / 5.0, (a * a + b * b) / 5.0)
        case Cylinder(r, length):
            across = (3.0 * r * r + length * length) / 12.0
            return math.pi * r * r * length, (across, across, r * r / 2.0)
        case Capsule(r, length):
            return _capsule(r, length)
        case _:
            return None


def _capsule(r: float, length: float) -> _Solid:
    """A cylinder between two half balls, whose own centres are 3/8 of the radius above the cylinder's ends."""
    middle, ends = math.pi * r * r * length, 4.0 / 3.0 * math.pi * r**3
    whole = middle + ends
    if whole <= 0.0:
        return 0.0, ZERO
    along = (middle * r * r / 2.0 + ends * 0.4 * r * r) / whole
    far = 0.4 * r * r + length * length / 4.0 + 3.0 / 8.0 * r * length
    across = (middle * (3.0 * r * r + length * length) / 12.0 + ends * far) / whole
    return whole, (across, across, along)
