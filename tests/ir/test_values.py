"""Vectors, rotations, poses, tensors and the text of numbers, against scipy and numpy."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from hymeko_x.ir.values import (
    IDENTITY,
    NO_ROTATION,
    Pose,
    Quat,
    Vec3,
    Written,
    apply,
    compose,
    cross,
    inverse,
    matrix_from_quat,
    plane_axes,
    pose,
    pose_from_rpy,
    quat_about,
    quat_from_rpy,
    quat_from_z,
    quat_product,
    rotate,
    rotate_tensor,
    rotation_angle,
    rpy_from_quat,
    rpy_of,
    unit,
    unit_quat,
)
from hymeko_x.testing.values import POSES, QUATERNIONS, VECTORS

ANGLES = st.floats(-10.0, 10.0) | st.sampled_from([0.0, math.pi, -math.pi, math.pi / 2, -math.pi / 2])
MANY = settings(max_examples=100, deadline=None)


def scipy_rotation(quat: Quat) -> Rotation:
    return Rotation.from_quat(quat, scalar_first=True)


# ---- rotations -----------------------------------------------------------------------------------------------------------------


@MANY
@given(st.tuples(ANGLES, ANGLES, ANGLES))
def test_rpy_turns_about_fixed_axes_roll_first(rpy: Vec3) -> None:
    expected = Rotation.from_euler("xyz", rpy)
    assert (scipy_rotation(quat_from_rpy(rpy)) * expected.inv()).magnitude() < 1e-12
    np.testing.assert_allclose(matrix_from_quat(quat_from_rpy(rpy)), expected.as_matrix(), atol=1e-12)


@MANY
@given(st.tuples(ANGLES, ANGLES, ANGLES))
@example((0.3, math.pi / 2, 0.0))
@example((0.3, -math.pi / 2, 0.7))
@example((0.0, math.pi / 2 - 1e-9, 0.1))
@example((1.0, math.pi / 2 + 1e-13, -2.0))
@example((math.pi, 0.0, math.pi))
@example((-math.pi, math.pi, -math.pi))
def test_rpy_of_a_rotation_gives_that_rotation_even_in_gimbal_lock(rpy: Vec3) -> None:
    quat = quat_from_rpy(rpy)
    roll, pitch, yaw = rpy_from_quat(quat)
    assert rotation_angle(quat_from_rpy((roll, pitch, yaw)), quat) < 1e-12
    assert -math.pi < roll <= math.pi
    assert abs(pitch) <= math.pi / 2 or (roll, yaw) == (0.0, 0.0)
    assert abs(yaw) <= math.pi


def test_in_gimbal_lock_the_yaw_is_zero() -> None:
    for sign in (1.0, -1.0):
        roll, pitch, yaw = rpy_from_quat(quat_from_rpy((0.2, sign * math.pi / 2, 0.5)))
        assert (yaw, pitch) == (0.0, pytest.approx(sign * math.pi / 2, abs=1e-7))
        assert roll == pytest.approx(0.2 - sign * 0.5, abs=1e-7)


@MANY
@given(st.tuples(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1)))
def test_moderate_angles_come_back(rpy: Vec3) -> None:
    np.testing.assert_allclose(rpy_from_quat(quat_from_rpy(rpy)), rpy, atol=1e-12)


@MANY
@given(QUATERNIONS)
def test_normalising_twice_is_normalising_once(quat: Quat) -> None:
    once = unit_quat(quat)
    assert unit_quat(once) == once
    assert math.hypot(*once) == pytest.approx(1.0, abs=4e-16)
    assert once[0] >= 0.0
    assert "-0.0" not in map(repr, once)


@MANY
@given(QUATERNIONS)
@example((0.0, -1.0, 0.0, 2.0))
@example((0.0, 0.0, -3.0, 2.0))
def test_a_quaternion_and_its_negative_are_the_same_numbers(quat: Quat) -> None:
    w, x, y, z = quat
    assert unit_quat((-w, -x, -y, -z)) == unit_quat(quat)


@MANY
@given(VECTORS.filter(lambda v: max(map(abs, v)) > 1e-3))
def test_a_unit_vector_stays_as_it_is(vector: Vec3) -> None:
    once = unit(vector)
    assert unit(once) == once
    assert math.hypot(*once) == pytest.approx(1.0, abs=4e-16)


@pytest.mark.parametrize("vector", [(0.0, 0.0, 0.0), (1e-310, 0.0, 0.0), (math.inf, 0.0, 0.0), (math.nan, 1.0, 0.0)])
def test_what_has_no_direction_is_refused(vector: Vec3) -> None:
    with pytest.raises(ZeroDivisionError, match="has no direction"):
        unit(vector)
    with pytest.raises(ZeroDivisionError, match="is no rotation"):
        unit_quat((0.0, *vector))


@MANY
@given(POSES, POSES, VECTORS)
def test_composing_and_inverting_agree_with_scipy(a: Pose, b: Pose, point: Vec3) -> None:
    first, second = scipy_rotation(a.quat), scipy_rotation(b.quat)
    both = compose(a, b)
    np.testing.assert_allclose(both.xyz, np.add(a.xyz, first.apply(b.xyz)), atol=1e-9)
    assert (scipy_rotation(both.quat) * (first * second).inv()).magnitude() < 1e-12
    np.testing.assert_allclose(apply(a, point), np.add(a.xyz, first.apply(point)), atol=1e-9)
    back = compose(inverse(a), a)
    np.testing.assert_allclose(back.xyz, (0.0, 0.0, 0.0), atol=1e-9)
    assert rotation_angle(back.quat, NO_ROTATION) < 1e-12


@MANY
@given(QUATERNIONS, VECTORS)
def test_rotating_agrees_with_scipy(quat: Quat, vector: Vec3) -> None:
    turn = unit_quat(quat)
    np.testing.assert_allclose(rotate(turn, vector), scipy_rotation(turn).apply(vector), atol=1e-9)
    np.testing.assert_allclose(
        scipy_rotation(unit_quat(quat_product(turn, turn))).as_matrix(), np.linalg.matrix_power(matrix_from_quat(turn), 2), atol=1e-12
    )


@MANY
@given(QUATERNIONS, QUATERNIONS)
def test_the_angle_between_rotations_is_that_of_scipy(a: Quat, b: Quat) -> None:
    first, second = unit_quat(a), unit_quat(b)
    angle = rotation_angle(first, second)
    assert angle == pytest.approx((scipy_rotation(first).inv() * scipy_rotation(second)).magnitude(), abs=1e-12)
    assert rotation_angle(first, second) <= angle + 1e-12
    assert angle < 1e-6 or rotation_angle(first, second) > angle / 2


@MANY
@given(QUATERNIONS, st.tuples(*[st.floats(-10.0, 10.0)] * 6))
def test_a_turned_tensor_is_r_i_r_transposed(quat: Quat, tensor: tuple[float, float, float, float, float, float]) -> None:
    turn = unit_quat(quat)
    xx, yy, zz, xy, xz, yz = tensor
    r = scipy_rotation(turn).as_matrix()
    expected = r @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ r.T
    found = rotate_tensor(turn, tensor)
    np.testing.assert_allclose(found, expected[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]], atol=1e-12 * 100)


@MANY
@given(VECTORS.filter(lambda v: max(map(abs, v)) > 1e-3))
@example((0.0, 0.0, -1.0))
@example((1e-9, 0.0, -1.0))
def test_z_is_turned_into_any_direction(vector: Vec3) -> None:
    direction = unit(vector)
    np.testing.assert_allclose(rotate(quat_from_z(direction), (0.0, 0.0, 1.0)), direction, atol=1e-7)
    x, y = plane_axes(direction)
    np.testing.assert_allclose(cross(x, y), direction, atol=1e-7)


def test_a_rotation_about_an_axis_follows_the_right_hand() -> None:
    np.testing.assert_allclose(rotate(quat_about((0.0, 0.0, 1.0), math.pi / 2), (1.0, 0.0, 0.0)), (0.0, 1.0, 0.0), atol=1e-15)


# ---- notation ------------------------------------------------------------------------------------------------------------------


def test_angles_are_remembered_as_written_and_no_comparison_looks_at_them() -> None:
    turned = pose_from_rpy((1.0, 2.0, 3.0), (7.0, 0.0, 0.0))
    assert turned.written == Written("rpy", (7.0, 0.0, 0.0))
    assert rpy_of(turned) == (7.0, 0.0, 0.0)
    assert turned == Pose((1.0, 2.0, 3.0), turned.quat)
    assert rpy_of(Pose((0.0, 0.0, 0.0), turned.quat)) == (pytest.approx(7.0 - 2 * math.pi), 0.0, 0.0)


def test_an_unusual_quaternion_is_remembered_and_a_usual_one_is_not() -> None:
    assert pose((0.0, 0.0, 0.0), (2.0, 0.0, 0.0, 0.0)).written == Written("quat", (2.0, 0.0, 0.0, 0.0))
    assert pose((0.0, 0.0, 0.0), (2.0, 0.0, 0.0, 0.0)) == IDENTITY
    assert pose((0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0)).written is None
    assert pose_from_rpy((0.0, 0.0, 1.0), (0.0, 0.0, 0.0)).written is None


def test_a_rotation_does_not_depend_on_the_signs_of_zeros() -> None:
    """Equal angles are turned into a rotation once, and zeros of both signs are equal."""
    angles = (0.0, math.pi, -math.pi, math.pi / 2, 5e-324, 0.3, -0.7)
    for rpy in product(angles, repeat=3):
        quats = {
            repr(quat_from_rpy.__wrapped__(signed)) for signed in product(*[(angle, -angle) if angle == 0.0 else (angle,) for angle in rpy])
        }
        assert len(quats) == 1, rpy
