"""Stages `--for newton` and `--for isaac` keep the rules of REP 158, and each rule finds what breaks it."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics, UsdShade, Vt

import hymeko_x as hx
from hymeko_x.corpus.catalog import DevelopmentFile, development_files
from hymeko_x.ir.parts import Body, Frame
from tests.conftest import RealRobots
from tests.usd.rep158 import RULES, problems, problems_of

if TYPE_CHECKING:
    from collections.abc import Callable

ARM = """<robot name="arm">
  <link name="world"/>
  <link name="base">{inertial}<collision name="foot"><geometry><mesh filename="foot.obj"/></geometry></collision></link>
  <link name="plate"/>
  <link name="upper">{inertial}<visual><geometry><sphere radius="0.1"/></geometry></visual></link>
  <link name="fore"/>
  <link name="lens"><visual><geometry><box size="0.1 0.1 0.1"/></geometry></visual></link>
  <link name="tool"/>
  <joint name="hold" type="fixed"><parent link="world"/><child link="base"/></joint>
  <joint name="top" type="fixed"><origin xyz="0 0 0.2"/><parent link="base"/><child link="plate"/></joint>
  <joint name="turn" type="continuous"><origin xyz="0 0 0.1"/><axis xyz="0 0 1"/><parent link="plate"/><child link="upper"/></joint>
  <joint name="bend" type="revolute"><origin xyz="0 0 0.5"/><axis xyz="0 1 0"/><parent link="upper"/><child link="fore"/>
    <limit lower="-1" upper="1" effort="40" velocity="2"/><mimic joint="turn" multiplier="2" offset="0.5"/></joint>
  <joint name="eye" type="fixed"><parent link="fore"/><child link="lens"/></joint>
  <joint name="end" type="fixed"><origin xyz="0 0 0.3"/><parent link="fore"/><child link="tool"/></joint>
</robot>""".replace(
    "{inertial}", '<inertial><mass value="2"/><inertia ixx="0.2" ixy="0.01" ixz="0" iyy="0.2" iyz="0" izz="0.3"/></inertial>'
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The arm as a stage that keeps all rules; its foot is a long mesh."""
    place = tmp_path_factory.mktemp("rep158")
    grid = "".join(f"v {x} {y} {x * y % 3}\n" for x in range(10) for y in range(10))
    (place / "foot.obj").write_text(grid + "".join(f"f {n} {n + 1} {n + 10}\n" for n in range(1, 90) if n % 10))
    (place / "arm.urdf").write_text(ARM, "utf-8")
    hx.convert(place / "arm.urdf", place / "arm.usda", target="isaac")
    return place


def test_the_stage_keeps_every_rule(folder: Path) -> None:
    assert problems(folder / "arm.usda") == []
    names = sorted(path.name for path in (folder / "arm_layers").iterdir())
    layers = ["base", "hymeko", "materials", "mujoco", "newton", "physics", "physx"]
    assert names == sorted(["geometries.usdc", *(f"{layer}.usda" for layer in layers)])


def test_links_without_mass_and_shapes_are_frames_and_come_back_as_links(folder: Path, tmp_path: Path) -> None:
    robot = hx.load(folder / "arm.usda").mechanism
    assert [key.name for key, _ in robot.vertices(Body)] == ["base", "upper", "fore", "lens"]
    assert sorted(key.name for key, _ in robot.vertices(Frame)) == ["plate", "tool"]
    assert {view.id.name: (view.parent.name, view.parent_pose.xyz[2]) for view in robot.joints.values()} == {
        "hold": ("world", 0.0),
        "turn": ("base", pytest.approx(0.3)),
        "bend": ("upper", 0.5),
        "eye": ("fore", 0.0),
    }
    hx.convert(folder / "arm.usda", tmp_path / "arm.urdf", target="ros2")
    links = [key.name for key, _ in hx.load(tmp_path / "arm.urdf").mechanism.vertices(Body)]
    assert sorted(links) == ["base", "fore", "lens", "plate", "tool", "upper", "world"]


def test_the_report_has_what_the_target_changes(folder: Path, tmp_path: Path) -> None:
    report = hx.convert(folder / "arm.urdf", tmp_path / "arm.usda", target="newton").report
    assert [item.message for item in report if "REP" in item.message or "--for newton" in item.message or "mass" in item.message] == [
        "2 links without mass and shapes written as frames (--for newton): 'plate', 'tool'",
        "2 links have no mass or no inertia; mass 1e-10 and inertia 1e-10 are written: 'fore', 'lens'",
        "1 shape without friction get 1, MuJoCo's and Newton's default (--for newton)",
        "the stage has timeCodesPerSecond, assetInfo and a physics scene (--for newton)",
        "tensors are principal moments in single precision, and limits that joints do not have are infinite (--for newton)",
    ]


# ---- each rule finds what breaks it -----------------------------------------------------------------------------------------------


def prim(stage: Any, name: str) -> Any:
    return next(prim for prim in stage.TraverseAll() if prim.GetName() == name)


def hide_in_payload(stage: Any) -> None:
    hidden = Usd.Stage.CreateNew(f"{Path(stage.GetRootLayer().identifier).parent}/hidden.usda")
    UsdPhysics.RigidBodyAPI.Apply(UsdGeom.Xform.Define(hidden, "/hidden/body").GetPrim())
    hidden.GetRootLayer().Save()
    UsdGeom.Xform.Define(stage, "/arm/more").GetPrim().GetPayloads().AddPayload("./hidden.usda", "/hidden")


def close_loop(stage: Any) -> None:
    joint = UsdPhysics.FixedJoint.Define(stage, "/arm/joints/loop")
    joint.GetBody0Rel().SetTargets([prim(stage, "base").GetPath()])
    joint.GetBody1Rel().SetTargets([prim(stage, "lens").GetPath()])


def add_texture(stage: Any) -> None:
    shader = UsdShade.Shader.Define(stage, "/arm/materials/image")
    shader.CreateInput("file", Sdf.ValueTypeNames.Asset).Set(Sdf.AssetPath("./wood.exr"))


def add_plain_material(stage: Any) -> None:
    UsdShade.Material.Define(stage, "/arm/materials/plain")


def fill_root_layer(stage: Any) -> None:
    points = UsdGeom.Points.Define(stage, "/arm/points")
    points.CreatePointsAttr(Vt.Vec3fArray([Gf.Vec3f(number) for number in range(100)]))


def add_variant(stage: Any) -> None:
    prim(stage, "base").GetVariantSets().AddVariantSet("size").AddVariant("large")


BREAKS: dict[str, Callable[[Any], object]] = {
    "1.1 units": lambda stage: stage.GetRootLayer().pseudoRoot.SetInfo("metersPerUnit", 0.01),
    "1.1 transforms": lambda stage: UsdGeom.Xformable(prim(stage, "upper")).AddScaleOp().Set(Gf.Vec3f(2.0)),
    "1.1 root": lambda stage: UsdGeom.Xformable(stage.GetDefaultPrim()).AddRotateXOp().Set(90.0),
    "1.2.1 encoding": fill_root_layer,
    "1.2.2 kind": lambda stage: Usd.ModelAPI(stage.GetDefaultPrim()).SetKind("subcomponent"),
    "1.2.3 payloads": hide_in_payload,
    "1.2.4 variants": add_variant,
    "1.2.5 identity": lambda stage: stage.GetDefaultPrim().SetAssetInfoByKey("identifier", ""),
    "1.2.5 paths": lambda stage: prim(stage, "base").GetReferences().AddReference("/abs/other.usda"),
    "1.2.5 prefabs": lambda stage: prim(stage, "base").CreateAttribute("sim:prefabPath", Sdf.ValueTypeNames.String).Set("a.usd"),
    "1.2.6 instances": lambda stage: prim(stage, "base").SetInstanceable(True),
    "1.3 limits": lambda stage: UsdPhysics.RevoluteJoint.Define(stage, "/arm/joints/bare"),
    "1.3 trees": close_loop,
    "1.3 mass": lambda stage: prim(stage, "upper").GetAttribute("physics:mass").Set(0.0),
    "1.3 frames": lambda stage: UsdPhysics.RigidBodyAPI.Apply(prim(stage, "tool")),
    "1.3 inertia": lambda stage: (
        prim(stage, "upper").CreateAttribute("newton:inertia", Sdf.ValueTypeNames.DoubleArray).Set(Vt.DoubleArray([1.0] * 6))
    ),
    "1.3 mimic": lambda stage: prim(stage, "bend").GetRelationship("ext_physics:mimic:joint").SetTargets([prim(stage, "bend").GetPath()]),
    "1.3.4 contact": lambda stage: UsdPhysics.CollisionAPI.Apply(UsdGeom.Sphere.Define(stage, "/arm/upper/bump").GetPrim()),
    "1.4 engines": lambda stage: prim(stage, "upper").CreateAttribute("mjc:extra", Sdf.ValueTypeNames.Double).Set(1.0),
    "3.1 surfaces": add_plain_material,
    "3.2 textures": add_texture,
    "3.4 triangles": lambda stage: prim(stage, "foot").GetAttribute("faceVertexCounts").Set(Vt.IntArray([4] * 10)),
    "3.4 winding": lambda stage: prim(stage, "foot").CreateAttribute("orientation", Sdf.ValueTypeNames.Token).Set("leftHanded"),
    "3.6 lights": lambda stage: stage.DefinePrim("/arm/lamp", "RectLight"),
}


@pytest.mark.parametrize("section", [section for section, _ in RULES])
def test_a_rule_finds_what_breaks_it(section: str, folder: Path, tmp_path: Path) -> None:
    shutil.copytree(folder, tmp_path / "copy")
    stage = Usd.Stage.Open(str(tmp_path / "copy" / "arm.usda"))
    if section == "1.4 engines":
        prim(stage, "upper").CreateAttribute("physics:velocity", Sdf.ValueTypeNames.Vector3f)
    BREAKS[section](stage)
    assert section in {found.partition(":")[0] for found in problems_of(stage)}


# ---- real robots -----------------------------------------------------------------------------------------------------------------


FILES = [
    file for format, count in (("urdf", 60), ("mjcf", 40)) for file in development_files(format)[:: len(development_files(format)) // count]
]
NAMES = ("finger.xml",)


@pytest.mark.corpus
@pytest.mark.parametrize("file", [file for file in FILES if Path(file.path).name in NAMES], ids=lambda file: file.id)
def test_a_real_robot_keeps_every_rule(file: DevelopmentFile, real_robot: RealRobots, tmp_path: Path) -> None:
    hx.convert(real_robot(file), tmp_path / "robot.usda", target="newton")
    assert problems(tmp_path / "robot.usda") == []


@pytest.mark.full
@pytest.mark.corpus
def test_sixty_urdfs_and_forty_mjcfs_keep_every_rule(real_robot: RealRobots, tmp_path: Path) -> None:
    wrong = {}
    for number, file in enumerate(FILES):
        stage = tmp_path / str(number) / "robot.usda"
        stage.parent.mkdir()
        hx.convert(real_robot(file), stage, target="isaac")
        if found := problems(stage):
            wrong[file.id] = found[:3]
    assert len(FILES) >= 100
    assert wrong == {}
