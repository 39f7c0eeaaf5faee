"""The listings of the tutorial do what it shows."""

from __future__ import annotations

from pathlib import Path

import pytest

from examples.listings import LISTING, run

PAGE = Path(__file__).parents[2] / "docs/robot.md"


def test_every_listing_prints_what_the_page_shows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    shown = [content for language, name, content in LISTING.findall(PAGE.read_text("utf-8")) if language == "text" and not name]
    assert run(PAGE) == shown
    assert len(shown) == 5
