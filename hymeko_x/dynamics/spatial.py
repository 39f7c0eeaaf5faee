"""Spatial vectors on any number type: motions, forces, inertias, and how they change from a link's frame to its parent's.

A motion is (angular, linear), a force (couple, force), both at the origin of a frame and in its axes.
Source: Featherstone, Rigid Body Dynamics Algorithms (2008), chapter 2; numbers in brackets are its equations.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.dynamics.numbers import add, dot, is_zero, times

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hymeko_x.dynamics.numbers import Number, Numbers

Vector = list["Number"]
Rotation = list[Vector]

ZERO: Vector = [0, 0, 0]
UNIT: Rotation = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]


class Spatial(NamedTuple):
    """A motion (angular, linear) or a force (couple, force)."""

    angular: Vector
    linear: Vector


class FramePose(NamedTuple):
    """The pose of a frame in another one: rotation (its axes as columns) and position of its origin."""

    rotation: Rotation
    position: Vector


class Inertia(NamedTuple):
    """Mass, first moment (mass times centre of mass) and tensor about the origin of the frame [2.63]."""

    mass: Number
    moment: Vector
    tensor: Rotation


class Articulated(NamedTuple):
    """The 6x6 inertia [[a, b], [b', c]] of an articulated body, in blocks: couple = a angular + b linear, force = b' angular + c linear."""

    a: Rotation
    b: Rotation
    c: Rotation


NOTHING = Spatial(ZERO, ZERO)


# ---- vectors of three -------------------------------------------------------------------------------------------------------


def plus(a: Vector, b: Vector) -> Vector:
    """a + b."""
    return [add(x, y) for x, y in zip(a, b, strict=True)]


def minus(a: Number) -> Number:
    """-a, where zero stays the plain zero."""
    return 0 if is_zero(a) else -a


def scaled(a: Sequence[Number], factor: Number) -> Vector:
    """factor * a."""
    return [times(factor, x) for x in a]


def cross(a: Vector, b: Vector) -> Vector:
    """a x b."""
    return [
        add(times(a[1], b[2]), minus(times(a[2], b[1]))),
        add(times(a[2], b[0]), minus(times(a[0], b[2]))),
        add(times(a[0], b[1]), minus(times(a[1], b[0]))),
    ]


def skew(a: Vector) -> Rotation:
    """The matrix of a x."""
    x, y, z = a
    return [[0, minus(z), y], [z, 0, minus(x)], [minus(y), x, 0]]


def turned(rotation: Rotation, a: Vector) -> Vector:
    """R a."""
    return [dot(row, a) for row in rotation]


def turned_back(rotation: Rotation, a: Vector) -> Vector:
    """R' a."""
    return [dot([row[j] for row in rotation], a) for j in range(3)]


def product(a: Rotation, b: Rotation) -> Rotation:
    """A B."""
    columns = transposed(b)
    return [[dot(row, column) for column in columns] for row in a]


def transposed(a: Rotation) -> Rotation:
    """A'."""
    return [list(column) for column in zip(*a, strict=True)]


def total(*matrices: Rotation) -> Rotation:
    """A + B + ..."""
    first, *others = matrices
    for other in others:
        first = [plus(x, y) for x, y in zip(first, other, strict=True)]
    return first


def negative(a: Rotation) -> Rotation:
    """-A."""
    return [[minus(x) for x in row] for row in a]


def turned_tensor(rotation: Rotation, tensor: Rotation) -> Rotation:
    """R I R'."""
    return product(product(rotation, tensor), transposed(rotation))


# ---- rotations --------------------------------------------------------------------------------------------------------------


def about(axis: Vector, angle: Number, numbers: Numbers) -> Rotation:
    """The rotation by an angle in rad about a constant unit vector: 1 + s [a]x + (1 - c) [a]x [a]x [2.23]."""
    s, c = numbers.sin(angle), numbers.cos(angle)
    matrix = skew(axis)
    squared = product(matrix, matrix)
    return [
        [
            add(
                add(UNIT[i][j], times(matrix[i][j], s)),
                times(squared[i][j], 1 - c),
            )
            for j in range(3)
        ]
        for i in range(3)
    ]


def of_quaternion(quat: Sequence[Number]) -> Rotation:
    """The rotation of a unit quaternion (w, x, y, z)."""
    w, x, y, z = quat
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]


def composed(a: FramePose, b: FramePose) -> FramePose:
    """The frame b, given in the frame a, where a is given."""
    return FramePose(product(a.rotation, b.rotation), plus(a.position, turned(a.rotation, b.position)))


# ---- motions and forces --------------------------------------------------------------------------------------------------------


def together(a: Spatial, b: Spatial) -> Spatial:
    """a + b."""
    return Spatial(plus(a.angular, b.angular), plus(a.linear, b.linear))


def times_spatial(a: Spatial, factor: Number) -> Spatial:
    """factor * a."""
    return Spatial(scaled(a.angular, factor), scaled(a.linear, factor))


def down(frame: FramePose, motion: Spatial) -> Spatial:
    """A motion given in the parent, in the frame: iXp v [2.28]."""
    moved = plus(motion.linear, cross(motion.angular, frame.position))
    return Spatial(turned_back(frame.rotation, motion.angular), turned_back(frame.rotation, moved))


def up(frame: FramePose, force: Spatial) -> Spatial:
    """A force given in the frame, in the parent: pXi* f [2.25]."""
    push = turned(frame.rotation, force.linear)
    return Spatial(plus(turned(frame.rotation, force.angular), cross(frame.position, push)), push)


def crossed(v: Spatial, m: Spatial) -> Spatial:
    """v x m of motions [2.31]."""
    return Spatial(cross(v.angular, m.angular), plus(cross(v.angular, m.linear), cross(v.linear, m.angular)))


def crossed_force(v: Spatial, f: Spatial) -> Spatial:
    """v x* f [2.32]."""
    return Spatial(plus(cross(v.angular, f.angular), cross(v.linear, f.linear)), cross(v.angular, f.linear))


def inner(motion: Spatial, force: Spatial) -> Number:
    """The power of a force along a motion."""
    return add(dot(motion.angular, force.angular), dot(motion.linear, force.linear))


# ---- inertias --------------------------------------------------------------------------------------------------------------------


def momentum(inertia: Inertia, v: Spatial) -> Spatial:
    """I v [2.63]."""
    couple = plus(turned(inertia.tensor, v.angular), cross(inertia.moment, v.linear))
    return Spatial(couple, plus(scaled(v.linear, inertia.mass), cross(v.angular, inertia.moment)))


def joined(a: Inertia, b: Inertia) -> Inertia:
    """The inertia of two bodies that are fixed to each other."""
    return Inertia(add(a.mass, b.mass), plus(a.moment, b.moment), total(a.tensor, b.tensor))


def seen_from_parent(frame: FramePose, inertia: Inertia) -> Inertia:
    """An inertia given in the frame, in the parent [2.66]."""
    p, mass = frame.position, inertia.mass
    h = turned(frame.rotation, inertia.moment)
    moment = plus(h, scaled(p, mass))
    spread = add(times(2, dot(h, p)), times(mass, dot(p, p)))
    tensor = turned_tensor(frame.rotation, inertia.tensor)
    shifted = [[add(times(UNIT[i][j], spread), minus(add(times(moment[i], p[j]), times(p[i], h[j])))) for j in range(3)] for i in range(3)]
    return Inertia(mass, moment, total(tensor, shifted))


def articulated(inertia: Inertia) -> Articulated:
    """A rigid inertia as that of an articulated body."""
    mass = inertia.mass
    return Articulated(inertia.tensor, skew(inertia.moment), [[times(UNIT[i][j], mass) for j in range(3)] for i in range(3)])


def force_of(inertia: Articulated, motion: Spatial) -> Spatial:
    """I^A a."""
    couple = plus(turned(inertia.a, motion.angular), turned(inertia.b, motion.linear))
    return Spatial(couple, plus(turned_back(inertia.b, motion.angular), turned(inertia.c, motion.linear)))


def articulated_in_parent(frame: FramePose, inertia: Articulated) -> Articulated:
    """The inertia of an articulated body, in the parent: pXi* I^a iXp."""
    a, b, c = (turned_tensor(frame.rotation, block) for block in inertia)
    p = skew(frame.position)
    moved = total(b, product(p, c))
    return Articulated(total(a, negative(product(moved, p)), product(p, transposed(b))), moved, c)


def joined_articulated(a: Articulated, b: Articulated) -> Articulated:
    """The sum of two inertias."""
    return Articulated(*[total(x, y) for x, y in zip(a, b, strict=True)])
