"""Nothing is lost silently: every change of a source shows in the output or in the ledger."""

from __future__ import annotations

from pathlib import Path

import pytest

from hymeko_x import formats, pipeline
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.corpus.catalog import development_files
from hymeko_x.diagnostics import Report
from hymeko_x.ir.legalize import Options
from hymeko_x.source import NoFiles, Package, Source
from tests.residue import silence
from tests.residue.samples import MJCF, URDF


@pytest.mark.parametrize("target", ["mjcf", "urdf", "hymeko", "xacro"])
@pytest.mark.parametrize(("text", "own"), [(URDF, "urdf"), (MJCF, "mjcf")])
def test_every_change_is_seen(text: str, own: str, target: str) -> None:
    assert silence.silent_changes(text.encode(), own, target, most=60) == []


REAL = [
    (file, target)
    for format in ("urdf", "mjcf")
    for file in development_files(format)[:: {"urdf": 2, "mjcf": 3}[format]]
    for target in ("mjcf", "urdf", "hymeko")
    if target != format
]


@pytest.mark.full
@pytest.mark.corpus
@pytest.mark.parametrize(("robot", "target"), REAL, ids=lambda value: str(getattr(value, "id", value)), indirect=["robot"])
def test_every_change_of_a_real_robot_is_seen(robot: Path, target: str) -> None:
    data = robot.read_bytes()
    own = formats.of_input(robot.name, data).name
    assert silence.silent_changes(data, own, target, DiskFiles(robot.parent), most=20) == []


def test_without_a_ledger_silence_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """A writer that always says the same is only found out by what is measured."""
    robot = pipeline.read(Source("robot", URDF.encode(), NoFiles()), formats.URDF, Report())
    frozen = pipeline.write(robot, formats.URDF, Options(pure=True), NoFiles(), Report())
    monkeypatch.setattr(pipeline, "writer", lambda _: lambda mechanism, report: Package(frozen.main))
    assert len(silence.silent_changes(URDF.encode(), "urdf", "urdf", most=20)) < 3
    monkeypatch.setattr(pipeline, "ledger", lambda *_: ())
    assert len(silence.silent_changes(URDF.encode(), "urdf", "urdf", most=20)) > 10
