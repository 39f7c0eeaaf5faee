"""What a stage hides is not shown elsewhere, and a rod without a moment about its axis keeps its tensor."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from pxr import Usd, UsdGeom, UsdPhysics

import hymeko_x as hx
from hymeko_x.ir.parts import Role
from tests.usd.stages import stage_with_body

if TYPE_CHECKING:
    from pathlib import Path

ROD = """<robot name="r"><link name="b"><inertial><origin rpy="0.3 0.2 0.1"/><mass value="1"/>
<inertia ixx="0" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


def stage(folder: Path) -> Path:
    """A body with a cube for each way to hide one."""
    found = stage_with_body(folder)
    UsdGeom.Xform.Define(found, "/r/b/below").CreateVisibilityAttr("invisible")
    for name in ("seen", "invisible", "guide", "below/invisible", "hull_invisible", "hull_guide", "hull_seen"):
        cube = UsdGeom.Cube.Define(found, f"/r/b/{name}")
        if name.endswith("_invisible") or name == "invisible":
            cube.CreateVisibilityAttr("invisible")
        if name.endswith("guide"):
            cube.CreatePurposeAttr("guide")
        if name.startswith("hull"):
            UsdPhysics.CollisionAPI.Apply(cube.GetPrim())
    found.Save()
    return folder / "r.usda"


def test_what_is_hidden_is_only_felt(tmp_path: Path) -> None:
    robot = hx.load(stage(tmp_path / "home")).mechanism
    assert {view.shape.name: view.shape.role for view in robot.every_shape()} == {
        "seen": Role.VISUAL,
        "hull_invisible": Role.COLLISION,
        "hull_guide": Role.COLLISION,
        "hull_seen": Role.BOTH,
    }


@pytest.mark.parametrize("target", ["r.urdf", "r.xml"])
def test_it_stays_hidden_elsewhere_is_named_as_lost_and_comes_back(target: str, tmp_path: Path) -> None:
    source = stage(tmp_path / "home")
    (tmp_path / "back").mkdir()
    losses = hx.convert(source, tmp_path / target, keep="inside").losses or ()
    assert sum(loss.field.startswith("usd ") and "def Cube" in str(loss.before) for loss in losses) == 3
    assert hx.verify(source, tmp_path / target).verdict == "same"
    hx.convert(tmp_path / target, tmp_path / "back" / "r.usda")
    assert hx.diff(hx.load(source).mechanism, hx.load(tmp_path / "back" / "r.usda").mechanism) == ()
    assert hx.verify(source, tmp_path / "back" / "r.usda").verdict == "same"


def test_a_rod_keeps_its_tensor_for_every_reader_of_usd(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(ROD)
    hx.convert(tmp_path / "r.urdf", tmp_path / "r.usda")
    found = Usd.Stage.Open(str(tmp_path / "r.usda"))
    (body,) = [prim for prim in found.Traverse() if prim.HasAPI(UsdPhysics.MassAPI)]
    moments = sorted(UsdPhysics.MassAPI(body).GetDiagonalInertiaAttr().Get())
    assert moments == pytest.approx([0.0, 0.1, 0.1])
    assert hx.verify(tmp_path / "r.urdf", tmp_path / "r.usda").verdict == "same"
