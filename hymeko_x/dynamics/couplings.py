"""Joints that follow others: the independent coordinates of a tree, and what its whole motion is in terms of them."""

from __future__ import annotations

from graphlib import CycleError, TopologicalSorter
from itertools import zip_longest
from typing import TYPE_CHECKING, NamedTuple

from msgspec.structs import replace

from hymeko_x import codes, formats
from hymeko_x.diagnostics import refuse
from hymeko_x.dynamics.lines import terms_of
from hymeko_x.dynamics.numbers import add, times
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import numbers_weight

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from hymeko_x.dynamics.lines import Terms
    from hymeko_x.dynamics.numbers import Matrix, Number, Numbers
    from hymeko_x.dynamics.tree import Link, LinkTree
    from hymeko_x.ir.ids import Id
    from hymeko_x.ir.mechanism import Mechanism, RobotArc


class Follower(NamedTuple):
    """A link whose coordinate is a constant and the polynomials of other links' coordinates (coefficients c0, c1, ...), added up."""

    link: int
    leaders: tuple[tuple[int, tuple[float, ...]], ...]
    offset: float = 0.0


class _Relation(NamedTuple):
    """A constant and polynomials of links' coordinates (coefficients c1, c2, ...), which are zero together; and the follower's links."""

    constant: float
    polynomials: dict[int, list[float]]
    own: list[int]


class TreeMotion(NamedTuple):
    """The whole motion of a tree: q, v, the matrix G with v = G z', and what of the accelerations G' z' is."""

    q: list[Number]
    v: list[Number]
    ratios: Matrix
    drift: list[Number]


def followers_of(mechanism: Mechanism, tree: LinkTree) -> tuple[tuple[Follower, ...], list[Id]]:
    """The active couplings of joints and of fixed tendons, leaders before followers; and those that have no equations here.

    Raises: Refusal (HX403) where joints follow each other in a circle.
    """
    found: dict[int, Follower] = {}
    left: list[Id] = []
    for key, arcs in _active(mechanism):
        relation = _relation(mechanism, tree, arcs)
        follower = None if relation is None else _follower(relation, found)
        if follower is None:
            left.append(key)
        else:
            found[follower.link] = follower
    return _ordered(mechanism, tree, found), left


def _active(mechanism: Mechanism) -> Iterator[tuple[Id, tuple[RobotArc, ...]]]:
    """The active couplings with their arcs, those that only extras hold at the end."""
    yield from ((key, arcs) for key, coupling, arcs in mechanism.edges(parts.Coupling) if coupling.active)
    native = formats.native_format(mechanism)
    if native is not None and native.couplings is not None:
        yield from ((key, edge.arcs) for key, edge in formats.loaded(native.couplings)(mechanism) if edge.data.active)


def _relation(mechanism: Mechanism, tree: LinkTree, arcs: tuple[RobotArc, ...]) -> _Relation | None:
    """What a coupling makes zero; None for polynomials of several coordinates, and for ends that are no sum of coordinates."""
    constant, polynomials, own = 0.0, dict[int, list[float]](), list[int]()
    for arc in arcs:
        terms = _length(mechanism, tree, arc)
        given = numbers_weight(arc)
        coefficients = (0.0, *(given or (1.0,))[:1]) if arc.sign > 0 else given or (0.0, 1.0)
        if terms is None or (len(terms) > 1 and any(coefficients[2:])):
            return None
        constant += arc.sign * coefficients[0]
        own += [link for link, _ in terms if arc.sign > 0]
        for link, factor in terms:
            added = [arc.sign * coefficient * factor**power for power, coefficient in enumerate(coefficients) if power]
            polynomials[link] = [x + y for x, y in zip_longest(polynomials.get(link, ()), added, fillvalue=0.0)]
    return _Relation(constant, polynomials, own) if sum(arc.sign > 0 for arc in arcs) == 1 else None


def _length(mechanism: Mechanism, tree: LinkTree, arc: RobotArc) -> Terms | None:
    """The links that add up to the coordinate of a joint, which is 0 for a fixed one, or to the length of a fixed tendon."""
    edge = mechanism.graph.edges.get(arc.target)
    if edge is not None and isinstance(edge.data, parts.Tendon):
        return terms_of(mechanism, tree, edge.arcs) if edge.data.kind == "fixed" else None
    if edge is not None and edge.data == parts.Joint():
        return ()
    return terms_of(mechanism, tree, (replace(arc, weight=None),))


def _follower(relation: _Relation, found: Mapping[int, Follower]) -> Follower | None:
    """A link that is linear in the relation, in terms of the others: the follower's first, and one without a circle if there is one."""
    linear = [link for link, (slope, *rest) in relation.polynomials.items() if slope and not any(rest) and link not in found]
    wanted = [link for link in linear if link in relation.own] or linear
    ends = [link for link, polynomial in relation.polynomials.items() if any(polynomial)]
    open_ones = [link for link in wanted if len(wanted) == 1 or not _leads(link, [end for end in ends if end != link], found)]
    if not wanted:
        return None
    chosen = (open_ones or wanted)[0]
    slope = relation.polynomials[chosen][0]
    leaders = ((link, (0.0, *(-value / slope for value in relation.polynomials[link]))) for link in ends if link != chosen)
    return Follower(chosen, tuple(leaders), -relation.constant / slope)


def _leads(link: int, followers: list[int], found: Mapping[int, Follower]) -> bool:
    """Whether one of these links follows a link, over any number of others."""
    left, seen = list(followers), set(followers)
    while left:
        place = left.pop()
        if place == link:
            return True
        new = {leader for leader, _ in found[place].leaders} - seen if place in found else set()
        left += new
        seen |= new
    return False


def _ordered(mechanism: Mechanism, tree: LinkTree, left: Mapping[int, Follower]) -> tuple[Follower, ...]:
    """The followers, each behind those that it follows."""
    order = TopologicalSorter({place: [leader for leader, _ in follower.leaders] for place, follower in left.items()})
    try:
        return tuple(left[place] for place in order.static_order() if place in left)
    except CycleError as error:
        circle = error.args[1][1:]
        names = ", ".join(str(tree.links[place].joint) for place in sorted(circle))
        joint = tree.links[min(circle)].joint
        message = f"{names} follow each other in a circle; their positions form an algebraic loop"
        raise refuse(codes.ALGEBRAIC_LOOP, message, mechanism.origin(joint), element=str(joint)) from error


def independent(tree: LinkTree, followers: Sequence[Follower]) -> list[Link]:
    """The links that follow no other."""
    dependent = {follower.link for follower in followers}
    return [link for place, link in enumerate(tree.links) if place not in dependent]


def expanded(tree: LinkTree, followers: Sequence[Follower], z: Sequence[Number], rate: Sequence[Number], numbers: Numbers) -> TreeMotion:
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
        q[own.q] = numbers.exact(follower.offset) if follower.offset else 0
        for leader, coefficients in follower.leaders:
            other = tree.links[leader]
            value, slope, bend = _polynomial(coefficients, q[other.q], numbers)
            q[own.q] = add(q[own.q], value)
            v[own.v] = add(v[own.v], times(slope, v[other.v]))
            ratios[own.v] = [add(a, times(slope, b)) for a, b in zip(ratios[own.v], ratios[other.v], strict=True)]
            drift[own.v] = add(drift[own.v], add(times(slope, drift[other.v]), times(bend, v[other.v] * v[other.v])))
    return TreeMotion(q, v, ratios, drift)


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
