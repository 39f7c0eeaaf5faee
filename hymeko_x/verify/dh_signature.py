"""The canonical numbers of a chain: the same for two robots whenever they move alike, however their frames were chosen.

Rigid motions of the base and points sliding along their axes change nothing. What geometry leaves free is fixed in one way: the
first frame by the first common normal, slides' lines by the hinges around them, and x by a fixed sense of each normal.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

from hymeko_x.verify.dh_lines import NEARLY_PARALLEL, Frame, Line, Link, Vec, cross, dot, feet, length, link_between, minus, plus, times

if TYPE_CHECKING:
    from collections.abc import Sequence

_TOUCHING = 1e-6  # m; robots are compared with a tolerance, so that closer lines are one


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
