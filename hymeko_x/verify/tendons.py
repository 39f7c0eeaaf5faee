"""Tendons as every reader describes them: steps along a path, and what they do with its length."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.frozen import frozen

if TYPE_CHECKING:
    from hymeko_x.verify.model import Array

Point = tuple[float, float, float]

JOINT, SITE, SIDE, SPHERE, CYLINDER, PULLEY = "joint", "site", "side", "sphere", "cylinder", "pulley"
"""The kinds of steps. A side is a point beside the shape before it, which says on which side of it a cable passes."""


def point_of(numbers: Array) -> Point:
    """Three numbers of an array, in m or without unit, as they are."""
    x, y, z = (float(number) for number in numbers)
    return x, y, z


@frozen
class Step:
    """One step of a path. ``on``: the dof of a joint, the body of everything else but a pulley, as indices into the model.

    ``number``: the coefficient of a joint, the divisor of a pulley, the radius of a shape in m. ``point`` is where a site is,
    or the centre of a shape, in m in the body's frame; ``axis`` is the direction of a cylinder there, as a unit vector.
    """

    kind: str
    on: int = -1
    number: float = 0.0
    point: Point | None = None
    axis: Point | None = None


@frozen
class Spring:
    """The lengths between which a tendon pulls and pushes nothing.

    ``between`` is None where an engine has yet to compute them from the pose at rest; ``at_rest``: whether they are the length there.
    """

    between: tuple[float, float] | None = None
    at_rest: bool = True


RELAXED = Spring()


@frozen
class Tendon:
    """A cable through points and around shapes, or a weighted sum of joint coordinates.

    ``mechanics``: stiffness, damping, friction, armature. ``limits`` are its least and greatest length, ``force`` the least and
    greatest that all actuators on it may apply; None = without. ``spring`` counts where it is stiff. ``curves`` holds the higher
    coefficients of stiffness and damping, nothing where all are zero, None where a format or its reader cannot say.
    """

    name: str | None
    path: tuple[Step, ...]
    mechanics: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    limits: tuple[float, float] | None = None
    force: tuple[float, float] | None = None
    spring: Spring = RELAXED
    curves: tuple[float, ...] | None = None
