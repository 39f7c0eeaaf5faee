"""The rules of `usdchecker`, which are validators of usd-core: none of them has anything against what is written."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from pxr import Usd, UsdGeom, UsdPhysics, UsdValidation

import hymeko_x as hx
from hymeko_x.compare.diff import diff
from hymeko_x.corpus.catalog import development_files
from hymeko_x.formats.usd import shapes
from hymeko_x.ir.parts import Loop, Mesh

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
        hx.convert(robot, stage, layout=layout, keep="inside")
        if reported := complaints(stage):
            found[suffix] = reported
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


EGG = """<mujoco model="egg"><worldbody><body name="egg"><freejoint/>
<geom name="shell" type="ellipsoid" size="0.03 0.03 0.04" density="500" rgba="1 0.5 0 1"/>
<geom name="shine" type="ellipsoid" size="0.031 0.03 0.04" contype="0" conaffinity="0" group="2" density="0"/>
</body></worldbody></mujoco>"""


def test_an_ellipsoid_collides_as_the_hull_of_a_mesh_and_is_an_ellipsoid_again(tmp_path: Path) -> None:
    (tmp_path / "egg.xml").write_text(EGG, encoding="utf-8")
    hx.convert(tmp_path / "egg.xml", tmp_path / "egg.usda")
    assert complaints(tmp_path / "egg.usda") == []
    stage = Usd.Stage.Open(str(tmp_path / "egg.usda"))
    prims = {prim.GetName(): prim for prim in stage.Traverse()}
    assert prims["shell"].GetTypeName() == "Mesh"
    assert UsdPhysics.MeshCollisionAPI(prims["shell"]).GetApproximationAttr().Get() == "convexHull"
    assert UsdGeom.Boundable(prims["shell"]).ComputeLocalBound(0, "default").ComputeAlignedRange().GetMax()[2] == pytest.approx(0.04)
    shell = UsdGeom.Mesh(prims["shell"])
    normals, points = np.array(shell.GetNormalsAttr().Get()), np.array(shell.GetPointsAttr().Get())
    middles = points[np.array(shell.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3)].mean(axis=1)
    assert np.einsum("ij,ij->i", normals, middles).min() > 0.9  # one for each triangle of the unit ball, outwards
    assert prims["shine"].GetTypeName() == "Sphere"
    back = hx.load(tmp_path / "egg.usda").mechanism
    sizes = {view.shape.name: view.shape.geometry for views in back.shapes.values() for view in views}
    assert {name: getattr(geometry, "radii", None) for name, geometry in sizes.items()} == {
        "shell": pytest.approx((0.03, 0.03, 0.04)),
        "shine": pytest.approx((0.031, 0.03, 0.04)),
    }
    assert list(back.vertices(Mesh)) == []
    assert hx.verify(tmp_path / "egg.xml", tmp_path / "egg.usda").is_same


BALL = shapes.ball()
FAULTS = {
    "ball": lambda: (BALL[0] * np.float32((1.0, 1.0, 0.5)), BALL[1]),
    "default_gprim": lambda geometry, role: shapes.Gprim("Sphere", (0.05,)),
}


@pytest.mark.parametrize("name", FAULTS)
def test_the_verifier_finds_a_fault_in_the_writers_table_of_shapes(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "egg.xml").write_text(EGG, encoding="utf-8")
    monkeypatch.setattr(shapes, name, FAULTS[name])
    hx.convert(tmp_path / "egg.xml", tmp_path / "egg.usda")
    assert hx.verify(tmp_path / "egg.xml", tmp_path / "egg.usda").verdict == "different"


def test_a_sphere_that_its_author_scaled_stays_a_sphere(tmp_path: Path) -> None:
    source = tmp_path / "a.usda"
    scaled = '{\n float3 xformOp:scale = (1, 2, 3)\n uniform token[] xformOpOrder = ["xformOp:scale"]\n}\n'
    sphere = f'def Sphere "s" (\n  prepend apiSchemas = ["PhysicsCollisionAPI"]\n)\n{scaled}'
    body = f'def Xform "b" (\n  prepend apiSchemas = ["PhysicsRigidBodyAPI"]\n)\n{{\n{sphere}}}\n'
    source.write_text(f'#usda 1.0\n(\n  defaultPrim = "b"\n  metersPerUnit = 1\n  upAxis = "Z"\n)\n{body}', encoding="utf-8")
    hx.convert(source, tmp_path / "back.usda", keep="inside")
    stage = Usd.Stage.Open(str(tmp_path / "back.usda"))
    assert [prim.GetTypeName() for prim in stage.Traverse() if prim.GetName() == "s"] == ["Sphere"]


@pytest.mark.unread("HX104")
def test_a_closure_of_the_world_with_itself_is_left_out_and_there_again_with_the_residue(tmp_path: Path) -> None:
    source, stage, back = (tmp_path / name for name in ("closed.hymeko", "closed.usda", "back.hymeko"))
    source.write_text(
        "r : robot { a { mass 1 inertia [1 1 1] } @j { + world - a } @l : loop.weld { ~ world ~ world } }\n", encoding="utf-8"
    )
    assert [key.name for key, _, _ in hx.load(source).mechanism.edges(Loop)] == ["l"]
    report = hx.convert(source, stage, keep="inside")
    assert complaints(stage) == []
    assert "loop 'l'" in {loss.element for loss in report.losses or ()}
    hx.convert(stage, back, keep="inside")
    assert diff(hx.load(source).mechanism, hx.load(back).mechanism) == ()
