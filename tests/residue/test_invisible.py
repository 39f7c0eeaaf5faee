"""Nobody else sees a residue: other readers make the same of a file with one as of a file without, and say no more about it."""

from __future__ import annotations

import logging
import warnings
from pathlib import Path

import mujoco
import pytest

import hymeko_x as hx
from hymeko_x.corpus.catalog import development_files
from tests.mjcf.mjmodels import differences
from tests.residue.readers import ASSERTS
from tests.residue.samples import MJCF, PLAIN_MJCF, URDF
from tests.residue.test_real_robots import SUFFIXES

SAMPLES = [(MJCF, "mjcf", "urdf"), (URDF, "urdf", "mjcf"), (MJCF, "mjcf", "xacro"), (MJCF, "mjcf", "usd"), (PLAIN_MJCF, "mjcf", "usd")]
EVERY = 4
"""One of so many real robots is looked at in the full run."""


@pytest.mark.parametrize(("text", "own", "target"), SAMPLES)
@pytest.mark.unread("HX204")
def test_other_readers_see_the_same(
    text: str, own: str, target: str, tmp_path: Path, capfd: pytest.CaptureFixture[str], caplog: pytest.LogCaptureFixture
) -> None:
    robot = hx.loads(text, own).mechanism
    carrying, pure = (tmp_path / name / f"robot{SUFFIXES[target]}" for name in ("carrying", "pure"))
    for path in (carrying, pure):
        path.parent.mkdir()
        path.write_text(hx.dumps(robot, target, keep=None if path is pure else "inside"))
    assert "residue" in carrying.read_text()
    assert "residue" not in pure.read_text()
    with warnings.catch_warnings(), caplog.at_level(logging.WARNING):
        warnings.simplefilter("error")
        ASSERTS[target](carrying, pure)
    printed = capfd.readouterr()
    assert "hymeko" not in printed.out + printed.err + caplog.text


def test_the_only_trace_in_a_model_is_one_text() -> None:
    spec = mujoco.MjSpec.from_string(hx.dumps(hx.loads(URDF, "urdf"), "mjcf", keep="inside"))
    assert [text.name for text in spec.texts] == ["hymeko-x residue"]
    assert spec.compile().ntext == 1


def test_mujoco_sees_the_same_urdf() -> None:
    robot = hx.loads(PLAIN_MJCF, "mjcf").mechanism
    carrying, pure = (mujoco.MjModel.from_xml_string(hx.dumps(robot, "urdf", keep=keep)) for keep in ("inside", None))
    assert differences(pure, carrying) == []


REAL = [
    (file, target)
    for format in SUFFIXES
    for file in development_files(format)[::EVERY]
    for target in SUFFIXES
    if target != format and file.format == format
]


@pytest.mark.full
@pytest.mark.corpus
@pytest.mark.parametrize(("robot", "target"), REAL, ids=lambda value: str(getattr(value, "id", value)), indirect=["robot"])
def test_other_readers_see_the_same_real_robot(robot: Path, target: str, tmp_path: Path) -> None:
    carrying, pure = (tmp_path / name / f"robot{SUFFIXES[target]}" for name in ("carrying", "pure"))
    for path in (carrying, pure):
        path.parent.mkdir()
        hx.convert(robot, path, to_format=target, keep=None if path is pure else "inside")
    ASSERTS[target](carrying, pure)
