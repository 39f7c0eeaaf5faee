"""Rigid bodies, and the masses that UsdPhysics gives them: explicit ones, or those of their colliders.

Source: UsdPhysics, "Rigid Body Mass": explicit mass before density before the material's density before 1000 kg/m^3.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from hymeko_x.formats import usd as words
from hymeko_x.frontends.usd.bindings import bound_to
from hymeko_x.frontends.usd.places import numbers_of, turn_of
from hymeko_x.frontends.usd.volumes import Solid, joined, solid_of
from hymeko_x.ir.parts import Body, Inertial, InertialWritten, Role, Shape
from hymeko_x.ir.values import NO_ROTATION, ZERO, Pose, Tensor, Vec3, rotate_tensor

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.draft import Draft
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.ir.mechanism import Id

BODY = "PhysicsRigidBodyAPI"
MASS = "PhysicsMassAPI"
_DENSITY = 1000.0


def read_body(prim: Prim, draft: Draft) -> None:
    """The vertex of a rigid body; its mass comes later, when its shapes are known."""
    key = draft.own(prim, "body")
    draft.bodies[prim.path] = key
    draft.vertices[key] = Body()
    draft.take(prim, f"@{BODY}", *(name for name in prim.properties if name.startswith("xformOp")))
    if prim.kind in ("Xform", ""):
        draft.take(prim, "@type")


def body_at(prim: Prim | None, draft: Draft) -> tuple[Prim, Id] | None:
    """The nearest body at or above a prim, as prim and id."""
    while prim is not None:
        key = draft.bodies.get(prim.path)
        if key is not None:
            return prim, key
        prim = prim.parent
    return None


# ---- mass --------------------------------------------------------------------------------------------------------------------


def read_mass(prim: Prim, key: Id, shapes: list[tuple[Prim, Shape, Pose, Any]], draft: Draft) -> None:
    """The inertial of a body. ``shapes`` are its own, each with its prim, pose in the body and mesh points."""
    stated = _stated(prim, draft) if prim.has_api(MASS) else Inertial()
    if stated.mass is not None and stated.tensor is not None:
        draft.take(prim, f"@{MASS}")
        draft.vertices[key] = Body(stated)
        return
    density = draft.scene.kilograms / draft.scene.metres**3 * _plain(prim, "physics:density")
    solids = [solid for item in shapes for solid in [_solid(*item, density, draft)] if solid is not None]
    if not solids and stated == Inertial():
        return
    draft.vertices[key] = Body(_completed(stated, joined(solids)) if solids else _massless(stated))
    draft.take(prim, f"@{MASS}", *(["physics:mass"] if solids else []))


def _stated(prim: Prim, draft: Draft) -> Inertial:
    """What the body's own MassAPI says; None for what it leaves to be computed."""
    scene = draft.scene
    mass = draft.number(prim, "physics:mass", 0.0) * scene.kilograms
    centre = draft.get(prim, "physics:centerOfMass")
    scale = draft.places.of(prim).scale
    com: Vec3 = ZERO
    if centre is not None and all(map(math.isfinite, centre)):
        com = (centre[0] * scale[0] + 0.0, centre[1] * scale[1] + 0.0, centre[2] * scale[2] + 0.0)
    tensor, written = _tensor(prim, com, scene.kilograms * scene.metres**2, draft)
    return Inertial(mass if mass > 0.0 else None, com, tensor, written)


def _tensor(prim: Prim, com: Vec3, unit: float, draft: Draft) -> tuple[Tensor | None, InertialWritten | None]:
    """The tensor in body axes: Newton's six doubles before UsdPhysics' principal moments."""
    full = draft.get(prim, "newton:inertia")
    diagonal = draft.get(prim, "physics:diagonalInertia")
    axes = draft.get(prim, "physics:principalAxes")
    if full is not None and len(full) == 6:
        draft.take(prim, "@NewtonMassAPI")
        xx, yy, zz, xy, xz, yz = (value * unit for value in numbers_of(full))
        return (xx, yy, zz, xy, xz, yz), None
    if diagonal is None or not any(diagonal):
        return None, None
    principal: Tensor = (diagonal[0] * unit, diagonal[1] * unit, diagonal[2] * unit, 0.0, 0.0, 0.0)
    quat = turn_of(axes) if axes is not None else NO_ROTATION
    if quat == NO_ROTATION:
        return principal, None
    return rotate_tensor(quat, principal), InertialWritten(Pose(com, quat), principal)


def _solid(prim: Prim, shape: Shape, pose: Pose, points: Any, density: float, draft: Draft) -> Solid | None:
    """A collider with its mass, by the rules of precedence; None for what has no volume or only is looked at."""
    if shape.role is Role.VISUAL:
        return None
    unit = solid_of(shape.geometry, pose, points)
    if unit is None:
        return None
    mass = _plain(prim, "physics:mass") * draft.scene.kilograms
    if mass > 0.0 and unit.mass > 0.0:
        return unit.times(mass / unit.mass)
    per_volume = draft.scene.kilograms / draft.scene.metres**3
    own = _plain(prim, "physics:density") * per_volume
    return unit.times(own or density or _material_density(prim, draft) * per_volume or _DENSITY)


def _material_density(prim: Prim, draft: Draft) -> float:
    """The density of the physics material that is bound to a collider, 0 without one."""
    bound = bound_to(prim, draft.scene, "physics")
    return _plain(bound, "physics:density") if bound is not None else 0.0


def _plain(prim: Prim, name: str) -> float:
    """A number that stays an extra even though it counts here; 0 without one."""
    value = prim.value(name)
    return words.single(value) if isinstance(value, float) and value > 0.0 else 0.0


def _massless(stated: Inertial) -> Inertial:
    """What was said of a body that no collider gives a mass: none at all, where it has a tensor."""
    return replace(stated, mass=0.0) if stated.mass is None and stated.tensor is not None else stated


def _completed(stated: Inertial, solid: Solid) -> Inertial:
    """What was said, with the rest from the colliders; their tensor is scaled to a mass that was said."""
    mass = stated.mass if stated.mass is not None else solid.mass
    com = stated.com if any(stated.com) else solid.com
    if stated.tensor is not None:
        return replace(stated, mass=mass, com=com)
    return Inertial(mass, com, solid.about(com, mass))
