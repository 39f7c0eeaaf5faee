"""Rigid bodies, and the masses that UsdPhysics gives them: explicit ones, or those of their colliders.

Source: UsdPhysics, "Rigid Body Mass": explicit mass before density before the material's density before 1000 kg/m^3.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.formats import usd as words
from hymeko_x.frontends.usd.materials import bound_to
from hymeko_x.frontends.usd.transforms import numbers_of, rotation_of
from hymeko_x.ir.decimals import clean_vector, shortest, shortest_of
from hymeko_x.ir.parts import Body, Inertial, InertialWritten, MeshShape, Role, Shape
from hymeko_x.ir.solids import Solid, joined, solid_of
from hymeko_x.ir.values import NO_ROTATION, ZERO, Pose, Tensor, Vec3, rotate_tensor
from hymeko_x.rewrite.inertia import physical

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hymeko_x.frontends.usd.builder import UsdBuilder
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.ir.mechanism import Id

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
    builder.check_transform(prim, builder.transforms.of(prim))
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
    unit = _of_shape(read)
    if unit is None:
        return None
    mass = _plain(prim, "physics:mass") * builder.scene.kilograms
    if mass > 0.0 and unit.mass > 0.0:
        return unit.times(mass / unit.mass)
    per_volume = builder.scene.kilograms / builder.scene.metres**3
    own = _plain(prim, "physics:density") * per_volume
    return unit.times(own or density or _material_density(prim, builder) * per_volume or _DENSITY)


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
    mass = stated.mass if stated.mass is not None else shortest(solid.mass)
    com = stated.com if any(stated.com) else clean_vector(solid.com)
    if stated.tensor is not None:
        return replace(stated, mass=mass, com=com)
    tensor = solid.times(mass / solid.mass).tensor if solid.mass else solid.tensor
    xx, yy, zz, xy, xz, yz = shortest_of(tensor)
    short = (xx, yy, zz, xy, xz, yz)
    return Inertial(mass, com, short if physical(short) == short else tensor)


# ---- solids of density 1 -------------------------------------------------------------------------------------------------------------


def _of_shape(read: ReadShape) -> Solid | None:
    """A shape of density 1 at its pose in the body; a mesh counts as its convex hull. None without a volume."""
    solid = _hull(_points(read)) if isinstance(read.shape.geometry, MeshShape) else solid_of(read.shape.geometry)
    return None if solid is None else solid.at(read.pose)


def _hull(points: NDArray[Any] | None) -> Solid | None:
    """The convex hull of points as a sum of tetrahedra from its middle. None where it is flat."""
    if points is None:
        return None
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


def _points(read: ReadShape) -> NDArray[Any] | None:
    """The points of a mesh (n, 3) in the shape's frame; None for other shapes."""
    if read.scale is None:
        return None
    import numpy as np

    points = np.asarray(read.prim.value("points"), dtype=np.float64)
    return points * np.asarray(read.scale, dtype=np.float64)
