"""Whether values are the same to the last bit."""

from __future__ import annotations

import math

from hypothesis import given
from hypothesis import strategies as st

from hymeko_x.ir.fields import have_same_bytes, identical
from hymeko_x.ir.parts import Dof

VALUES = st.sampled_from([0.0, -0.0, 1.0, 1, -2.5, math.nan, -math.nan, math.inf, 10**400, "1", None, (0.0,), (-0.0,)])
"""Numbers, and what else a list of plain data may hold."""
PAIRS = st.one_of(st.sampled_from([(0.0, -0.0), (1, 1.0), (math.nan, -math.nan)]), VALUES.map(lambda value: (value, value)))


@given(st.lists(PAIRS, min_size=1, max_size=3), st.sampled_from([0, 100]))
def test_long_rows_are_the_same_where_each_of_their_values_is(pairs: list[tuple[object, object]], length: int) -> None:
    start = (0.5,) * length
    first, second = (start + tuple(pair[side] for pair in pairs) for side in (0, 1))
    assert identical(first, second) == all(identical(a, b) for a, b in pairs)


@given(VALUES | st.lists(VALUES).map(tuple), VALUES | st.lists(VALUES).map(tuple))
def test_values_with_the_same_bytes_are_the_same(a: object, b: object) -> None:
    assert identical(a, b) or not have_same_bytes(a, b)


def test_floats_and_parts_have_the_same_bytes_where_all_their_bits_are_the_same() -> None:
    assert have_same_bytes((0.1, math.nan, -0.0, None), (0.1, math.nan, -0.0, None))
    assert have_same_bytes(Dof(damping=0.5), Dof(damping=0.5))
    assert not have_same_bytes(0.0, -0.0)
    assert not have_same_bytes(10**400, 10**400)
