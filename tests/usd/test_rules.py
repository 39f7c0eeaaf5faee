"""The rules of `usdchecker`, which are validators of usd-core: none of them has anything against what is written."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import pytest
from pxr import Usd, UsdValidation

import hymeko_x as hx
from hymeko_x.corpus.catalog import development_files

FEW = ("racecar.urdf", "quadruped.urdf", "arm.xml", "tendon.xml")
FILES = [file for format in ("urdf", "mjcf") for file in development_files(format)]
LAYOUTS = pytest.mark.parametrize("layout", ["single", "layered"])


def complaints(stage: Path) -> list[str]:
    """What the rules say of a stage, a line each, warnings too."""
    rules = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    assert len(rules) > 20
    found = UsdValidation.ValidationContext(rules).Validate(Usd.Stage.Open(str(stage)))
    return [f"{error.GetType()} {error.GetName()}: {error.GetMessage()}" for error in found]


def complaints_about(robot: Path, layout: Literal["single", "layered"], folder: Path) -> dict[str, list[str]]:
    """What the rules say of the stages that a robot becomes, text, crate and package."""
    found = {}
    for suffix in (".usda", ".usdc", ".usdz"):
        stage = folder / suffix[1:] / f"{robot.stem}{suffix}"
        stage.parent.mkdir()
        hx.convert(robot, stage, layout=layout)
        if said := complaints(stage):
            found[suffix] = said
    return found


def test_the_rules_find_what_is_wrong(tmp_path: Path) -> None:
    stage = tmp_path / "bare.usda"
    stage.write_text('#usda 1.0\n\ndef Xform "a" (\n    prepend apiSchemas = ["PhysicsArticulationRootAPI"]\n)\n{\n}\n', encoding="utf-8")
    assert any("Error" in line for line in complaints(stage))


@pytest.mark.corpus
@LAYOUTS
@pytest.mark.parametrize("robot", [file for file in FILES if Path(file.path).name in FEW], ids=lambda file: file.id, indirect=True)
def test_the_rules_have_nothing_against_a_real_robot(robot: Path, layout: Literal["single", "layered"], tmp_path: Path) -> None:
    assert complaints_about(robot, layout, tmp_path) == {}


@pytest.mark.full
@pytest.mark.corpus
@LAYOUTS
@pytest.mark.parametrize("robot", [file for file in FILES if Path(file.path).name not in FEW], ids=lambda file: file.id, indirect=True)
def test_the_rules_have_nothing_against_any_real_robot(robot: Path, layout: Literal["single", "layered"], tmp_path: Path) -> None:
    assert complaints_about(robot, layout, tmp_path) == {}
