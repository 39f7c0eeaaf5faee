"""Computed numbers are written as a person would: the shortest decimal that is equal to rounding."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hymeko_x.ir.decimals import PRECISION, clean_quat, shortest, shortest_of
from hymeko_x.ir.digits import number_text
from hymeko_x.ir.values import Pose, compose, quat_from_rpy, rotate_tensor, rpy_from_quat, unit_quat
from hymeko_x.ir.written import Written, clean_pose, length_of, pose_as_written

FLOATS = st.floats(allow_nan=False, allow_infinity=False)


@pytest.mark.parametrize(
    ("computed", "text"),
    [
        (59.99999999999999, "60"),
        (0.1 + 0.2, "0.3"),
        (0.00032900000000000003, "0.000329"),
        (2e200 / 3.0, "6.66666666666667e199"),
        (2.0 / 3.0, "0.666666666666667"),
        (-0.0, "-0"),
        (math.inf, "inf"),
        (5e-324, "5e-324"),
    ],
)
def test_a_computed_number_has_no_noise_behind_its_digits(computed: float, text: str) -> None:
    assert number_text(shortest(computed)) == text


@given(FLOATS)
def test_a_shortened_number_moves_by_rounding_at_most_and_is_no_longer(value: float) -> None:
    short = shortest(value)
    assert abs(Fraction(short) - Fraction(value)) <= Fraction(PRECISION) * abs(Fraction(value)) * (1 + Fraction(1, 2**20))
    assert len(repr(short)) <= len(repr(value))


def test_what_is_rounding_beside_the_largest_component_is_zero() -> None:
    assert shortest_of((0.00123, -4.9e-20, 1.2e-18)) == (0.00123, 0.0, 0.0)
    assert shortest_of((5.5e-17, 0.0, -1e-16)) == (5.5e-17, 0.0, -1e-16)  # small, but there is nothing larger
    assert shortest_of((5.5e-17, 0.0, -1e-16), 1.0) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("rpy", "quat"),
    [
        ((0.0, 0.0, math.pi), (0.0, 0.0, 0.0, 1.0)),
        ((math.pi, 0.0, math.pi / 2), (0.0, math.sqrt(0.5), math.sqrt(0.5), 0.0)),
        ((math.pi / 2, 0.0, math.pi / 2), (0.5, 0.5, 0.5, 0.5)),
        ((-math.pi / 2, 0.0, 0.0), (math.sqrt(0.5), -math.sqrt(0.5), 0.0, 0.0)),
    ],
)
def test_quarter_and_half_turns_have_clean_quaternions_and_clean_angles(
    rpy: tuple[float, float, float], quat: tuple[float, float, float, float]
) -> None:
    assert quat_from_rpy(rpy) == quat
    assert quat_from_rpy(rpy_from_quat(quat)) == quat


@given(st.tuples(*[st.floats(-1.0, 1.0)] * 4).filter(lambda quat: math.hypot(*quat) > 0.01))
def test_a_clean_quaternion_is_a_unit_one_to_the_last_bit(quat: tuple[float, float, float, float]) -> None:
    clean = clean_quat(unit_quat(quat))
    assert {abs(value) for value in unit_quat(clean)} == {abs(value) for value in clean}
    assert max(abs(a - b) for a, b in zip(clean, unit_quat(quat), strict=True)) <= 1.5 * PRECISION or unit_quat(quat) != quat


def test_a_tensor_in_turned_axes_has_no_products_of_rounding() -> None:
    turn = quat_from_rpy((0.0, math.pi / 2, 0.0))
    assert rotate_tensor(turn, (0.0123, 0.004, 0.0077, 0.0, 0.0, 0.0)) == (0.0077, 0.004, 0.0123, 0.0, 0.0, 0.0)


def test_a_pose_that_was_composed_forth_and_back_is_where_it_was() -> None:
    pose = Pose((0.1, 0.2, 0.3), quat_from_rpy((0.0, 0.0, math.pi / 2)))
    for _ in range(4):
        pose = compose(pose, Pose((0.0, 0.0, 0.0), quat_from_rpy((0.0, 0.0, math.pi / 2))))
    assert clean_pose(pose) == Pose((0.1, 0.2, 0.3), quat_from_rpy((0.0, 0.0, math.pi / 2)))


def test_a_solid_between_two_points_lies_midway_without_noise() -> None:
    between = Written("fromto", (0.1, 0.0, 0.2, 0.2, 0.0, 0.1))
    assert pose_as_written((0.0, 0.0, 0.0), between).xyz == (0.15, 0.0, 0.15)
    assert number_text(length_of(Written("fromto", (0.0, 0.0, 0.1, 0.0, 0.0, 0.3)))) == "0.2"
