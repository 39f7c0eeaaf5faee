"""What a group of attributes is sure to repeat means the same to MuJoCo as what was read."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from hymeko_x.formats.mjcf.codec import POSE, BadAttribute, Group, Settings
from hymeko_x.formats.mjcf.places import INERTIAL, seen_from
from hymeko_x.ir.values import Pose

SETTINGS = Settings()


def texts(count: int) -> st.SearchStrategy[str]:
    """Numbers among which there are zeros of both signs and whole ones."""
    number = st.sampled_from(["0", "-0", "1", "-1", "1.0", "2e-5", "0.25"]) | st.floats(-9.0, 9.0).map(repr)
    return st.lists(number, min_size=count, max_size=count).map(" ".join)


TURNS = {"quat": texts(4), "euler": texts(3), "axisangle": texts(4), "zaxis": texts(3)}
MOMENTS = {"diaginertia": texts(3), "fullinertia": texts(6)}


def repeats(group: Group, attributes: dict[str, str]) -> bool:
    """Whether the group is sure to repeat the attributes, which then mean the same as those that it writes."""
    try:
        value = group.read(attributes, SETTINGS)
    except BadAttribute:
        return False
    assert group.repeats is not None
    if not group.repeats(value, attributes):
        return False
    written = group.write(value, SETTINGS)
    assert group.seen(written, SETTINGS) == group.seen(attributes, SETTINGS)
    return True


@given(st.fixed_dictionaries({}, optional={"pos": texts(3), **TURNS}))
def test_a_pose_that_is_repeated_means_the_same(attributes: dict[str, str]) -> None:
    repeats(POSE, attributes)


@given(st.fixed_dictionaries({"pos": texts(3), "mass": texts(1)}, optional={**MOMENTS, **TURNS}))
def test_an_inertial_that_is_repeated_means_the_same(attributes: dict[str, str]) -> None:
    repeats(INERTIAL, attributes)


def test_usual_attributes_are_repeated_and_others_are_compared() -> None:
    body = {"pos": "0 0 1", "mass": "2"}
    assert repeats(POSE, {"pos": "1 2 3", "quat": "0.5 0.5 0.5 0.5"})
    assert repeats(INERTIAL, {**body, "diaginertia": "1 2 3"})
    assert repeats(INERTIAL, {**body, "fullinertia": "1 2 3 0 0.1 0"})
    assert not repeats(INERTIAL, {**body, "fullinertia": "1 2 3 0 0 0"})
    assert not repeats(POSE, {"euler": "0 0 0"})
    assert seen_from(POSE, Pose((1.0, 2.0, 3.0))).repeats is None
