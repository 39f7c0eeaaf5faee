"""Mass properties of solids of density 1: what a collider without an explicit mass weighs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hymeko_x.frozen import frozen
from hymeko_x.ir.parts import Box, Capsule, Cylinder, Ellipsoid, MeshShape, Sphere
from hymeko_x.ir.values import Tensor, Vec3, apply, rotate_tensor

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hymeko_x.ir.parts import Geometry
    from hymeko_x.ir.values import Pose


@frozen
class Solid:
    """Mass in kg, centre of mass in m and tensor in kg m^2 about it, in the axes of the body."""

    mass: float
    com: Vec3
    tensor: Tensor

    def times(self, factor: float) -> Solid:
        """The same solid, this much denser."""
        return Solid(self.mass * factor, self.com, _times(self.tensor, factor))

    def about(self, com: Vec3, mass: float) -> Tensor:
        """The tensor when it weighs ``mass`` and its centre of mass is said to be elsewhere."""
        del com  # UsdPhysics moves no tensor along with a stated centre of mass
        return _times(self.tensor, mass / self.mass if self.mass else 1.0)


def joined(solids: list[Solid]) -> Solid:
    """Several solids as one."""
    mass = sum(solid.mass for solid in solids)
    if mass <= 0.0:
        return Solid(0.0, (0.0, 0.0, 0.0), (0.0,) * 6)
    x, y, z = (sum(solid.mass * solid.com[i] for solid in solids) / mass for i in range(3))
    total = [0.0] * 6
    for solid in solids:
        offset = _point_mass(solid.mass, (solid.com[0] - x, solid.com[1] - y, solid.com[2] - z))
        total = [a + b + c for a, b, c in zip(total, solid.tensor, offset, strict=True)]
    return Solid(mass, (x, y, z), (total[0], total[1], total[2], total[3], total[4], total[5]))


def solid_of(geometry: Geometry, pose: Pose, points: NDArray | None) -> Solid | None:  # type: ignore[type-arg]
    """A geometry of density 1 at its pose in the body; a mesh (its points, n x 3) counts as its convex hull. None: no volume."""
    if isinstance(geometry, MeshShape):
        return _placed(_hull(points), pose) if points is not None else None
    moments = _moments(geometry)
    if moments is None:
        return None
    volume, xx, yy, zz = moments
    return _placed(Solid(volume, (0.0, 0.0, 0.0), (xx, yy, zz, 0.0, 0.0, 0.0)), pose)


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


def _placed(solid: Solid | None, pose: Pose) -> Solid | None:
    if solid is None:
        return None
    return Solid(solid.mass, apply(pose, solid.com), rotate_tensor(pose.quat, solid.tensor))


def _hull(points: NDArray) -> Solid | None:  # type: ignore[type-arg]
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
