"""The examples of the language reference and of the page on the representation."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x.diagnostics import Report
from hymeko_x.formats.hymeko import (
    ALIASES,
    AXES,
    CALIBRATION_WORDS,
    DOF_WORDS,
    LIMIT_WORDS,
    MOVES,
    PARTS,
    ROLE_MOVES,
    SAFETY_WORDS,
    SHAPE_WORDS,
)
from hymeko_x.formats.hymeko.units import BASE_UNITS
from hymeko_x.frontends.hymeko import read
from hymeko_x.ir.ids import KINDS
from hymeko_x.language.expansion import MAX_ITEMS
from hymeko_x.language.expressions import CONSTANTS, FUNCTIONS
from hymeko_x.language.machine import MAX_DEPTH
from hymeko_x.language.templates import standard_templates
from hymeko_x.source import Source

ROOT = Path(__file__).parents[2]
LANGUAGE = (ROOT / "docs" / "language.md").read_text(encoding="utf-8")
IR = (ROOT / "docs" / "ir.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```hymeko\n(.*?)```", LANGUAGE, re.DOTALL)


@pytest.mark.parametrize("text", EXAMPLES, ids=lambda text: re.search(r"\w+(?= .*\{)", text)[0])  # type: ignore[index]
@pytest.mark.unread("HX201")
def test_an_example_is_read_in_silence_and_round_trips(text: str) -> None:
    report = Report()
    robot = read(Source("example.hymeko", text.encode()), report).mechanism
    assert [str(diagnostic) for diagnostic in report] == []
    assert robot.graph.edges
    again = hx.dumps(robot, "hymeko")
    assert hx.loads(again, "hymeko").mechanism == robot


def test_the_reference_has_examples() -> None:
    assert len(EXAMPLES) >= 8


def test_every_word_of_the_vocabulary_is_in_the_reference() -> None:
    words = {name for name in standard_templates() if name not in ("body", "link")}
    words |= {word.word for part in PARTS.values() for word in part.words} | {word for words in ALIASES.values() for word in words}
    for table in (LIMIT_WORDS, DOF_WORDS, SAFETY_WORDS, CALIBRATION_WORDS, SHAPE_WORDS):
        words |= {word.word for word in table}
    words |= {*AXES, *ROLE_MOVES, *CONSTANTS, *FUNCTIONS} | {move for move in MOVES if move not in ("none", "free")}
    words |= {unit for units in BASE_UNITS.values() for unit in units} | set(BASE_UNITS)
    code = re.findall(r"```hymeko\n.*?```|(?<!`)`[^`\n]+`", LANGUAGE, re.DOTALL)
    used = set(re.findall(r"[\w°µ%]+", " ".join(code)))
    assert words - used == set()


def test_the_reference_names_the_bounds_that_hold() -> None:
    assert f"nested deeper than {MAX_DEPTH} brackets" in LANGUAGE
    assert f"make more of it than {MAX_ITEMS} items" in LANGUAGE


def test_every_part_is_on_the_page_of_the_representation() -> None:
    assert {part.__name__ for part in KINDS} - set(re.findall(r"`(\w+)`", IR)) == set()


def test_the_python_example_runs(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", IR, re.DOTALL)
    monkeypatch.chdir(ROOT)
    exec(compile(code, "docs/ir.md", "exec"), {})
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "joint_1 base shoulder ['hinge']"
    assert len(lines) == 7
