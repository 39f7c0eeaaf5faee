"""Denavit-Hartenberg parameters: the canonical numbers of every chain from the base to a tip."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

import numpy as np

from hymeko_x.verify.checks.pair import Pair, worst
from hymeko_x.verify.dh import chain, chains, lines_of
from hymeko_x.verify.dh.lines import NEARLY_PARALLEL, Frame, Line, Link, Vec, cross, dot, feet, length, link_between, minus, plus, times

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from hymeko_x.verify.verdict import Check

_MOST_ROWS = 3000  # of all chains together; forward kinematics covers what is left out
_TOUCHING = 1e-6  # m; robots are compared with a tolerance, so that closer lines are one
_ALLOWED = 1e-7  # m and rad: common normals of axes 3 degrees apart amplify errors by some hundreds


def check_chains(pair: Pair) -> Iterator[Check]:
    """Lengths (a and d) and angles (theta, alpha, beta) of the chains that both robots have."""
    lengths: list[float] = []
    angles: list[float] = []
    labels: list[str] = []
    for i, j, dofs_a, dofs_b in _chains(pair):
        ours, theirs = _signature(pair, i, dofs_a, first=True), _signature(pair, j, dofs_b, first=False)
        for dof, x, y in zip(dofs_a, ours, theirs, strict=True):
            lengths.append(max(abs(x.d - y.d), abs(x.a - y.a)))
            angles.append(max(_apart(x.theta, y.theta), _apart(x.alpha, y.alpha), _apart(x.beta, y.beta)))
            labels.append(f"{pair.a.dof_label(dof)} in the chain to {pair.a.body_label(i)}")
    if labels:
        yield worst("DH parameters, lengths", "m", np.array(lengths), pair.allowed(_ALLOWED, 50.0), lambda k: labels[k])
        yield worst("DH parameters, angles", "rad", np.array(angles), pair.allowed(_ALLOWED, 50.0), lambda k: labels[k])


def _chains(pair: Pair) -> Iterator[tuple[int, int, list[int], list[int]]]:
    """The tips of the first robot that have a counterpart below the same dofs, as long as there are not too many."""
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


def _signature(pair: Pair, body: int, dofs: list[int], *, first: bool) -> tuple[Link, ...]:
    model, poses, rest = (pair.a, pair.zero_a, None) if first else (pair.b, pair.zero_b, pair.rest_b)
    lines, frames = lines_of(model, chain(model, body)[0], body, dofs, poses, rest)
    return signature(lines, frames[1])


def _apart(a: float, b: float) -> float:
    """The distance of two angles on the circle."""
    return abs(math.remainder(a - b, 2.0 * math.pi))


# ---- the canonical numbers of a chain --------------------------------------------------------------------------------


def signature(lines: Sequence[Line], tip: Frame) -> tuple[Link, ...]:
    """One link per joint: theta and d of the joint (0 of the first one), and the link to the next joint (0 of the last one)."""
    placed = [_placed(lines, i, tip.o) for i in range(len(lines))]
    frame = _first_frame(placed, tip)
    found: list[Link] = []
    for line, following in itertools.pairwise(placed):
        link, frame = link_between(frame, line, following, signed=True, touching=_TOUCHING, keep=True)
        found.append(link)
    return (*found, Link(0.0, 0.0, 0.0, 0.0))


def _placed(lines: Sequence[Line], i: int, tip: Vec) -> Line:
    """A slide's line, which may be anywhere, through a point that only the hinges around it and the tip decide."""
    line = lines[i]
    if not line.sliding:
        return line
    before = [k for k in range(i - 1, -1, -1) if not lines[k].sliding]
    after = [k for k in range(i + 1, len(lines)) if not lines[k].sliding]
    if not after and not before:
        return Line(tip, line.axis, sliding=True)
    own, others = (after[0], [*before[:1], *after[1:]]) if after else (before[0], before[1:])
    hinge = lines[own]
    skew = next((lines[k] for k in others if _sine(hinge, lines[k]) >= NEARLY_PARALLEL), None)
    point = _projected(tip, hinge) if skew is None else feet(hinge, skew, cross(hinge.axis, skew.axis))[0]
    return Line(point, line.axis, sliding=True)


def _first_frame(lines: Sequence[Line], tip: Frame) -> Frame:
    """On the first axis, at the height and in the direction of the first common normal that is determined."""
    first = lines[0]
    pairs = itertools.pairwise(lines)
    decisive = next(((a, b) for a, b in pairs if _sine(a, b) >= NEARLY_PARALLEL), None)
    height = tip.o if decisive is None else feet(decisive[0], decisive[1], cross(decisive[0].axis, decisive[1].axis))[0]
    origin = _projected(height, first)
    return _with_x(origin, first.axis, _direction(lines, origin, tip))


def _direction(lines: Sequence[Line], origin: Vec, tip: Frame) -> Vec:
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


def _with_x(origin: Vec, z: Vec, towards: Vec) -> Frame:
    x = _across(towards, z)
    x = times(1.0 / length(x), x)
    return Frame(origin, x, cross(z, x), z)


def _across(vector: Vec, axis: Vec) -> Vec:
    """The part of a vector that is perpendicular to a unit axis."""
    return minus(vector, times(dot(vector, axis), axis))


def _projected(point: Vec, line: Line) -> Vec:
    """The foot of a point on a line."""
    return plus(line.point, times(dot(minus(point, line.point), line.axis), line.axis))


def _sine(a: Line, b: Line) -> float:
    return length(cross(a.axis, b.axis))
