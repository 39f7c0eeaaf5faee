"""What is written: a stage that UsdPhysics' own parser understands, exact, deterministic, and open to edits."""

from __future__ import annotations

import io
import math
import zipfile
from pathlib import Path

import pytest
from pxr import Sdf, Usd, UsdGeom, UsdPhysics

import hymeko_x as hx
from hymeko_x import formats, pipeline
from hymeko_x.backends.usd.layers import text_with_residue
from hymeko_x.compare.diff import diff
from hymeko_x.diagnostics import Report
from hymeko_x.formats.usd import RESIDUE
from hymeko_x.frontends import urdf, usd
from hymeko_x.ir.mechanism import WORLD, Id, Mechanism
from hymeko_x.ir.parts import Body, Mesh
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Source
from tests.usd.stages import Texts, again, opened, parsed, written

ARM = """<robot name="my arm">
  <link name="base"/>
  <link name="1 upper.arm">
    <inertial><origin xyz="0 0 .1" rpy=".3 .2 .1"/><mass value="0.1"/>
      <inertia ixx="1" ixy=".1" ixz="0" iyy="2" iyz="0" izz="2.5"/></inertial>
    <visual><origin xyz="0.1 0.2 0.3" rpy="0.1 0 0"/>
      <geometry><box size="0.1 0.2 0.3"/></geometry>
      <material name="red"><color rgba="0.8 0.1 0.1 1"/></material></visual>
    <collision><geometry><cylinder radius="0.1" length="0.7"/></geometry></collision>
  </link>
  <link name="före"/>
  <joint name="elbow" type="revolute"><parent link="base"/><child link="1 upper.arm"/><origin xyz="0 0 .7" rpy="0.1 0.2 0.3"/>
    <axis xyz="0 0.6 0.8"/><limit lower="-1.1" upper="2.3" effort="7" velocity="3"/><dynamics damping="0.2" friction="0.3"/></joint>
  <joint name="slide" type="prismatic"><parent link="1 upper.arm"/><child link="före"/><axis xyz="0 0 -1"/>
    <limit lower="0" upper="0.1" effort="7" velocity="3"/><mimic joint="elbow" multiplier="0.1" offset="0.01"/></joint>
  <gazebo reference="base"><kept/></gazebo>
</robot>"""


def arm() -> Mechanism:
    report = Report()
    mechanism = urdf.read(Source("arm.urdf", ARM.encode()), report).mechanism
    assert list(report) == []
    return mechanism


def test_every_double_of_a_urdf_comes_back_and_the_text_with_it() -> None:
    """Single precision, degrees and principal moments in between change no bit."""
    back = again(arm())
    assert diff(arm(), back) == ()
    assert (back.notations, back.layout) == (arm().notations, arm().layout)

    def as_urdf(mechanism: Mechanism) -> bytes:
        return pipeline.write(mechanism, formats.by_name("urdf"), Options(), NoFiles(), Report()).main

    assert as_urdf(back) == as_urdf(arm())


@pytest.mark.parametrize("format", ["usd", "usdc", "usdz"])
def test_text_crate_and_package_say_the_same_twice_the_same_way(format: str) -> None:
    data = written(arm(), format)
    assert data == written(arm(), format)
    assert pipeline.read(Source(f"arm.{format}", data), formats.by_name(format), Report()) == arm()


def test_a_package_does_not_tell_when_it_was_made() -> None:
    robot = pipeline.convert(arm(), formats.by_name("usdz"), Options(keep="inside"), NoFiles(), Report())
    for data in (written(arm(), "usdz"), robot.package.main):
        with zipfile.ZipFile(io.BytesIO(data)) as package:
            assert {inside.date_time for inside in package.infolist()} == {(1980, 1, 1, 0, 0, 0)}


def test_the_stage_has_units_a_default_prim_and_one_articulation(tmp_path: Path) -> None:
    stage = opened(written(arm()), tmp_path)
    assert (UsdGeom.GetStageMetersPerUnit(stage), UsdGeom.GetStageUpAxis(stage), UsdPhysics.GetStageKilogramsPerUnit(stage)) == (1, "Z", 1)
    assert str(stage.GetDefaultPrim().GetPath()) == "/my_arm"
    assert [str(prim.GetPath()) for prim in stage.Traverse() if prim.HasAPI(UsdPhysics.ArticulationRootAPI)] == ["/my_arm"]


def test_names_that_usd_forbids_are_shown_as_they_were(tmp_path: Path) -> None:
    stage = opened(written(arm()), tmp_path)
    assert stage.GetPrimAtPath("/my_arm/_1_upper_arm").GetMetadata("displayName") == "1 upper.arm"
    assert stage.GetPrimAtPath("/my_arm/före")


def test_the_parser_of_usd_physics_sees_the_joint_where_urdf_puts_it(tmp_path: Path) -> None:
    stage = opened(written(arm()), tmp_path)
    seen = parsed(stage)
    assert seen.bodies["/my_arm/_1_upper_arm"][:3] == pytest.approx((0, 0, 0.7))
    joint = UsdPhysics.RevoluteJoint(stage.GetPrimAtPath("/my_arm/joints/elbow"))
    assert joint.GetLowerLimitAttr().Get() == pytest.approx(math.degrees(-1.1))
    assert joint.GetUpperLimitAttr().Get() == pytest.approx(math.degrees(2.3))
    kind, _, _, axis, _, position, _, zero, *_ = seen.joints["/my_arm/joints/elbow"]
    assert (kind, position) == ("RevoluteJoint", pytest.approx((0, 0, 0)))
    turned = arm().joints[Id("joint", "elbow")].parent_pose.quat
    assert zero == pytest.approx(turned, abs=1e-6) or zero == pytest.approx(tuple(-value for value in turned), abs=1e-6)
    assert axis is not None


def test_what_a_shape_is_for_is_its_purpose(tmp_path: Path) -> None:
    stage = opened(written(arm()), tmp_path)
    shown, felt = (stage.GetPrimAtPath(f"/my_arm/_1_upper_arm/{name}") for name in ("visual", "collision"))
    assert not shown.HasAPI(UsdPhysics.CollisionAPI)
    assert felt.HasAPI(UsdPhysics.CollisionAPI)
    assert (UsdGeom.Imageable(shown).ComputePurpose(), UsdGeom.Imageable(felt).ComputePurpose()) == ("default", "guide")


def test_a_root_link_that_stands_for_the_world_is_no_body(tmp_path: Path) -> None:
    text = """<robot name="r"><link name="world"/><link name="a"/>
      <joint name="j" type="fixed"><parent link="world"/><child link="a"/></joint></robot>"""
    mechanism = urdf.read(Source("r.urdf", text.encode()), Report()).mechanism
    joints = parsed(opened(written(mechanism), tmp_path)).joints
    assert {path: values[:2] for path, values in joints.items()} == {
        "/r/joints/j": ("FixedJoint", ""),
    }
    assert diff(mechanism, again(mechanism)) == ()


def test_a_body_of_a_stage_that_is_called_world_stays_a_body(tmp_path: Path) -> None:
    """Of a stage it is a rigid body like any other, which falls."""
    body = 'def Xform "world" (prepend apiSchemas = ["PhysicsRigidBodyAPI"]) {}'
    (tmp_path / "r.usda").write_text(f'#usda 1.0\n(\n    defaultPrim = "r"\n)\ndef Xform "r"\n{{\n    {body}\n}}\n')
    hx.convert(tmp_path / "r.usda", tmp_path / "again.usdc")
    assert [key.name for key, _ in hx.load(tmp_path / "again.usdc").mechanism.vertices(Body)] == ["world"]


def test_without_a_residue_too_the_link_that_stands_for_the_world_comes_back(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(
        """<robot name="r"><link name="world"/><link name="a"/>
      <joint name="j" type="fixed"><parent link="world"/><child link="a"/></joint></robot>"""
    )
    hx.convert(tmp_path / "r.urdf", tmp_path / "r.usda")
    stage = hx.load(tmp_path / "r.usda").mechanism
    assert [(view.parent, view.joint.dofs) for view in stage.joints.values()] == [(WORLD, ())]
    hx.convert(tmp_path / "r.usda", tmp_path / "back.urdf")
    back = hx.load(tmp_path / "back.urdf").mechanism
    assert ([root.name for root in back.roots], list(back.joints)) == (["world"], [Id("joint", "j")])


# ---- edits win -----------------------------------------------------------------------------------------------------------------


def test_an_edit_of_a_native_value_wins_over_what_is_carried(tmp_path: Path) -> None:
    stage = opened(written(arm()), tmp_path)
    stage.GetPrimAtPath("/my_arm/joints/elbow").GetAttribute("physics:upperLimit").Set(90.0)
    stage.GetPrimAtPath("/my_arm/_1_upper_arm").GetAttribute("physics:mass").Set(5.0)
    mechanism = pipeline.read(Source("edited.usda", stage.GetRootLayer().ExportToString().encode()), formats.USD, Report())
    dof = mechanism.joints[Id("joint", "elbow")].joint.dofs[0]
    assert (dof.limits.upper, dof.limits.velocity) == (math.pi / 2, pytest.approx(3))
    assert dof.damping == pytest.approx(0.2)
    inertial = mechanism.vertex(Id("body", "1 upper.arm"), Body).inertial
    assert inertial is not None
    assert inertial.mass == 5.0
    assert mechanism.joints[Id("joint", "slide")] == arm().joints[Id("joint", "slide")]


def test_a_deleted_prim_takes_along_what_hangs_on_it(tmp_path: Path) -> None:
    stage = opened(written(arm()), tmp_path)
    stage.RemovePrim("/my_arm/joints/slide")
    mechanism = pipeline.read(Source("edited.usda", stage.GetRootLayer().ExportToString().encode()), formats.USD, Report())
    assert [key.name for key in mechanism.joints if key.name == "slide"] == []


# ---- meshes --------------------------------------------------------------------------------------------------------------------

OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
MESHES = """<robot name="m"><link name="a">
  <visual><geometry><mesh filename="a.obj" scale="2 -1 1"/></geometry></visual>
  <collision><geometry><mesh filename="a.obj" scale="2 -1 1"/></geometry></collision></link></robot>"""


def test_a_mesh_that_is_shown_twice_is_stored_once_and_keeps_its_file(tmp_path: Path) -> None:
    files = Texts({"a.obj": OBJ})
    mechanism = urdf.read(Source("m.urdf", MESHES.encode(), files), Report()).mechanism
    data = pipeline.convert(mechanism, formats.USD, Options(keep="inside"), files, Report()).package.main
    assert data.count(b"point3f[] points") == 1
    stage = opened(data, tmp_path)
    prims = [prim for prim in stage.Traverse() if prim.GetTypeName() == "Mesh"]
    assert [len(prim.GetAttribute("points").Get()) for prim in prims] == [4, 4]
    assert pipeline.read(Source("m.usda", data, files), formats.USD, Report()) == mechanism


def test_without_its_file_a_mesh_has_the_points_of_the_stage() -> None:
    mechanism = urdf.read(Source("m.urdf", MESHES.encode()), Report()).mechanism
    data = pipeline.write(mechanism, formats.by_name("usd"), Options(), Texts({"a.obj": OBJ}), Report()).main
    ((_, mesh),) = usd.read(Source("m.usda", data), Report()).mechanism.vertices(Mesh)
    assert (mesh.uri, len(mesh.vertices), len(mesh.faces)) == (None, 12, 12)
    shown = {tuple(factor * x for factor, x in zip(mesh.scale, mesh.vertices[at : at + 3], strict=True)) for at in range(0, 12, 3)}
    assert (0.0, 0.0, pytest.approx(0.1)) in [tuple(abs(x) for x in point) for point in shown]


# ---- laws ----------------------------------------------------------------------------------------------------------------------


def test_a_written_stage_needs_no_other_layer(tmp_path: Path) -> None:
    stage = opened(written(arm()), tmp_path)
    assert len(stage.GetUsedLayers()) == 2
    assert isinstance(stage, Usd.Stage)


def shown_once(factor: float) -> str:
    """A stage with one mesh as we write it, its normals multiplied."""
    robot = b'<robot name="m"><link name="a"><visual><geometry><mesh filename="a.obj"/></geometry></visual></link></robot>'
    mechanism = urdf.read(Source("m.urdf", robot), Report()).mechanism
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.ImportFromString(pipeline.write(mechanism, formats.USD, Options(), Texts({"a.obj": OBJ}), Report()).main.decode())
    normals = layer.GetAttributeAtPath("/m/a/visual.normals")
    normals.default = [factor * normal for normal in normals.default]
    return str(layer.ExportToString())


@pytest.mark.parametrize(("factor", "kept"), [(1.0, False), (-1.0, True)])
def test_normals_that_follow_from_the_triangles_are_no_extra_and_are_written_again(factor: float, kept: bool) -> None:
    text = shown_once(factor)
    mechanism = usd.read(Source("m.usda", text.encode()), Report()).mechanism
    assert any("normals" in extra.text for extras in mechanism.extras.values() for extra in extras) is kept
    result = Sdf.Layer.CreateAnonymous(".usda")
    result.ImportFromString(pipeline.write(mechanism, formats.USD, Options(), NoFiles(), Report()).main.decode())
    source = Sdf.Layer.CreateAnonymous(".usda")
    source.ImportFromString(text)
    before, after = (layer.GetAttributeAtPath("/m/a/visual.normals") for layer in (source, result))
    assert (before.default, before.GetInfo("interpolation")) == (after.default, after.GetInfo("interpolation"))


@pytest.mark.parametrize("comment", ["plain", "two lines\n)\nlike the end of a header"])
def test_a_residue_in_the_header_leaves_the_rest_of_the_text_as_it_was(comment: str) -> None:
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.ImportFromString(written(arm()).decode())
    layer.comment = comment
    whole = layer.ExportToString()
    carried = text_with_residue(layer, whole, 'text "so"\n)\n').decode()
    layer.customLayerData = {**layer.customLayerData, RESIDUE: 'text "so"\n)\n'}
    assert carried == layer.ExportToString()
