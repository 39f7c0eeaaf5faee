"""Mistakes in an editing session are errors at their lines, and change nothing."""

from __future__ import annotations

import numpy as np
import pytest

import hymeko_x as hx
from tests.robot.robots import arm


def test_a_field_that_elements_do_not_have_is_an_error() -> None:
    with arm().edit() as e:
        with pytest.raises(hx.EditError, match="joint 'elbow' has no 'limit'; did you mean 'limits'"):
            e.joints["elbow"].limit = (-1, 1)  # type: ignore[attr-defined]
        with pytest.raises(hx.EditError, match="body 'fore' has no 'colour'; there are"):
            e.bodies["fore"].colour = (1, 0, 0)  # type: ignore[attr-defined]
    assert e.robot == arm()


def test_sizes_are_more_than_zero_and_whole_numbers_are_sizes() -> None:
    with arm().edit() as e:
        with pytest.raises(hx.EditError, match=r"has a size that is not more than 0, found Box\(size=\(1, 1, -1\)\)"):
            e.add_shape("bad", hx.Box((1, 1, -1)), on="fore")
        with pytest.raises(hx.EditError, match=r"shape '.*': geometry has a size that is not more than 0, found Sphere\(radius=0\)"):
            e.shapes["foot"].geometry = hx.Sphere(0)
        assert "bad" not in e.shapes
        e.shapes["foot"].geometry = hx.Box(np.array((1, 2, 3)))  # type: ignore[arg-type]
        e.add_shape("floor", hx.Plane((0, 0)), on="world")
    assert e.robot.shapes["foot"].geometry == hx.Box((1.0, 2.0, 3.0))


def test_an_axis_of_two_numbers_is_an_error_that_names_three() -> None:
    with arm().edit() as e, pytest.raises(hx.EditError, match=r"joint 'elbow': axis is of the type tuple\[float, float, float\]"):
        e.joints["elbow"].axis = (1, 2)  # type: ignore[assignment]
