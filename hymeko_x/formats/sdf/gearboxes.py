"""Gearboxes: a joint that relates the angles of two links, each seen from a third one, as a relation of the two hinges between them.

theta_2 = -ratio * theta_1, where theta_1 is the angle of the parent link about <axis>, theta_2 that of the child link about <axis2>,
both from the reference body. Source: the SDF schema, joint/gearbox_ratio and joint/gearbox_reference_body.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Id
    from hymeko_x.ir.values import Vec3

GEARBOX = "gearbox"
"""The type of such a joint."""
REFERENCE = "gearbox_reference_body"
RATIO = "gearbox_ratio"
ENDS = ("parent", "child", REFERENCE)
_PARALLEL = 1e-6


class Hinge(NamedTuple):
    """A joint with one hinge: its id, its parent body, and its unit axis in the world at the zero configuration."""

    joint: Id
    parent: Id
    axis: Vec3


class Turn(NamedTuple):
    """The angle of a body as a coordinate: the hinge's joint, and 1.0 or -1.0 by which its coordinate is multiplied."""

    joint: Id
    sign: float


def turn_of(body: Id, reference: Id, axis: Vec3, hinges: Mapping[frozenset[Id], Hinge]) -> Turn | None:
    """The angle of a body from the reference body about a unit axis in the world; None where no hinge between them turns about it."""
    hinge = hinges.get(frozenset((body, reference)))
    along = 0.0 if hinge is None else sum(a * b for a, b in zip(hinge.axis, axis, strict=True))
    if hinge is None or abs(abs(along) - 1.0) > _PARALLEL:
        return None
    forwards = (along > 0.0) == (hinge.parent == reference)
    return Turn(hinge.joint, 1.0 if forwards else -1.0)
