"""`--for newton` and `--for isaac`: stages that say what they are, and whose drives have force limits."""

from __future__ import annotations

from pathlib import Path

import pytest
from pxr import Usd, UsdGeom, UsdPhysics

import hymeko_x as hx

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


def rep_158_problems(path: Path) -> list[str]:
    """What contradicts the rules of REP 158 (draft of 2026) for a stage as a whole: sections 1.1, 1.2.2 and 1.2.5."""
    stage = Usd.Stage.Open(str(path))
    layer, root = stage.GetRootLayer(), stage.GetDefaultPrim()
    info = root.GetAssetInfo() if root else {}
    rules = {
        "metersPerUnit": layer.pseudoRoot.GetInfo("metersPerUnit") == 1.0,
        "kilogramsPerUnit": layer.pseudoRoot.GetInfo("kilogramsPerUnit") == 1.0,
        "upAxis": UsdGeom.GetStageUpAxis(stage) == "Z",
        "timeCodesPerSecond": layer.HasTimeCodesPerSecond() and layer.timeCodesPerSecond == 1.0,
        "defaultPrim": bool(root),
        "assetInfo": bool(info.get("identifier")) and bool(info.get("version")),
        "kind": Usd.ModelAPI(root).GetKind() in ("component", "assembly", "group"),
        "relative paths": all(file.startswith("./") for file in layer.subLayerPaths),
        "root transform": UsdGeom.Xformable(root).GetLocalTransformation() == type(UsdGeom.Xformable(root).GetLocalTransformation())(1.0),
    }
    return [name for name, holds in rules.items() if not holds]


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
    assert rep_158_problems(tmp_path / "arm.usda") == []
    assert forces(tmp_path / "arm.usda") == {"shoulder": 40.0, "extend": 25.0}
    stage = Usd.Stage.Open(str(tmp_path / "arm.usda"))
    scenes = [prim for prim in stage.Traverse() if prim.IsA(UsdPhysics.Scene)]
    assert [prim.GetName() for prim in scenes] == ["physicsScene"]
    assert [loss for loss in result.losses or () if loss.field.startswith("usd ") and loss.before] == []
    assert hx.verify(tmp_path / "arm.xml", tmp_path / "arm.usda", samples=5).is_same


def test_without_a_target_the_rules_find_what_is_missing(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(ARM.replace("BASE", ""), "utf-8")
    hx.convert(tmp_path / "arm.xml", tmp_path / "arm.usda")
    assert rep_158_problems(tmp_path / "arm.usda") == ["timeCodesPerSecond", "assetInfo"]
    assert forces(tmp_path / "arm.usda") == {}


def test_what_the_target_adds_is_no_loss_and_stays_within_usd(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(ARM.replace("BASE", ""), "utf-8")
    result = hx.convert(tmp_path / "arm.xml", tmp_path / "arm.usda", target="newton")
    assert [loss for loss in result.losses or () if loss.element == "mechanism" and loss.field.startswith("usd") and loss.before] == []
    again = hx.convert(tmp_path / "arm.usda", tmp_path / "again.usda", target="newton")
    assert again.losses == ()
    assert rep_158_problems(tmp_path / "again.usda") == []
