"""Factoring without order: sets of (name, text) that several elements share, such as the attributes of joints.

Serves formats in which an element may take fields from a class or a stereotype, and classes refine classes. Format-free,
exact and deterministic, as :mod:`hymeko_x.factor` is for forms with an order and holes.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from heapq import nsmallest
from itertools import combinations
from typing import TYPE_CHECKING

from msgspec import Struct

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

Pair = tuple[str, str]
"""The name and the text of a field."""
Row = list[Pair]
"""The fields of one element."""
Members = frozenset[int]
"""The numbers of the rows with a field."""
Owners = Mapping[Pair, Members]
"""The rows with a field, for every field that more than one of these rows has."""

_NO_MEMBERS: Members = frozenset()
_SEEDS = 24
_LEAST = 12
"""Letters that a set must save to be a candidate."""
_MOST = 32
"""The most sets in one group of elements."""


class Costs(Struct, frozen=True):
    """In letters: the costs of a definition, of a field, and of naming its set in a row; and the least that a set must save."""

    definition: int
    field: int
    use: int
    least: int


class Shared(Struct, frozen=True):
    """Fields that several rows share, the numbers of those rows, and the number of the set that it refines."""

    pairs: frozenset[Pair]
    members: tuple[int, ...]
    refines: int | None


def share(rows: Sequence[Row], costs: Costs) -> list[Shared]:
    """Sets that shorten the rows, each behind the one that it refines. A row is in one set, and in those that this one refines."""
    found: list[Shared] = []
    queue: list[tuple[Owners, int | None]] = [(_owners(rows), None)]
    for owners, parent in queue:
        while owners and len(found) < _MOST:
            best = _best(rows, owners, costs, use=costs.use if parent is None else 0)
            if best is None:
                break
            pairs, members = best
            inside = {pair: numbers & members for pair, numbers in owners.items() if pair not in pairs}
            queue.append((_of_several(inside), len(found)))
            found.append(Shared(pairs, tuple(sorted(members)), parent))
            owners = _of_several({pair: numbers - members for pair, numbers in owners.items()})
    return found


def _best(rows: Sequence[Row], owners: Owners, costs: Costs, use: int) -> tuple[frozenset[Pair], Members] | None:
    """The set that saves most, and the rows that have all of it."""
    best, most = None, costs.least - 1
    for pairs, members in _ranked(rows, owners):
        fields = sum([len(name) + len(text) + costs.field for name, text in pairs])
        saved = (len(members) - 1) * fields - len(members) * use - costs.definition
        if saved > most:
            best, most = (pairs, members), saved
    return best


def candidates(rows: Sequence[Row]) -> list[frozenset[Pair]]:
    """Sets of fields that rows share, by about how much they save, the best first. Near linear in the number of fields."""
    return [shared for shared, _ in _ranked(rows, _owners(rows))]


def _ranked(rows: Sequence[Row], owners: Owners) -> list[tuple[frozenset[Pair], Members]]:
    """The same with the rows that have all of a set; ``owners`` are those of each field."""

    def common(members: Members) -> frozenset[Pair]:
        """All fields that these rows share: a subset of those of any one of them."""
        return frozenset([pair for pair in rows[next(iter(members))] if members <= owners.get(pair, _NO_MEMBERS)])

    sharing: dict[Members, list[Pair]] = {}
    for pair, members in owners.items():
        sharing.setdefault(members, []).append(pair)
    ranked = list(sharing)
    if len(sharing) > 8 * _SEEDS:
        ranked = nsmallest(8 * _SEEDS, sharing, key=lambda members: (-_worth(members, sharing[members]), sorted(sharing[members])))
    closed = {members: common(members) for members in ranked}
    ranks = {members: (-_worth(members, shared), sorted(shared)) for members, shared in closed.items()}
    seeds = [members for members in sorted(ranks, key=ranks.__getitem__)[:_SEEDS] if len(members) > 2]  # of two, no part is shared
    for first, second in combinations(seeds, 2):
        both = first & second
        if len(both) > 1 and both not in closed:
            shared = closed[both] = common(both)
            ranks[both] = -_worth(both, shared), sorted(shared)
    worthy = sorted([members for members, (cost, _) in ranks.items() if -cost >= _LEAST], key=ranks.__getitem__)
    return [(closed[members], members) for members in worthy[:_SEEDS]]


def _owners(rows: Sequence[Row]) -> Owners:
    """For every field that occurs more than once the rows that have it."""
    found: dict[Pair, list[int]] = defaultdict(list)
    for number, row in enumerate(rows):
        for pair in row:
            found[pair].append(number)
    return _of_several({pair: frozenset(numbers) for pair, numbers in found.items()})


def _of_several(owners: Owners) -> Owners:
    """The fields that more than one row has."""
    return {pair: members for pair, members in owners.items() if len(members) > 1}


def _worth(members: Members, shared: Iterable[Pair]) -> int:
    """About how many letters a set saves."""
    cost = sum([len(text) for _, text in shared])
    return (len(members) - 1) * cost - 10
