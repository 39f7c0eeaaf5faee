"""Rotations and quaternions of the verifier against scipy's."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from hymeko_x.verify.spatial import quat_from_rotation, rotation_from_quat

ANGLE = st.floats(-4.0, 4.0) | st.sampled_from([0.0, 1e-9, np.pi / 2, np.pi, -np.pi, np.pi - 1e-9])


@given(arrays(float, st.tuples(st.integers(1, 4), st.just(3)), elements=ANGLE))
def test_quaternions_of_rotations_are_those_of_scipy(vectors: np.ndarray) -> None:
    rotations = Rotation.from_rotvec(vectors).as_matrix()
    quats = quat_from_rotation(rotations)
    theirs = Rotation.from_matrix(rotations).as_quat()[:, [3, 0, 1, 2]]
    assert np.minimum(np.abs(quats - theirs).max(axis=1), np.abs(quats + theirs).max(axis=1)).max() < 1e-14
    assert (quats[:, 0] >= 0.0).all()
    np.testing.assert_allclose(rotation_from_quat(quats), rotations, atol=1e-14)
    np.testing.assert_array_equal(quat_from_rotation(rotations[0]), quats[0])
