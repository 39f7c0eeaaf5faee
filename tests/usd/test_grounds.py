"""A plane on a body that stands: UsdPhysics allows it on kinematic bodies alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from pxr import Usd, UsdValidation

import hymeko_x as hx

if TYPE_CHECKING:
    from pathlib import Path

WORLD = """<sdf version="1.9"><world name="w"><light name="sun" type="directional"/><model name="ground"><static>{}</static>
<link name="link">
<collision name="c"><geometry><plane><size>10 10</size></plane></geometry></collision></link></model>
<model name="box"><pose>0 0 1 0 0 0</pose><link name="l"/></model></world></sdf>"""


def problems(path: Path) -> list[str]:
    """The names of what the validators of USD find."""
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    stage = Usd.Stage.Open(str(path))
    return [error.GetName() for error in UsdValidation.ValidationContext(validators).Validate(stage)]


@pytest.mark.unread("HX104")
@pytest.mark.parametrize(("stands", "expected"), [("true", []), ("false", ["ColliderPlaneDynamic"])])
def test_the_validators_accept_a_world_with_a_floor(tmp_path: Path, stands: str, expected: list[str]) -> None:
    (tmp_path / "w.sdf").write_text(WORLD.format(stands), "utf-8")
    found = hx.convert(tmp_path / "w.sdf", tmp_path / "w.usda").report.diagnostics
    assert [str(diagnostic.element) for diagnostic in found if diagnostic.code.id == "HX104"] == ["shape 'ground::link/collision'"] * len(
        expected
    )
    assert problems(tmp_path / "w.usda") == expected
    assert hx.verify(hx.load(tmp_path / "w.sdf").mechanism, tmp_path / "w.usda", samples=2).is_same
