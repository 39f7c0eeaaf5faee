"""Meshes with subsets: one mesh in several materials, out of USD and back, and as other formats say it."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import pytest
from msgspec.structs import replace
from pxr import Usd, UsdShade

import hymeko_x as hx
from hymeko_x.corpus.catalog import development_files
from hymeko_x.diagnostics import Report
from hymeko_x.ir.mechanism import Id, Mechanism, subset_edge
from tests.usd.stages import HEADER, again, opened, read_text, written
from tests.usd.test_rules import complaints

MATERIAL = """
    def Material "{name}"
    {{
        token outputs:surface.connect = </robot/{name}/s.outputs:surface>
        def Shader "s"
        {{
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor = ({colour})
            token outputs:surface
        }}
    }}
"""
TRIANGLES = """
            int[] faceVertexCounts = [3, 3, 3, 3, 3, 3, 3, 3]
            int[] faceVertexIndices = [0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5]
"""
POLYGONS = """
            int[] faceVertexCounts = [4, 3, 3, 3, 3]
            int[] faceVertexIndices = [0, 3, 1, 2, 0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4]
"""
SUBSET = """
            def GeomSubset "{name}" (
                prepend apiSchemas = ["MaterialBindingAPI"]
            )
            {{
                uniform token elementType = "face"
                uniform token familyName = "{family}"
                int[] indices = [{faces}]
                rel material:binding = </robot/{material}>
            }}
"""


def subset(faces: str, material: str = "red", name: str = "part", family: str = "materialBind") -> str:
    return SUBSET.format(faces=faces, material=material, name=name, family=family)


GREY = '            prepend apiSchemas = ["MaterialBindingAPI"]'
SOLID = '            prepend apiSchemas = ["MaterialBindingAPI", "PhysicsCollisionAPI", "PhysicsMeshCollisionAPI"]'


def stage(*subsets: str, faces: str = TRIANGLES, apis: str = GREY, family: str = "nonOverlapping") -> str:
    """A body with an octahedron that is grey but for its subsets."""
    colours = {"grey": "0.5, 0.5, 0.5", "red": "1, 0, 0", "blue": "0, 0, 1"}
    materials = "".join(MATERIAL.format(name=name, colour=colour) for name, colour in colours.items())
    return f"""{HEADER}
def Xform "robot"
{{{materials}
    def Xform "body" (
        prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]
    )
    {{
        float physics:mass = 2
        float3 physics:diagonalInertia = (1, 1, 1)
        def Mesh "hull" (
{apis}
        )
        {{
            point3f[] points = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]{faces}
            uniform token subdivisionScheme = "none"
            uniform token subsetFamily:materialBind:familyType = "{family}"
            rel material:binding = </robot/grey>
            {"".join(subsets)}
        }}
    }}
}}
"""


TWO = (subset("1, 2"), subset("4, 5", "blue", "tip"))


def shown(mechanism: Mechanism) -> dict[str, tuple[tuple[int, ...], str]]:
    """The triangles of each subset, and the material that they show."""
    return {view.id.name: (view.faces, view.material.name) for views in mechanism.subsets.values() for view in views}


def lay(folder: Path, *subsets: str, apis: str = GREY) -> Path:
    (folder / "s.usda").write_text(stage(*subsets, apis=apis), encoding="utf-8")
    return folder / "s.usda"


def bound(stage: Usd.Stage) -> dict[str, dict[str, tuple[list[int], str]]]:
    """By mesh, the faces of each subset with the name of its material, as USD finds them."""
    found: dict[str, dict[str, tuple[list[int], str]]] = {}
    for prim in meshes(stage):
        own = found[prim.GetName()] = {}
        for part in UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets():
            material = UsdShade.MaterialBindingAPI(part.GetPrim()).ComputeBoundMaterial()[0]
            own[part.GetPrim().GetName()] = list(part.GetIndicesAttr().Get()), material.GetPath().name
    return found


def families(stage: Usd.Stage) -> list[str]:
    return [UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsetsFamilyType() for prim in meshes(stage)]


def meshes(stage: Usd.Stage) -> list[Usd.Prim]:
    return [prim for prim in stage.Traverse() if prim.GetTypeName() == "Mesh"]


# ---- USD ------------------------------------------------------------------------------------------------------------------------


def test_subsets_are_edges_and_nothing_of_them_is_left_over() -> None:
    robot = read_text(stage(*TWO))
    assert shown(robot) == {"part": ((1, 2), "red"), "tip": ((4, 5), "blue")}
    assert robot.extras == {}


def test_a_stage_with_subsets_is_written_as_it_was(tmp_path: Path) -> None:
    robot = read_text(stage(*TWO))
    assert again(robot) == robot
    out = opened(written(robot), tmp_path)
    assert bound(out) == {"hull": {"part": ([1, 2], "red"), "tip": ([4, 5], "blue")}}
    assert families(out) == ["nonOverlapping"]


def test_faces_of_polygons_are_their_triangles_and_stay_as_they_were_written(tmp_path: Path) -> None:
    robot = read_text(stage(subset("2, 0"), subset("1", "blue", "tip"), faces=POLYGONS))
    assert shown(robot) == {"part": ((0, 1, 3), "red"), "tip": ((2,), "blue")}
    assert again(robot) == robot
    out = opened(written(robot), tmp_path)
    assert bound(out) == {"hull": {"part": ([2, 0], "red"), "tip": ([1], "blue")}}
    assert list(out.GetPrimAtPath("/robot/body/hull").GetAttribute("faceVertexCounts").Get()) == [4, 3, 3, 3, 3]


def test_a_family_that_covers_the_mesh_is_still_called_a_partition(tmp_path: Path) -> None:
    robot = read_text(stage(subset("0, 1, 2, 3"), subset("4, 5, 6, 7", "blue", "tip"), family="partition"))
    assert families(opened(written(robot), tmp_path)) == ["partition"]
    assert again(robot) == robot


@pytest.mark.parametrize(
    ("subsets", "kept", "message"),
    [
        ((subset("1, 8"),), "int[] indices = [1, 8]", "has a face that the mesh does not have"),
        ((subset("-1"),), "int[] indices = [-1]", "has a face that the mesh does not have"),
        ((subset("1, 1"),), "int[] indices = [1, 1]", "has a face that shows a material already"),
        ((subset("1, 2", name="first"), subset("2", "blue")), "int[] indices = [2]", "has a face that shows a material already"),
        ((subset("1", family="grasps"),), 'familyName = "grasps"', None),
        ((subset("1", "nothing"),), "rel material:binding = </robot/nothing>", None),
    ],
)
@pytest.mark.unread("HX203")
def test_what_is_no_subset_that_shows_a_material_is_kept_as_written(subsets: tuple[str, ...], kept: str, message: str | None) -> None:
    report = Report()
    robot = read_text(stage(*subsets), report)
    assert "part" not in shown(robot)
    assert sum(kept in extra.text for found in robot.extras.values() for extra in found) == 1
    assert [item.message for item in report] == (
        [] if message is None else [f"subset '/robot/body/hull/part' {message}; it is kept as written"]
    )
    assert written(robot).decode().count(kept) == 1
    assert again(robot) == robot


def test_a_mesh_that_is_shown_twice_has_the_subsets_of_each_shape(tmp_path: Path) -> None:
    robot = read_text(stage(*TWO))
    hull, red = Id("shape", "hull"), Id("material", "red")
    twin = {Id("shape", "twin"): robot.graph.edges[hull], Id("subset", "other"): subset_edge((0, 7), Id("shape", "twin"), red)}
    both = replace(robot, graph=robot.graph.replace(edges=twin))
    assert bound(opened(written(both), tmp_path)) == {
        "hull": {"part": ([1, 2], "red"), "tip": ([4, 5], "blue")},
        "hull_2": {"other": ([0, 7], "red")},
    }
    assert again(both) == both


PROTOTYPES = """
    def Xform "{name}" (
        prepend apiSchemas = ["PhysicsRigidBodyAPI"]
        instanceable = true
        prepend references = </robot/body>
    )
    {{
    }}
"""


def test_the_subsets_of_a_prototype_are_those_of_all_its_instances() -> None:
    head, _, _ = stage(*TWO).rpartition("}")
    robot = read_text(head + PROTOTYPES.format(name="second") + "}\n")
    faces = [[view.faces for view in robot.subsets[view.id]] for views in robot.shapes.values() for view in views]
    assert faces == [[(1, 2), (4, 5)]] * 2
    assert again(robot) == robot


def test_a_subset_goes_when_its_shape_or_its_material_goes() -> None:
    text = written(read_text(stage(*TWO))).decode()
    assert shown(read_residue(text.replace("int[] indices = [4, 5]", "int[] indices = [4, 6]")))["tip"] == ((4, 6), "blue")
    assert shown(read_residue(text.replace("</robot/blue>", "</robot/nothing>"))) == {"part": ((1, 2), "red")}


def read_residue(text: str) -> Mechanism:
    return hx.loads(text, "usd").mechanism


@pytest.mark.parametrize("layout", ["single", "layered"])
@pytest.mark.parametrize("suffix", [".usda", ".usdc", ".usdz"])
def test_the_rules_of_usdchecker_have_nothing_against_subsets(tmp_path: Path, suffix: str, layout: Literal["single", "layered"]) -> None:
    out = tmp_path / f"r{suffix}"
    hx.convert(lay(tmp_path, *TWO), out, layout=layout, keep="inside")
    assert complaints(out) == []
    assert bound(Usd.Stage.Open(str(out))) == {"hull": {"part": ([1, 2], "red"), "tip": ([4, 5], "blue")}}


# ---- other formats ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("target", ["r.urdf", "r.xacro", "r.xml", "r.hymeko"])
@pytest.mark.parametrize("apis", [GREY, SOLID])
def test_other_formats_give_the_stage_back(tmp_path: Path, target: str, apis: str) -> None:
    source = lay(tmp_path, *TWO, apis=apis)
    hx.convert(source, tmp_path / target, keep="inside")
    hx.convert(tmp_path / target, tmp_path / "back.usda", keep="inside")
    assert hx.diff(hx.load(source).mechanism, hx.load(tmp_path / "back.usda").mechanism) == ()
    assert hx.verify(source, tmp_path / target).is_same


OBJ = """usemtl grey
f 1 3 5
usemtl red
f 3 2 5
f 2 4 5
usemtl grey
f 4 1 5
usemtl blue
f 3 1 6
f 2 3 6
usemtl grey
f 4 2 6
f 1 4 6
"""


def test_in_urdf_the_file_of_a_mesh_has_its_materials(tmp_path: Path) -> None:
    hx.convert(lay(tmp_path, *TWO), tmp_path / "r.urdf")
    text = (tmp_path / "shapes" / "hull.obj").read_text()
    assert text.startswith("mtllib hull.mtl\n")
    assert text.endswith(OBJ)
    assert (tmp_path / "shapes" / "hull.mtl").read_text() == "newmtl grey\nKd 0.5 0.5 0.5\nnewmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n"
    hx.convert(tmp_path / "r.urdf", tmp_path / "back.usdc")
    out = Usd.Stage.Open(str(tmp_path / "back.usdc"))
    assert sorted(bound(out)["hull"].values()) == [([0, 3, 6, 7], "grey_2"), ([1, 2], "red_2"), ([4, 5], "blue_2")]
    assert [len(prim.GetAttribute("points").Get()) for prim in meshes(out)] == [6]


def test_two_looks_of_a_mesh_are_two_files_in_urdf(tmp_path: Path) -> None:
    robot = read_text(stage(*TWO))
    twin = {Id("shape", "twin"): robot.graph.edges[Id("shape", "hull")]}
    hx.dump(replace(robot, graph=robot.graph.replace(edges=twin)), tmp_path / "r.urdf", keep="inside")
    files = {path.name: path.read_text().count("usemtl") for path in (tmp_path / "shapes").glob("*.obj")}
    assert files == {"hull.obj": 5, "hull_2.obj": 0}


def test_in_mjcf_each_look_is_a_geom(tmp_path: Path) -> None:
    import mujoco

    for apis, collides in ((GREY, 0), (SOLID, 1)):
        hx.convert(lay(tmp_path, *TWO, apis=apis), tmp_path / "r.xml")
        model = mujoco.MjModel.from_xml_path(str(tmp_path / "r.xml"))
        seen = [geom for geom in range(model.ngeom) if not model.geom_contype[geom]]
        colours = {tuple(model.mat_rgba[model.geom_matid[geom]][:3]): model.mesh_facenum[model.geom_dataid[geom]] for geom in seen}
        assert colours == {(0.5, 0.5, 0.5): 4, (1, 0, 0): 2, (0, 0, 1): 2}
        solid = [model.mesh_facenum[model.geom_dataid[geom]] for geom in range(model.ngeom) if model.geom_contype[geom]]
        assert solid == [8] * collides


def test_hymeko_text_says_which_triangles_show_which_material() -> None:
    text = hx.dumps(read_text(stage(*TWO)), "hymeko")
    assert "@part : subset { + hull - red faces [1 2]" in text
    assert shown(hx.loads(text, "hymeko").mechanism) == {"part": ((1, 2), "red"), "tip": ((4, 5), "blue")}


BROKEN = """r : robot {
  red : material { rgba [1 0 0] }
  hull : mesh { vertices [0 0 0 1 0 0 0 1 0 0 0 1] faces [0 1 2 0 1 9] }
  a { mass 1 inertia [1 1 1] visual { mesh=hull name=v id "v" } shape { box [1 1 1] name=b id "b" } }
  @far : subset { + v - red faces [0 7 -1] }
  @flat : subset { + b - red faces [0] }
  @none : subset { + v - red }
}
"""


@pytest.mark.parametrize("format", ["urdf", "xacro", "mjcf", "usd"])
@pytest.mark.unread("HX203", "HX204")
def test_subsets_of_what_is_not_there_are_carried(format: str) -> None:
    robot = hx.loads(BROKEN, "hymeko").mechanism
    assert hx.diff(robot, hx.loads(hx.dumps(robot, format, keep="inside"), format).mechanism) == ()


# ---- real robots ------------------------------------------------------------------------------------------------------------------

PANDA = [file for file in development_files("urdf") if file.path.endswith("panda_bullet/panda.urdf")]


@pytest.mark.full
@pytest.mark.corpus
@pytest.mark.parametrize("robot", PANDA, ids=lambda file: file.id, indirect=True)
def test_a_real_robot_has_one_mesh_for_each_file(robot: Path, tmp_path: Path) -> None:
    hx.convert(robot, tmp_path / "r.usdc", keep="inside")
    source, out = hx.load(robot).mechanism, Usd.Stage.Open(str(tmp_path / "r.usdc"))
    assert len(meshes(out)) == sum(view.mesh is not None for views in source.shapes.values() for view in views)
    assert sum(prim.GetTypeName() == "GeomSubset" for prim in out.Traverse()) > 10
    assert set(families(out)) >= {"nonOverlapping"}
    assert complaints(tmp_path / "r.usdc") == []
    assert hx.diff(source, hx.load(tmp_path / "r.usdc").mechanism) == ()
    assert hx.verify(robot, tmp_path / "r.usdc", samples=5).is_same
