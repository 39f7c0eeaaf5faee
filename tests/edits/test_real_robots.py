"""Edits of real robots come home: to the robot with the edit, and to few lines of its author's text."""

from __future__ import annotations

import itertools
import random
from pathlib import Path

import pytest

from hymeko_x import disk, formats, pipeline
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.edits.updating import update
from hymeko_x.rewrite import Options
from hymeko_x.source import PackageFiles, Source
from tests.edits.test_copying import SUFFIXES
from tests.residue import edits
from tests.residue.edits import Edit, applied, applied_to_stage

KINDS = {"urdf": edits._URDF, "mjcf": edits._MJCF, "usd": edits._USD}
VALUES = ("mass", "weigh", "limit", "range", "place")
"""Edits of one value, which change one line."""


def one_edit(kind: str, target: str, value: float, place: int) -> Edit:
    return lambda root: KINDS[target][kind](root, value, place)


@pytest.mark.full
@pytest.mark.robots("urdf", every=2)
@pytest.mark.parametrize("target", ["mjcf"])
def test_edits_come_home(robot: Path, target: str) -> None:
    """Twenty of them, one after the other; those that a reader of the target refuses are none."""
    source = disk.open_source(str(robot))
    format, there = formats.of_input(source.name, source.data), formats.by_name(target)
    if format is there:
        pytest.skip("the same format")
    mechanism = pipeline.read(source, format, Report())
    place = pipeline.Place(str(robot.parent), "reference")
    package = pipeline.write(mechanism, there, Options(), source.files, Report(), place)
    name = str(robot.with_name(f"there{SUFFIXES[target]}"))
    chance = random.Random(robot.name)
    few: list[int] = []
    for kind in itertools.islice(itertools.cycle(sorted(KINDS[target])), 20):
        edit = one_edit(kind, target, round(chance.uniform(0.001, 2.0), 4), chance.randrange(1000))
        text, (what,) = (applied_to_stage if target == "usd" else applied)(package.main.decode(), [edit])
        if what == "nothing":
            continue
        report = Report()
        try:
            edited = Source(name, text.encode(), PackageFiles(package, source.files))
            found = update(source, format, edited, there, Options(), report)
        except Refusal:
            continue
        assert found.edits, what
        lines = [line for line in found.diff.splitlines() if line[:1] in "+-" and line[:3] not in ("+++", "---")]
        assert lines, what
        if kind in VALUES and not any(diagnostic.code.id == "HX108" for diagnostic in report):
            few.append(sum(line[:1] == "+" for line in lines))
    assert sorted(few)[len(few) // 2 :][:1] in ([], [1])
