"""The geometry under DH tables: directed lines, frames on them, and the link from one line to the next.

Plain tuples and floats: a chain has a handful of axes, and one number at a time is faster than an array of three.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct

from hymeko_x.ir.values import add, cross, scaled

if TYPE_CHECKING:
    from hymeko_x.ir.values import Vec3
    from hymeko_x.verify.model import Array

PARALLEL = 1e-12
"""The sine of the angle below which two axes are exactly parallel: rounding of doubles."""

NEARLY_PARALLEL = math.sin(math.radians(3.0))
"""The sine below which a link is Hayati and Roberts's, since a and d of the common normal grow without bound."""

TOUCHING = 1e-10
"""The distance in m below which two lines meet, or coincide when they are parallel."""


class AxisLine(Struct, frozen=True):
    """A joint's axis in its positive sense: through ``point``, along unit ``axis``. Of a slide only the direction is physical."""

    point: Vec3
    axis: Vec3
    sliding: bool = False


class DhFrame(Struct, frozen=True):
    """A right-handed frame: origin and axes."""

    o: Vec3
    x: Vec3
    y: Vec3
    z: Vec3

    @classmethod
    def of(cls, matrix: Array) -> DhFrame:
        """From a homogeneous matrix."""
        columns = [(float(c[0]), float(c[1]), float(c[2])) for c in matrix[:3].T]
        return cls(columns[3], columns[0], columns[1], columns[2])

    def turn_to(self, x: Vec3) -> float:
        """The angle about z from this x axis to another direction."""
        return math.atan2(dot(x, self.y), dot(x, self.x))

    def height_of(self, point: Vec3) -> float:
        """How far along z a point is."""
        return dot(minus(point, self.o), self.z)


class DhLink(Struct, frozen=True):
    """J = Rz(theta) Tz(d) along one line, then L = Tx(a) Rx(alpha) Ry(beta) to the next."""

    theta: float
    d: float
    a: float
    alpha: float
    beta: float = 0.0

    def matrix(self) -> Array:
        """L as a homogeneous matrix."""
        return motion(self.a, self.alpha, self.beta)


def motion(a: float, alpha: float, beta: float = 0.0) -> Array:
    """Tx(a) Rx(alpha) Ry(beta) as a homogeneous matrix."""
    ca, sa, cb, sb = math.cos(alpha), math.sin(alpha), math.cos(beta), math.sin(beta)
    return np.array([[cb, 0, sb, a], [sa * sb, ca, -sa * cb, 0], [-ca * sb, sa, ca * cb, 0], [0, 0, 0, 1]])


def link_between(
    frame: DhFrame, line: AxisLine, following: AxisLine, *, signed: bool = False, touching: float = TOUCHING, keep: bool = False
) -> tuple[DhLink, DhFrame]:
    """The link from a frame on ``line`` to a frame on the line that follows it, and that frame.

    A parallel link may leave the line anywhere: it does so at the height of the line's own point (or of the frame, with ``keep``).
    ``signed`` lets a be negative, so that alpha is in (0, pi) always and the numbers are continuous where lines meet.
    """
    normal = cross(line.axis, following.axis)
    sine = length(normal)
    if sine >= NEARLY_PARALLEL:
        foot, other = feet(line, following)
        gap = minus(other, foot)
        unit = scaled(normal, 1.0 / sine)
        away = dot(gap, unit)
        x = unit if signed or abs(away) < touching or away > 0 else scaled(unit, -1.0)
        return _finished(frame, foot, x, dot(gap, x), following.axis)
    foot = frame.o if keep else add(frame.o, scaled(frame.z, frame.height_of(line.point)))
    along = dot(minus(foot, following.point), line.axis) / dot(following.axis, line.axis)
    other = add(following.point, scaled(following.axis, along))
    gap = minus(other, foot)
    distance = length(gap)
    if distance < touching:
        return _finished(frame, frame.o if sine < PARALLEL else foot, frame.x, 0.0, following.axis, tilted=sine >= PARALLEL)
    return _finished(frame, foot, scaled(gap, 1.0 / distance), distance, following.axis, tilted=sine >= PARALLEL)


def _finished(frame: DhFrame, foot: Vec3, x: Vec3, a: float, axis: Vec3, *, tilted: bool = False) -> tuple[DhLink, DhFrame]:
    """The numbers of a link that leaves the line at ``foot`` in direction ``x``, and the frame that they lead to.

    ``tilted`` allows an angle beta, for axes that are nearly parallel.
    """
    theta, d = frame.turn_to(x), frame.height_of(foot)
    c, s = math.cos(theta), math.sin(theta)
    out_x = add(scaled(frame.x, c), scaled(frame.y, s))
    out_y = add(scaled(frame.x, -s), scaled(frame.y, c))
    across, up, along = dot(axis, out_x), dot(axis, out_y), dot(axis, frame.z)
    alpha = math.atan2(-up, along)
    beta = math.atan2(across, math.hypot(up, along)) if tilted else 0.0
    link = DhLink(theta + 0.0, d + 0.0, a + 0.0, alpha + 0.0, beta + 0.0)  # no negative zeros
    rotation = np.array([out_x, out_y, frame.z]).T @ link.matrix()[:3, :3]
    origin = add(add(frame.o, scaled(frame.z, d)), scaled(out_x, a))
    (x0, y0, z0), (x1, y1, z1), (x2, y2, z2) = rotation.tolist()
    return link, DhFrame(origin, (x0, x1, x2), (y0, y1, y2), (z0, z1, z2))


def feet(line: AxisLine, other: AxisLine) -> tuple[Vec3, Vec3]:
    """The ends of the common normal of two lines that are not parallel, one on each."""
    normal = cross(line.axis, other.axis)
    gap = minus(other.point, line.point)
    square = dot(normal, normal)
    s = dot(cross(gap, other.axis), normal) / square
    t = dot(cross(gap, line.axis), normal) / square
    return add(line.point, scaled(line.axis, s)), add(other.point, scaled(other.axis, t))


# ---- three numbers ---------------------------------------------------------------------------------------------------


def dot(a: Vec3, b: Vec3) -> float:
    """a . b"""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def minus(a: Vec3, b: Vec3) -> Vec3:
    """a - b"""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def length(a: Vec3) -> float:
    """|a|"""
    return math.sqrt(dot(a, a))
