"""Planes that collide, which UsdPhysics allows on static and kinematic bodies alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Plane, Role, Shape

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.rewrite.context import Context


def grounds(mechanism: Mechanism) -> set[Id]:
    """The bodies that stand and have a plane that collides: they become kinematic bodies."""
    return {*_planes(mechanism).values()} & _standing(mechanism)


def report_planes_that_move(mechanism: Mechanism, context: Context) -> Mechanism:
    """A plane that collides on a body that moves is written, and physics engines of USD leave it out."""
    planes = _planes(mechanism)
    standing = _standing(mechanism) if planes else set()
    for key, body in planes.items():
        if body not in standing:
            message = f"{key} is a plane on a body that moves; UsdPhysics has planes for contact on static and kinematic bodies alone"
            context.report.warn(codes.NOT_REPRESENTED, message, mechanism.origin(key), element=str(key))
    return mechanism


def _planes(mechanism: Mechanism) -> dict[Id, Id]:
    """The body of each plane that collides."""
    found = mechanism.edges(Shape)
    return {key: arcs[0].target for key, shape, arcs in found if isinstance(shape.geometry, Plane) and shape.role is not Role.VISUAL}


def _standing(mechanism: Mechanism) -> set[Id]:
    """The world and all bodies that joints without dofs hold in it."""
    standing = {WORLD}
    for body in mechanism.depth_first():
        above = mechanism.parent_joint.get(body)
        if above is not None and not above.joint.dofs and above.parent in standing:
            standing.add(body)
    return standing
