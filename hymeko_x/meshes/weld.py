"""Joining points: equal rows of a table become one.

A hash table of rows, in arrays: sorting (np.unique) in its place makes a whole conversion with meshes 3 to 130 %
slower (`python -m benchmarks.meshes`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_ROUNDS = 8
"""How often rows that share a slot with others look for a new one, before all are sorted instead."""
_LEAST_BITS = 12
"""Of the number of a slot: a table that fits into the nearest cache costs nothing."""
_BITS = 64
_ODD = 0x9E3779B97F4A7C15
"""Its powers are odd too, and each column of each turn is multiplied by one of its own."""


def joined(rows: NDArray[Any]) -> tuple[NDArray[Any], NDArray[np.int32]]:
    """The different rows of floats (n, k) in the order of their first appearance, and for each given row its place there.

    The zeros of both signs are the same; NaN equals nothing.
    """
    first = _first_equal(rows)
    new = np.flatnonzero(first == np.arange(len(rows)))
    places = np.empty(len(rows), dtype=np.int32)
    places[new] = np.arange(len(new), dtype=np.int32)
    return rows.take(new, axis=0) + rows.dtype.type(0.0), places[first]


def _first_equal(rows: NDArray[Any]) -> NDArray[np.int32]:
    """For each row the number of the first one that equals it.

    Equal rows share a slot, and the first row of a slot represents all in it. Rows that differ from that one
    look for other slots among themselves; that those are few is likely, not certain.
    """
    first = _first_in_slots(rows, 0)
    rest = _unequal(rows, rows, first)
    for turn in range(1, _ROUNDS):
        if not len(rest):
            return first
        others = rows[rest]
        own = _first_in_slots(others, turn)
        first[rest] = rest[own]
        rest = rest[_unequal(others, others, own)]
    return _first_by_sorting(rows) if len(rest) else first


def _unequal(rows: NDArray[Any], others: NDArray[Any], first: NDArray[np.int32]) -> NDArray[np.intp]:
    """The rows that differ from the first row of their slot."""
    found = np.flatnonzero(others.take(first, axis=0) != rows) // rows.shape[1]
    is_new = np.ones(len(found), dtype=bool)
    is_new[1:] = found[1:] != found[:-1]
    return np.asarray(found[is_new])


def _first_in_slots(rows: NDArray[Any], turn: int) -> NDArray[np.int32]:
    """For each row the first one in the same slot. There are at least twice as many slots as rows; each turn shares them out anew."""
    bits = max(len(rows).bit_length() + 1, _LEAST_BITS)
    slots = (_keys(rows, turn) >> np.uint64(_BITS - bits)).view(np.int64)
    table = np.empty(1 << bits, dtype=np.int32)
    table[slots[::-1]] = np.arange(len(rows) - 1, -1, -1, dtype=np.int32)  # where several go, the last one stays
    return table[slots]


def _keys(rows: NDArray[Any], turn: int) -> NDArray[np.uint64]:
    """A number for each row, the same for equal rows, whose leading bits hardly ever are the same for others.

    Source: multiplicative hashing, D. Knuth, The Art of Computer Programming 3, section 6.4.
    """
    columns = (rows + rows.dtype.type(0.0)).view(f"u{rows.itemsize}").T
    keys = np.zeros(len(rows), dtype=np.uint64)
    for number, column in enumerate(columns):
        keys += column * np.uint64(pow(_ODD, number * _ROUNDS + turn + 1, 1 << _BITS))
    return keys


def _first_by_sorting(rows: NDArray[Any]) -> NDArray[np.int32]:
    """The same by sorting all rows, whatever they are."""
    order = np.lexsort(rows.T[::-1])
    ordered = rows[order]
    starts = np.ones(len(rows), dtype=bool)
    starts[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    first = np.empty(len(rows), dtype=np.int32)
    first[order] = order[starts][np.cumsum(starts) - 1]
    return first
