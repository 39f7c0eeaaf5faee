"""Meshes that a stage holds leave it as files, from which MuJoCo reads the same points, triangles and texture coordinates."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np
import pytest
import trimesh
from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics, Vt

import hymeko_x as hx
from tests.usd.stages import stage_with_body

if TYPE_CHECKING:
    from pathlib import Path

BALL = trimesh.creation.icosphere(subdivisions=3, radius=0.1)
POINTS = np.vstack([BALL.vertices, [[0.3, 0.3, 0.3]]]).astype(np.float32)
"""The last one is of no triangle; a hull counts it."""
PLACES = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (0.5, 0.25)]
SEAM = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0)]
"""The last point is where the first one is, at another place of the image."""
CORNERS = [0, 2, 1, 0, 1, 3, 4, 3, 2, 1, 2, 3, 0, 0, 1]
"""The last triangle is degenerate."""


def stage(folder: Path) -> Path:
    """A body with a hull of many points, and with a visual that has texture coordinates."""
    found = stage_with_body(folder)
    mass = UsdPhysics.MassAPI(found.GetPrimAtPath("/r/b"))
    mass.CreateDiagonalInertiaAttr((0.1, 0.1, 0.1))
    mass.CreatePrincipalAxesAttr(Gf.Quatf(1))
    ball = mesh(found, "/r/b/ball", Vt.Vec3fArray.FromNumpy(POINTS), BALL.faces.ravel().tolist())
    UsdPhysics.CollisionAPI.Apply(ball.GetPrim())
    UsdPhysics.MeshCollisionAPI.Apply(ball.GetPrim()).CreateApproximationAttr("convexHull")
    seen = UsdGeom.PrimvarsAPI(mesh(found, "/r/b/seen", SEAM, CORNERS))
    seen.CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, "vertex").Set(PLACES)
    found.Save()
    return folder / "r.usda"


def mesh(found: Usd.Stage, path: str, points: object, corners: list[int]) -> UsdGeom.Mesh:
    prim = UsdGeom.Mesh.Define(found, path)
    prim.CreatePointsAttr(points)
    prim.CreateFaceVertexIndicesAttr(corners)
    prim.CreateFaceVertexCountsAttr([3] * (len(corners) // 3))
    prim.CreateSubdivisionSchemeAttr("none")
    return prim


def test_mujoco_reads_what_the_stage_has(tmp_path: Path) -> None:
    source = stage(tmp_path / "home")
    (tmp_path / "away").mkdir()
    hx.convert(source, tmp_path / "away" / "r.xml")
    assert "vertex=" not in (tmp_path / "away" / "r.xml").read_text()
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "away" / "r.xml"))
    assert model.mesh_vertnum.tolist() == [len(POINTS), 5]
    assert model.mesh_face.tolist() == [*BALL.faces.tolist(), *np.reshape(CORNERS, (-1, 3)).tolist()]
    assert model.mesh_texcoord.tolist() == [[u, 1.0 - v] for u, v in PLACES]
    assert model.mesh_facetexcoord[len(BALL.faces) :].tolist() == np.reshape(CORNERS, (-1, 3)).tolist()
    hull = model.mesh_graph[model.mesh_graphadr[0] :]
    assert len(POINTS) - 1 in hull[2 + hull[0] : 2 + 2 * hull[0]].tolist()


@pytest.mark.parametrize("target", ["r.xml", "r.urdf"])
def test_that_points_have_become_a_file_is_no_loss_and_nothing_of_them_is_carried(target: str, tmp_path: Path) -> None:
    source = stage(tmp_path / "home")
    for folder in ("away", "back"):
        (tmp_path / folder).mkdir()
    result = hx.convert(source, tmp_path / "away" / target, keep="inside")
    assert [loss for loss in result.losses or () if loss.field in ("vertices", "faces", "texcoords", "texfaces", "uri")] == []
    assert (tmp_path / "away" / target).stat().st_size < 5000
    hx.convert(tmp_path / "away" / target, tmp_path / "back" / "r.usda", keep="inside")
    assert hx.diff(hx.load(source).mechanism, hx.load(tmp_path / "back" / "r.usda").mechanism) == ()
    assert hx.verify(source, tmp_path / "back" / "r.usda").verdict == "same"


def test_a_point_that_is_not_as_it_was_is_a_loss(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from hymeko_x.backends.mjcf import meshes

    written = meshes.obj_bytes
    monkeypatch.setattr(meshes, "obj_bytes", lambda part: written(part).replace(b"v 0.3", b"v 0.4"))
    source = stage(tmp_path / "home")
    result = hx.convert(source, tmp_path / "home" / "r.xml", keep="inside")
    assert {(loss.element, loss.field) for loss in result.losses or () if loss.element == "mesh 'ball'"} >= {("mesh 'ball'", "vertices")}


@pytest.mark.unread("HX204")
def test_on_standard_output_a_model_stands_alone(tmp_path: Path) -> None:
    text = hx.dumps(hx.load(stage(tmp_path / "home")), "mjcf", keep="inside")
    assert "ball" in text
    assert "ball.obj" not in text


# ---- one cause each, with the smallest stage ---------------------------------------------------------------------------------

SOLID = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
SIDES = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]


def compiled(folder: Path, points: object, corners: list[int], places: list[tuple[float, float]] | None = None) -> mujoco.MjModel:
    """The model that MuJoCo makes of a stage with a body that has one mesh, which collides by its hull."""
    found = stage_with_body(folder)
    shape = mesh(found, "/r/b/shape", points, corners)
    UsdPhysics.CollisionAPI.Apply(shape.GetPrim())
    UsdPhysics.MeshCollisionAPI.Apply(shape.GetPrim()).CreateApproximationAttr("convexHull")
    if places is not None:
        UsdGeom.PrimvarsAPI(shape).CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, "vertex").Set(places)
    found.Save()
    hx.convert(folder / "r.usda", folder / "r.xml")
    return mujoco.MjModel.from_xml_path(str(folder / "r.xml"))


def test_many_points_go_into_a_file_and_not_into_the_text(tmp_path: Path) -> None:
    model = compiled(tmp_path / "r", Vt.Vec3fArray.FromNumpy(BALL.vertices.astype(np.float32)), BALL.faces.ravel().tolist())
    assert model.nmeshvert == len(BALL.vertices)
    assert (tmp_path / "r" / "r.xml").stat().st_size < 2000


def test_texture_coordinates_reach_mujoco(tmp_path: Path) -> None:
    model = compiled(tmp_path / "r", SOLID, SIDES, PLACES[:4])
    assert model.mesh_texcoord.tolist() == [[u, 1.0 - v] for u, v in PLACES[:4]]
    assert model.mesh_facetexcoord.ravel().tolist() == SIDES


@pytest.mark.parametrize("places", [None, PLACES])
def test_a_point_of_no_triangle_is_in_the_hull(places: list[tuple[float, float]] | None, tmp_path: Path) -> None:
    model = compiled(tmp_path / "r", [*SOLID, (1, 1, 1)], SIDES, places)
    assert (model.nmeshvert, model.mesh_graph[0]) == (5, 5)


@pytest.mark.parametrize("places", [None, PLACES])
def test_points_at_one_place_stay_two_points(places: list[tuple[float, float]] | None, tmp_path: Path) -> None:
    corners = [*SIDES[:9], 1, 2, 4]
    model = compiled(tmp_path / "r", [*SOLID, SOLID[3]], corners, places)
    assert (model.nmeshvert, model.mesh_face.ravel().tolist()) == (5, corners)
