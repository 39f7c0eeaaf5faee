"""A layered layout of an incidence graph: columns from left to right, arcs along their direction, nothing on top of anything.

1. Arcs that close a cycle are turned for the layout. 2. A node is one column right of the last of its predecessors; nodes without
predecessors move up to their first successor. 3. Long arcs pass each column between through a point of their own. 4. Points are
sorted in their columns by the mean place of their neighbours, a few times to the right and to the left. 5. Heights are the means
of the neighbours' heights, as near as the order allows without an overlap (isotonic regression). Each step is linear but for sorting.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from msgspec import Struct

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

_ROUNDS = 8
_LONGEST = 24
"""Over more columns an arc goes straight, so that the points of all arcs together remain few."""
_POINT = 10.0
"""The height that a passing arc has for itself."""


class Size(NamedTuple):
    """The room that a node needs: width, and height above and below its own line, with distances to others."""

    width: float
    above: float
    below: float


class GraphLayout(Struct, frozen=True):
    """The height of every node, the left and right end of every column, and the heights at which every arc passes the columns between."""

    height: Sequence[float]
    ends: Sequence[tuple[float, float]]
    passing: Sequence[Sequence[float]]


def columns(count: int, arcs: Sequence[tuple[int, int]]) -> dict[int, int]:
    """The column of every node; the ends of an arc are in different columns, and nearly always its start is in the left one."""
    turned = _closing(count, arcs)
    return _columns(count, [(end, start) if turned[number] else (start, end) for number, (start, end) in enumerate(arcs)])


def layered(sizes: Sequence[Size], column: Mapping[int, int], arcs: Sequence[tuple[int, int]], gap: float) -> GraphLayout:
    """Places for nodes of these sizes in these columns, with arcs from left to right by number; ``gap`` is the distance of columns."""
    points = _Points(sizes, column, arcs)
    order = _sorted(points)
    height = _heights(points, order)
    ends, left = [], 0.0
    for nodes in order:
        width = max((sizes[node].width for node in nodes if node < len(sizes)), default=0.0)
        ends.append((left, left + width))
        left += width + gap
    return GraphLayout([height[node] for node in range(len(sizes))], ends, [[height[point] for point in way] for way in points.ways])


def _closing(count: int, arcs: Sequence[tuple[int, int]]) -> list[bool]:
    """Which arcs close a cycle, walking depth first from nodes that nothing leads to."""
    outward: list[list[int]] = [[] for _ in range(count)]
    entered = [0] * count
    for number, (start, end) in enumerate(arcs):
        outward[start].append(number)
        entered[end] += 1
    closing = [False] * len(arcs)
    state = [0] * count
    for first in sorted(range(count), key=lambda node: entered[node] > 0):
        if state[first]:
            continue
        state[first] = 1
        stack = [(first, iter(outward[first]))]
        while stack:
            node, rest = stack[-1]
            arc = next(rest, None)
            if arc is None:
                state[node] = 2
                stack.pop()
                continue
            end = arcs[arc][1]
            closing[arc] = state[end] == 1
            if not state[end]:
                state[end] = 1
                stack.append((end, iter(outward[end])))
    return closing


def _columns(count: int, arcs: Iterable[tuple[int, int]]) -> dict[int, int]:
    """The longest way to a node; a node that nothing leads to is one column before the first node that it leads to."""
    after: list[list[int]] = [[] for _ in range(count)]
    waiting = [0] * count
    for start, end in arcs:
        after[start].append(end)
        waiting[end] += 1
    column = dict.fromkeys(range(count), 0)
    sources = [node for node in range(count) if not waiting[node]]
    ready = list(reversed(sources))
    while ready:
        node = ready.pop()
        for end in after[node]:
            column[end] = max(column[end], column[node] + 1)
            waiting[end] -= 1
            if not waiting[end]:
                ready.append(end)
    for node in sources:
        column[node] = min((column[end] for end in after[node]), default=1) - 1
    return column


class _Points:
    """Nodes, and behind them in the numbering the points through which long arcs pass; each with its neighbours on both sides."""

    def __init__(self, sizes: Sequence[Size], column: Mapping[int, int], arcs: Sequence[tuple[int, int]]) -> None:
        self.sizes = list(sizes)
        self.columns: list[list[int]] = [[] for _ in range(max(column.values(), default=-1) + 1)]
        self.before: list[list[int]] = [[] for _ in sizes]
        self.after: list[list[int]] = [[] for _ in sizes]
        self.ways: list[list[int]] = []
        for node in range(len(sizes)):
            self.columns[column[node]].append(node)
        for start, end in arcs:
            is_far = column[end] - column[start] > _LONGEST
            between = range(0) if is_far else range(column[start] + 1, column[end])
            self.ways.append([self._add(place) for place in between])
            if not is_far:
                chain = [start, *self.ways[-1], end]
                for left, right in pairwise(chain):
                    self.after[left].append(right)
                    self.before[right].append(left)

    def _add(self, column: int) -> int:
        point = len(self.sizes)
        self.sizes.append(Size(0, _POINT / 2, _POINT / 2))
        self.before.append([])
        self.after.append([])
        self.columns[column].append(point)
        return point


def _sorted(points: _Points) -> list[list[int]]:
    """The points of each column from top to bottom."""
    columns = [list(column) for column in points.columns]
    place = {point: float(number) for column in columns for number, point in enumerate(column)}
    for turn in range(_ROUNDS):
        rightwards = turn % 2 == 0
        near = points.before if rightwards else points.after
        for column in columns if rightwards else reversed(columns):
            column.sort(key=lambda point: _mean([place[other] for other in near[point]], place[point]))
            place.update((point, float(number)) for number, point in enumerate(column))
    return columns


def _heights(points: _Points, columns: Sequence[Sequence[int]]) -> dict[int, float]:
    """The height of each point, at the mean of its neighbours where the others leave room."""
    height = {point: 0.0 for column in columns for point in column}
    for turn in range(_ROUNDS + 1):
        rightwards = turn % 2 == 0
        near = points.before if rightwards else points.after
        for column in columns if rightwards else reversed(columns):
            wishes = [_mean([height[other] for other in near[point]], height[point]) for point in column]
            height.update(zip(column, _apart([points.sizes[point] for point in column], wishes), strict=True))
    top = min((height[point] - points.sizes[point].above for point in height), default=0.0)
    return {point: round(value - top, 1) for point, value in height.items()}


def _apart(sizes: Sequence[Size], wishes: Sequence[float]) -> list[float]:
    """The heights nearest to the wishes (least squares) at which nothing overlaps, in the given order."""
    offsets, offset = [], 0.0
    for number, size in enumerate(sizes):
        offset += size.above + sizes[number - 1].below if number else 0.0
        offsets.append(offset)
    blocks: list[tuple[float, int]] = []
    for wish, offset in zip(wishes, offsets, strict=True):
        total, count = wish - offset, 1
        while blocks and blocks[-1][0] / blocks[-1][1] > total / count:
            total, count = total + blocks[-1][0], count + blocks[-1][1]
            blocks.pop()
        blocks.append((total, count))
    level = [total / count for total, count in blocks for _ in range(count)]
    return [base + offset for base, offset in zip(level, offsets, strict=True)]


def _mean(values: Sequence[float], otherwise: float) -> float:
    return sum(values) / len(values) if values else otherwise
