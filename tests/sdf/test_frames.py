"""Random frame graphs: where Drake puts every link at random configurations, so do we."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import Phase, given, settings

import hymeko_x as hx
from tests.sdf.graphs import models

pytest.importorskip("pydrake")


@given(models())
@settings(max_examples=25, deadline=None, phases=(Phase.generate,))
def test_random_frame_graphs_are_read_as_drake_reads_them(tmp_path_factory: pytest.TempPathFactory, model: str) -> None:
    text = f'<sdf version="1.10">{model}</sdf>'
    file: Path = tmp_path_factory.mktemp("graph") / "m.sdf"
    file.write_text(text, "utf-8")
    verdict = hx.verify(str(file), hx.load(str(file)).mechanism, samples=5)
    assert verdict.is_same, f"{[check for check in verdict.checks if not check.passed]} {verdict.reason}\n{text}"
