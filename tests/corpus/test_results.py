"""The committed results: the README, the pages and the report say what the tables say."""

from __future__ import annotations

from pathlib import Path

import pytest

from hymeko_x.corpus import pages, report
from hymeko_x.corpus.statistics import pair_rows
from hymeko_x.corpus.store import Store, load, load_pace

ROOT = Path(__file__).parents[2]
RESULTS = ROOT / "corpus/results"
PAGES = {
    "README.md": ["pairs"],
    "docs/results.md": ["summary", "claims", "shorter", "failures"],
    "docs/losses.md": ["losses"],
    "docs/scale.md": ["costs", "pace", "million"],
}


@pytest.mark.parametrize("page", PAGES)
def test_the_numbers_in_a_page_are_those_of_the_results(page: str) -> None:
    text = (ROOT / page).read_text("utf-8")
    store = Store(str(RESULTS))
    assert pages.renewed(text, load(store), load_pace(store)) == text
    assert [
        line.split()[1].rstrip(":") for line in text.splitlines() if line.startswith("<!-- ") and "by `hymeko-x corpus" in line
    ] == PAGES[page]


def test_a_page_without_a_known_block_is_not_renewed() -> None:
    tables = load(Store(str(RESULTS)))
    with pytest.raises(ValueError, match="the page has no block"):
        pages.renewed("text", tables)
    with pytest.raises(ValueError, match="there is no block 'nonsense'"):
        pages.renewed("<!-- nonsense: written by `hymeko-x corpus stats` -->\n<!-- end of nonsense -->", tables)


def test_the_readme_shows_a_figure_of_the_results() -> None:
    text = (ROOT / "README.md").read_text("utf-8")
    shown = [line.partition("](")[2].rstrip(")") for line in text.splitlines() if line.startswith("![") and "corpus/results/" in line]
    assert shown == ["corpus/results/sizes.svg"]


def test_figures_and_tables_are_drawn_from_the_tables_beside_them() -> None:
    made = dict(report.files_of(load(Store(str(RESULTS)))))
    exact = [name for name in made if name.endswith((".csv", ".md"))]
    assert len(exact) > 10
    assert [name for name in exact if (RESULTS / name).read_bytes() != made[name]] == []
    assert [name for name in made if not (RESULTS / name).is_file()] == []


def test_the_report_has_the_pairs_and_figures_of_the_results() -> None:
    text = (RESULTS / "report.md").read_text("utf-8")
    assert report.matrix(pair_rows(load(Store(str(RESULTS))))) in text
    named = [line.partition("](")[2].rstrip(")") for line in text.splitlines() if line.startswith("![")]
    assert named == ["pairs.svg", "lengths.svg", "ratios.svg", "sizes.svg"]


def test_results_hold_no_file_of_others() -> None:
    assert {path.suffix for path in RESULTS.iterdir()} == {".md", ".csv", ".parquet", ".png", ".svg"}
