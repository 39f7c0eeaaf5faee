"""Lines along which tendons and actuators pull: sums of joints, straight paths through sites and over pulleys, and pushes of a site.

Every line has a length L(q) in m or rad and a row r(q) = dL/dv over all velocities: a pull f along it is the forces r' f, and its
rate is r v. A push has the row of a wrench that stands still on its link, and no length.
Source: MuJoCo, computation, actuation: length and moment arms of transmissions.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from msgspec import Struct

from hymeko_x.dynamics.numbers import add, dot, times
from hymeko_x.dynamics.recursion import constant
from hymeko_x.dynamics.spatial import FramePose, Spatial, composed, cross, inner, plus, scaled, turned, turned_back, up
from hymeko_x.dynamics.tree import frame_of
from hymeko_x.ir.kinematics import dof_at
from hymeko_x.ir.mechanism import numbers_weight
from hymeko_x.ir.parts import Shape
from hymeko_x.ir.tendons import FIXED, PULLEY, WRAP

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from hymeko_x.dynamics.numbers import Number
    from hymeko_x.dynamics.recursion import Constants
    from hymeko_x.dynamics.tree import LinkTree
    from hymeko_x.ir.ids import Id
    from hymeko_x.ir.mechanism import Mechanism, RobotArc
    from hymeko_x.ir.parts import Tendon

    Terms = tuple[tuple[int, float], ...]
    Seats = Mapping[Id, tuple[int, FramePose]]

_TINY = 1e-300
"""In m^2, added to squares of distances: where two sites meet, the pull between them is zero instead of undefined."""


class Point(NamedTuple):
    """A place on a link (-1 is the world), in its frame in m."""

    link: int
    place: tuple[float, ...]


class Push(NamedTuple):
    """A wrench on a link, in its frame about its origin: torque before force, per unit of what drives it."""

    link: int
    torque: tuple[float, ...]
    force: tuple[float, ...]


class ActionLine(Struct, frozen=True):
    """What a tendon or an actuator acts along.

    Its length is the sum of coefficient * position over the links of ``terms``, and of factor * distance over the pairs of ``spans``.
    """

    terms: Terms = ()
    spans: tuple[tuple[Point, Point, float], ...] = ()
    push: Push | None = None


class Stretch(NamedTuple):
    """The length of a line at a configuration, and its row: how the length changes with the velocities, by their columns."""

    length: Number
    row: dict[int, Number]

    def rate(self, v: Sequence[Number]) -> Number:
        """How fast the length changes at velocities."""
        return dot(list(self.row.values()), [v[column] for column in self.row])


# ---- from the mechanism ------------------------------------------------------------------------------------------------------------


def terms_of(mechanism: Mechanism, tree: LinkTree, arcs: Sequence[RobotArc]) -> Terms | None:
    """The links of one coordinate that arcs lead to, with the first number of their weights; None where an arc leads elsewhere."""
    found = []
    for arc in arcs:
        dof = dof_at(mechanism.graph.edges, arc)
        if dof is None or (arc.target, dof[0]) not in tree.places:
            return None
        found.append((tree.places[arc.target, dof[0]], (numbers_weight(arc) or (1.0,))[0]))
    return tuple(found)


def seats_of(mechanism: Mechanism, tree: LinkTree) -> Seats:
    """The link that each frame is on (-1 is the world), and the frame's pose in it."""
    views = [view for views in mechanism.mounts.values() for view in views if view.body in tree.bodies]
    found = {view.mounted: (*tree.bodies[view.body], frame_of(view.pose)) for view in views}
    return {key: (link, composed(place, frame)) for key, (link, place, frame) in found.items()}


def path_of(mechanism: Mechanism, arcs: Sequence[RobotArc], seats: Seats) -> ActionLine | str:
    """The line of a tendon's path through sites and over pulleys; as text the reason why there is none."""
    spans: list[tuple[Point, Point, float]] = []
    before: Point | None = None
    divisor = 1.0
    for arc in arcs:
        if arc.role == PULLEY:
            before, divisor = None, numbers_weight(arc)[0]
            continue
        if arc.role == WRAP or arc.target.kind == "shape":
            edge = mechanism.graph.edges.get(arc.target)
            name = edge.data.name if edge is not None and isinstance(edge.data, Shape) else None
            return f"wraps around the shape '{name or arc.target.name}'"
        if arc.target not in seats:
            return f"leads through {arc.target}, which is on no body"
        link, seat = seats[arc.target]
        point = Point(link, tuple(seat.position))
        if before is not None:
            spans.append((before, point, 1.0 / divisor))
        before = point
    return ActionLine(spans=tuple(spans))


def line_of(mechanism: Mechanism, tree: LinkTree, tendon: Tendon, arcs: Sequence[RobotArc], seats: Seats) -> ActionLine | str:
    """The line of a tendon; as text the reason why there is none."""
    if tendon.kind != FIXED:
        return path_of(mechanism, arcs, seats)
    terms = terms_of(mechanism, tree, arcs)
    return "combines what is no coordinate of a joint" if terms is None else ActionLine(terms)


def push_of(arc: RobotArc, seats: Seats) -> ActionLine | str:
    """The line of an actuator at a frame: its gear is a force and a torque in the frame's axes. As text why there is none."""
    if arc.target not in seats:
        return f"acts on {arc.target}, which is on no body"
    link, seat = seats[arc.target]
    gear = [*(numbers_weight(arc) or (1.0,)), *[0.0] * 6][:6]
    wrench = up(seat, Spatial(gear[3:], gear[:3]))
    return ActionLine(push=Push(link, tuple(map(float, wrench.angular)), tuple(map(float, wrench.linear))))


def geared(line: ActionLine, gear: float) -> ActionLine:
    """A line whose length counts ``gear`` times."""
    terms = tuple((link, gear * factor) for link, factor in line.terms)
    return ActionLine(terms, tuple((a, b, gear * factor) for a, b, factor in line.spans), line.push)


# ---- lengths and rows --------------------------------------------------------------------------------------------------------------


def stretches(lines: Sequence[ActionLine], constants: Constants, q: Sequence[Number]) -> list[Stretch]:
    """The lines at a configuration of all coordinates."""
    frames = constants.link_frames(q) if any(line.spans or line.push for line in lines) else []
    world: list[FramePose] = []
    for link, frame in zip(constants.tree.links, frames, strict=False):
        world.append(composed(world[link.parent], frame) if link.parent >= 0 else frame)
    return [_stretch(line, constants, q, frames, world) for line in lines]


def _stretch(
    line: ActionLine, constants: Constants, q: Sequence[Number], frames: Sequence[FramePose], world: Sequence[FramePose]
) -> Stretch:
    tree, numbers = constants.tree, constants.numbers
    length: Number = 0
    row: dict[int, Number] = {}
    for place, factor in line.terms:
        link = tree.links[place]
        length = add(length, times(numbers.exact(factor), q[link.q]))
        row[link.v] = add(row.get(link.v, 0), numbers.exact(factor))
    for a, b, factor in line.spans:
        length = add(length, _span(row, a, b, factor, constants, frames, world))
    if line.push is not None:
        torque, force = ([constant(x, numbers) for x in part] for part in (line.push.torque, line.push.force))
        _feel(row, line.push.link, -1, Spatial(torque, force), constants, frames)
    return Stretch(length, row)


def _span(
    row: dict[int, Number], a: Point, b: Point, factor: float, constants: Constants, frames: Sequence[FramePose], world: Sequence[FramePose]
) -> Number:
    """factor * the distance of two points; what it adds to the row is the wrenches of a unit of pull on both links."""
    numbers = constants.numbers
    if a.link == b.link:
        return numbers.exact(factor * math.dist(a.place, b.place))
    places = [[constant(x, numbers) for x in point.place] for point in (a, b)]
    seats = [_in_world(point.link, place, world) for point, place in zip((a, b), places, strict=True)]
    apart = plus(seats[1], scaled(seats[0], -1))
    squares = dot(apart, apart)
    distance = numbers.functions["sqrt"](squares if numbers.name == "sympy" else squares + _TINY)
    scale = constant(factor, numbers)
    away = [times(scale, x) / distance for x in apart]
    common = _common(a.link, b.link, constants.tree)
    for point, place, pull in zip((a, b), places, (scaled(away, -1), away), strict=True):
        if point.link >= 0:
            own = turned_back(world[point.link].rotation, pull)
            _feel(row, point.link, common, Spatial(cross(place, own), own), constants, frames)
    return times(scale, distance)


def _in_world(link: int, place: list[Number], world: Sequence[FramePose]) -> list[Number]:
    return plus(world[link].position, turned(world[link].rotation, place)) if link >= 0 else place


def _common(a: int, b: int, tree: LinkTree) -> int:
    """The last link that moves both of two links; -1 is the world. Parents stand before children."""
    while a != b:
        if a > b:
            a = tree.links[a].parent
        else:
            b = tree.links[b].parent
    return a


def _feel(row: dict[int, Number], link: int, until: int, wrench: Spatial, constants: Constants, frames: Sequence[FramePose]) -> None:
    """Add the power of a wrench on a link along the motions of it and of all above it, as far as ``until``."""
    while link != until:
        own = constants.tree.links[link]
        for k, column in enumerate(constants.subspaces[link], own.v):
            row[k] = add(row.get(k, 0), inner(column, wrench))
        wrench = up(frames[link], wrench)
        link = own.parent


def act(forces: list[Number], stretch: Stretch, force: Number) -> None:
    """Add a force along a line to the forces of all coordinates."""
    for column, slope in stretch.row.items():
        forces[column] = add(forces[column], times(slope, force))
