"""What USD's own code warns of is a diagnostic of the file, not a line of its own on the terminal."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx

_BOUND_WITHOUT_SCHEMA = """#usda 1.0
(
    defaultPrim = "robot"
    metersPerUnit = 1
    upAxis = "Z"
)
def Xform "robot"
{
    def Xform "body" (
        prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]
    )
    {
        float physics:mass = 1
        def Cube "shape"
        {
            rel material:binding = </robot/paint>
        }
    }
    def Material "paint"
    {
    }
}
"""


def test_a_warning_of_usd_is_a_diagnostic_at_the_file(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    stage = tmp_path / "robot.usda"
    stage.write_text(_BOUND_WITHOUT_SCHEMA)
    report = hx.Report()
    hx.load(stage, report=report)
    prim = "prim at path '/robot/body/shape' but MaterialBindingAPI is not applied on the prim"
    assert [str(item) for item in report] == [f"{stage}: warning[HX056]: USD: Found material bindings on {prim}"]
    assert capfd.readouterr().err == ""
