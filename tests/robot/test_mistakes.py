"""Mistakes in an editing session are errors at their lines, and change nothing."""

from __future__ import annotations

import numpy as np
import pytest

import hymeko_x as hx
from hymeko_x.robot.kinematics import Coordinates
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


def test_a_path_is_no_part_and_the_message_names_what_loads_it() -> None:
    with pytest.raises(hx.EditError, match=r"a part is a Robot, found 'hand.xml'; give hymeko_x.load\('hand.xml'\)"):
        arm().attach("hand.xml", at="flange")  # type: ignore[arg-type]
    with pytest.raises(hx.EditError, match="a part is a Robot, found 3"):
        hx.compose((arm(), 3))  # type: ignore[type-var]


@pytest.mark.parametrize(
    ("tensor", "message"),
    [
        ((1, 1, 5, 0, 0, 0), "no body can have the inertia tensor of body 'fore': of 1, 1, 5 the last exceeds the sum of the others"),
        ((1, 1, 1, 2, 0, 0), "the inertia tensor of body 'fore' is not positive definite: its principal moments are -1, 1, 3"),
    ],
)
def test_a_tensor_that_no_body_can_have_is_an_error(tensor: tuple[float, ...], message: str) -> None:
    with arm().edit() as e:
        with pytest.raises(hx.EditError, match=message):
            e.bodies["fore"].tensor = tensor  # type: ignore[assignment]
        with pytest.raises(hx.EditError, match="of body 'new'"):
            e.add_body("new", on="fore", mass=1, tensor=(1, 1, 5, 0, 0, 0))
        assert "new" not in e.bodies
    assert e.robot == arm()
    with arm().edit() as e:
        e.bodies["fore"].tensor = (0, 0, 0, 0, 0, 0)  # a point
        e.bodies["upper"].tensor = (1, 1, 2, 0, 0, 0)  # a disc


@pytest.mark.parametrize(
    ("q", "message"),
    [
        ({"turn": float("nan")}, "joint 'turn': coordinates are finite numbers, found nan"),
        ({"turn": "much"}, "joint 'turn': coordinates are finite numbers, found 'much'"),
        ({"turn": None}, "joint 'turn': coordinates are finite numbers, found None"),
        ({"turn": (1, 2)}, "joint 'turn' has 1 coordinates, found 2"),
        ({"fly": (0, 0, 1, 0, 0, 0, 0)}, "joint 'fly': a quaternion of zeros is no rotation"),
        ({"roll": (0, 0, 0, 0)}, "joint 'roll': a quaternion of zeros is no rotation"),
        ([0.0] * 11 + [float("inf")], "robot 'r': coordinates are finite numbers, found"),
        ([0.0] * 11, "robot 'r' has 12 coordinates, found 11"),
    ],
)
def test_coordinates_that_are_none_are_named(q: Coordinates, message: str) -> None:
    text = "r : robot { a {} b {} c {} @fly : floating { + world - a } @roll : ball { + a - b } @turn : revolute { + b - c axis=Z } }"
    robot = hx.loads(text, "hymeko")
    with pytest.raises(hx.EditError) as error:
        robot.fk(q)
    assert str(error.value).startswith(message)
    assert robot.fk({"fly": (1, 0, 0, 1, 0, 0, 0), "turn": np.float64(0.5)})["c"].xyz == (1, 0, 0)
