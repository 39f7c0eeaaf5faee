"""Denavit-Hartenberg parameters: the canonical numbers of every chain from the base to a tip.

Compared: a and d in m; alpha, theta and beta in rad. Allowed: 1e-7, because the common normals of axes 3 degrees apart amplify
errors some hundreds of times.

The numbers are the same for two robots whenever they move equally, however their frames were chosen: rigid motions of the base and points
sliding along their axes change nothing. What geometry leaves free is fixed in one way: the first frame by the first common
normal, lines of slides by the hinges around them, and x by a fixed sense of each normal.
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

from hymeko_x.ir.values import add, cross, scaled
from hymeko_x.verify.checks.pair import Differences, Pair
from hymeko_x.verify.dh import chain, chains, lines_of
from hymeko_x.verify.dh.lines import NEARLY_PARALLEL, AxisLine, DhFrame, DhLink, dot, feet, length, link_between, minus

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from hymeko_x.ir.values import Vec3
    from hymeko_x.verify.verdict import Check

_MOST_ROWS = 3000  # of all chains together, a second's work; forward kinematics covers the other chains
_TOUCHING = 1e-6  # m; far above the errors of single precision, so that two files agree on which lines meet
_ALLOWED = 1e-7  # m and rad
_AMPLIFIED = 50.0  # the scale of the rounding errors


def check_chains(pair: Pair) -> Iterator[Check]:
    """Lengths (a and d) and angles (theta, alpha, beta) of the chains that both robots have."""
    lengths, angles = Differences("DH parameters, lengths", "m"), Differences("DH parameters, angles", "rad")
    allowed = pair.allowed(_ALLOWED, _AMPLIFIED)
    for i, j, dofs_a, dofs_b in _chains(pair):
        ours, theirs = _signature(pair, i, dofs_a, first=True), _signature(pair, j, dofs_b, first=False)
        for dof, x, y in zip(dofs_a, ours, theirs, strict=True):
            at = f"{pair.a.dof_label(dof)} in the chain to {pair.a.body_label(i)}"
            lengths.add(max(abs(x.d - y.d), abs(x.a - y.a)), allowed, at)
            angles.add(max(_angle(x.theta - y.theta), _angle(x.alpha - y.alpha), _angle(x.beta - y.beta)), allowed, at)
    yield from (*lengths.checks(), *angles.checks())


def _angle(difference: float) -> float:
    """The distance of two angles on the circle."""
    return abs(math.remainder(difference, 2.0 * math.pi))


def _chains(pair: Pair) -> Iterator[tuple[int, int, list[int], list[int]]]:
    """The tips of the first robot that have a counterpart at the end of the same dofs, up to a number of rows."""
    partner, bodies = dict(pair.match.dofs), dict(pair.match.bodies)
    rows = 0
    for i in chains(pair.a):
        dofs = chain(pair.a, i)[1]
        if i not in bodies or not dofs:
            continue
        theirs = chain(pair.b, bodies[i])[1]
        if [partner.get(d) for d in dofs] != theirs or any(pair.a.dofs[d].kind is not pair.b.dofs[partner[d]].kind for d in dofs):
            continue
        rows += len(dofs)
        if rows > _MOST_ROWS:
            pair.notes.append(f"DH parameters: more than {_MOST_ROWS} rows; kinematics cover the other chains")
            return
        yield i, bodies[i], dofs, theirs


def _signature(pair: Pair, body: int, dofs: list[int], *, first: bool) -> tuple[DhLink, ...]:
    model, poses, rest = (pair.a, pair.zero_a, None) if first else (pair.b, pair.zero_b, pair.rest_b)
    lines, frames = lines_of(model, chain(model, body)[0], body, dofs, poses, rest)
    return signature(lines, frames[1])


# ---- the canonical numbers of a chain --------------------------------------------------------------------------------


def signature(lines: Sequence[AxisLine], tip: DhFrame) -> tuple[DhLink, ...]:
    """One link per joint: theta and d of the joint (0 of the first one), and the link to the next joint (0 of the last one)."""
    placed = [_placed(lines, i, tip.o) for i in range(len(lines))]
    frame = _first_frame(placed, tip)
    found: list[DhLink] = []
    for line, following in itertools.pairwise(placed):
        link, frame = link_between(frame, line, following, signed=True, touching=_TOUCHING, keep=True)
        found.append(link)
    return (*found, DhLink(0.0, 0.0, 0.0, 0.0))


def _placed(lines: Sequence[AxisLine], i: int, tip: Vec3) -> AxisLine:
    """A slide's line, which may be anywhere, through a point that only the hinges around it and the tip determine."""
    line = lines[i]
    if not line.sliding:
        return line
    before = [k for k in range(i - 1, -1, -1) if not lines[k].sliding]
    after = [k for k in range(i + 1, len(lines)) if not lines[k].sliding]
    if not after and not before:
        return AxisLine(tip, line.axis, sliding=True)
    own, others = (after[0], [*before[:1], *after[1:]]) if after else (before[0], before[1:])
    hinge = lines[own]
    skew = next((lines[k] for k in others if _sine(hinge, lines[k]) >= NEARLY_PARALLEL), None)
    point = _projected(tip, hinge) if skew is None else feet(hinge, skew)[0]
    return AxisLine(point, line.axis, sliding=True)


def _first_frame(lines: Sequence[AxisLine], tip: DhFrame) -> DhFrame:
    """On the first axis, at the height and in the direction of the first common normal that is determined."""
    first = lines[0]
    decisive = next(((a, b) for a, b in itertools.pairwise(lines) if _sine(a, b) >= NEARLY_PARALLEL), None)
    origin = _projected(tip.o if decisive is None else feet(*decisive)[0], first)
    x = _across(_direction(lines, origin, tip), first.axis)
    x = scaled(x, 1.0 / length(x))
    return DhFrame(origin, x, cross(first.axis, x), first.axis)


def _direction(lines: Sequence[AxisLine], origin: Vec3, tip: DhFrame) -> Vec3:
    """Where x points: along the first link whose direction is determined, else to the tip, else along the tip's own axes."""
    axis = lines[0].axis
    for a, b in itertools.pairwise(lines):
        if _sine(a, b) >= NEARLY_PARALLEL:
            return cross(a.axis, b.axis)
        away = minus(_projected(origin, b), origin)
        if length(_across(away, axis)) >= _TOUCHING:
            return away
    away = _across(minus(tip.o, origin), axis)
    if length(away) >= _TOUCHING:
        return away
    return max((_across(tip.x, axis), _across(tip.y, axis)), key=length)


def _across(vector: Vec3, axis: Vec3) -> Vec3:
    """The part of a vector that is perpendicular to a unit axis."""
    return minus(vector, scaled(axis, dot(vector, axis)))


def _projected(point: Vec3, line: AxisLine) -> Vec3:
    """The foot of a point on a line."""
    return add(line.point, scaled(line.axis, dot(minus(point, line.point), line.axis)))


def _sine(a: AxisLine, b: AxisLine) -> float:
    return length(cross(a.axis, b.axis))
