"""Numbers as text: the fewest digits, and every bit."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hymeko_x.ir.digits import number_text, number_texts, numbers_text


@settings(max_examples=100, deadline=None)
@given(st.floats(allow_nan=False))
def test_the_text_of_a_number_reads_back_to_the_same_double(value: float) -> None:
    text = number_text(value)
    assert float(text) == value
    assert math.copysign(1.0, float(text)) == math.copysign(1.0, value)
    assert len(text) <= len(repr(value))


@pytest.mark.parametrize(
    ("value", "text"),
    [(2.0, "2"), (0.1, "0.1"), (-1e-7, "-1e-7"), (1e22, "1e22"), (1e16, "1e16"), (123456789.0, "123456789"), (1 / 3, "0.3333333333333333")],
)
def test_numbers_are_as_short_as_they_can_be(value: float, text: str) -> None:
    assert number_text(value) == text


def test_numbers_stand_with_blanks_between_them() -> None:
    assert numbers_text((1.0, -0.5, 0.0)) == "1 -0.5 0"


def test_small_numbers_have_an_exponent_from_the_same_size_on() -> None:
    assert numbers_text((1e-4, 1e-5, -1.25e-5, 9.5e-6, 10.00002)) == "0.0001 1e-5 -1.25e-5 9.5e-6 10.00002"


@given(st.lists(st.floats() | st.integers(-(10**20), 10**20) | st.sampled_from([-0.0, 1e-5, 9.999e-5, 1e-4, 1e15, 1e16, 5e-324, True])))
def test_several_numbers_are_written_as_each_of_them_is(values: list[float]) -> None:
    assert numbers_text(tuple(values)) == " ".join(map(number_text, values))
    assert numbers_text(tuple(map(np.float64, values))) == " ".join(map(number_text, values))
    named = {f"n{place}": value for place, value in enumerate(values)}
    assert number_texts(named) == {name: number_text(value) for name, value in named.items()}


def test_rows_that_are_equal_keep_the_signs_of_their_own_zeros() -> None:
    assert [numbers_text(row) for row in ((0.0, 1.0), (-0.0, 1.0), (0.0, 1.0))] == ["0 1", "-0 1", "0 1"]
