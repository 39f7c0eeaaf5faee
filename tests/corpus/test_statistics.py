"""How the statistics of a run say their numbers."""

from __future__ import annotations

import pytest

from hymeko_x.corpus.statistics import percentage


@pytest.mark.parametrize(
    ("part", "whole", "percent"),
    [(231, 231, "100 %"), (230, 231, "99.5 %"), (99_999, 100_000, "99.9 %"), (0, 3, "0.0 %"), (0, 0, "none")],
)
def test_only_all_is_100_percent(part: int, whole: int, percent: str) -> None:
    assert percentage(part, whole) == percent
