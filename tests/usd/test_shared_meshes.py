"""Two prims of one mesh: what each has of its own fits what it shares with the other."""

from __future__ import annotations

from pathlib import Path

import hymeko_x as hx
from tests.usd.test_read import body, robot

QUADS = """def Mesh "{name}" (prepend apiSchemas = ["PhysicsCollisionAPI"])
{{
    int[] faceVertexCounts = [4, 4]
    int[] faceVertexIndices = [0, 1, 2, 3, 3, 2, 1, 0]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0.5)]
    texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1), (0, 0.5), (1, 0.5), (1, 0), (0, 0)] (
        interpolation = "faceVarying"
    )
    uniform token subdivisionScheme = "none"
}}
"""


def test_texture_coordinates_of_quads_come_home_where_two_prims_share_them(tmp_path: Path) -> None:
    source = tmp_path / "r.usda"
    source.write_text(robot(body("a", QUADS.format(name="left")), body("b", QUADS.format(name="right"))))
    hx.convert(source, tmp_path / "r.urdf", keep="beside")
    hx.convert(tmp_path / "r.urdf", tmp_path / "back.usda")
    before, after = hx.load(source).mechanism, hx.load(tmp_path / "back.usda").mechanism
    assert len(list((tmp_path / "shapes").iterdir())) == 1
    assert [item for item in hx.diff(before, after) if item.field.startswith("tex")] == []
