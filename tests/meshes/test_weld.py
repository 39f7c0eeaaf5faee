"""Joining points: what is equal becomes one, in order, whatever the numbers are."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from hymeko_x.meshes.weld import joined

if TYPE_CHECKING:
    from numpy.typing import NDArray

DICE = np.random.default_rng(0)
TABLES = {
    "none": np.zeros((0, 3)),
    "one": np.ones((1, 3)),
    "all the same": np.ones((5000, 3), dtype=np.float32),
    "all different": DICE.normal(size=(5000, 3)),
    "a lattice": DICE.integers(-9, 10, (20000, 3)).astype(np.float32),
    "a lattice in double precision": DICE.integers(-9, 10, (20000, 3)).astype(np.float64),
    "powers of two": 2.0 ** DICE.integers(-60, 60, (20000, 3)),
    "with texture coordinates": DICE.integers(0, 4, (5000, 5)) / 3.0,
    "points and their mirror images": np.concatenate(
        [DICE.normal(size=(9000, 3)).astype(np.float32).astype(np.float64) * side for side in (1, -1)]
    ),
    "zeros of both signs": DICE.choice([0.0, -0.0], (100, 3)),
}


@pytest.mark.parametrize("name", TABLES)
def test_equal_rows_become_one_in_the_order_of_their_first_appearance(name: str) -> None:
    rows = TABLES[name]
    unique, index = joined(rows)
    assert list(map(tuple, unique.tolist())) == list(dict.fromkeys(map(tuple, rows.tolist())))
    assert np.array_equal(unique[index], rows)


def test_what_is_not_a_number_equals_nothing() -> None:
    rows = np.array([[np.nan, 0.0, 0.0], [1.0, 1.0, 1.0], [np.nan, 0.0, 0.0], [1.0, 1.0, 1.0]])
    unique, index = joined(rows)
    assert index.tolist() == [0, 1, 2, 1]
    assert len(unique) == 3


def test_rows_that_are_made_to_share_their_slots_are_told_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    def one_slot(rows: NDArray[Any], turn: int) -> NDArray[np.uint64]:
        del turn
        return np.zeros(len(rows), dtype=np.uint64)

    monkeypatch.setattr("hymeko_x.meshes.weld._keys", one_slot)
    rows = DICE.integers(0, 5, (2000, 3)).astype(np.float64)
    unique, index = joined(rows)
    assert list(map(tuple, unique.tolist())) == list(dict.fromkeys(map(tuple, rows.tolist())))
    assert np.array_equal(unique[index], rows)
