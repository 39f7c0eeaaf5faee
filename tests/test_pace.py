"""What takes too long is reported, and a round that the machine disturbed is not."""

from __future__ import annotations

import pytest

from tests.pace import ROUNDS, assert_at_most, assert_within


def linear(count: int) -> int:
    return sum(range(100 * count))


def quadratic(count: int) -> int:
    return sum(sum(range(count)) for _ in range(count))


def test_linear_work_takes_ten_times_as_long_as_a_tenth_of_it() -> None:
    assert_at_most(2.0, lambda: linear(20_000), lambda: linear(2_000), count=10)


def test_quadratic_work_does_not() -> None:
    with pytest.raises(AssertionError, match=r"times as long, not 2 at most"):
        assert_at_most(2.0, lambda: quadratic(1_000), lambda: quadratic(100), count=10)


def test_one_good_round_is_enough() -> None:
    lengths = iter([50_000] * (ROUNDS - 1) + [1])
    assert_at_most(2.0, lambda: linear(next(lengths)), lambda: linear(2_000))
    assert next(lengths, None) is None


def test_a_bound_in_seconds_holds_in_one_round_or_in_none() -> None:
    lengths = iter([20_000_000, 1])
    assert_within(0.1, lambda: sum(range(next(lengths))))
    with pytest.raises(AssertionError, match=r"^(\d\.\d{3}(, )?){5} s, not 0 s at most"):
        assert_within(0.0, lambda: linear(100))
