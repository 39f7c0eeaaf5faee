"""Sets of fields that several things share: what is written once holds for all of them, and saves letters."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from hymeko_x.factor.sets import Costs, Shared, share

COSTS = Costs(definition=20, field=3, use=8, least=1)
ROWS = st.lists(st.dictionaries(st.sampled_from("abcdef"), st.sampled_from(["1", "22", "0.125 0.25", "1.0625"]), max_size=6), max_size=20)


def letters(rows: list[list[tuple[str, str]]], found: list[Shared]) -> int:
    """What rows and sets cost together."""
    left = [set(row) for row in rows]
    named: set[int] = set()
    for shared in found:
        named |= set(shared.members)
        for member in shared.members:
            left[member] -= shared.pairs
    fields = [pair for row in left for pair in row] + [pair for shared in found for pair in shared.pairs]
    return sum(len(name) + len(text) + COSTS.field for name, text in fields) + len(found) * COSTS.definition + len(named) * COSTS.use


@given(ROWS)
@settings(max_examples=200)
def test_sets_are_true_of_their_rows_and_save_letters(table: list[dict[str, str]]) -> None:
    rows = [list(row.items()) for row in table]
    found = share(rows, COSTS)
    assert found == share(rows, COSTS)
    for number, shared in enumerate(found):
        assert all(shared.pairs <= set(rows[member]) for member in shared.members)
        if shared.refines is not None:
            assert shared.refines < number
            assert set(shared.members) <= set(found[shared.refines].members)
    tops = [member for shared in found if shared.refines is None for member in shared.members]
    assert len(tops) == len(set(tops))
    assert letters(rows, found) <= letters(rows, [])


def test_roles_are_found_among_rows_that_also_share_something_else() -> None:
    hip = [("axis", "0 1 0"), ("range", "-1.0625 1.0625"), ("damping", "0.125")]
    knee = [("axis", "1 0 0"), ("range", "-0.03125 2.0625"), ("damping", "0.125")]
    found = share([hip, knee] * 4, COSTS)
    assert [(sorted(shared.pairs), shared.members, shared.refines) for shared in found] == [
        (sorted(knee), (1, 3, 5, 7), None),
        (sorted(hip), (0, 2, 4, 6), None),
    ]
