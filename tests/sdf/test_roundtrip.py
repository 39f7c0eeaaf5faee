"""SDF that is read and written again has what it had, element by element and number by number."""

from __future__ import annotations

import pytest

from hymeko_x import formats, pipeline
from hymeko_x.diagnostics import Report
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Source
from tests.sdf.canonical import canonical
from tests.sdf.samples import SAMPLES


def again(text: str) -> bytes:
    """The file as it is written after reading."""
    mechanism = pipeline.read(Source("a.sdf", text.encode()), formats.SDF, Report())
    return pipeline.write(mechanism, formats.SDF, Options(), NoFiles(), Report()).main


@pytest.mark.parametrize("name", SAMPLES)
@pytest.mark.unread("HX045", "HX201")
def test_an_sdf_file_is_written_as_it_was(name: str) -> None:
    text = SAMPLES[name]
    assert canonical(again(text)) == canonical(text.encode())


@pytest.mark.parametrize("name", SAMPLES)
@pytest.mark.unread("HX045", "HX201")
def test_writing_is_a_fixed_point(name: str) -> None:
    once = again(SAMPLES[name])
    assert again(once.decode()) == once
