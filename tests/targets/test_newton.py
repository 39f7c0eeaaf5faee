"""`--for newton` and `--for isaac`: stages that say what they are, and whose drives have force limits."""

from __future__ import annotations

from pathlib import Path

import pytest
from pxr import Usd, UsdPhysics

import hymeko_x as hx
from tests.usd.rep158 import problems

ARM = """
<mujoco model="my arm">
  <compiler angle="radian"/>
  <worldbody>
    <light name="sun" pos="0 0 3"/><geom name="floor" type="plane" size="0 0 1"/>
    <body name="base">BASE<geom size="0.1"/>
      <body name="upper" pos="0 0 0.3"><joint name="shoulder" axis="0 1 0" range="-2 2"/><geom size="0.1"/>
        <body name="slider" pos="0 0 0.3"><joint name="extend" type="slide" range="0 1"/><geom size="0.1"/></body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <general name="turn" joint="shoulder" gainprm="300" biastype="affine" biasprm="0 -300 -20" forcerange="-40 40"/>
    <motor name="push" joint="extend" ctrlrange="-1 1" gear="25"/>
  </actuator>
</mujoco>
"""


def forces(path: Path) -> dict[str, float]:
    """The greatest force of each driven joint."""
    found = {}
    stage = Usd.Stage.Open(str(path))
    for prim in stage.Traverse():
        for instance in ("angular", "linear"):
            if prim.HasAPI(UsdPhysics.DriveAPI, instance):
                found[prim.GetName()] = UsdPhysics.DriveAPI(prim, instance).GetMaxForceAttr().Get()
    return found


@pytest.mark.parametrize("target", ["newton", "isaac"])
@pytest.mark.parametrize("base", ["", "<freejoint/>"])
def test_a_stage_keeps_the_rules_and_has_the_forces_of_the_actuators(target: str, base: str, tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(ARM.replace("BASE", base), "utf-8")
    result = hx.convert(tmp_path / "arm.xml", tmp_path / "arm.usda", target=target)
    assert problems(tmp_path / "arm.usda") == []
    assert forces(tmp_path / "arm.usda") == {"shoulder": 40.0, "extend": 25.0}
    stage = Usd.Stage.Open(str(tmp_path / "arm.usda"))
    scenes = [prim for prim in stage.Traverse() if prim.IsA(UsdPhysics.Scene)]
    assert [prim.GetName() for prim in scenes] == ["physicsScene"]
    assert [loss for loss in result.losses or () if loss.field.startswith("usd ") and loss.before] == []
    assert hx.verify(tmp_path / "arm.xml", tmp_path / "arm.usda", samples=5).is_same


def test_without_a_target_the_rules_find_what_is_missing(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(ARM.replace("BASE", ""), "utf-8")
    hx.convert(tmp_path / "arm.xml", tmp_path / "arm.usda")
    found = {found.partition(":")[0] for found in problems(tmp_path / "arm.usda")}
    assert found == {"1.1 units", "1.2.5 identity", "1.3 inertia", "1.3.4 contact", "1.4 engines"}
    assert forces(tmp_path / "arm.usda") == {}


def test_what_the_target_adds_is_no_loss_and_stays_within_usd(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(ARM.replace("BASE", ""), "utf-8")
    result = hx.convert(tmp_path / "arm.xml", tmp_path / "arm.usda", target="newton")
    assert [loss for loss in result.losses or () if loss.element == "mechanism" and loss.field.startswith("usd") and loss.before] == []
    again = hx.convert(tmp_path / "arm.usda", tmp_path / "again.usda", target="newton")
    assert again.losses == ()
    assert problems(tmp_path / "again.usda") == []
