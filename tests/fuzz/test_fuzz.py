"""Damaged texts are a mechanism or a diagnostic. Here a few thousand of them, the same ones each time; `make fuzz` runs more."""

from __future__ import annotations

import os
import random
from pathlib import Path

import pytest

from hymeko_x import formats
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.pipeline import read
from hymeko_x.source import Source
from hymeko_x.testing.mutations import MOST_BYTES, MUTATORS, mutated
from tests.fuzz.cases import data_of, run, warm_up
from tests.fuzz.run import Task, fuzz
from tests.fuzz.seeds import FORMATS, seeds, small_seeds

ROOT = Path(__file__).parents[2]
FOUND = sorted((Path(__file__).parent / "found").iterdir())
REFUSED = {
    "endless_place_of_an_extra.hymeko": "HX062",
    "joint_that_is_no_edge.hymeko": "HX045",
    "place_of_an_extra_that_is_no_number.hymeko": "HX062",
    "angle_that_is_no_number.hymeko": "HX062",
    "axis_of_no_direction.hymeko": "HX062",
    "copies_of_copies.mjcf": "HX007",
    "endless_angle.hymeko": "HX062",
    "euler_of_no_axes.mjcf": "HX020",
    "notation_with_endless_angle.hymeko": "HX062",
}
CASES = {"hymeko": 400, "urdf": 800, "mjcf": 400, "usd": 100, "sdf": 400, "xacro": 4, "xml": 200}


@pytest.mark.parametrize("path", FOUND, ids=lambda path: path.name)
@pytest.mark.unread  # generated or damaged input: any
def test_what_was_found_once_stays_found(path: Path) -> None:
    assert run(path.suffix[1:], path.read_bytes()) is None
    assert _refused(path.suffix[1:], path.read_bytes()) == REFUSED.get(path.name)


def _refused(format: str, data: bytes) -> str | None:
    """The code with which a text is refused, or None."""
    try:
        read(Source(f"a.{format}", data), formats.by_name(format), Report(), lenient=True)
    except Refusal as refusal:
        return refusal.diagnostic.code.id
    return None


@pytest.mark.parametrize("format", FORMATS)
@pytest.mark.unread  # generated or damaged input: any
def test_damaged_texts_are_a_mechanism_or_a_diagnostic(format: str) -> None:
    warm_up(format)
    findings = {number: run(format, data_of(format, number)) for number in range(CASES[format])}
    assert {number: finding for number, finding in findings.items() if finding} == {}


@pytest.mark.parametrize("format", ["hymeko", "urdf", "mjcf", "usd", "sdf", "xacro"])
@pytest.mark.unread  # generated or damaged input: any
def test_seeds_are_read_without_damage(format: str) -> None:
    assert {text: code for text in (*small_seeds(format), *seeds(format)) if (code := _refused(format, text))} == {}


@pytest.mark.parametrize("format", ["hymeko", "urdf", "mjcf", "usd"])
def test_a_number_is_always_the_same_text_and_another_one_is_another(format: str) -> None:
    assert data_of(format, 7) == data_of(format, 7)
    assert len({data_of(format, number) for number in range(100)}) > 70


@pytest.mark.parametrize("mutator", MUTATORS, ids=lambda mutator: mutator.__name__)
@pytest.mark.parametrize("data", [b"", b"<", b'<a b="1"/>', b"a { b 1 }"])
def test_mutators_take_anything(mutator, data: bytes) -> None:  # type: ignore[no-untyped-def]
    for number in range(50):
        assert isinstance(mutator(data, random.Random(number), (data, b'<c d="2"><e/></c>')), bytes)


def test_a_case_never_grows_without_bound() -> None:
    data = b"x" * (MOST_BYTES + 1)
    assert all(len(mutated(data, random.Random(number), (data,))) <= MOST_BYTES for number in range(20))


@pytest.mark.parametrize(
    ("damage", "kind"),
    [
        ("import os; os.kill(os.getpid(), 9)", "death -9"),
        ("while True: pass", "slow"),
        ("raise KeyError(1)", "KeyError"),
        ("x = bytearray(10**10)", "MemoryError"),
    ],
)
def test_the_runner_notices_whatever_goes_wrong(damage: str, kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A reader with a mistake planted in it, in the child as it is really run."""
    (tmp_path / "sitecustomize.py").write_text(
        "import hymeko_x.pipeline as pipeline\n"
        "right = pipeline.read\n"
        "def read(source, format, report, **options):\n"
        "    if source.data == DATA:\n"
        f"        {damage}\n"
        "    return right(source, format, report, **options)\n"
        "pipeline.read = read\n".replace("DATA", repr(data_of("urdf", 3)))
    )
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}{os.pathsep}{ROOT}")
    monkeypatch.setattr("tests.fuzz.run.FOUND", tmp_path / "found")
    tally = fuzz(Task("urdf", "", 1, 5, 60.0))
    assert tally.cases == 5
    assert list(tally.kinds.values()) == [3]
    assert next(iter(tally.kinds)).startswith(kind)
