"""Normals of COLLADA, glTF and PLY files arrive in MJCF and USD as the file has them, turned as its nodes are."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray
from pxr import Usd, UsdGeom

import hymeko_x as hx
from hymeko_x.meshes.change import changes
from hymeko_x.meshes.reader import read_colours, read_mapped, read_parts
from hymeko_x.meshes.submesh import Submesh
from hymeko_x.meshes.tables import read_mesh
from tests.meshes.test_mesh import nothing_else

Corners = tuple[NDArray[np.float64], NDArray[np.float64]]
"""The points and the normals at the corners of all triangles (n, 3)."""

BALL = trimesh.creation.icosphere(subdivisions=1, radius=0.1)
LEAN = np.array([0.05, 0.02, 0.0])
"""The normals of the files lean by this, so that none is one that a program computes."""
MIRRORED = np.array([[0.0, -2.0, 0.0, 1.0], [-1.0, 0.0, 0.0, 2.0], [0.0, 0.0, -1.0, 3.0], [0.0, 0.0, 0.0, 1.0]])
TURNED = np.array([[0.0, -2.0, 0.0, 1.0], [1.0, 0.0, 0.0, 2.0], [0.0, 0.0, 0.5, 3.0], [0.0, 0.0, 0.0, 1.0]])
ROBOT = """<robot name="r"><link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><mesh filename="{}"/></geometry></visual></link></robot>"""


def ball() -> trimesh.Trimesh:
    return trimesh.Trimesh(BALL.vertices, BALL.faces, vertex_normals=leaning(BALL.vertices), process=False)


def leaning(points: NDArray[np.float64]) -> NDArray[np.float64]:
    normals = points + LEAN
    return np.asarray(normals / np.linalg.norm(normals, axis=1, keepdims=True))


def collada(matrix: NDArray[np.float64]) -> bytes:
    text = ball().export(file_type="dae").decode()
    words = " ".join(map(str, matrix.ravel().tolist()))
    assert "NORMAL" in text
    assert "<instance_geometry" in text
    return text.replace("<instance_geometry", f"<matrix>{words}</matrix><instance_geometry").encode()


def unusual(matrix: NDArray[np.float64]) -> bytes:
    """COLLADA that the quick reader leaves to the general one."""
    return collada(matrix).replace(b"</matrix>", b"</matrix><skew>0 1 0 0 0 1 0</skew>")


def glb(matrix: NDArray[np.float64]) -> bytes:
    scene = trimesh.Scene()
    scene.add_geometry(ball(), transform=matrix)
    return bytes(scene.export(file_type="glb", include_normals=True))


def ply(matrix: NDArray[np.float64]) -> bytes:
    assert np.array_equal(matrix, np.eye(4))
    return bytes(ball().export(file_type="ply"))


CASES = [
    *((name, matrix, make) for name, make in (("a.dae", collada), ("a.glb", glb)) for matrix in (np.eye(4), TURNED, MIRRORED)),
    ("a.ply", np.eye(4), ply),
]


def corners_of_stage(file: Path) -> Corners:
    stage = Usd.Stage.Open(str(file))
    (mesh,) = [UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    points = np.array(mesh.GetPointsAttr().Get())[np.array(mesh.GetFaceVertexIndicesAttr().Get())]
    return points.astype(float), np.array(UsdGeom.PrimvarsAPI(mesh).GetPrimvar("normals").ComputeFlattened()).astype(float)


def corners_of_file(file: Path) -> Corners:
    (path,) = file.parent.glob("meshes/*.obj")
    return corners_of(read_mesh(path.read_bytes(), ".obj"))


def corners_of(part: Submesh | None) -> Corners:
    assert part is not None
    assert part.normals is not None
    rows = part.faces if part.normal_corners is None else part.normal_corners
    return part.points[part.faces].reshape(-1, 3), part.normals[rows].reshape(-1, 3)


def assert_leaning(found: Corners, matrix: NDArray[np.float64]) -> None:
    """Whether the normals at the points are those of the file, turned by the matrix as planes are."""
    points, normals = found
    assert len(points) == 3 * len(BALL.faces)
    own = (points - matrix[:3, 3]) @ np.linalg.inv(matrix[:3, :3]).T
    expected = leaning(own) @ np.linalg.inv(matrix[:3, :3])
    assert np.allclose(normals, expected / np.linalg.norm(expected, axis=1, keepdims=True), atol=2e-5)
    sides = points.reshape(-1, 3, 3)
    across = np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])
    assert (np.einsum("ij,ij->i", across, normals.reshape(-1, 3, 3).sum(axis=1)) > 0.0).all()


@pytest.mark.parametrize(("target", "seen"), [("r.xml", corners_of_file), ("r.usda", corners_of_stage)])
@pytest.mark.parametrize(("name", "matrix", "make"), CASES)
def test_normals_of_a_file_arrive(
    name: str,
    matrix: NDArray[np.float64],
    make: Callable[[NDArray[np.float64]], bytes],
    target: str,
    seen: Callable[[Path], Corners],
    tmp_path: Path,
) -> None:
    (tmp_path / name).write_bytes(make(matrix))
    (tmp_path / "r.urdf").write_text(ROBOT.format(name))
    result = hx.convert(tmp_path / "r.urdf", tmp_path / target)
    assert_leaning(seen(tmp_path / target), matrix)
    assert [str(loss) for loss in result.losses or () if "content" in str(loss)] == []


def test_the_general_reader_of_collada_has_normals_and_colours_too() -> None:
    data = unusual(np.eye(4))
    for part in (read_parts(data, ".dae", nothing_else)[0], read_mapped(data, ".dae", nothing_else)):
        assert_leaning(corners_of(part), np.eye(4))
    coloured = read_colours(data, ".dae", nothing_else)
    assert_leaning(corners_of(coloured.mesh), np.eye(4))


def test_normals_of_the_points_of_a_collada_file_are_those_of_its_corners() -> None:
    text = collada(np.eye(4)).decode()
    assert 'semantic="NORMAL"' in text
    text = text.replace('semantic="NORMAL"', 'semantic="COLOR"')
    text = text.replace("</vertices>", '<input semantic="NORMAL" source="#normals-array"/></vertices>')
    assert_leaning(corners_of(read_colours(text.encode(), ".dae", nothing_else).mesh), np.eye(4))


def test_normals_that_do_not_fit_are_left_out() -> None:
    text = collada(np.eye(4)).decode()
    start = text.index("<float_array", text.index("normal"))
    damaged = text[:start] + re.sub(r">[^<]*<", ">0 0<", text[start:], count=1)
    part = read_colours(damaged.encode(), ".dae", nothing_else).mesh
    assert (len(part.faces), part.normals) == (len(BALL.faces), None)


def test_lost_and_turned_normals_are_changes() -> None:
    part = read_mapped(ply(np.eye(4)), ".ply", nothing_else)
    assert part.normals is not None
    bare = Submesh(part.points, part.faces)
    turned = Submesh(part.points, part.faces, normals=part.normals[::-1], normal_corners=part.normal_corners)
    assert changes(part, part) == ()
    assert changes(bare, part) == ()
    assert [tuple(change) for change in changes(part, bare)] == [("normals", len(BALL.faces), 0)]
    ((name, before, after),) = changes(part, turned)
    assert (name, before) == ("turn of normals", 0.0)
    assert 1.0 < after < np.pi
