"""Nothing is lost silently: every change of a source shows in the output or in the ledger."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest

from hymeko_x import formats, pipeline
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.diagnostics import Report
from hymeko_x.memory import remembering
from hymeko_x.residue import measuring
from hymeko_x.rewrite import Options
from hymeko_x.source import Files, NoFiles, Package, Source
from tests.residue import silence
from tests.residue.samples import MJCF, URDF

NATIVE = tuple(target for target in silence.TARGETS if target != "hymeko")


def silent(data: bytes, own: str, targets: Sequence[str], files: Files | None = None, *, most: int | None = None) -> list[str]:
    """The changes that some format lets pass."""
    found = silence.silent_changes(data, own, targets, files, most=most)
    return [f"{what} ({', '.join(among)})" for what, among in found if among]


@pytest.mark.parametrize(("text", "own"), [(URDF, "urdf"), (MJCF, "mjcf")])
def test_every_change_is_seen(text: str, own: str) -> None:
    assert silent(text.encode(), own, silence.TARGETS, most=25) == []


IN_FULL = 5_000
"""Real robots of up to so many bytes, some sixty, are changed everywhere; of the others twenty changes are looked at."""
CONCEPTS = sorted(Path("corpus/robots").glob("*.hymeko"))


@pytest.mark.parametrize("robot", CONCEPTS, ids=lambda path: path.stem)
def test_every_change_of_a_concept_is_seen(robot: Path) -> None:
    assert silent(robot.read_bytes(), "hymeko", NATIVE, DiskFiles(robot.parent), most=4) == []


@pytest.mark.full
@pytest.mark.parametrize("robot", CONCEPTS, ids=lambda path: path.stem)
def test_each_change_of_a_concept_is_seen(robot: Path) -> None:
    assert silent(robot.read_bytes(), "hymeko", NATIVE, DiskFiles(robot.parent)) == []


@pytest.mark.full
@pytest.mark.robots("urdf", "mjcf", "usd")
@remembering()
def test_every_change_of_a_real_robot_is_seen(robot: Path) -> None:
    data = robot.read_bytes()
    own = formats.of_input(robot.name, data).name
    targets = [target for target in silence.TARGETS if target != own]
    assert silent(data, own, targets, DiskFiles(robot.parent), most=None if len(data) <= IN_FULL else 20) == []


def test_without_a_ledger_silence_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """A writer that always says the same is only found out by what is measured."""
    robot = pipeline.read(Source("robot", URDF.encode(), NoFiles()), formats.URDF, Report())
    frozen = pipeline.write(robot, formats.URDF, Options(), NoFiles(), Report())
    monkeypatch.setattr(pipeline, "writer", lambda _: lambda mechanism, options, report: Package(frozen.main))
    assert len(silent(URDF.encode(), "urdf", ["urdf"], most=20)) < 3
    monkeypatch.setattr(measuring, "losses_between", lambda *_, **__: ())
    assert len(silent(URDF.encode(), "urdf", ["urdf"], most=20)) > 10
