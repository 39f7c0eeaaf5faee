"""Images of mesh files in a stage: texture coordinates, the material that shows the image, and the way back to mesh files."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
import trimesh
from PIL import Image
from pxr import Usd, UsdGeom, UsdShade

import hymeko_x as hx
from hymeko_x.ir.parts import Texture
from hymeko_x.meshes.reader import read_colours
from hymeko_x.meshes.submesh import Submesh
from tests.usd.test_rules import complaints

URDF = """<robot name="r"><link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual name="shell"><geometry><mesh filename="a{suffix}" scale="2 2 2"/></geometry>{material}</visual></link></robot>"""
PYRAMID = """v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0.1
v 0.5 0.5 1
vt 0 0
vt 1 0
vt 0.1 0.7
vt 1 1
vt 0.5 0.25
"""
IMAGE_FACES = "usemtl wood\nf 1/1 4/3 3/4 2/2\nf 1/1 2/2 5/5\nf 2/1 3/2 5/5\n"
RED_FACES = "usemtl paint\nf 3/1 4/2 5/5\nf 4/1 1/2 5/5\n"
LIBRARY = "newmtl wood\nKd 0.8 0.8 0.8\nmap_Kd wood{suffix}\nnewmtl paint\nKd 1 0 0\n"


def image(kind: str = "PNG") -> bytes:
    out = io.BytesIO()
    Image.fromarray(np.arange(48, dtype=np.uint8).reshape(4, 4, 3)).save(out, kind)
    return out.getvalue()


def lay_obj(folder: Path, faces: str = IMAGE_FACES, suffix: str = ".png", kind: str = "PNG") -> Path:
    (folder / "a.obj").write_text(f"mtllib a.mtl\n{PYRAMID}{faces}")
    (folder / "a.mtl").write_text(LIBRARY.format(suffix=suffix))
    (folder / f"wood{suffix}").write_bytes(image(kind))
    return lay(folder, ".obj")


def lay(folder: Path, suffix: str, material: str = "") -> Path:
    (folder / "r.urdf").write_text(URDF.format(suffix=suffix, material=material))
    return folder / "r.urdf"


GLASS = "newmtl glass\nKd 0.5 0.5 0.5\nd 0.25\nnewmtl paint\nKd 1 0 0\n"


def lay_glass(folder: Path) -> Path:
    """A robot whose mesh file has one transparent colour and an opaque one, whose opacity the file leaves out."""
    (folder / "a.obj").write_text(
        f"mtllib a.mtl\n{PYRAMID}usemtl glass\nf 1 4 3\nf 1 3 2\nusemtl paint\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n"
    )
    (folder / "a.mtl").write_text(GLASS)
    return lay(folder, ".obj")


def meshes(stage: Usd.Stage) -> list[Usd.Prim]:
    return [prim for prim in stage.Traverse(Usd.TraverseInstanceProxies()) if prim.IsA(UsdGeom.Mesh)]


def shown_file(prim: Usd.Prim) -> str | None:
    """The file of the image that colours a mesh, as USD finds it."""
    source = surface_of(prim).GetInput("diffuseColor").GetConnectedSource()
    return None if source is None else str(source[0].GetPrim().GetAttribute("inputs:file").Get().resolvedPath)


def surface_of(prim: Usd.Prim) -> UsdShade.Shader:
    return UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0].ComputeSurfaceSource()[0]


def corners(prim: Usd.Prim) -> set[tuple[float, ...]]:
    """Point and place in the image of every corner."""
    mesh, places = UsdGeom.Mesh(prim), UsdGeom.PrimvarsAPI(prim).GetPrimvar("st")
    points = [mesh.GetPointsAttr().Get()[row] for row in mesh.GetFaceVertexIndicesAttr().Get()]
    return {(*map(float, point), *map(float, place)) for point, place in zip(points, places.ComputeFlattened(), strict=True)}


def corners_of(part: Submesh) -> set[tuple[float, ...]]:
    assert part.uv is not None
    assert part.corners is not None
    rows = np.hstack([part.points[part.faces].reshape(-1, 3), part.uv[part.corners].reshape(-1, 2)])
    return {tuple(map(float, row)) for row in rows.astype(np.float32)}


EXPECTED = {(0, 0, 0, 0, 0), (1, 0, 0, 1, 0), (1, 1, 0, 1, 1), (0, 1, np.float32(0.1), np.float32(0.1), np.float32(0.7))} | {
    (0.5, 0.5, 1, 0.5, 0.25),
    (1, 0, 0, 0, 0),
    (1, 1, 0, 1, 0),
}


@pytest.mark.parametrize("target", ["r.usda", "r.usdc"])
def test_an_obj_file_brings_its_image_and_the_place_of_every_corner(tmp_path: Path, target: str) -> None:
    (tmp_path / "out").mkdir()
    hx.convert(lay_obj(tmp_path), tmp_path / "out" / target, keep="inside")
    stage = Usd.Stage.Open(str(tmp_path / "out" / target))
    (prim,) = meshes(stage)
    assert shown_file(prim) == str(tmp_path / "out" / "textures" / "wood.png")
    assert (tmp_path / "out" / "textures" / "wood.png").read_bytes() == image()
    primvar = UsdGeom.PrimvarsAPI(prim).GetPrimvar("st")
    assert (primvar.GetInterpolation(), primvar.GetTypeName(), len(primvar.GetIndices())) == ("faceVarying", "texCoord2f[]", 12)
    assert corners(prim) == EXPECTED
    assert len(UsdGeom.Mesh(prim).GetPointsAttr().Get()) == 5


def test_the_robot_is_the_same_and_comes_back_as_it_was(tmp_path: Path) -> None:
    hx.convert(lay_obj(tmp_path), tmp_path / "r.usda", keep="inside")
    hx.convert(tmp_path / "r.usda", tmp_path / "back.urdf", keep="inside")
    assert hx.diff(hx.load(tmp_path / "r.urdf").mechanism, hx.load(tmp_path / "back.urdf").mechanism) == ()
    assert hx.verify(tmp_path / "r.urdf", tmp_path / "r.usda").is_same


def test_a_stage_of_others_leaves_as_obj_with_its_image(tmp_path: Path) -> None:
    hx.convert(lay_obj(tmp_path), tmp_path / "r.usda")
    (tmp_path / "out").mkdir()
    hx.convert(tmp_path / "r.usda", tmp_path / "out" / "r.urdf", keep="inside")
    mesh = next((tmp_path / "out").rglob("*.obj"))
    part, ((appearance, rows),) = read_colours(mesh.read_bytes(), ".obj", lambda name: (mesh.parent / name).read_bytes())
    assert corners_of(part) == EXPECTED
    assert (appearance.image, len(rows)) == (image(), len(part.faces))
    assert hx.verify(tmp_path / "r.usda", tmp_path / "out" / "r.urdf").is_same
    (tmp_path / "again").mkdir()
    hx.convert(tmp_path / "out" / "r.urdf", tmp_path / "again" / "r.usda", keep="inside")
    stage = Usd.Stage.Open(str(tmp_path / "again" / "r.usda"))
    assert [corners(prim) for prim in meshes(stage)] == [EXPECTED]
    assert [Path(shown_file(prim) or "").read_bytes() for prim in meshes(stage)] == [image()]


def test_a_stage_leaves_for_mujoco_with_its_image(tmp_path: Path) -> None:
    import mujoco

    hx.convert(lay_obj(tmp_path), tmp_path / "r.usda")
    hx.convert(tmp_path / "r.usda", tmp_path / "r.xml", keep="inside")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "r.xml"))
    assert (model.ntex, model.mesh_texcoordnum[0] > 0, model.mat_texid[model.geom_matid[0], 1]) == (1, True, 0)


def test_a_file_in_an_image_and_a_colour_is_one_mesh_with_a_subset_for_each(tmp_path: Path) -> None:
    hx.convert(lay_obj(tmp_path, IMAGE_FACES + RED_FACES), tmp_path / "r.usda", keep="inside")
    stage = Usd.Stage.Open(str(tmp_path / "r.usda"))
    (prim,) = meshes(stage)
    wood, paint = (part.GetPrim() for part in UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets())
    assert [list(part.GetAttribute("indices").Get()) for part in (wood, paint)] == [[0, 1, 2, 3], [4, 5]]
    assert shown_file(wood) == str(tmp_path / "textures" / "wood.png")
    assert tuple(surface_of(paint).GetInput("diffuseColor").Get()) == (1.0, 0.0, 0.0)
    assert len(UsdGeom.Mesh(prim).GetPointsAttr().Get()) == 5
    assert {corner for corner in corners(prim) if corner[3:] != (0.0, 0.0)} == {corner for corner in EXPECTED if corner[3:] != (0, 0)}


@pytest.mark.parametrize(
    ("suffix", "kind", "there"), [(".jpg", "JPEG", "wood.jpg"), (".tif", "TIFF", "wood.png"), (".gif", "GIF", "wood.png")]
)
def test_png_and_jpeg_stay_what_they_are_and_other_images_become_png(tmp_path: Path, suffix: str, kind: str, there: str) -> None:
    hx.convert(lay_obj(tmp_path, suffix=suffix, kind=kind), tmp_path / "r.usda", keep="inside")
    stage = Usd.Stage.Open(str(tmp_path / "r.usda"))
    assert shown_file(meshes(stage)[0]) == str(tmp_path / "textures" / there)
    if there.endswith("jpg"):
        assert (tmp_path / "textures" / there).read_bytes() == (tmp_path / "wood.jpg").read_bytes()


def test_an_image_on_the_disk_of_its_author_is_found_beside_the_mesh(tmp_path: Path) -> None:
    source = lay_obj(tmp_path)
    (tmp_path / "a.mtl").write_text("newmtl wood\nmap_Kd D:\\robots\\wood.png\n")
    hx.convert(source, tmp_path / "r.usda", keep="inside")
    stage = Usd.Stage.Open(str(tmp_path / "r.usda"))
    assert shown_file(meshes(stage)[0]) == str(tmp_path / "textures" / "wood.png")


def test_without_its_image_a_file_has_its_colour_and_a_warning(tmp_path: Path) -> None:
    source = lay_obj(tmp_path)
    (tmp_path / "wood.png").unlink()
    report = hx.convert(source, tmp_path / "r.usda", keep="inside").report
    stage = Usd.Stage.Open(str(tmp_path / "r.usda"))
    assert surface_of(meshes(stage)[0]).GetInput("diffuseColor").Get()[0] == pytest.approx(0.8)
    assert [entry.message for entry in report.diagnostics if "image" in entry.message] == [
        "mesh 'a': its image 'wood.png' was not found; it is shown without"
    ]


def test_of_a_mesh_that_only_collides_no_image_is_missed(tmp_path: Path) -> None:
    source = lay_obj(tmp_path)
    (tmp_path / "wood.png").unlink()
    source.write_text(source.read_text().replace("visual", "collision"))
    report = hx.convert(source, tmp_path / "r.usda", keep="inside").report
    stage = Usd.Stage.Open(str(tmp_path / "r.usda"))
    (mesh,) = meshes(stage)
    assert len(UsdGeom.Mesh(mesh).GetFaceVertexCountsAttr().Get()) == 4
    assert [entry.message for entry in report.diagnostics if "image" in entry.message] == []


def test_a_damaged_image_is_one_warning(tmp_path: Path) -> None:
    source = lay_obj(tmp_path)
    (tmp_path / "wood.png").write_bytes(image()[:45])
    report = hx.convert(source, tmp_path / "r.usda", keep="inside").report
    assert [entry.message.split(":")[:2] for entry in report.diagnostics if "image" in entry.message] == [
        ["mesh 'a'", " its image 'wood.png' cannot be read"]
    ]


def test_the_image_of_a_urdf_material_is_laid_on_by_the_coordinates_of_the_mesh(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text(PYRAMID + IMAGE_FACES.partition("\n")[2])
    (tmp_path / "wood.png").write_bytes(image())
    source = lay(tmp_path, ".obj", '<material name="w"><texture filename="wood.png"/></material>')
    hx.convert(source, tmp_path / "r.usda", keep="inside")
    stage = Usd.Stage.Open(str(tmp_path / "r.usda"))
    assert corners(meshes(stage)[0]) == EXPECTED


def test_a_mjcf_mesh_keeps_its_coordinates(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text(PYRAMID + IMAGE_FACES.partition("\n")[2])
    (tmp_path / "wood.png").write_bytes(image())
    (tmp_path / "r.xml").write_text(
        '<mujoco><asset><texture type="2d" name="t" file="wood.png"/><material name="m" texture="t"/><mesh name="a" file="a.obj"/></asset>'
        '<worldbody><body name="b"><freejoint/><geom type="mesh" mesh="a" material="m" mass="1"/></body></worldbody></mujoco>'
    )
    hx.convert(tmp_path / "r.xml", tmp_path / "r.usda", keep="inside")
    stage = Usd.Stage.Open(str(tmp_path / "r.usda"))
    assert len(corners(meshes(stage)[0])) == len(EXPECTED)


def test_a_glb_file_brings_its_image(tmp_path: Path) -> None:
    box = trimesh.creation.box((1.0, 2.0, 3.0))
    places = np.linspace(0.0, 1.0, 2 * len(box.vertices)).reshape(-1, 2)
    appearances = trimesh.visual.material.PBRMaterial(name="wood", baseColorTexture=Image.open(io.BytesIO(image())))
    box.visual = trimesh.visual.TextureVisuals(uv=places, material=appearances)
    (tmp_path / "a.glb").write_bytes(trimesh.Scene(box).export(file_type="glb"))
    hx.convert(lay(tmp_path, ".glb"), tmp_path / "r.usda", keep="inside")
    stage = Usd.Stage.Open(str(tmp_path / "r.usda"))
    (prim,) = meshes(stage)
    expected = {(*map(np.float32, point), *map(np.float32, place)) for point, place in zip(box.vertices, places, strict=True)}
    assert np.allclose(sorted(corners(prim)), sorted(expected))
    assert np.array_equal(np.asarray(Image.open(shown_file(prim) or "")), np.asarray(Image.open(io.BytesIO(image()))))


COLLADA = """<COLLADA><library_images><image id="i"><init_from>wood.png</init_from></image></library_images>
<library_effects><effect id="e"><profile_COMMON><newparam sid="s"><surface type="2D"><init_from>i</init_from></surface></newparam>
<newparam sid="p"><sampler2D><source>s</source></sampler2D></newparam>
<technique sid="c"><lambert><diffuse><texture texture="p" texcoord="UV"/></diffuse></lambert></technique>
</profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="x"><float_array>0 0 0 1 0 0 1 1 0</float_array><technique_common><accessor stride="3"><param/><param/><param/></accessor>
</technique_common></source>
<source id="u"><float_array>0 0 1 0 0.5 1 0.25 0.75</float_array><technique_common><accessor stride="2"><param/><param/></accessor>
</technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#x"/></vertices>
<triangles material="k"><input semantic="VERTEX" source="#v" offset="0"/><input semantic="TEXCOORD" source="#u" offset="1"/>
<p>0 3 1 1 2 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="k" target="#m"/></technique_common></bind_material></instance_geometry></node>
</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"""


def test_a_collada_file_brings_its_image(tmp_path: Path) -> None:
    (tmp_path / "a.dae").write_text(COLLADA)
    (tmp_path / "wood.png").write_bytes(image())
    hx.convert(lay(tmp_path, ".dae"), tmp_path / "r.usda", keep="inside")
    stage = Usd.Stage.Open(str(tmp_path / "r.usda"))
    (prim,) = meshes(stage)
    assert corners(prim) == {(0, 0, 0, 0.25, 0.75), (1, 0, 0, 1, 0), (1, 1, 0, 0.5, 1)}
    assert shown_file(prim) == str(tmp_path / "textures" / "wood.png")


OTHERS = """#usda 1.0
(
  defaultPrim = "r"
  metersPerUnit = 1
  upAxis = "Z"
)
def Xform "r" {
  def Xform "a" (prepend apiSchemas = ["PhysicsRigidBodyAPI"]) {
    def Mesh "m" (prepend apiSchemas = ["MaterialBindingAPI"]) {
      int[] faceVertexCounts = [4]
      int[] faceVertexIndices = [0, 1, 2, 3]
      point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
      texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] ( interpolation = "vertex" )
      rel material:binding = </r/w>
    }
  }
  def Material "w" {
    token outputs:surface.connect = </r/w/s.outputs:surface>
    def Shader "s" {
      uniform token info:id = "UsdPreviewSurface"
      color3f inputs:diffuseColor.connect = </r/w/t.outputs:rgb>
      token outputs:surface
    }
    def Shader "t" {
      uniform token info:id = "UsdUVTexture"
      asset inputs:file = @wood.png@
      float2 inputs:st.connect = </r/w/c.outputs:result>
      token inputs:wrapS = "clamp"
      float4 inputs:scale = (0.5, 0.5, 0.5, 1)
      float3 outputs:rgb
    }
    def Shader "c" {
      uniform token info:id = "UsdPrimvarReader_float2"
      string inputs:varname = "st"
      float2 outputs:result
    }
  }
}
"""


def test_an_image_with_further_attributes_is_typed_and_stays_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "s.usda").write_text(OTHERS)
    (tmp_path / "wood.png").write_bytes(image())
    hx.convert(tmp_path / "s.usda", tmp_path / "back.usda")
    before, after = (Usd.Stage.Open(str(tmp_path / name)) for name in ("s.usda", "back.usda"))
    for prim in before.Traverse():
        there = after.GetPrimAtPath(prim.GetPath())
        for attribute in prim.GetAuthoredAttributes():
            assert there.GetAttribute(attribute.GetName()).Get() == attribute.Get(), attribute.GetPath()
    assert not after.GetAttributeAtPath("/r/a/m.primvars:st:indices")
    hx.convert(tmp_path / "s.usda", tmp_path / "r.urdf")
    mesh = next((tmp_path / "shapes").glob("*.obj"))
    part, ((appearance, rows),) = read_colours(mesh.read_bytes(), ".obj", lambda name: (mesh.parent / name).read_bytes())
    assert corners_of(part) == {(0, 0, 0, 0, 0), (1, 0, 0, 1, 0), (1, 1, 0, 1, 1), (0, 1, 0, 0, 1)}
    assert (appearance.image, len(rows)) == (image(), len(part.faces))


@pytest.mark.parametrize("layout", ["single", "layered"])
@pytest.mark.parametrize("suffix", [".usda", ".usdc", ".usdz"])
def test_the_rules_of_usdchecker_find_every_image(tmp_path: Path, suffix: str, layout: Literal["single", "layered"]) -> None:
    (tmp_path / "out").mkdir()
    stage = tmp_path / "out" / f"r{suffix}"
    hx.convert(lay_obj(tmp_path, IMAGE_FACES + RED_FACES), stage, layout=layout, keep="inside")
    assert complaints(stage) == []
    assert (tmp_path / "out" / "textures").exists() == (suffix != ".usdz")


@pytest.mark.parametrize("keep", [None, "inside", "beside"])
@pytest.mark.parametrize("layout", ["single", "layered"])
def test_an_image_comes_out_of_a_package_again(
    tmp_path: Path, layout: Literal["single", "layered"], keep: Literal["beside", "inside"] | None
) -> None:
    (tmp_path / "a.obj").write_text(PYRAMID + IMAGE_FACES.partition("\n")[2])
    (tmp_path / "wood.png").write_bytes(image())
    hx.convert(
        lay(tmp_path, ".obj", '<material name="w"><texture filename="wood.png"/></material>'), tmp_path / "r.usdz", keep=keep, layout=layout
    )
    (tmp_path / "wood.png").unlink()
    hx.convert(tmp_path / "r.usdz", tmp_path / "back.urdf", keep="inside")
    (texture,) = (part for _, part in hx.load(tmp_path / "back.urdf").mechanism.vertices(Texture))
    assert texture.uri == ("wood.png" if keep else "textures/wood.png")
    assert (tmp_path / texture.uri).read_bytes() == image()


# ---- transparent colours -------------------------------------------------------------------------------------------------------------


def test_a_colour_to_look_through_reaches_a_stage_and_comes_back_in_the_mesh_file(tmp_path: Path) -> None:
    source = lay_glass(tmp_path)
    hx.convert(source, tmp_path / "there.usda")
    out = Usd.Stage.Open(str(tmp_path / "there.usda"))
    surfaces = [surface_of(prim) for prim in out.Traverse(Usd.TraverseInstanceProxies()) if prim.IsA(UsdGeom.Subset)]
    assert [[surface.GetInput(name).Get() for name in ("diffuseColor", "opacity")] for surface in surfaces] == [
        [(0.5, 0.5, 0.5), 0.25],
        [(1, 0, 0), 1],
    ]
    for names in ("", "_2"):  # the URDF file names the materials of the stage as well
        hx.convert(tmp_path / "there.usda", tmp_path / "back.urdf")
        (library,) = (tmp_path / "shapes").glob("*.mtl")
        assert library.read_text() == GLASS.replace("glass", f"glass{names}").replace("paint", f"paint{names}")
        hx.convert(tmp_path / "back.urdf", tmp_path / "there.usda")


def test_a_colour_to_look_through_is_one_in_mjcf_and_the_way_home_is_exact(tmp_path: Path) -> None:
    import mujoco

    source = lay_glass(tmp_path)
    hx.convert(source, tmp_path / "there.xml", keep="inside")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "there.xml"))
    assert sorted(model.mat_rgba[model.geom_matid].tolist()) == [[0.5, 0.5, 0.5, 0.25], [1, 0, 0, 1]]
    for target in ("there.xml", "there.usdc"):
        hx.convert(source, tmp_path / target, keep="inside")
        hx.convert(tmp_path / target, tmp_path / "back.urdf", keep="inside")
        assert hx.diff(hx.load(source).mechanism, hx.load(tmp_path / "back.urdf").mechanism) == ()


# ---- appearances of one triangle -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("faces", ["usemtl wood\nf 1/1 2/2 5/5\n" + RED_FACES, "usemtl paint\nf 1 2 3\nusemtl other\nf 1 2 5\nf 2 3 5\n"])
def test_a_look_of_one_triangle_stays_that_surface_in_mjcf(faces: str, tmp_path: Path) -> None:
    import mujoco

    source = lay_obj(tmp_path, faces)
    hx.convert(source, tmp_path / "there.xml", keep="inside")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "there.xml"))
    assert sorted(zip(model.mesh_vertnum.tolist(), model.mesh_facenum.tolist(), strict=True)) == [(4, 1), (4, 2)]
    assert model.body_mass[1] == 1
    assert hx.verify(source, tmp_path / "there.xml").is_same
    hx.convert(tmp_path / "there.xml", tmp_path / "home.urdf", keep="inside")
    assert hx.diff(hx.load(source).mechanism, hx.load(tmp_path / "home.urdf").mechanism) == ()
