"""Broken texts and the whole message that each of them gets: tests/language/broken/NAME.hymeko and NAME.txt."""

from __future__ import annotations

from pathlib import Path

import pytest

from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.frontends.hymeko import read
from hymeko_x.source import NoFiles, Source

BROKEN = sorted((Path(__file__).parent / "broken").glob("*.hymeko"))


@pytest.mark.parametrize("path", BROKEN, ids=lambda path: path.stem)
def test_a_broken_text_gets_this_message(path: Path) -> None:
    with pytest.raises(Refusal) as refusal:
        read(Source(path.name, path.read_bytes()), Report())
    assert f"{refusal.value}\n" == path.with_suffix(".txt").read_text(encoding="utf-8")


def test_every_message_belongs_to_a_text() -> None:
    texts = {path.stem for path in BROKEN}
    assert {path.stem for path in (Path(__file__).parent / "broken").glob("*.txt")} == texts
    assert len(texts) >= 30


OF_THE_NEWER_CONSTRUCTS = """
    body_in_data joint_in_data element_of_a_block_twice relation_to_nothing reference_in_data_to_nothing path_from_the_root_to_nothing
    template_of_data_without_parameter copy_of_itself prototype_of_itself
    value_that_is_not_there list_with_a_missing_value values_in_a_circle weight_by_reference_to_nothing arc_to_a_value change_of_nothing
    open_value_of_a_body open_weight_of_a_joint open_axis
    shared_ball shared_block_with_a_mass shared_ratio_of_the_first shared_ratio_of_zero shared_ratio_without_motion two_parents_of_two
    spring_of_another_motion spring_of_a_compound damper_of_another_motion
    constant_twice constant_unknown constant_with_a_unit constant_without_value constants_in_a_circle
    group_not_closed group_with_a_block group_without_comma using_without_name using_without_path short_import_missing
"""
"""Nested graphs, references, values left open, joints of several bodies, springs on edges, and the dialect of 2026."""


@pytest.mark.parametrize("name", OF_THE_NEWER_CONSTRUCTS.split())
def test_a_message_shows_the_line_the_place_and_what_to_do(name: str) -> None:
    message, line, caret, hint = (Path(__file__).parent / "broken" / f"{name}.txt").read_text(encoding="utf-8").splitlines()
    number = int(message.split(":")[1])
    source = (Path(__file__).parent / "broken" / f"{name}.hymeko").read_text(encoding="utf-8").split("\n")[number - 1]
    assert line == f"{number:5} | {source}"
    assert set(caret.removeprefix("      | ")) <= {" ", "^"}
    assert hint.startswith("  hint: ")


class Folder(NoFiles):
    """Files by name."""

    def __init__(self, files: dict[str, str]) -> None:
        self.files = files

    def find(self, uri: str) -> str | None:
        return uri if uri in self.files else None

    def read(self, path: str) -> bytes:
        return self.files[path].encode()


def refused(text: str | bytes, files: dict[str, str] | None = None) -> str:
    with pytest.raises(Refusal) as refusal:
        read(Source("a.hymeko", text.encode() if isinstance(text, str) else text, Folder(files or {})), Report())
    return str(refusal.value)


def test_imports_that_lead_back_are_found() -> None:
    files = {"b.hymeko": 'import "c.hymeko"', "c.hymeko": '\n  import "b.hymeko"'}
    assert refused('import "b.hymeko"\nr : robot {}', files) == (
        "c.hymeko:2:3: error[HX063]: the import of 'b.hymeko' leads back to itself"
    )


def test_a_file_that_is_imported_twice_is_read_once() -> None:
    files = {f"{number}.hymeko": f'import "{number + 1}.hymeko" import "{number + 1}.hymeko" as again' for number in range(60)}
    files["60.hymeko"] = "part() : link { mass 2 }"
    robot = read(
        Source("a.hymeko", b'import "0.hymeko" import "60.hymeko" as parts\nr : robot { a : parts.part {} }', Folder(files)), Report()
    ).mechanism
    assert [body.inertial.mass for body in robot.graph.vertices.values()] == [2.0]  # type: ignore[union-attr]


def test_a_syntax_error_in_an_imported_file_is_shown_there() -> None:
    assert refused('import "legs.hymeko"\nr : robot {}', {"legs.hymeko": "leg() {\n  hip {"}).split("\n") == [
        "legs.hymeko:2:8: error[HX060]: the text ends; expected a name, a value, a direction (+ - ~ -> <- <>), '}' or '@'",
        "    2 |   hip {",
        "      |        ^",
        "  hint: the '{' in line 2 is never closed",
    ]


def test_bytes_that_are_no_text_are_refused() -> None:
    assert refused(b"arm { \xff }") == "a.hymeko: error[HX060]: byte 6 is not UTF-8"


def test_a_long_line_is_cut_around_the_place() -> None:
    text = "arm : robot { base { com [" + "0 " * 200 + "; " + "0 " * 200 + "] } }"
    _, line, caret, _ = refused(text).split("\n")
    assert len(line) < 180
    assert line[caret.index("^")] == ";"


def test_the_words_that_are_left_over_are_kept_and_reported() -> None:
    report = Report()
    robot = read(Source("a.hymeko", b"arm : robot {\n  base { colour [1 0 0] }\n}"), report).mechanism
    assert [str(diagnostic) for diagnostic in report] == ["a.hymeko:2:10: warning[HX061]: body 'base' has no 'colour'; it is kept as it is"]
    assert [extra.text for extra in robot.extras[next(iter(robot.graph.vertices))]] == ["colour [1 0 0]"]


def test_the_position_of_what_turns_an_axis_means_nothing_and_that_is_reported() -> None:
    report = Report()
    read(Source("a.hymeko", b"r : robot { a {} b {} @j : prismatic { + a - b, [[0 0 0.2] [0 45 0]] axis -> X } }"), report)
    message = "only the rotation of the weight turns the axis; the position 0 0 0.2 means nothing"
    assert [str(diagnostic) for diagnostic in report] == [f"a.hymeko:1:49: warning[HX062]: {message}"]
