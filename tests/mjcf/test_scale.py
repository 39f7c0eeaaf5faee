"""The time per element does not grow with their number nor with their depth. Ratios, since machines differ."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from mjmodels import read_text, write

from hymeko_x.backends import hymeko
from hymeko_x.diagnostics import Report
from hymeko_x.rewrite.context import Options
from tests.pace import assert_at_most

if TYPE_CHECKING:
    from collections.abc import Callable


def nested_bodies(count: int) -> str:
    return '<body pos="0 0 1"><joint/><geom size=".1"/>' * count + "</body>" * count


def nested_frames(count: int) -> str:
    return '<frame pos="0 0 .1"><geom size=".1"/>' * count + "</frame>" * count


def many_geoms(count: int) -> str:
    return "".join([f'<geom name="g{number}" size=".1" pos="{number} 0 0"/>' for number in range(count)])


def one_mesh(count: int) -> str:
    points = " ".join([f"{number * 0.001:.6f} {number * 0.002:.6f} {number * 0.003:.6f}" for number in range(count)])
    return f'<geom type="mesh" mesh="m"/></worldbody><asset><mesh name="m" vertex="{points}"/></asset><worldbody>'


def converting(content: str) -> Callable[[], object]:
    """The work to read a model and to write it as MJCF and as HyMeKo text."""
    text = f"<mujoco><worldbody>{content}</worldbody></mujoco>"

    def work() -> None:
        robot = read_text(text)
        write(robot)
        hymeko.write(robot, Options(), Report())

    return work


@pytest.mark.parametrize(
    ("make", "count"),
    [
        pytest.param(nested_bodies, 300, id="bodies in a chain"),
        pytest.param(nested_frames, 1000, id="frames in frames", marks=pytest.mark.full),
        pytest.param(many_geoms, 1000, id="geoms"),
        pytest.param(one_mesh, 5000, id="points of an inline mesh"),
    ],
)
def test_ten_times_as_many_take_ten_times_as_long(make: Callable[[int], str], count: int) -> None:
    assert_at_most(1.5, converting(make(10 * count)), converting(make(count)), count=10)


@pytest.mark.full
@pytest.mark.parametrize(
    ("make", "count"),
    [
        pytest.param(nested_bodies, 10_000, id="10,000 bodies in a chain"),
        pytest.param(nested_frames, 10_000, id="10,000 frames in frames"),
        pytest.param(many_geoms, 100_000, id="100,000 geoms"),
        pytest.param(one_mesh, 1_700_000, id="50 MB of points"),
    ],
)
def test_the_largest_files_take_no_longer_per_element_than_small_ones(make: Callable[[int], str], count: int) -> None:
    assert_at_most(2.0, converting(make(count)), converting(make(count // 100)), count=100)
