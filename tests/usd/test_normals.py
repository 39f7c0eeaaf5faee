"""The normals of a mesh file reach a stage and come home from it, and those of a stage reach mesh files."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np
import pytest
from pxr import Usd, UsdGeom

import hymeko_x as hx
from hymeko_x.meshes.tables import read_mesh

if TYPE_CHECKING:
    from pathlib import Path

POINTS = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
NORMALS = "vn 0 0 -1\nvn 1 0 0\nvn 0 1 0\nvn 0 0.6 0.8\n"
OBJ = POINTS + NORMALS + "f 1//1 3//1 2//4\nf 1//2 2//2 4//2\nf 1//3 4//3 3//3\nf 2//4 3//4 4//1\n"
MAPPED = POINTS + "vt 0 0\nvt 1 0\n" + NORMALS + "f 1/1/1 3/2/1 2/1/4\nf 1/1/2 2/1/2 4/2/2\nf 1/1/3 4/2/3 3/2/2\nf 2/1/4 3/1/4 4/1/1\n"
MODEL = """<mujoco><asset><mesh name="m" file="m.obj"/></asset><worldbody><body name="b"><freejoint/>
<geom type="mesh" mesh="m"/></body></worldbody></mujoco>"""
ROBOT = """<robot name="r"><link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><mesh filename="m.obj"/></geometry></visual></link></robot>"""
STAGE = """#usda 1.0
(
    defaultPrim = "r"
    metersPerUnit = 1
    upAxis = "Z"
)
def Xform "r" (
    prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]
)
{
    float physics:mass = 1
    float3 physics:diagonalInertia = (1, 1, 1)
    def Mesh "skin"
    {
        point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0.5)]
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        normal3f[] normals = [(0, 0, 1), (0, 0.6, 0.8), (0, 0.8, 0.6), (0, 1, 0)] (
            interpolation = "vertex"
        )
        uniform token subdivisionScheme = "none"
    }
}
"""


def shading(file: Path) -> np.ndarray:
    """The normal of each corner of each triangle, as MuJoCo has it."""
    model = mujoco.MjModel.from_xml_path(str(file))
    return np.asarray(model.mesh_normal[model.mesh_facenormal.ravel()])


@pytest.mark.parametrize("obj", [OBJ, MAPPED])
@pytest.mark.parametrize(("home", "text"), [("r.xml", MODEL), ("r.urdf", ROBOT)])
def test_normals_of_a_file_come_home_from_a_stage(home: str, text: str, obj: str, tmp_path: Path) -> None:
    (tmp_path / "m.obj").write_text(obj, "utf-8")
    (tmp_path / home).write_text(text, "utf-8")
    (tmp_path / "there").mkdir()
    (tmp_path / "back").mkdir()
    hx.convert(tmp_path / home, tmp_path / "there" / "r.usda")
    stage = Usd.Stage.Open(str(tmp_path / "there" / "r.usda"))
    (mesh,) = [UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    normals = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("normals")
    assert normals.GetInterpolation() == "faceVarying"
    assert np.allclose(normals.ComputeFlattened()[2], (0, 0.6, 0.8))
    hx.convert(tmp_path / "there" / "r.usda", tmp_path / "back" / "r.xml")
    (tmp_path / "r.xml").write_text(MODEL, "utf-8")
    assert np.allclose(shading(tmp_path / "back" / "r.xml"), shading(tmp_path / "r.xml"), atol=1e-6)
    hx.convert(tmp_path / "there" / "r.usda", tmp_path / "there" / "r.hymeko")
    hx.convert(tmp_path / "there" / "r.hymeko", tmp_path / "back" / "r.usda")
    assert (tmp_path / "back" / "r.usda").read_text().count("primvars:normals:indices") == 1


@pytest.mark.parametrize("target", ["urdf", "sdf", "xml"])
def test_normals_of_a_stage_are_in_its_mesh_file(target: str, tmp_path: Path) -> None:
    (tmp_path / "r.usda").write_text(STAGE, "utf-8")
    hx.convert(tmp_path / "r.usda", tmp_path / f"r.{target}")
    (file,) = tmp_path.glob("*/*.obj")
    part = read_mesh(file.read_bytes(), ".obj")
    assert part is not None
    assert part.normals is not None
    assert part.normal_corners is not None
    assert np.allclose(part.normals[part.normal_corners[0]], [(0, 0, 1), (0, 0.6, 0.8), (0, 0.8, 0.6)])


def test_normals_are_read_as_mujoco_reads_them(tmp_path: Path) -> None:
    (tmp_path / "m.obj").write_text(OBJ, "utf-8")
    (tmp_path / "r.xml").write_text(MODEL, "utf-8")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "r.xml"))
    part = read_mesh(OBJ.replace("2//4 3//4", "2//-1 3//4").encode(), ".obj")
    assert part is not None
    assert part.normal_corners is not None
    assert part.normal_corners.tolist() == model.mesh_facenormal.tolist()
    partial = read_mesh(OBJ.replace("2//4 3//4", "2 3//4").encode(), ".obj")
    assert partial is not None
    assert partial.normals is None
