"""HyMeKo text is short: repeated fields are written once, and no default is written."""

from __future__ import annotations

import statistics
from typing import TYPE_CHECKING

import pytest

from benchmarks.size import BOUNDS, letters, ratio
from hymeko_x.backends.hymeko import write
from hymeko_x.corpus.catalog import development_files
from hymeko_x.diagnostics import Report
from hymeko_x.frontends.hymeko import read
from hymeko_x.rewrite.context import Options
from hymeko_x.source import Source
from tests.pace import assert_at_most

if TYPE_CHECKING:
    from tests.conftest import RealRobots

_EVERY = 12


def canonical(text: str) -> str:
    """The text as hymeko-x prints it."""
    return write(read(Source("robot.hymeko", text.encode()), Report()).mechanism, Options(), Report()).main.decode()


@pytest.mark.corpus
@pytest.mark.parametrize("form", sorted(BOUNDS))
def test_a_sample_of_real_robots_is_short(form: str, real_robot: RealRobots) -> None:
    files = development_files(form)[::_EVERY]
    assert statistics.median(ratio(real_robot(file), form) for file in files) <= BOUNDS[form] + 0.05


@pytest.mark.corpus
@pytest.mark.slow
@pytest.mark.parametrize("form", sorted(BOUNDS))
def test_half_of_all_real_robots_are_shorter_than_the_bound(form: str, real_robot: RealRobots) -> None:
    files = development_files(form)
    assert len(files) >= 60
    assert statistics.median(ratio(real_robot(file), form) for file in files) <= BOUNDS[form]


def test_equal_fields_become_a_stereotype() -> None:
    assert canonical("""
arm : robot {
  base {} upper {} fore {} hand {}
  @shoulder { [0 0 0.3] + base - upper axis=Y limit [-90 90] effort 87 velocity 120 }
  @elbow { [0 0 0.3] + upper - fore axis=Y limit [-90 90] effort 87 velocity 120 }
  @wrist { [0 0 0.3] + fore - hand axis=X limit [-90 90] effort 87 velocity 120 }
}
""") == (
        "arm : robot {\n"
        "  arm_joint() { limit [-90 90] velocity 120 effort 87 }\n"
        "  base {}\n"
        "  upper {}\n"
        "  fore {}\n"
        "  hand {}\n"
        "  @shoulder : arm_joint { [0 0 0.3] + base - upper axis=Y }\n"
        "  @elbow : arm_joint { [0 0 0.3] + upper - fore axis=Y }\n"
        "  @wrist : arm_joint { [0 0 0.3] + fore - hand axis=X }\n"
        "}\n"
    )


def test_what_two_short_elements_share_is_no_stereotype() -> None:
    text = "arm : robot { a { mass 1 } b { mass 1 } }\n"
    assert canonical(text) == text


def test_parameters_of_one_name_stay_together_and_in_order() -> None:
    text = "\n".join(f'  d{n} : drive.kind {{ interface "hardware/position" interface "hardware/{n}" }}' for n in range(4))
    robot = read(
        Source("robot.hymeko", f"r : robot {{\n{text}\n}}\n".replace("d0 :", "@d0 :").replace("  d", "  @d").encode()), Report()
    ).mechanism
    back = read(Source("robot.hymeko", write(robot, Options(), Report()).main), Report()).mechanism
    assert back == robot


def test_letters_are_no_white_space() -> None:
    assert letters(" a\n\tb c ") == 3


@pytest.mark.slow
def test_printing_takes_little_longer_than_reading_where_thousands_of_values_are_shared() -> None:
    """Every set of fields that two elements share could be a stereotype."""
    joints = (
        f"  @j{n} {{ [0 0 {n % 1000}] + b{n} - b{n + 1} limit [-1 {n % 600}] effort {n % 1500} velocity {n % 750} "
        f"damping {n % 500} friction {n % 400} }}"
        for n in range(3000)
    )
    bodies = (f"  b{n} {{ mass {n} }}" for n in range(3001))
    text = "\n".join(("r : robot {", *bodies, *joints, "}"))
    source = Source("robot.hymeko", text.encode())
    robot = read(source, Report()).mechanism
    assert_at_most(2.5, lambda: write(robot, Options(), Report()), lambda: read(source, Report()).mechanism)
