"""Laws of verdicts, in every ordered pair of formats: equal robots are the same, and one change makes another robot, there."""

from __future__ import annotations

import re
from collections.abc import Iterable
from itertools import product
from pathlib import Path

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from hymeko_x import formats, pipeline
from hymeko_x.diagnostics import Report
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles
from hymeko_x.testing import arms
from hymeko_x.verify import model_of
from hymeko_x.verify.checks import compare
from hymeko_x.verify.features import Feature
from hymeko_x.verify.matching.bodies import identifier
from hymeko_x.verify.model import KinematicModel
from hymeko_x.verify.verdict import Verdict
from tests.verify.one_change import PLANTERS, Change
from tests.verify.one_tendon import TENDON_PLANTERS, cabled

FILES = {"hymeko": "r.hymeko", "urdf": "r.urdf", "xacro": "r.xacro", "mjcf": "r.xml", "usd": "r.usda"}
PAIRS = list(product(FILES, repeat=2))
OF_TENDONS = list(product(("hymeko", "mjcf", "usd"), repeat=2))
"""The pairs of formats that have tendons."""
SAMPLES = 4
_QUOTED = re.compile(r"'([^']*)'")


def law(share: int) -> settings:
    """So many times fewer examples than the profile says, each of which is judged in all pairs of formats."""
    return settings(max_examples=max(2, settings.default.max_examples // share), deadline=None, suppress_health_check=list(HealthCheck))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("laws")


def seen(robot: Mechanism, wanted: Iterable[str], folder: Path) -> dict[str, KinematicModel]:
    """The robot as the reference reader of each of these formats sees what is written of it."""
    found = {}
    for format in wanted:
        package = pipeline.write(robot, formats.by_name(format), Options(), NoFiles(), Report())
        (folder / FILES[format]).write_bytes(package.main)
        found[format] = model_of(folder / FILES[format])
    return found


@law(33)
@given(robot=arms())
def test_a_robot_is_the_same_in_every_two_formats(robot: Mechanism, folder: Path) -> None:
    models = seen(robot, FILES, folder)
    apart = {(a, b): verdict for a, b in PAIRS if not (verdict := compare(models[a], models[b], samples=SAMPLES)).is_same}
    assert apart == {}


@pytest.mark.parametrize("planted", PLANTERS)
@law(50)
@given(data=st.data())
def test_one_change_makes_another_robot_in_every_two_formats(planted: str, data: st.DataObject, folder: Path) -> None:
    """Each example is judged in two or three pairs of formats; which one comes first is another one for each change."""
    robot = data.draw(arms())
    change = PLANTERS[planted](data.draw, robot)
    assume(change is not None)
    pairs = data.draw(st.lists(st.sampled_from(_turned(PAIRS, [*PLANTERS].index(planted))), min_size=2, max_size=3, unique=True))
    assert_found(robot, change, pairs, folder)


@law(33)
@given(robot=cabled())
def test_tendons_are_the_same_in_every_two_formats_that_have_them(robot: Mechanism, folder: Path) -> None:
    models = seen(robot, {a for a, _ in OF_TENDONS}, folder)
    verdicts = {(a, b): compare(models[a], models[b], samples=SAMPLES) for a, b in OF_TENDONS}
    assert {pair: verdict for pair, verdict in verdicts.items() if not verdict.is_same} == {}
    assert all(Feature.TENDONS.value in {check.quantity for check in verdict.checks} for verdict in verdicts.values())


@pytest.mark.parametrize("planted", TENDON_PLANTERS)
@law(50)
@given(data=st.data())
def test_one_change_to_a_tendon_makes_another_robot_in_every_two_formats_that_have_them(
    planted: str, data: st.DataObject, folder: Path
) -> None:
    robot = data.draw(cabled())
    change = TENDON_PLANTERS[planted](data.draw, robot)
    assume(change is not None)
    pairs = _turned(OF_TENDONS, [*TENDON_PLANTERS].index(planted))
    assert_found(robot, change, data.draw(st.lists(st.sampled_from(pairs), min_size=2, max_size=3, unique=True)), folder)


def _turned(pairs: list[tuple[str, str]], by: int) -> list[tuple[str, str]]:
    """The same pairs, another one first."""
    first = by % len(pairs)
    return pairs[first:] + pairs[:first]


def assert_found(robot: Mechanism, change: Change, pairs: list[tuple[str, str]], folder: Path) -> None:
    """In each pair of formats that can say what was changed."""
    before, after = seen(robot, {a for a, _ in pairs}, folder), seen(change.robot, {b for _, b in pairs}, folder)
    for a, b in pairs:
        if change.feature is None or change.feature in before[a].features & after[b].features:
            assert finds(compare(before[a], after[b], samples=SAMPLES), change), (a, b)


def finds(verdict: Verdict, change: Change) -> bool:
    """Whether the check that the change is for says where it is. USD spells names in its own way."""
    names = {_spelled(name) for name in change.names}
    reported = [_spelled(check.at) for check in verdict.failed if check.quantity == change.quantity]
    return verdict.verdict == "different" and any(name in words for words in reported for name in names)


def _spelled(words: str) -> str:
    return _QUOTED.sub(lambda name: f"'{identifier(name[1])}'", words)
