"""`hymeko-x attach`: one robot on another on the command line."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x.cli import exits, main
from tests.robot.robots import ARM, URDF_HAND, arm, claw


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "arm.xml").write_text(ARM)
    (tmp_path / "claw.urdf").write_text(URDF_HAND)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("suffix", ["xml", "urdf", "usda", "hymeko"])
def test_a_hand_is_on_an_arm_in_any_format(folder: Path, suffix: str) -> None:
    assert main(["attach", "arm.xml", "claw.urdf", "--at", "flange", "--xyz", "0", "0", "0.1", "-o", f"both.{suffix}", "-q"]) == exits.DONE
    both = hx.load(folder / f"both.{suffix}")
    assert both.mass == pytest.approx(arm().mass + claw().mass, abs=1e-6)
    assert both.fk({"shoulder": 0.2})["claw/palm"].xyz == pytest.approx(
        arm().attach(claw(), at="flange", prefix="claw/", pose=(0, 0, 0.1)).fk({"shoulder": 0.2})["claw/palm"].xyz, abs=1e-6
    )


def test_a_frame_that_is_not_there_is_named_with_similar_ones(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["attach", "arm.xml", "claw.urdf", "--at", "flnge", "-o", "both.xml"]) == exits.USAGE
    assert "there is no body or frame 'flnge'; did you mean 'flange'?" in capsys.readouterr().err
    assert not (folder / "both.xml").exists()
