"""Real robots for the tests, from the cache that `hymeko-x corpus fetch` fills."""

from __future__ import annotations

import os
import random
from collections import defaultdict
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import settings
from hypothesis.internal.conjecture import providers
from hypothesis.internal.constants_ast import Constants

from hymeko_x import codes
from hymeko_x.corpus import cache, catalog
from hymeko_x.diagnostics import Refusal
from hymeko_x.draw.render import choose_backend
from tests.unread import UNREAD

if TYPE_CHECKING:
    from collections.abc import Iterator

choose_backend()  # MuJoCo decides how it draws when it is imported, by whichever test that is

# The same examples in every run, however busy the machine is, so that a change is judged by what it changed;
# `HYPOTHESIS_PROFILE=search` looks for new ones.
settings.register_profile("same", derandomize=True, database=None, deadline=None)
# `ci` and `nightly` look for new ones for minutes and for hours (`make fuzz`): tests of laws take their number from the profile.
settings.register_profile("search", derandomize=False)
settings.register_profile("ci", derandomize=False, max_examples=200)
settings.register_profile("nightly", derandomize=False, max_examples=20_000)
PROFILE = os.environ.get("HYPOTHESIS_PROFILE", "same")
settings.load_profile(PROFILE)


def pytest_configure() -> None:
    """Draw the same examples whatever was imported before: Hypothesis also draws the constants that it finds in imported modules."""
    if PROFILE == "same":
        pytest.MonkeyPatch().setattr(providers, "_get_local_constants", Constants)


UNREAD.install()


@pytest.fixture(autouse=True)
def _no_unexpected_diagnostics(request: pytest.FixtureRequest) -> Iterator[None]:
    """A test fails when a warning or an error stays unread, unless it has the mark ``unread("HX101")`` for that code, or for all.

    Real robots are as they are: the corpus run counts their diagnostics.
    """
    UNREAD.take()
    yield
    found = UNREAD.take()
    marks = list(request.node.iter_markers("unread"))
    allowed = {code for mark in marks for code in mark.args}
    if all(mark.args for mark in marks) and request.node.get_closest_marker("corpus") is None:
        assert [str(item) for item in found if item.code.id not in allowed] == []


@pytest.fixture(scope="session")
def corpus_root() -> Path:
    """The corpus cache of the user who runs the tests."""
    return cache.cache_root(os.environ)


@pytest.fixture(scope="session")
def real_robot(corpus_root: Path) -> RealRobots:
    """Call it with a development file to get its path; the package is downloaded on first use, whichever worker is first."""
    return RealRobots(corpus_root)


class RealRobots:
    """Development files by their path on this machine. Without a network the test is skipped; any other failure fails it."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._unavailable: str | None = None

    def __call__(self, file: catalog.DevelopmentFile) -> Path:
        return self.package(file.package) / file.path

    def package(self, package: catalog.WheelPackage) -> Path:
        """The folder of a package of the catalogue."""
        if self._unavailable and not cache.is_fetched(package, self._root):
            pytest.skip(self._unavailable)
        try:
            return cache.fetch(package, self._root)
        except Refusal as refusal:
            if refusal.diagnostic.code not in (codes.PACKAGE_UNAVAILABLE, codes.OFFLINE):
                raise
            self._unavailable = refusal.diagnostic.message
            pytest.skip(refusal.diagnostic.message)


LARGE = ("newton/ant_multi.usda",)
"""Robots that take as long as all others of their format together."""


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """`@pytest.mark.robots("urdf")` runs a test once for each development file of that format, as its argument ``robot`` (a path).

    With ``every=3`` each third file has its turn in `make test`, the others and those of LARGE are `full`.
    """
    mark = metafunc.definition.get_closest_marker("robots")
    if mark is None:
        return
    files = [file for format in mark.args for file in catalog.development_files(format)]
    every = mark.kwargs.get("every", 1)
    robots = []
    for number, file in enumerate(files):
        later = [pytest.mark.full] if number % every or file.id in LARGE else []
        robots.append(pytest.param(file, id=file.id, marks=[pytest.mark.corpus, *later]))
    metafunc.parametrize("robot", robots, indirect=True)


MOST = 40
"""So many cases of one test run with `make test-full`; those of tests with more are drawn."""


@pytest.hookimpl(tryfirst=True)  # marks decide which tests run
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Of a `full` test with many cases, such as every robot in every format, the same few run with `make test-full`.

    The others have the mark `hours`.
    """
    cases: dict[str, list[pytest.Item]] = defaultdict(list)
    for item in items:
        if item.get_closest_marker("full") is not None and item.get_closest_marker("hours") is None:
            cases[item.nodeid.partition("[")[0]].append(item)
    for name, found in cases.items():
        drawn = random.Random(name).sample(found, min(MOST, len(found)))
        for item in {*found} - {*drawn}:
            item.add_marker("hours")


@pytest.fixture
def robot(request: pytest.FixtureRequest, real_robot: RealRobots) -> Path:
    """The path of the development file that this run of the test is about."""
    return real_robot(request.param)
