"""What a run reads, how long texts are, and which pairs there are."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x import formats
from hymeko_x.corpus import catalog, engines
from hymeko_x.corpus.cases import from_folder, own_robots
from hymeko_x.corpus.lengths import lengths
from hymeko_x.corpus.plan import Plan, pairs_of
from hymeko_x.corpus.rows import Leg, Outcome, RobotRow
from hymeko_x.corpus.statistics import interval, signed_rank
from hymeko_x.corpus.store import Store
from hymeko_x.corpus.work import counted
from hymeko_x.diagnostics import Report
from tests.corpus.folder import MJCF, fill


def test_the_catalogue_lists_about_five_hundred_robots_each_once() -> None:
    listed = [(package.name, path) for package in catalog.load() for _, path in package.listed()]
    assert len(listed) == len(set(listed)) == 503
    assert {format for package in catalog.load() for format, _ in package.listed()} == {"urdf", "mjcf", "xacro", "usd", "sdf"}


def test_every_listed_robot_is_kept_and_every_argument_belongs_to_one() -> None:
    for package in catalog.load():
        paths = {path for _, path in package.listed()}
        assert [path for path in paths if not package.wants(path)] == []
        assert set(package.arguments) <= paths


def test_a_folder_gives_the_files_whose_format_is_known(tmp_path: Path) -> None:
    fill(tmp_path / "toys", robots=2)
    (tmp_path / "toys/notes.xml").write_text("<notes/>")
    (tmp_path / "toys/more").mkdir()
    (tmp_path / "toys/more/a.usda").write_text("#usda 1.0\n")
    assert [(case.key, case.format) for case in from_folder(str(tmp_path / "toys"))] == [
        ("toys/arm1.urdf", "urdf"),
        ("toys/arm2.urdf", "urdf"),
        ("toys/broken.urdf", "urdf"),
        ("toys/more/a.usda", "usd"),
        ("toys/one.hymeko", "hymeko"),
        ("toys/pendulum.xml", "mjcf"),
    ]


def test_a_url_gives_a_package_for_each_of_its_folders_and_is_fetched_once(tmp_path: Path) -> None:
    import fsspec

    memory = fsspec.filesystem("memory")
    for path in fill(tmp_path / "toys", robots=1).iterdir():
        memory.pipe_file(f"/farm/toys/{path.name}", path.read_bytes())
    cases = from_folder("memory://farm")
    assert [case.key for case in cases] == ["toys/arm1.urdf", "toys/broken.urdf", "toys/one.hymeko", "toys/pendulum.xml"]
    assert {case.folder for case in cases} == {"memory://farm/toys"}
    first = engines.fetched(cases[0].folder, tmp_path / "cache")
    assert (Path(first) / "arm1.urdf").read_bytes() == (tmp_path / "toys/arm1.urdf").read_bytes()
    memory.rm("/farm", recursive=True)
    assert engines.fetched(cases[0].folder, tmp_path / "cache") == first


def test_results_may_be_kept_behind_a_url() -> None:
    store = Store("memory://results-of-a-test")
    store.open(Plan((("urdf", "mjcf"),)).as_json(), resume=False)
    outcome = Outcome(RobotRow("p/a", "p", "urdf", diagnostics={"HX001": 2}), (Leg("p/a", "urdf", "mjcf", lost={"body": 1}),), ())
    store.add(outcome)
    assert list(store.outcomes()) == [outcome]


def test_our_own_robots_take_part() -> None:
    assert "hymeko_x/robots/humanoid.hymeko" in [case.key for case in own_robots()]


def test_all_pairs_are_those_of_the_table_of_formats() -> None:
    pairs = pairs_of("all")
    assert {source for source, _ in pairs} == {"hymeko", "urdf", "xacro", "mjcf", "usd", "sdf"}
    assert {target for _, target in pairs} == {format.name for format in formats.FORMATS if format.backend} - {"json", "usdc", "usdz"}
    assert pairs_of("urdf:usdz,mjcf:urdf,urdf:usdz") == (("urdf", "usdz"), ("mjcf", "urdf"))


@pytest.mark.parametrize(
    ("format", "text", "tokens"),
    [
        ("urdf", "<a b='1 2'>x<!-- no --></a>", ["<", "a", "b", "=", "'1 2'", ">", "x", "</", "a", ">"]),
        ("hymeko", 'r : robot { // no\n a { "x y" [1 2] } }', ["r", ":", "robot", "{", "a", "{", '"x y"', "[1 2]", "}", "}"]),
        (
            "usd",
            '#usda 1.0\ndef X "n" { # no\n a:b = (1, -2) }',
            ["#usda 1.0", "def", "X", '"n"', "{", "a:b", "=", "(", "1", ",", "-2", ")", "}"],
        ),
    ],
)
def test_tokens_are_those_of_the_formats_own_lexer(format: str, text: str, tokens: list[str]) -> None:
    assert formats.loaded(formats.by_name(format).tokens)(text) == tokens
    found = lengths(text.encode(), format)
    assert (found.tokens, found.code) == (len(tokens), sum(len("".join(token.split())) for token in tokens))
    assert found.characters == len("".join(text.split()))


def test_binary_files_and_large_texts_have_bytes_only() -> None:
    assert lengths(b"PXR-USDC" + bytes(9), "usd") == lengths(b"PXR-USDC" + bytes(9), "usdc")
    assert (lengths(b"PXR-USDC", "usd").tokens, lengths(b" " * 2**21, "urdf").characters) == (None, None)


def test_the_signed_rank_test_is_that_of_the_textbook() -> None:
    import numpy as np

    p, effect = signed_rank(np.array([1.0, 2.0, 3.0, -4.0, 5.0, 0.0]))
    assert effect == pytest.approx((1 + 2 + 3 + 5 - 4) / 15)
    assert 0.05 < p < 0.5
    assert signed_rank(np.array([0.0, 0.0])) == (1.0, 0.0)
    low, high = interval(np.arange(101.0))
    assert low < 50.0 < high
    assert (low, high) == interval(np.arange(101.0))


def test_a_file_is_counted_in_bodies_joints_dofs_and_shapes() -> None:
    mechanism = hx.loads(MJCF, "mjcf").mechanism
    robot = counted(RobotRow("k", "p", "mjcf"), mechanism, Report())
    assert (robot.bodies, robot.joints, robot.dofs, robot.shapes) == (1, 1, 1, 1)
