"""Normals of an OBJ file that contradict its triangles are reported, and written as they are."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

import hymeko_x as hx

if TYPE_CHECKING:
    from pathlib import Path

CORNERS = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
NORMALS = "vn 0 0 1\nvn 0 0 -1\n"
URDF = '<robot name="r"><link name="base"><{0}><geometry><mesh filename="a.obj"/></geometry></{0}></link></robot>'


@pytest.mark.parametrize(
    ("role", "faces", "found"),
    [
        (
            "visual",
            "f 1//2 2//2 3//2\n",
            ["mesh 'a': the normals in 'a.obj' contradict 1 of its 1 triangles; both are written as they are"],
        ),
        ("visual", "f 1//1 2//1 3//1\n", []),
        ("visual", "f 1//1 3//1 2//1\n" + 10 * "f 1//1 2//1 3//1\n", []),
        ("collision", "f 1//2 2//2 3//2\n", []),
    ],
)
def test_normals_on_the_other_side_are_noted(role: str, faces: str, found: list[str], tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text(CORNERS + NORMALS + faces)
    (tmp_path / "a.urdf").write_text(URDF.format(role))
    report = hx.convert(tmp_path / "a.urdf", tmp_path / "a.usda").report
    assert [diagnostic.message for diagnostic in report if diagnostic.code.id == "HX206"] == found
