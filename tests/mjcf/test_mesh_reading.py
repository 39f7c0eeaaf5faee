"""Mesh files as MuJoCo reads them, proven with its own compiled model: points, triangles, texture coordinates."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

import mujoco
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import hymeko_x as hx
from hymeko_x.meshes.submesh import Unreadable
from hymeko_x.meshes.tables import read_mesh
from tests.meshes.real import cached_meshes

if TYPE_CHECKING:
    from pathlib import Path

TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
SIDES = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


def compiled(data: bytes, suffix: str) -> mujoco.MjModel | None:
    """MuJoCo's model of one mesh; None where it refuses the file."""
    mesh = f'<asset><mesh name="a" file="a{suffix}" inertia="shell"/></asset>'
    text = f'<mujoco>{mesh}<worldbody><geom type="mesh" mesh="a"/></worldbody></mujoco>'
    try:
        return mujoco.MjModel.from_xml_string(text, {f"a{suffix}": data})
    except ValueError:
        return None


def check(data: bytes, suffix: str) -> None:
    """MuJoCo and we read the same, where it reads the file."""
    model = compiled(data, suffix)
    if model is None:
        return
    part = read_mesh(data, suffix)
    assert part is not None
    assert model.mesh_face.tolist() == part.faces.tolist()
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.mesh_quat[0])
    points = model.mesh_vert @ turn.reshape(3, 3).T + model.mesh_pos[0]
    assert points.shape == part.points.shape
    assert np.abs(points - part.points).max() <= 2e-6 * np.abs(points).max()
    if model.mesh_texcoordnum[0]:
        assert part.uv is not None
        assert model.mesh_texcoord == pytest.approx(part.uv * (1, -1) + (0, 1), abs=1e-6, rel=1e-6)
        assert model.mesh_facetexcoord.tolist() == (part.faces if part.corners is None else part.corners).tolist()
    else:
        assert part.uv is None


@pytest.mark.parametrize(
    "text",
    [
        TETRAHEDRON + SIDES,
        TETRAHEDRON + "v 5 5 5\n" + SIDES,
        TETRAHEDRON + "v 0 0 0\n" + SIDES.replace("f 1 4 3", "f 5 4 3"),
        TETRAHEDRON + SIDES + "f 1 1 2\n",
        "o a\n" + TETRAHEDRON + SIDES + "o b\nv 2 0 0\nv 3 0 0\nv 2 1 0\nf 5 6 7\n",
        TETRAHEDRON + "g a\nf 1 3 2\nf 1 2 4\ng b\nf 1 4 3\nf 2 3 4\n",
        "g x\n" + TETRAHEDRON + "g a\n" + SIDES,
        TETRAHEDRON + "usemtl a\nf 1 3 2\nf 1 2 4\nusemtl b\nf 1 4 3\nf 2 3 4\n",
        TETRAHEDRON + "vt 0 0.25\nvt 1 0\nvt 0 1\nf 1/1 3/2 2/3\nf 1/1 2/2 4/3\nf 1/1 4/2 3/3\nf 2/1 3/2 4/3\n",
        TETRAHEDRON + "vt 0 0.25\nvt 1 0\nvt 0 1\nf 1/1 3/2 2/3\nf 1 2 4\nf 1/1 4/2 3/3\nf 2/1 3/2 4/3\n",
        TETRAHEDRON + "vn 0 0 1\nf 1//1 3//1 2//1\nf 1//1 2//1 4//1\nf 1//1 4//1 3//1\nf 2//1 3//1 4//1\n",
        TETRAHEDRON + "  f\t-4 -2 -3\n" + SIDES + "f 1 2\n",
        (TETRAHEDRON + SIDES).replace("\n", "\r\n"),
        TETRAHEDRON.replace("\n", " 1 0 0\n") + SIDES,
    ],
)
def test_an_obj_file_is_read_as_mujoco_reads_it(text: str) -> None:
    assert compiled(text.encode(), ".obj") is not None
    check(text.encode(), ".obj")


numbers = st.one_of(st.integers(-3, 3).map(float), st.floats(-10, 10, width=32).map(lambda x: round(x, 4)))


@st.composite
def objs(draw: st.DrawFn) -> str:
    """Files with concave, bent and tangled polygons, unused and double points, texture coordinates and several objects."""
    points = draw(st.lists(st.tuples(numbers, numbers, numbers), min_size=4, max_size=12))
    places = draw(st.lists(st.tuples(numbers, numbers), max_size=4))
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in points] + [f"vt {u!r} {v!r}" for u, v in places]
    for _ in range(draw(st.integers(2, 6))):
        lines += draw(st.sampled_from([[], [], [], [], ["o x"], ["g y"], ["usemtl z"]]))
        corners = draw(st.lists(st.integers(1, len(points)), min_size=3, max_size=9))
        has_places = bool(places) and draw(st.booleans())
        words = [f"{corner}/{draw(st.integers(1, len(places)))}" if has_places else str(corner) for corner in corners]
        lines.append("f " + " ".join(words))
    return "\n".join(lines) + "\n"


@given(objs())
def test_polygons_are_cut_as_mujoco_cuts_them(text: str) -> None:
    assume(compiled(text.encode(), ".obj") is not None)
    check(text.encode(), ".obj")


@given(st.lists(st.tuples(*(st.sampled_from([-1.0, -0.0, 0.0, 0.5, 1e-9, 2.0]),) * 9), min_size=4, max_size=12))
def test_equal_points_of_stl_become_one_as_in_mujoco(triangles: list[tuple[float, ...]]) -> None:
    faces = b"".join(struct.pack("<12fH", 0, 0, 0, *corners, 0) for corners in triangles)
    check(b"".ljust(80) + struct.pack("<I", len(triangles)) + faces, ".stl")


@pytest.mark.parametrize("places", [0, 4])
def test_msh_is_read_as_mujoco_reads_it(places: int) -> None:
    points, uv = np.eye(4, 3, -1, dtype="<f4"), np.linspace(0, 1, 8, dtype="<f4")[: 2 * places]
    faces = np.array([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3], dtype="<i4")
    check(struct.pack("<4i", 4, 0, places, 4) + points.tobytes() + uv.tobytes() + faces.tobytes(), ".msh")


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("v 0 0 0\n", "it has no triangles"),
        ("v 0 0 0\nf 1 2 3\n", "a face has a point that does not exist"),
        ("v 0 0 zero\nf 1 1 1\n", "a line is not understood (could not convert string to float: b'zero')"),
        ("v 0 0 0\nf 0 1 1\n", "a face has a point that does not exist"),
    ],
)
def test_damaged_files_are_refused_with_their_reason(text: str, reason: str) -> None:
    with pytest.raises(Unreadable) as refusal:
        read_mesh(text.encode(), ".obj")
    assert str(refusal.value) == reason


# ---- robots ------------------------------------------------------------------------------------------------------------------------

HEXAHEDRON = """v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 0.7\nv 0 1 1\nv 3 3 3
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"""
ROBOT = """<mujoco><asset><mesh name="a" file="a.obj"/></asset>
<worldbody><body><freejoint/><geom type="mesh" mesh="a"/></body></worldbody></mujoco>"""


@pytest.mark.parametrize("text", [HEXAHEDRON, "o a\n" + HEXAHEDRON + "o b\nf 9 3 7\nf 9 7 8\n"])
@pytest.mark.parametrize("through", ["usda", "urdf"])
def test_a_mesh_that_mujoco_cuts_keeps_its_mass_on_the_way(through: str, text: str, tmp_path: Path) -> None:
    (tmp_path / "home").mkdir()
    (tmp_path / "away").mkdir()
    (tmp_path / "home" / "a.obj").write_text(text)
    (tmp_path / "home" / "r.xml").write_text(ROBOT)
    hx.convert(tmp_path / "home" / "r.xml", tmp_path / "away" / f"r.{through}")
    hx.convert(tmp_path / "away" / f"r.{through}", tmp_path / "away" / "back.xml")
    before, after = (mujoco.MjModel.from_xml_path(str(path)) for path in (tmp_path / "home" / "r.xml", tmp_path / "away" / "back.xml"))
    assert after.body_mass.tolist() == pytest.approx(before.body_mass.tolist(), rel=1e-7)
    assert (after.mesh_vertnum.tolist(), after.mesh_face.tolist()) == (before.mesh_vertnum.tolist(), before.mesh_face.tolist())


@pytest.mark.corpus
@pytest.mark.parametrize("count", [60, pytest.param(1000, marks=pytest.mark.full)])
def test_meshes_of_real_robots_are_read_as_mujoco_reads_them(count: int) -> None:
    faults = []
    for path in cached_meshes((".obj", ".stl", ".msh"), count):
        data, suffix = path.read_bytes(), path.suffix.lower()
        try:
            check(data, suffix)
        except (AssertionError, Unreadable) as error:
            faults.append(f"{path}: {error}")
    assert faults == []


@pytest.mark.parametrize(
    ("text", "is_converted"),
    [
        (TETRAHEDRON + SIDES, False),
        (HEXAHEDRON.replace("0.7", "1"), False),
        (HEXAHEDRON, True),
        ("o a\n" + TETRAHEDRON + SIDES + "o b\nv 2 0 0\nv 3 0 0\nv 2 1 0\nf 5 6 7\n", True),
        ("v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nv 2 2 2\nf 5 4 3 2 1\nf 1 2 6\nf 2 3 6\nf 3 4 6\nf 4 5 6\nf 5 1 6\n", True),
    ],
)
def test_a_file_that_other_programs_read_otherwise_is_written_as_mujoco_reads_it(text: str, is_converted: bool, tmp_path: Path) -> None:
    (tmp_path / "home").mkdir()
    (tmp_path / "away").mkdir()
    (tmp_path / "home" / "a.obj").write_text(text)
    (tmp_path / "home" / "r.xml").write_text(ROBOT)
    result = hx.convert(tmp_path / "home" / "r.xml", tmp_path / "away" / "r.urdf")
    (mesh,) = (tmp_path / "away").rglob("*.obj")
    assert (mesh.read_text() != text) == is_converted
    assert any(item.code.id == "HX202" for item in result.report) == is_converted
    assert hx.verify(tmp_path / "home" / "r.xml", tmp_path / "away" / "r.urdf").is_same
