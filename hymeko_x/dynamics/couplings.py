"""Joints that follow others: the independent coordinates of a tree, and what its whole motion is in terms of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.dynamics.numbers import add, times
from hymeko_x.ir import parts
from hymeko_x.ir.kinematics import dof_number
from hymeko_x.ir.mechanism import numbers_weight

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hymeko_x.dynamics.numbers import Matrix, Number, Numbers
    from hymeko_x.dynamics.tree import Link, Tree
    from hymeko_x.ir.mechanism import Mechanism, RobotArc


class Follower(NamedTuple):
    """A link whose coordinate is the sum of the polynomials of other links' coordinates (coefficients c0, c1, ...)."""

    link: int
    leaders: tuple[tuple[int, tuple[float, ...]], ...]


class Expanded(NamedTuple):
    """The whole motion of a tree: q, v, the matrix G with v = G z', and what of the accelerations G' z' is."""

    q: list[Number]
    v: list[Number]
    ratios: Matrix
    drift: list[Number]


def followers_of(mechanism: Mechanism, tree: Tree) -> tuple[Follower, ...]:
    """The active couplings of a mechanism's joints, leaders before followers.

    Raises: Refusal (HX403) where joints follow each other in a circle.
    """
    places = {(link.joint, link.number): place for place, link in enumerate(tree.links)}

    def link_of(arc: RobotArc) -> int | None:
        edge = mechanism.graph.edges.get(arc.target)
        number = dof_number(edge.data, arc.role) if edge is not None and isinstance(edge.data, parts.Joint) else None
        place = None if number is None else places.get((arc.target, number))
        return place if place is not None and tree.links[place].coordinates == 1 else None

    found: dict[int, Follower] = {}
    for _, coupling, arcs in mechanism.edges(parts.Coupling):
        ends = [(arc, link_of(arc)) for arc in arcs]
        if not coupling.active or any(place is None for _, place in ends):
            continue
        followers = [place for arc, place in ends if arc.sign > 0 and place is not None]
        leaders = tuple((place, numbers_weight(arc) or (0.0, 1.0)) for arc, place in ends if arc.sign < 0 and place is not None)
        if len(followers) == 1 and followers[0] not in found:
            found[followers[0]] = Follower(followers[0], leaders)
    return _ordered(mechanism, tree, found)


def _ordered(mechanism: Mechanism, tree: Tree, left: dict[int, Follower]) -> tuple[Follower, ...]:
    ordered: list[Follower] = []
    while left:
        ready = [place for place, follower in left.items() if not any(leader in left for leader, _ in follower.leaders)]
        if not ready:
            names = ", ".join(str(tree.links[place].joint) for place in left)
            joint = tree.links[next(iter(left))].joint
            message = f"{names} follow each other in a circle; their positions form an algebraic loop"
            raise refuse(codes.ALGEBRAIC_LOOP, message, mechanism.origin(joint), element=str(joint))
        ordered += [left.pop(place) for place in ready]
    return tuple(ordered)


def independent(tree: Tree, followers: Sequence[Follower]) -> list[Link]:
    """The links that follow no other."""
    dependent = {follower.link for follower in followers}
    return [link for place, link in enumerate(tree.links) if place not in dependent]


def expanded(tree: Tree, followers: Sequence[Follower], z: Sequence[Number], rate: Sequence[Number], numbers: Numbers) -> Expanded:
    """The motion of the whole tree when its independent links have the coordinates z and the velocities ``rate``."""
    q: list[Number] = [0] * tree.nq
    v: list[Number] = [0] * tree.nv
    ratios: Matrix = [[0] * len(rate) for _ in range(tree.nv)]
    drift: list[Number] = [0] * tree.nv
    at = column = 0
    for link in independent(tree, followers):
        q[link.q : link.q + link.coordinates] = z[at : at + link.coordinates]
        v[link.v : link.v + link.velocities] = rate[column : column + link.velocities]
        for k in range(link.velocities):
            ratios[link.v + k][column + k] = 1
        at, column = at + link.coordinates, column + link.velocities
    for follower in followers:
        own = tree.links[follower.link]
        for leader, coefficients in follower.leaders:
            other = tree.links[leader]
            value, slope, bend = _polynomial(coefficients, q[other.q], numbers)
            q[own.q] = add(q[own.q], value)
            v[own.v] = add(v[own.v], times(slope, v[other.v]))
            ratios[own.v] = [add(a, times(slope, b)) for a, b in zip(ratios[own.v], ratios[other.v], strict=True)]
            drift[own.v] = add(drift[own.v], add(times(slope, drift[other.v]), times(bend, v[other.v] * v[other.v])))
    return Expanded(q, v, ratios, drift)


def _polynomial(coefficients: Sequence[float], x: Number, numbers: Numbers) -> tuple[Number, Number, Number]:
    """The value of c0 + c1 x + c2 x^2 + ..., its slope and its second derivative."""
    value: Number = 0
    slope: Number = 0
    bend: Number = 0
    for coefficient in reversed(coefficients):
        bend = add(times(bend, x), times(2, slope))
        slope = add(times(slope, x), value)
        value = add(times(value, x), 0 if coefficient == 0.0 else numbers.exact(coefficient))
    return value, slope, bend
