"""The page docs/json.md: its document is sound, and its message is what the program prints."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x.cli import exits, main
from tests.json_form.test_json import SCHEMA

PAGE = (Path(__file__).parents[2] / "docs/json.md").read_text("utf-8")
DOCUMENT = re.findall(r"```json\n(.*?)```", PAGE, re.DOTALL)[0]


def test_the_document_is_a_robot() -> None:
    SCHEMA.validate(json.loads(DOCUMENT))
    robot = hx.loads(DOCUMENT.encode(), "json").mechanism
    (joint,) = robot.joints.values()
    assert (joint.parent.name, joint.child.name, joint.parent_pose.xyz) == ("base", "tip", (0.0, 0.0, 0.3))


def test_a_broken_document_is_refused_as_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    Path("arm.json").write_text(DOCUMENT.replace('"axis": [0.0, 0.0, 1.0]', '"axis": "z"'))
    assert main(["check", "arm.json"]) == exits.FAILED
    shown = PAGE.partition("    $ hymeko-x check arm.json\n")[2]
    assert [line.strip() for line in capsys.readouterr().err.splitlines()] == [line.strip() for line in shown.splitlines()]
