"""Closed loops on any number type: the closure phi(q) = 0, its Jacobian, and the accelerations under the forces that keep it.

The closure is differentiated twice, which makes a system of index 1: accelerations a and forces f of the closures follow from
M a = tau - bias + J' f and J a = -J' v - 2 s J v - s^2 phi. Without the last two terms positions drift; with the rate s > 0 they
return to the closure as exp(-s t): the stabilisation of Baumgarte (1972). Closures that repeat each other (a planar four-bar that
is closed by a hinge in space) share their force: the equations for f are solved by the proximal iteration of Pinocchio (Carpentier,
Budhiraja, Mansard: Proximal and Sparse Resolution of Constrained Dynamic Equations, 2021).
Source: Featherstone, Rigid Body Dynamics Algorithms, chapter 8.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from msgspec import Struct

from hymeko_x.dynamics.numbers import add, dot, factorize, solve, times
from hymeko_x.dynamics.recursion import constant, exact_frame
from hymeko_x.dynamics.spatial import (
    NOTHING,
    UNIT,
    ZERO,
    FramePose,
    Spatial,
    composed,
    cross,
    crossed,
    down,
    minus,
    plus,
    product,
    scaled,
    together,
    total,
    transposed,
    turned,
    turned_back,
)
from hymeko_x.dynamics.tree import frame_of
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import pose_weight
from hymeko_x.ir.parts import DofKind

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from hymeko_x.dynamics.numbers import Matrix, Number, Numbers
    from hymeko_x.dynamics.recursion import Constants
    from hymeko_x.dynamics.spatial import Rotation, Vector
    from hymeko_x.dynamics.tree import LinkTree
    from hymeko_x.ir.ids import Id
    from hymeko_x.ir.mechanism import Mechanism

STABILISATION = 20.0
"""The rate of Baumgarte's stabilisation in 1/s that simulations and generated files have."""
_ROUNDS = 4
_PROXIMAL = 1e-8
"""Of the mean entry on the diagonal of J M^-1 J'; what it changes shrinks by this factor with each of the rounds."""


class ClosureEnd(NamedTuple):
    """One end of a closure: a frame on a link (-1 is the world)."""

    link: int
    frame: FramePose


class Closure(Struct, frozen=True):
    """A loop between two ends. ``along`` are the directions, constant in the first end's frame, in which the second may not move.

    Rotations: ``fixed`` closes all three; a ``hinge`` is the axis about which the second end may turn; neither leaves them free.
    """

    id: Id
    first: ClosureEnd
    second: ClosureEnd
    along: tuple[tuple[float, ...], ...]
    fixed: bool = False
    hinge: tuple[float, ...] | None = None

    @property
    def rows(self) -> int:
        """How many equations it has."""
        return len(self.along) + (3 if self.fixed else 2 if self.hinge else 0)


class Closing(NamedTuple):
    """The closures of a tree at (q, v): phi, its Jacobian J as rows, and J' v."""

    gap: list[Number]
    slope: Matrix
    drift: list[Number]


def closures_of(mechanism: Mechanism, tree: LinkTree) -> tuple[tuple[Closure, ...], list[Id]]:
    """The active loops between two bodies or frames on bodies, and those that have no equations here."""
    mounts = {view.mounted: (view.body, frame_of(view.pose)) for views in mechanism.mounts.values() for view in views}
    found, left = [], []
    for key, loop, arcs in mechanism.edges(parts.Loop):
        if not loop.active:
            continue
        directions = _directions(loop)
        places = [mounts.get(arc.target, (arc.target, FramePose(UNIT, ZERO))) for arc in arcs]
        if directions is None or len(places) != 2 or any(body not in tree.bodies for body, _ in places):
            left.append(key)
            continue
        ends = []
        for arc, (body, frame) in zip(arcs, places, strict=True):
            link, place = tree.bodies[body]
            ends.append(ClosureEnd(link, composed(composed(place, frame), frame_of(pose_weight(arc)))))
        found.append(Closure(key, ends[0], ends[1], *directions))
    return tuple(found), left


def _directions(loop: parts.Loop) -> tuple[tuple[tuple[float, ...], ...], bool, tuple[float, ...] | None] | None:
    """What a loop closes: directions, all rotations or not, the axis of its hinge; None for dofs that are not supported."""
    whole = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    if loop.kind in ("connect", "weld"):
        return whole, loop.kind == "weld", None
    turns = [dof for dof in loop.dofs if dof.kind in (DofKind.HINGE, DofKind.BALL)]
    slides = [dof for dof in loop.dofs if dof.kind is DofKind.SLIDE]
    if len(turns) + len(slides) < len(loop.dofs) or len(turns) > 1 or len(slides) > 1 or any(any(dof.anchor) for dof in loop.dofs):
        return None
    along = across(slides[0].axis) if slides else whole
    if not turns:
        return along, True, None
    return along, False, turns[0].axis if turns[0].kind is DofKind.HINGE else None


def across(axis: Sequence[float]) -> tuple[tuple[float, ...], ...]:
    """Two unit vectors that are perpendicular to a unit vector and to each other."""
    smallest = min(range(3), key=lambda k: abs(axis[k]))
    first = cross(list(axis), list(UNIT[smallest]))
    size = sum(x * x for x in first) ** 0.5
    unit = [x / size for x in first]
    return tuple(map(float, unit)), tuple(map(float, cross(list(axis), unit)))


# ---- phi, J and J' v -------------------------------------------------------------------------------------------------------------


class ClosureEnds(NamedTuple):
    """Where the ends of a closure are: the links' frames in them, the rotation of the second end and its place in the first's axes."""

    closure: Closure
    inside: tuple[FramePose, FramePose]
    turn: Rotation
    gap: Vector


class Displacement(NamedTuple):
    """A place and a rotation, or a derivative of them."""

    gap: Vector
    turn: Rotation


def closing(closures: Sequence[Closure], constants: Constants, q: Sequence[Number], v: Sequence[Number]) -> Closing:
    """The closures at (q, v)."""
    frames = constants.link_frames(q)
    pairs = _pairs(closures, constants, frames)
    velocities = _velocities(constants, frames, v)
    accelerations = _accelerations(constants, frames, v, velocities)
    gap = [x for pair in pairs for x in _gaps(pair.closure, Displacement(pair.gap, pair.turn), constants.numbers)]
    slope = [row for pair in pairs for row in _rows(pair, constants, frames)]
    drift = [x for pair in pairs for x in _gaps(pair.closure, _bend(pair, velocities, accelerations), constants.numbers)]
    return Closing(gap, slope, drift)


def _rows(pair: ClosureEnds, constants: Constants, frames: Sequence[FramePose]) -> Matrix:
    """The rows of a closure in J. What moves both ends together moves no closure: only links from there to the ends count."""
    closure, tree = pair.closure, constants.tree
    chains = list(_chain(closure.first.link, tree)), list(_chain(closure.second.link, tree))
    rows: Matrix = [[0] * tree.nv for _ in range(closure.rows)]
    for end in (0, 1):
        place, common = pair.inside[end], set(chains[1 - end])
        for i in chains[end]:
            if i in common:
                break
            for k, column in enumerate(constants.subspaces[i], tree.links[i].v):
                moved = down(place, column)
                rate = _rate(pair, moved, NOTHING) if end == 0 else _rate(pair, NOTHING, moved)
                for row, value in zip(rows, _gaps(closure, rate, constants.numbers), strict=True):
                    row[k] = value
            place = composed(frames[i], place)
    return rows


def _chain(link: int, tree: LinkTree) -> Iterator[int]:
    """A link and all above it."""
    while link >= 0:
        yield link
        link = tree.links[link].parent


def _velocities(constants: Constants, frames: Sequence[FramePose], v: Sequence[Number]) -> list[Spatial]:
    """The velocities of all links, in their own axes; NOTHING, which is last, is that of the world."""
    found: list[Spatial] = []
    for i, (link, frame) in enumerate(zip(constants.tree.links, frames, strict=True)):
        above = found[link.parent] if link.parent >= 0 else NOTHING
        found.append(together(down(frame, above), constants.along(i, v[link.v : link.v + link.velocities])))
    return [*found, NOTHING]


def _accelerations(constants: Constants, frames: Sequence[FramePose], v: Sequence[Number], velocities: Sequence[Spatial]) -> list[Spatial]:
    """What of the links' accelerations comes from velocities alone, without gravity; NOTHING, which is last, is that of the world."""
    found: list[Spatial] = []
    for i, (link, frame) in enumerate(zip(constants.tree.links, frames, strict=True)):
        above = found[link.parent] if link.parent >= 0 else NOTHING
        moving = constants.along(i, v[link.v : link.v + link.velocities])
        found.append(together(down(frame, above), crossed(velocities[i], moving)))
    return [*found, NOTHING]


def _pairs(closures: Sequence[Closure], constants: Constants, frames: Sequence[FramePose]) -> list[ClosureEnds]:
    world: list[FramePose] = []
    for link, frame in zip(constants.tree.links, frames, strict=True):
        world.append(composed(world[link.parent], frame) if link.parent >= 0 else frame)
    found = []
    for closure in closures:
        insides = [exact_frame(end.frame, constants.numbers) for end in (closure.first, closure.second)]
        links = closure.first.link, closure.second.link
        a, b = (composed(world[k], inside) if k >= 0 else inside for k, inside in zip(links, insides, strict=True))
        gap = turned_back(a.rotation, plus(b.position, _opposite(a.position)))
        found.append(ClosureEnds(closure, (insides[0], insides[1]), product(transposed(a.rotation), b.rotation), gap))
    return found


def _at_ends(pair: ClosureEnds, motions: Sequence[Spatial]) -> tuple[Spatial, Spatial]:
    """The motions of both ends, in their own axes."""
    first, second = pair.inside
    return down(first, motions[pair.closure.first.link]), down(second, motions[pair.closure.second.link])


def _rate(pair: ClosureEnds, a: Spatial, b: Spatial) -> Displacement:
    """d' = R v_b - v_a - w_a x d and R' = [w]x R, w = R w_b - w_a, of the motions a and b of both ends."""
    w = plus(turned(pair.turn, b.angular), _opposite(a.angular))
    moved = plus(turned(pair.turn, b.linear), _opposite(plus(a.linear, cross(a.angular, pair.gap))))
    return Displacement(moved, _crossed(w, pair.turn))


def _bend(pair: ClosureEnds, velocities: Sequence[Spatial], accelerations: Sequence[Spatial]) -> Displacement:
    """The derivatives of d' and R' when velocities change by ``accelerations``."""
    (a, b), (a_rate, b_rate) = _at_ends(pair, velocities), _at_ends(pair, accelerations)
    rate = _rate(pair, a, b)
    w = plus(turned(pair.turn, b.angular), _opposite(a.angular))
    w_rate = plus(plus(turned(pair.turn, b_rate.angular), turned(rate.turn, b.angular)), _opposite(a_rate.angular))
    moved = plus(plus(turned(rate.turn, b.linear), turned(pair.turn, b_rate.linear)), _opposite(a_rate.linear))
    moved = plus(moved, _opposite(plus(cross(a_rate.angular, pair.gap), cross(a.angular, rate.gap))))
    return Displacement(moved, total(_crossed(w_rate, pair.turn), _crossed(w, rate.turn)))


def _gaps(closure: Closure, change: Displacement, numbers: Numbers) -> list[Number]:
    """The rows of a closure: phi of a place and a rotation, phi' or phi'' of their derivatives, in which phi is linear."""
    found = [dot(_exact(axis, numbers), change.gap) for axis in closure.along]
    r = change.turn
    if closure.fixed:  # of a rotation this is twice the sine of its angle times its axis
        found += [add(r[2][1], minus(r[1][2])), add(r[0][2], minus(r[2][0])), add(r[1][0], minus(r[0][1]))]
    elif closure.hinge is not None:
        axis = turned(r, _exact(closure.hinge, numbers))
        found += [dot(_exact(side, numbers), axis) for side in across(closure.hinge)]
    return found


def _crossed(w: Vector, r: Rotation) -> Rotation:
    """[w]x R."""
    return transposed([cross(w, column) for column in transposed(r)])


def _exact(values: Sequence[float], numbers: Numbers) -> Vector:
    return [constant(value, numbers) for value in values]


def _opposite(a: Vector) -> Vector:
    return [minus(x) for x in a]


# ---- accelerations -----------------------------------------------------------------------------------------------------------------


def closed_acceleration(mass: Matrix, force: Sequence[Number], closed: Closing, v: Sequence[Number], rate: float) -> list[Number]:
    """The accelerations of M a = force + J' f with closures that are stabilised at a rate in 1/s."""
    factors = factorize(mass)
    free = solve(factors, force)
    moved = [solve(factors, row) for row in closed.slope]
    inner = [[dot(row, column) for column in moved] for row in closed.slope]
    count = len(inner)
    trace = sum(inner[i][i] for i in range(count))
    for_gap = [add(times(2 * rate, dot(row, v)), times(rate**2, gap)) for row, gap in zip(closed.slope, closed.gap, strict=True)]
    wanted = [minus(add(add(d, g), dot(row, free))) for d, g, row in zip(closed.drift, for_gap, closed.slope, strict=True)]
    soft = factorize([[add(inner[i][j], trace * (_PROXIMAL / count) if i == j else 0) for j in range(count)] for i in range(count)])
    pull: list[Number] = [0] * count
    for _ in range(_ROUNDS):
        missing = [add(value, minus(dot(row, pull))) for value, row in zip(wanted, inner, strict=True)]
        pull = plus(pull, solve(soft, missing))
    for value, column in zip(pull, moved, strict=True):
        free = plus(free, scaled(column, value))
    return free
