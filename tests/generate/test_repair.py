"""Repairs that need no model: each removes one error, and random texts that are refused can be read after them."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x import formats
from hymeko_x.diagnostics import Refusal
from hymeko_x.generate.loop import Task, generate, judged
from hymeko_x.generate.repair import Repair, repair
from tests.grammars.masks import walk

SCARA = Path(__file__).parents[2] / "corpus/listings/scara_robot.hymeko"
RIGHT = """arm : robot {
  base { mass 2 }
  link { mass 1 }
  @elbow : revolute { [0 0 1] + base - link axis=Y }
}
"""
MENDED = [
    ("revolute {", "revolut {", "it is now 'revolute'", RIGHT),
    ("+ base", "+ bsae", "it is now 'base'", RIGHT),
    ("}\n}\n", "}\n", "its brackets are in pairs", RIGHT),
    ("axis=Y }\n}\n", "axis=Y", "its brackets are in pairs", f"{RIGHT[:-5]}\n}}}}\n"),
    ("mass 2 }", "mass 2 }}", "its brackets are in pairs", None),
    ("  link {", "  base {", "the second is now 'base_2'", None),
    ("- link", "- hand", "'hand' is now defined, without fields", RIGHT.replace("  @", "  hand {}\n@").replace("- link", "- hand")),
    ("link {", "link : xyzzyq {", "the element has no type now", None),
    ("mass 1 ", "mass=red ", "field 'mass' is removed", RIGHT.replace(" mass 1", " ")),
    ("mass 1 ", "mass 1furlong ", "field 'mass' is removed", RIGHT.replace(" mass 1", " ")),
    ("mass 1 ", "mass ${one +} ", "field 'mass' is removed", RIGHT.replace(" mass 1", " ")),
]


@pytest.mark.parametrize(("part", "broken", "done", "expected"), MENDED, ids=[broken for _, broken, _, _ in MENDED])
def test_one_error_is_mended_by_the_smallest_change(part: str, broken: str, done: str, expected: str | None) -> None:
    assert part in RIGHT
    found = repair(RIGHT.replace(part, broken, 1))
    assert found.left is None
    assert found.changes[0].endswith(f"; {done}")
    if expected is not None:
        assert (found.text, len(found.changes)) == (expected, 1)


def test_a_text_that_can_be_read_is_not_changed() -> None:
    assert repair(RIGHT) == Repair(RIGHT)


@pytest.mark.unread("HX061")
def test_a_text_that_breaks_off_keeps_what_was_whole() -> None:
    text = SCARA.read_text("utf-8")
    for length in range(100, len(text), 97):
        found = repair(text[:length])
        assert found.left is None, (length, found)
        assert len(found.text) > length - 100


def test_several_errors_are_mended_one_after_the_other() -> None:
    text = RIGHT.replace("revolute", "revolut").replace("+ base", "+ bsae").replace("mass 1 ", "mass=red ")
    found = repair(text)
    assert (found.text, found.left) == (RIGHT.replace(" mass 1", " "), None)
    assert len(found.changes) == 3


def test_a_text_of_another_language_is_left_alone() -> None:
    found = repair("I cannot do that.")
    assert (found.text, found.changes) == ("I cannot do that.", ())
    assert found.left is not None


@pytest.mark.unread("HX314", "HX317")
def test_the_loop_mends_an_answer_before_it_asks_again() -> None:
    task = Task(SCARA.read_text("utf-8"), SCARA, hx.load(SCARA).mechanism, formats.OWN)
    broken = task.text.replace("+ base_link", "+ base_lnk")
    (step,) = generate(task, lambda messages: broken, 5)
    assert step.is_same
    assert step.text == task.text
    assert [change.rpartition("; ")[2] for change in step.repairs] == ["it is now 'base_link'"]
    other = judged(task, broken.replace("mass = 2.0", "mass = two"), 1)
    assert not other.is_same
    assert len(other.repairs) == 2


def refused(seeds: range) -> Counter[str]:
    """The random texts of the grammar that are refused for their meaning: by code, and how many of them repairs make readable."""
    found: Counter[str] = Counter()
    for seed in seeds:
        text = walk("llguidance", seed)
        try:
            hx.loads(text or "", "hymeko")
        except Refusal as refusal:
            found[refusal.diagnostic.code.id] += 1
            found["mended"] += repair(text or "").left is None
    return found


@pytest.mark.unread
def test_nine_of_ten_refused_walks_are_mended() -> None:
    found = refused(range(40))
    assert found.total() - found["mended"] > 5
    assert found["mended"] >= 0.9 * (found.total() - found["mended"])


@pytest.mark.full
@pytest.mark.unread
def test_nine_of_ten_of_many_refused_walks_are_mended() -> None:
    found = refused(range(1200))
    assert found.total() - found["mended"] >= 300
    assert found["mended"] >= 0.9 * (found.total() - found["mended"])
