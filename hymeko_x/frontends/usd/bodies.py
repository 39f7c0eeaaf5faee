"""Rigid bodies, and the masses that UsdPhysics gives them: explicit ones, or those of their colliders.

Source: UsdPhysics, "Rigid Body Mass": explicit mass before density before the material's density before 1000 kg/m^3.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.formats import usd as words
from hymeko_x.frontends.usd.materials import bound_to
from hymeko_x.frontends.usd.transforms import numbers_of, rotation_of
from hymeko_x.ir.parts import Body, Box, Capsule, Cylinder, Ellipsoid, Inertial, InertialWritten, MeshShape, Role, Shape, Sphere
from hymeko_x.ir.values import NO_ROTATION, ZERO, Pose, Tensor, Vec3, apply, rotate_tensor

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hymeko_x.frontends.usd.builder import UsdBuilder
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.ir.parts import Geometry

BODY = "PhysicsRigidBodyAPI"
MASS = "PhysicsMassAPI"
_DENSITY = 1000.0
_SINGLE = 1e-5
"""Of the largest moment: tensors of numbers in single precision that differ by less are the same."""


class ReadShape(NamedTuple):
    """A shape that was read: its prim, part, pose in the body, and for a mesh the scale of its points, which the prim holds."""

    prim: Prim
    shape: Shape
    pose: Pose
    scale: Vec3 | None


def read_body(prim: Prim, builder: UsdBuilder) -> None:
    """The vertex of a rigid body; its mass comes later, when its shapes are known."""
    key = builder.new_id(prim, "body")
    builder.bodies[prim.path] = key
    builder.vertices[key] = Body()
    builder.mark_read(prim, f"@{BODY}", *(name for name in prim.properties if name.startswith("xformOp")))
    if prim.kind in ("Xform", ""):
        builder.mark_read(prim, "@type")


def body_at(prim: Prim | None, builder: UsdBuilder) -> tuple[Prim, Id] | None:
    """The nearest body at or above a prim, as prim and id."""
    while prim is not None:
        key = builder.bodies.get(prim.path)
        if key is not None:
            return prim, key
        prim = prim.parent
    return None


# ---- mass --------------------------------------------------------------------------------------------------------------------


def read_mass(prim: Prim, key: Id, shapes: list[ReadShape], builder: UsdBuilder) -> None:
    """The inertial of a body. ``shapes`` are its own."""
    stated = _stated(prim, builder) if prim.has_api(MASS) else Inertial()
    if stated.mass is not None and stated.tensor is not None:
        builder.mark_read(prim, f"@{MASS}")
        builder.vertices[key] = Body(stated)
        return
    density = builder.scene.kilograms / builder.scene.metres**3 * _plain(prim, "physics:density")
    solids = [solid for item in shapes for solid in [_solid(item, density, builder)] if solid is not None]
    if not solids and stated == Inertial():
        return
    builder.vertices[key] = Body(_completed(stated, joined(solids)) if solids else _massless(stated))
    builder.mark_read(prim, f"@{MASS}", *(["physics:mass"] if solids else []))


def _stated(prim: Prim, builder: UsdBuilder) -> Inertial:
    """The MassAPI of the body itself; None for values that are left to be computed."""
    scene = builder.scene
    mass = builder.number(prim, "physics:mass", 0.0) * scene.kilograms
    centre = builder.get(prim, "physics:centerOfMass")
    scale = builder.transforms.of(prim).scale
    com: Vec3 = ZERO
    if centre is not None and all(map(math.isfinite, centre)):
        com = (centre[0] * scale[0] + 0.0, centre[1] * scale[1] + 0.0, centre[2] * scale[2] + 0.0)
    tensor, written = _tensor(prim, com, scene.kilograms * scene.metres**2, builder)
    return Inertial(mass if mass > 0.0 else None, com, tensor, written)


def _tensor(prim: Prim, com: Vec3, unit: float, builder: UsdBuilder) -> tuple[Tensor | None, InertialWritten | None]:
    """The tensor in body axes: Newton's six doubles before UsdPhysics' principal moments."""
    full = builder.get(prim, "newton:inertia")
    diagonal = builder.get(prim, "physics:diagonalInertia")
    axes = builder.get(prim, "physics:principalAxes")
    if full is not None and len(full) == 6:
        builder.mark_read(prim, "@NewtonMassAPI")
        xx, yy, zz, xy, xz, yz = (value * unit for value in numbers_of(full))
        _compare_tensors(prim, (xx, yy, zz, xy, xz, yz), _of_moments(diagonal, axes, unit), builder)
        return (xx, yy, zz, xy, xz, yz), None
    if diagonal is None or not any(diagonal):
        return None, None
    quat = rotation_of(axes) if axes is not None else NO_ROTATION
    principal = _of_moments(diagonal, None, unit)
    if quat == NO_ROTATION:
        return principal, None
    return rotate_tensor(quat, principal), InertialWritten(Pose(com, quat), principal)


def _of_moments(diagonal: Any, axes: Any, unit: float) -> Tensor:
    """The tensor in body axes of principal moments; zeros where there are none."""
    if diagonal is None:
        return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    principal: Tensor = (diagonal[0] * unit, diagonal[1] * unit, diagonal[2] * unit, 0.0, 0.0, 0.0)
    return principal if axes is None else rotate_tensor(rotation_of(axes), principal)


def _compare_tensors(prim: Prim, full: Tensor, of_moments: Tensor, builder: UsdBuilder) -> None:
    """Warn where the two notations of a tensor differ by more than single precision."""
    largest = max(map(abs, full))
    if any(of_moments) and any(abs(a - b) > _SINGLE * largest for a, b in zip(full, of_moments, strict=True)):
        message = (
            "newton:inertia is not the tensor of physics:diagonalInertia and physics:principalAxes; newton:inertia counts, as in Newton"
        )
        builder.warn(prim, codes.CONTRADICTION, message)


def _solid(read: ReadShape, density: float, builder: UsdBuilder) -> Solid | None:
    """A collider with its mass, by the rules of precedence; None for visuals and shapes without a volume."""
    prim = read.prim
    if read.shape.role is Role.VISUAL:
        return None
    unit = solid_of(read.shape.geometry, read.pose, _points(read))
    if unit is None:
        return None
    mass = _plain(prim, "physics:mass") * builder.scene.kilograms
    if mass > 0.0 and unit.mass > 0.0:
        return unit.times(mass / unit.mass)
    per_volume = builder.scene.kilograms / builder.scene.metres**3
    own = _plain(prim, "physics:density") * per_volume
    return unit.times(own or density or _material_density(prim, builder) * per_volume or _DENSITY)


def _points(read: ReadShape) -> NDArray[Any] | None:
    """The points of a mesh (n, 3) in the shape's frame; None for other shapes."""
    if read.scale is None:
        return None
    import numpy as np

    points = np.asarray(read.prim.value("points"), dtype=np.float64)
    return points * np.asarray(read.scale, dtype=np.float64)


def _material_density(prim: Prim, builder: UsdBuilder) -> float:
    """The density of the physics material that is bound to a collider, 0 without one."""
    bound = bound_to(prim, builder.scene, "physics")
    return _plain(bound, "physics:density") if bound is not None else 0.0


def _plain(prim: Prim, name: str) -> float:
    """A number that stays an extra even though it counts here; 0 without one."""
    value = prim.value(name)
    return words.single(value) if isinstance(value, float) and value > 0.0 else 0.0


def _massless(stated: Inertial) -> Inertial:
    """The inertial of a body that no collider gives a mass: none at all, where it has a tensor."""
    return replace(stated, mass=0.0) if stated.mass is None and stated.tensor is not None else stated


def _completed(stated: Inertial, solid: Solid) -> Inertial:
    """The authored values, with the others from the colliders; their tensor is scaled to an authored mass, and stays where it is."""
    mass = stated.mass if stated.mass is not None else solid.mass
    com = stated.com if any(stated.com) else solid.com
    if stated.tensor is not None:
        return replace(stated, mass=mass, com=com)
    return Inertial(mass, com, _times(solid.tensor, mass / solid.mass if solid.mass else 1.0))


# ---- solids of density 1 -------------------------------------------------------------------------------------------------------------


class Solid(Struct, frozen=True):
    """Mass in kg, centre of mass in m and tensor in kg m^2 about it, in the axes of the body."""

    mass: float
    com: Vec3
    tensor: Tensor

    def times(self, factor: float) -> Solid:
        """The same solid with this multiple of its density."""
        return Solid(self.mass * factor, self.com, _times(self.tensor, factor))


def joined(solids: list[Solid]) -> Solid:
    """Several solids as one."""
    mass = sum(solid.mass for solid in solids)
    if mass <= 0.0:
        return Solid(0.0, ZERO, (0.0,) * 6)
    x, y, z = (sum(solid.mass * solid.com[i] for solid in solids) / mass for i in range(3))
    total = [0.0] * 6
    for solid in solids:
        offset = _point_mass(solid.mass, (solid.com[0] - x, solid.com[1] - y, solid.com[2] - z))
        total = [a + b + c for a, b, c in zip(total, solid.tensor, offset, strict=True)]
    return Solid(mass, (x, y, z), (total[0], total[1], total[2], total[3], total[4], total[5]))


def solid_of(geometry: Geometry, pose: Pose, points: NDArray[Any] | None) -> Solid | None:
    """A geometry of density 1 at its pose in the body; a mesh (its points, n x 3) counts as its convex hull. None: no volume."""
    if isinstance(geometry, MeshShape):
        solid = _hull(points) if points is not None else None
    else:
        moments = _moments(geometry)
        solid = None if moments is None else Solid(moments[0], ZERO, (*moments[1:], 0.0, 0.0, 0.0))
    return None if solid is None else Solid(solid.mass, apply(pose, solid.com), rotate_tensor(pose.quat, solid.tensor))


def _moments(geometry: Geometry) -> tuple[float, float, float, float] | None:
    """Volume and principal moments of a centred primitive."""
    match geometry:
        case Box((x, y, z)):
            v = x * y * z
            return v, v * (y * y + z * z) / 12, v * (x * x + z * z) / 12, v * (x * x + y * y) / 12
        case Sphere(r):
            v = 4 / 3 * math.pi * r**3
            return v, 0.4 * v * r * r, 0.4 * v * r * r, 0.4 * v * r * r
        case Ellipsoid((a, b, c)):
            v = 4 / 3 * math.pi * a * b * c
            return v, v * (b * b + c * c) / 5, v * (a * a + c * c) / 5, v * (a * a + b * b) / 5
        case Cylinder(r, h):
            v = math.pi * r * r * h
            across = v * (3 * r * r + h * h) / 12
            return v, across, across, v * r * r / 2
        case Capsule(r, h):
            middle, caps = math.pi * r * r * h, 4 / 3 * math.pi * r**3
            across = middle * (3 * r * r + h * h) / 12 + caps * (0.4 * r * r + h * h / 4 + 3 * h * r / 8)
            return middle + caps, across, across, middle * r * r / 2 + caps * 0.4 * r * r
        case _:
            return None


def _hull(points: NDArray[Any]) -> Solid | None:
    """The convex hull of points as a sum of tetrahedra from its middle. None where it is flat."""
    import numpy as np
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(points)
    except (QhullError, ValueError):
        return None
    middle = points[hull.vertices].mean(axis=0)
    corners = points[hull.simplices] - middle
    volumes = np.abs(np.linalg.det(corners)) / 6
    total = float(volumes.sum())
    if total <= 0.0:
        return None
    com = (volumes[:, None] * corners.sum(axis=1) / 4).sum(axis=0) / total
    sums = corners.sum(axis=1)
    second = (np.einsum("n,nci,ncj->ij", volumes, corners, corners) + np.einsum("n,ni,nj->ij", volumes, sums, sums)) / 20
    second -= total * np.outer(com, com)
    tensor = np.trace(second) * np.eye(3) - second
    x, y, z = (com + middle).tolist()
    return Solid(total, (x, y, z), (*tensor.diagonal().tolist(), float(tensor[0, 1]), float(tensor[0, 2]), float(tensor[1, 2])))


def _point_mass(mass: float, at: Vec3) -> Tensor:
    x, y, z = at
    return (mass * (y * y + z * z), mass * (x * x + z * z), mass * (x * x + y * y), -mass * x * y, -mass * x * z, -mass * y * z)


def _times(tensor: Tensor, factor: float) -> Tensor:
    xx, yy, zz, xy, xz, yz = tensor
    return (xx * factor, yy * factor, zz * factor, xy * factor, xz * factor, yz * factor)
