"""The order of elements: which ones have to move, and moving them among whatever else an editor left."""

from __future__ import annotations

from bisect import bisect_left
from collections import defaultdict
from typing import TYPE_CHECKING

from hymeko_x.residue import Run

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from hymeko_x.ir.mechanism import Id


def by_kind(keys: Iterable[Id]) -> dict[str, list[Id]]:
    """The elements of each kind in their order, which is all of a graph's order that means something."""
    found: dict[str, list[Id]] = defaultdict(list)
    for key in keys:
        found[key.kind].append(key)
    return dict(found)


def moves(have: Sequence[Id], want: Sequence[Id]) -> Iterator[Run]:
    """The fewest elements to move so that one order becomes the other, of the same elements."""
    if have == want:
        return
    place = {key: number for number, key in enumerate(have)}
    staying = _rising([place[key] for key in want])
    after: Id | None = None
    run: list[Id] = []
    for key in want:
        if place[key] not in staying:
            run.append(key)
            continue
        if run:
            yield Run(after, tuple(run))
            run = []
        after = key
    if run:
        yield Run(after, tuple(run))


def _rising(numbers: Sequence[int]) -> set[int]:
    """A longest rising subsequence, in n log n."""
    tops: list[int] = []
    before: dict[int, int | None] = {}
    for number in numbers:
        level = bisect_left(tops, number)
        before[number] = tops[level - 1] if level else None
        tops[level : level + 1] = [number]
    found: set[int] = set()
    last: int | None = tops[-1] if tops else None
    while last is not None:
        found.add(last)
        last = before[last]
    return found


def moved(have: Sequence[Id], runs: Sequence[Run]) -> list[Id]:
    """The order with the runs in their places; a run whose place is gone stands behind the one before it."""
    there = set(have)
    going = {key for run in runs for key in run.elements if key in there}
    behind: dict[Id | None, list[Id]] = defaultdict(list)
    last: Id | None = None
    for run in runs:
        last = run.after if run.after is None or run.after in there else last
        behind[last] += [key for key in run.elements if key in going]
    result = list(behind[None])
    for key in have:
        if key not in going:
            result.append(key)
            result += behind.get(key, [])
    placed = set(result)
    return result + [key for key in have if key not in placed]


def laid_out(have: Sequence[Id], want: Sequence[Id], known: set[Id]) -> tuple[Id, ...]:
    """The wanted layout of the elements that are there; what is not known stays behind the element that it stood behind."""
    behind: dict[Id | None, list[Id]] = defaultdict(list)
    wanted = set(want)
    last: Id | None = None
    for key in have:
        if key in wanted:
            last = key
        elif key not in known:
            behind[last].append(key)
    result = list(behind[None])
    for key in want:
        result += [key, *behind.get(key, [])]
    return tuple(result)
