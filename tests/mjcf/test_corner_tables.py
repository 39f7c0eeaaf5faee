"""Normals and texture coordinates of meshes that only MuJoCo has in their places: .msh files, moved meshes, those of the text."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

import hymeko_x as hx

POINTS = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], "<f4")
FACES = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)], "<i4")
PLACES = np.array([(0, 0), (1, 0), (0, 0.75), (1, 1)], "<f4")
NORMALS = np.array([(0, 0, -1), (1, 0, 0), (0, 1, 0), (0.6, 0, 0.8)], "<f4")
MSH = b"".join(table.tobytes() for table in (np.array([4, 4, 4, 4], "<i4"), POINTS, NORMALS, PLACES, FACES))
OBJ = "".join(
    f"{word} {' '.join(map(str, row))}\n" for word, table in (("v", POINTS), ("vt", PLACES), ("vn", NORMALS)) for row in table
) + "".join(f"f {' '.join(f'{corner + 1}/{corner + 1}/{corner + 1}' for corner in face)}\n" for face in FACES.tolist())
MOVED = 'refpos="1 2 3" refquat="0.5 0.5 -0.5 0.5"'


def text_of(**tables: NDArray[np.generic]) -> str:
    return " ".join(f'{name}="{" ".join(map(str, table.ravel()))}"' for name, table in tables.items())


def corners(path: Path) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The normals in the world frame, and the texture coordinates, of all corners of the one mesh as MuJoCo reads it."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    turn = data.geom_xmat[0].reshape(3, 3)
    return model.mesh_normal[model.mesh_facenormal] @ turn.T, model.mesh_texcoord[model.mesh_facetexcoord]


@pytest.mark.unread("HX112")
@pytest.mark.parametrize(
    "mesh",
    [
        'file="m.msh"',
        f'file="m.msh" {MOVED}',
        f'file="m.obj" {MOVED}',
        text_of(vertex=POINTS, face=FACES, normal=NORMALS, texcoord=PLACES),
        text_of(vertex=POINTS, face=FACES, normal=NORMALS, texcoord=PLACES) + ' scale="1 2 3"',
    ],
    ids=["msh", "moved msh", "moved obj", "text", "scaled text"],
)
def test_normals_and_texture_coordinates_come_back_from_a_stage(mesh: str, tmp_path: Path) -> None:
    (tmp_path / "m.msh").write_bytes(MSH)
    (tmp_path / "m.obj").write_text(OBJ)
    body = '<body name="b"><geom type="mesh" mesh="m" pos="1 0 0" euler="10 20 30"/></body>'
    (tmp_path / "a.xml").write_text(f'<mujoco><asset><mesh name="m" {mesh}/></asset><worldbody>{body}</worldbody></mujoco>')
    hx.convert(tmp_path / "a.xml", tmp_path / "a.usda")
    hx.convert(tmp_path / "a.usda", tmp_path / "b.xml")
    before, after = corners(tmp_path / "a.xml"), corners(tmp_path / "b.xml")
    np.testing.assert_allclose(after[0], before[0], atol=1e-6)
    np.testing.assert_allclose(after[1], before[1], atol=1e-6)


def test_normals_that_mujoco_computes_are_not_written(tmp_path: Path) -> None:
    bare = np.array([4, 0, 0, 4], "<i4").tobytes() + POINTS.tobytes() + FACES.tobytes()
    (tmp_path / "m.msh").write_bytes(bare)
    body = '<body name="b"><geom type="mesh" mesh="m"/></body>'
    (tmp_path / "a.xml").write_text(f'<mujoco><asset><mesh name="m" file="m.msh"/></asset><worldbody>{body}</worldbody></mujoco>')
    hx.convert(tmp_path / "a.xml", tmp_path / "a.usda")
    assert "primvars:normals" not in (tmp_path / "a.usda").read_text()
