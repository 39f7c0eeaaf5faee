"""OBJ and STL files as the verifier reads them by itself, and as trimesh reads them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hymeko_x.verify.mesh_files import read_obj, read_stl
from hymeko_x.verify.meshes import _load_by_trimesh
from hymeko_x.verify.model import Surface

SQUARE = b"# a square\no square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\nvn 0 0 1\n"


def test_larger_faces_are_fans() -> None:
    found = read_obj(SQUARE + b"f 1//1 2//1 3//1 4//1\nf 4 3 2\n")
    assert found is not None
    assert found.faces.tolist() == [[0, 1, 2], [0, 2, 3], [3, 2, 1]]
    assert found.polygons
    assert found.vertices[3].tolist() == [0.0, 1.0, 0.5]


@pytest.mark.parametrize(
    "text",
    [
        SQUARE,
        SQUARE + b"f -1 -2 -3\n",
        SQUARE + b"f 1 2 9\n",
        SQUARE + b"f 0 1 2\n",
        SQUARE + b"f 1 2\n",
        SQUARE + b"f 1 2 \\\n3\n",
        SQUARE + b" f 1 2 3\n",
        SQUARE + b"v\t1 1 1\nf 1 2 3\n",
        SQUARE + b"v 1 1\nf 1 2 3\n",
        SQUARE + b"v 1 nan 1\nf 1 2 3\n",
        SQUARE + b"f 1 2 3 # one\n",
        b"",
    ],
)
def test_files_with_rare_or_broken_lines_are_left_to_trimesh(text: bytes) -> None:
    assert read_obj(text) is None


@pytest.mark.parametrize(
    "text",
    [
        "v 0 0 0\nv 1 .5 0\nv 0 1. +2\nf 1 2 3\n",
        "v  0 0 0\nv 1 0.5\t0 \nv 0 1e0 2\nf  1 2  3 \n",
        "v 0 0 0\nvn 0 0 1\nv 1 0.5 0\nvn 0 0 1\nv 0 1 2\n\nf 1 2 3",
        "#\nv 0 0 0\nv 1 0.5 0\nf 1 2 3\ng other\nv 0 1 2\n",
        "v 0 0 0 1 1 1\r\nv 1 0.5 0 1 1 1\r\nv 0 1 2 1 1 1\r\nf 1/1 2/2 3/3\r\n",
    ],
)
def test_numbers_and_lines_may_be_written_in_several_ways(text: str) -> None:
    found = read_obj(text.encode())
    assert found is not None
    assert found.vertices.tolist() == [[0.0, 0.0, 0.0], [1.0, 0.5, 0.0], [0.0, 1.0, 2.0]]
    assert found.faces.tolist() == [[0, 1, 2]]


COORDINATE = st.floats(-10, 10, width=32)


@settings(deadline=None)  # the first one imports trimesh
@given(
    st.lists(st.tuples(COORDINATE, COORDINATE, COORDINATE), min_size=4, max_size=8),
    st.lists(st.permutations([1, 2, 3, 4]), min_size=1, max_size=6),
    st.sampled_from(["{0}", "{0}//1", "{0}/1/1"]),
    st.sampled_from(["\n", "\r\n"]),
)
def test_triangles_are_those_that_trimesh_reads(
    points: list[tuple[float, float, float]], faces: list[list[int]], corner: str, end: str
) -> None:
    lines = [*(f"v {x!r} {y!r} {z!r}" for x, y, z in points), "vt 0 0", "vn 0 0 1"]
    lines += [f"f {' '.join(corner.format(number) for number in face[:3])}" for face in faces]
    data = end.join([*lines, ""]).encode()
    found = read_obj(data)
    assert found is not None
    expected = by_trimesh(data, "obj")
    assert np.allclose(found.vertices[found.faces], expected.vertices[expected.faces])


def by_trimesh(data: bytes, kind: str) -> Surface:
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"mesh.{kind}"
        path.write_bytes(data)
        found = _load_by_trimesh(path)
    assert isinstance(found, Surface)
    return found


def stl(corners: np.ndarray) -> bytes:
    facets = b"".join(bytes(12) + triangle.astype("<f4").tobytes() + bytes(2) for triangle in corners)
    return bytes(80) + len(corners).to_bytes(4, "little") + facets


def test_a_binary_stl_file_is_read_as_trimesh_reads_it() -> None:
    corners = np.random.default_rng(0).normal(size=(20, 3, 3))
    found, expected = read_stl(stl(corners)), by_trimesh(stl(corners), "stl")
    assert found is not None
    assert np.array_equal(found.vertices[found.faces], expected.vertices[expected.faces])


def test_other_stl_files_are_left_to_trimesh() -> None:
    whole = stl(np.ones((2, 3, 3)))
    for data in (whole[:-1], whole + b"x", stl(np.full((1, 3, 3), np.inf)), stl(np.ones((0, 3, 3))), b"solid a\nendsolid a\n"):
        assert read_stl(data) is None


def test_verifying_urdf_leaves_trimesh_alone_and_yourdfpy_whole(tmp_path: Path) -> None:
    box = '<link name="a"><visual><geometry><box size="1 1 1"/></geometry></visual></link>'
    (tmp_path / "a.urdf").write_text(f'<robot name="r">{box}</robot>')
    program = (
        "import sys, hymeko_x as hx; print(hx.verify('a.urdf', 'a.urdf').verdict, 'trimesh' in sys.modules); import yourdfpy;"
        "print(yourdfpy.URDF.load('a.urdf').scene.bounds.tolist(), 'trimesh' in sys.modules)"
    )
    run = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert run.stdout.splitlines() == ["same False", "[[-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]] True"]
