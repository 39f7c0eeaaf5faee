"""The committed results: the README and the report say what the tables say."""

from __future__ import annotations

from pathlib import Path

from hymeko_x.corpus import report
from hymeko_x.corpus.statistics import pair_rows
from hymeko_x.corpus.store import Store
from hymeko_x.corpus.tables import load

ROOT = Path(__file__).parents[2]
RESULTS = ROOT / "corpus/results"


def test_the_pairs_in_the_readme_are_those_of_the_results() -> None:
    text = (ROOT / "README.md").read_text("utf-8")
    assert report.with_pairs(text, load(Store(str(RESULTS)))) == text


def test_the_report_has_the_pairs_and_figures_of_the_results() -> None:
    text = (RESULTS / "report.md").read_text("utf-8")
    assert report.matrix(pair_rows(load(Store(str(RESULTS))))) in text
    named = [line.partition("](")[2].rstrip(")") for line in text.splitlines() if line.startswith("![")]
    assert named == ["pairs.svg", "lengths.svg", "ratios.svg", "sizes.svg"]
    assert [name for name in named if not (RESULTS / name).is_file()] == []


def test_results_hold_no_file_of_others() -> None:
    assert {path.suffix for path in RESULTS.iterdir()} == {".md", ".csv", ".parquet", ".png", ".svg"}
