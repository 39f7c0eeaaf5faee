"""Dynamics of trees by recursion, on any number type: one configuration of expressions, or arrays with one float per configuration.

Source: Featherstone, Rigid Body Dynamics Algorithms (2008): inverse dynamics (recursive Newton-Euler, table 5.1), the mass matrix
(composite rigid bodies, table 6.2), forward dynamics (articulated bodies, table 7.1). Numbers in brackets are its equations.
All vectors are in the frames of the links. The motion subspaces S are constant there, so that c_J = 0.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.dynamics.numbers import add, dot, factorize, is_zero, solve, times
from hymeko_x.dynamics.spatial import (
    NOTHING,
    UNIT,
    ZERO,
    Articulated,
    FramePose,
    Inertia,
    Spatial,
    about,
    articulated,
    articulated_in_parent,
    composed,
    cross,
    crossed,
    crossed_force,
    down,
    force_of,
    inner,
    joined,
    joined_articulated,
    minus,
    momentum,
    of_quaternion,
    scaled,
    seen_from_parent,
    times_spatial,
    together,
    up,
)
from hymeko_x.dynamics.tree import NO_INERTIA
from hymeko_x.ir.parts import DofKind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hymeko_x.dynamics.numbers import Matrix, Number, Numbers
    from hymeko_x.dynamics.tree import Link, LinkTree

GRAVITY = (0.0, 0.0, -9.81)
"""In m/s^2, in the world."""


class Constants:
    """The constants of a tree in one number type: placements, inertias, motion subspaces."""

    def __init__(self, tree: LinkTree, numbers: Numbers, gravity: Sequence[float] = GRAVITY) -> None:
        self.tree = tree
        self.numbers = numbers
        self.frames = [exact_frame(link.frame, numbers) for link in tree.links]
        self.inertias = [inertia_of(link, numbers) for link in tree.links]
        self.subspaces = [subspace(link, numbers) for link in tree.links]
        self.armatures = [constant(link.dof.armature, numbers) for link in tree.links]
        self.pull = Spatial(ZERO, [constant(-value, numbers) for value in gravity])

    def link_frames(self, q: Sequence[Number]) -> list[FramePose]:
        """The pose of each link in its parent at q."""
        pairs = zip(self.tree.links, self.frames, strict=True)
        return [composed(frame, motion(link, q[link.q : link.q + link.coordinates], self.numbers)) for link, frame in pairs]

    def along(self, number: int, values: Sequence[Number]) -> Spatial:
        """S_i times the velocities (or accelerations) of a link."""
        found = NOTHING
        for column, value in zip(self.subspaces[number], values, strict=True):
            found = together(found, times_spatial(column, value))
        return found


def constant(value: float, numbers: Numbers) -> Number:
    """A constant; the plain zero and one stay, because products with them cost nothing."""
    return int(value) if value in (0.0, 1.0, -1.0) else numbers.exact(value)


def exact_frame(frame: FramePose, numbers: Numbers) -> FramePose:
    """A constant frame in one number type."""
    return FramePose([[constant(x, numbers) for x in row] for row in frame.rotation], [constant(x, numbers) for x in frame.position])


def inertia_of(link: Link, numbers: Numbers) -> Inertia:
    """The inertia of all that is fixed to a link, in its frame: tensors about its origin, not about the centres of mass."""
    whole = NO_INERTIA
    for frame, inertial in link.bodies:
        xx, yy, zz, xy, xz, yz = (constant(x, numbers) for x in inertial.tensor or (0.0,) * 6)
        at_centre = Inertia(constant(inertial.mass or 0.0, numbers), ZERO, [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        centre = FramePose(UNIT, [constant(x, numbers) for x in inertial.com])
        whole = joined(whole, seen_from_parent(exact_frame(frame, numbers), seen_from_parent(centre, at_centre)))
    return whole


def subspace(link: Link, numbers: Numbers) -> list[Spatial]:
    """The columns of S: the motions of a link at unit velocities, in its own frame. Source: table 4.1."""
    axis = [constant(x, numbers) for x in link.dof.axis]
    match link.dof.kind:
        case DofKind.HINGE:
            return [Spatial(axis, ZERO)]
        case DofKind.SLIDE:
            return [Spatial(ZERO, axis)]
        case DofKind.SCREW:
            return [Spatial(axis, scaled(axis, constant(link.dof.pitch, numbers)))]
        case DofKind.BALL:
            return [Spatial(unit, ZERO) for unit in UNIT]
        case DofKind.FREE:
            return [*(Spatial(ZERO, unit) for unit in UNIT), *(Spatial(unit, ZERO) for unit in UNIT)]


def motion(link: Link, q: Sequence[Number], numbers: Numbers) -> FramePose:
    """How far a dof has moved its link at its coordinates."""
    kind = link.dof.kind
    if kind is DofKind.FREE:
        return FramePose(of_quaternion(q[3:]), list(q[:3]))
    if kind is DofKind.BALL:
        return FramePose(of_quaternion(q), ZERO)
    axis = [constant(x, numbers) for x in link.dof.axis]
    moved = add(q[0], constant(-link.dof.ref, numbers))
    if kind is DofKind.SLIDE:
        return FramePose(UNIT, scaled(axis, moved))
    turned = about(axis, moved, numbers)
    return FramePose(turned, scaled(scaled(axis, constant(link.dof.pitch, numbers)), moved) if kind is DofKind.SCREW else ZERO)


def inverse_dynamics(constants: Constants, q: Sequence[Number], v: Sequence[Number], a: Sequence[Number] | None = None) -> list[Number]:
    """The forces tau for which the accelerations are ``a`` (None: the bias C(q, v) v + g(q)), with armature. Table 5.1."""
    links, frames = constants.tree.links, constants.link_frames(q)
    velocities: list[Spatial] = []
    accelerations: list[Spatial] = []
    forces: list[Spatial] = []
    for i, (link, frame) in enumerate(zip(links, frames, strict=True)):
        own = slice(link.v, link.v + link.velocities)
        above_v = velocities[link.parent] if link.parent >= 0 else NOTHING
        above_a = accelerations[link.parent] if link.parent >= 0 else constants.pull  # a_0 = -g [5.6]
        moving = constants.along(i, v[own])
        velocities.append(together(down(frame, above_v), moving))  # [5.7]
        change = together(down(frame, above_a), crossed(velocities[i], moving))  # [5.8]
        accelerations.append(change if a is None else together(change, constants.along(i, a[own])))
        inertia = constants.inertias[i]
        gyroscopic = crossed_force(velocities[i], momentum(inertia, velocities[i]))
        forces.append(together(momentum(inertia, accelerations[i]), gyroscopic))  # [5.9]
    tau: list[Number] = [0] * constants.tree.nv
    for i in reversed(range(len(links))):
        link = links[i]
        for k, column in enumerate(constants.subspaces[i]):
            tau[link.v + k] = inner(column, forces[i])  # [5.11]
            felt = armature_bias(constants, i, k, v)
            if a is not None:
                felt = add(felt, times(constants.armatures[i], a[link.v + k]))
            tau[link.v + k] = add(tau[link.v + k], felt)
        if link.parent >= 0:
            forces[link.parent] = together(forces[link.parent], up(frames[i], forces[i]))  # [5.10]
    return tau


def armature_bias(constants: Constants, number: int, k: int, v: Sequence[Number]) -> Number:
    """What the armature adds to the bias: that of a free dof resists the acceleration along the world's axes, a + w x v."""
    link, armature = constants.tree.links[number], constants.armatures[number]
    if link.dof.kind is not DofKind.FREE or k > 2 or is_zero(armature):
        return 0
    moving = list(v[link.v : link.v + 6])
    return times(armature, cross(moving[3:], moving[:3])[k])


def mass_matrix(constants: Constants, q: Sequence[Number]) -> Matrix:
    """M(q) with armatures, as rows. Table 6.2."""
    links, frames = constants.tree.links, constants.link_frames(q)
    composite = list(constants.inertias)
    n = constants.tree.nv
    matrix: Matrix = [[0] * n for _ in range(n)]
    for i in reversed(range(len(links))):
        link = links[i]
        if link.parent >= 0:
            composite[link.parent] = joined(composite[link.parent], seen_from_parent(frames[i], composite[i]))  # [6.13]
        for k, column in enumerate(constants.subspaces[i]):
            force = momentum(composite[i], column)  # [6.14]
            for m, other in enumerate(constants.subspaces[i][: k + 1]):
                matrix[link.v + k][link.v + m] = matrix[link.v + m][link.v + k] = inner(other, force)
            matrix[link.v + k][link.v + k] = add(matrix[link.v + k][link.v + k], constants.armatures[i])
            j = i
            while links[j].parent >= 0:
                force = up(frames[j], force)  # [6.15]
                j = links[j].parent
                for m, other in enumerate(constants.subspaces[j]):
                    matrix[link.v + k][links[j].v + m] = matrix[links[j].v + m][link.v + k] = inner(other, force)
    return matrix


def forward_dynamics(constants: Constants, q: Sequence[Number], v: Sequence[Number], tau: Sequence[Number]) -> list[Number]:
    """The accelerations under the forces tau. Table 7.1."""
    links, frames = constants.tree.links, constants.link_frames(q)
    coriolis, biases = _velocity_terms(constants, frames, v)
    inertias: list[Articulated] = [articulated(inertia) for inertia in constants.inertias]
    solved = []
    for i in reversed(range(len(links))):
        link, columns = links[i], constants.subspaces[i]
        u = [force_of(inertias[i], column) for column in columns]  # [7.43]
        d = [[inner(column, force) for force in u] for column in columns]  # [7.44]
        for k in range(len(columns)):
            d[k][k] = add(d[k][k], constants.armatures[i])
        own = [add(inner(column, biases[i]), armature_bias(constants, i, k, v)) for k, column in enumerate(columns)]
        rest = [add(tau[link.v + k], minus(value)) for k, value in enumerate(own)]  # [7.45]
        factors = factorize(d)
        solved.append((u, factors, rest))
        if link.parent >= 0:
            gain = solve(factors, rest)
            inertia = _without(inertias[i], u, factors)  # [7.46]
            bias = together(biases[i], force_of(inertia, coriolis[i]))  # [7.47]
            for force, value in zip(u, gain, strict=True):
                bias = together(bias, times_spatial(force, value))
            inertias[link.parent] = joined_articulated(inertias[link.parent], articulated_in_parent(frames[i], inertia))
            biases[link.parent] = together(biases[link.parent], up(frames[i], bias))
    solved.reverse()
    accelerations: list[Spatial] = []
    found: list[Number] = []
    for i, (link, frame, (u, factors, rest)) in enumerate(zip(links, frames, solved, strict=True)):
        above = accelerations[link.parent] if link.parent >= 0 else constants.pull
        change = together(down(frame, above), coriolis[i])
        own = solve(factors, [add(value, minus(inner(change, force))) for value, force in zip(rest, u, strict=True)])  # [7.48]
        accelerations.append(together(change, constants.along(i, own)))
        found += own
    return found


def _velocity_terms(constants: Constants, frames: Sequence[FramePose], v: Sequence[Number]) -> tuple[list[Spatial], list[Spatial]]:
    """Of each link the acceleration and the force that its velocity causes: c [7.40] and p^A without what is below it [7.42]."""
    velocities: list[Spatial] = []
    coriolis: list[Spatial] = []
    biases: list[Spatial] = []
    for i, (link, frame) in enumerate(zip(constants.tree.links, frames, strict=True)):
        moving = constants.along(i, v[link.v : link.v + link.velocities])
        above = velocities[link.parent] if link.parent >= 0 else NOTHING
        velocities.append(together(down(frame, above), moving))
        coriolis.append(crossed(velocities[i], moving))
        biases.append(crossed_force(velocities[i], momentum(constants.inertias[i], velocities[i])))
    return coriolis, biases


def _without(inertia: Articulated, u: list[Spatial], factors: tuple[Matrix, list[Number]]) -> Articulated:
    """I^A - U D^-1 U' [7.46]: what of an inertia is felt through a joint that gives way."""
    rows = [[*force.angular, *force.linear] for force in u]
    columns = [solve(factors, [row[j] for row in rows]) for j in range(6)]
    felt = [[minus(_sum(rows, columns[j], i)) for j in range(6)] for i in range(6)]
    a, b, c = inertia
    return Articulated(
        [[add(a[i][j], felt[i][j]) for j in range(3)] for i in range(3)],
        [[add(b[i][j], felt[i][j + 3]) for j in range(3)] for i in range(3)],
        [[add(c[i][j], felt[i + 3][j + 3]) for j in range(3)] for i in range(3)],
    )


def _sum(rows: list[list[Number]], values: Sequence[Number], place: int) -> Number:
    return dot([row[place] for row in rows], values)
