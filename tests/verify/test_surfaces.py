"""Mesh files are read once for each content, and compared once for each place."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Usd, UsdGeom

import hymeko_x as hx
from hymeko_x import verify
from hymeko_x.verify import meshes as surfaces
from hymeko_x.verify.meshes import Meshes, mesh_distance
from hymeko_x.verify.model import MeshFile, Role, Shape, Surface

TETRAHEDRON = """solid t
facet normal 0 0 0
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 0
endloop
endfacet
facet normal 0 0 0
outer loop
vertex 0 0 0
vertex 0 1 0
vertex 0 0 {}
endloop
endfacet
endsolid t
"""


def mesh(path: Path, height: float) -> Path:
    path.parent.mkdir(exist_ok=True)
    path.write_text(TETRAHEDRON.format(height))
    return path


def test_a_copy_of_a_mesh_is_not_read_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    load, read = surfaces._load, []
    monkeypatch.setattr(surfaces, "_load", lambda path: read.append(path.name) or load(path))
    paths = [mesh(tmp_path / "a.stl", 1.0), mesh(tmp_path / "copy" / "b.stl", 1.0), mesh(tmp_path / "c.stl", 2.0)]
    meshes = Meshes()
    found = [meshes.surface(MeshFile(path.name, path)) for path in (*paths, *paths)]
    assert read == ["a.stl", "c.stl"]
    assert [float(item.vertices[:, 2].max()) for item in found if isinstance(item, Surface)] == [1.0, 1.0, 2.0] * 2


def test_the_same_bytes_of_another_kind_are_another_mesh(tmp_path: Path) -> None:
    stl, obj = mesh(tmp_path / "a.stl", 1.0), mesh(tmp_path / "a.obj", 1.0)
    meshes = Meshes()
    assert isinstance(meshes.surface(MeshFile("a.stl", stl)), Surface)
    assert meshes.surface(MeshFile("a.obj", obj)) == "the mesh 'a.obj' holds no triangles"


def test_a_mesh_has_every_scale_that_is_asked_for(tmp_path: Path) -> None:
    path = mesh(tmp_path / "a.stl", 1.0)
    meshes = Meshes()
    sizes = [meshes.surface(MeshFile("a.stl", path, (scale, 1.0, 1.0))) for scale in (1.0, 3.0)]
    assert [float(item.vertices[:, 0].max()) for item in sizes if isinstance(item, Surface)] == [1.0, 3.0]


def test_a_mesh_that_cannot_be_opened_is_a_reason(tmp_path: Path) -> None:
    words = Meshes().surface(MeshFile("a.stl", tmp_path))
    assert isinstance(words, str)
    assert words.startswith(f"the mesh '{tmp_path.name}' cannot be read: ")


GLTF = """{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes":
{"POSITION": 0}}]}], "accessors": [{"componentType": 5126, "type": "VEC3", "count": COUNT}]}"""


@pytest.mark.parametrize(("count", "reason"), [(900_000_000, "it has 900000000 elements without data, at most 60000000 are read"), (3, "")])
def test_a_gltf_file_without_data_is_a_reason(count: int, reason: str, tmp_path: Path) -> None:
    (tmp_path / "a.gltf").write_text(GLTF.replace("COUNT", str(count)))
    words = Meshes().surface(MeshFile("a.gltf", tmp_path / "a.gltf"))
    assert isinstance(words, str)
    assert words.startswith(f"the mesh 'a.gltf' cannot be read: {reason}")


def test_faces_of_any_number_of_corners_become_fans_of_triangles(tmp_path: Path) -> None:
    stage = Usd.Stage.CreateNew(str(tmp_path / "faces.usda"))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    faces = UsdGeom.Mesh.Define(stage, "/mesh")
    faces.CreatePointsAttr([(float(x), float(x * x), 0.0) for x in range(9)])
    faces.CreateFaceVertexCountsAttr([3, 5, 2, 4])
    faces.CreateFaceVertexIndicesAttr([0, 1, 2, 3, 4, 5, 6, 7, 0, 8, 5, 6, 7, 8])
    stage.Save()
    world = verify.model_of(tmp_path / "faces.usda").bodies[0]
    surface = world.shapes[0].mesh
    assert isinstance(surface, Surface)
    expected = [(0, 1, 2), (3, 4, 5), (3, 5, 6), (3, 6, 7), (5, 6, 7), (5, 7, 8)]
    assert np.array_equal(surface.faces, expected)


def test_faces_that_each_reader_splits_otherwise_are_the_same_mesh_and_a_moved_corner_is_found(tmp_path: Path) -> None:
    bent = "v 0 0 0\nv 1 0 0\nv 1 1 0.1\nv 0 1 0\nv 0.5 0.5 1\nf {}\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n"
    link = '<robot name="r"><link name="a"><visual><geometry><mesh filename="{}.obj"/></geometry></visual></link></robot>'
    for name, text in (
        ("a", bent.format("4 3 2 1")),
        ("b", bent.format("3 2 1 4")),
        ("c", bent.replace("1 1 0.1", "1 1 0.11").format("3 2 1 4")),
    ):
        (tmp_path / f"{name}.obj").write_text(text)
        (tmp_path / f"{name}.urdf").write_text(link.format(name))
    assert hx.verify(tmp_path / "a.urdf", tmp_path / "b.urdf").is_same
    assert [check.quantity for check in hx.verify(tmp_path / "a.urdf", tmp_path / "c.urdf").failed] == ["visual meshes"]


def test_files_of_the_same_bytes_at_the_same_pose_are_the_same_mesh(tmp_path: Path) -> None:
    def placed(path: Path, at: float = 0.0, scale: float = 1.0) -> list[Shape]:
        pose = np.eye(4)
        pose[0, 3] = at
        return [Shape(kind="mesh", size=(), pose=pose, role=Role.BOTH, mesh=MeshFile(path.name, path, (scale, 1.0, 1.0)))]

    own, copy, other = mesh(tmp_path / "a.stl", 1.0), mesh(tmp_path / "copy" / "b.stl", 1.0), mesh(tmp_path / "c.stl", 2.0)
    meshes = Meshes()
    assert meshes.are_placed_alike(placed(own), placed(copy))
    assert not meshes.are_placed_alike(placed(own), placed(other))
    assert not meshes.are_placed_alike(placed(own), placed(copy, at=1e-9))
    assert not meshes.are_placed_alike(placed(own), placed(copy, scale=2.0))
    assert not meshes.are_placed_alike(placed(own), placed(copy) * 2)
    assert not meshes.are_placed_alike(placed(tmp_path / "lost.stl"), placed(tmp_path / "lost.stl"))
    assert not Meshes(read=False).are_placed_alike(placed(own), placed(copy))
    assert mesh_distance(placed(own), placed(copy, at=1e-3), meshes)[:2] == (pytest.approx(1e-3), "the points of the meshes")
