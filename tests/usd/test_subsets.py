"""Meshes with subsets: one mesh in several materials, out of USD and back, and as other formats say it."""

from __future__ import annotations

import hymeko_x as hx
from hymeko_x.diagnostics import Report
from hymeko_x.ir.mechanism import Id, Mechanism
from hymeko_x.ir.parts import Material, Mesh
from tests.usd.stages import HEADER, again, opened, parsed, read_text, written

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
            int[] faceVertexCounts = [3, 3, 3, 3]
            int[] faceVertexIndices = [0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2]
"""
POLYGONS = """
            int[] faceVertexCounts = [4, 3, 3]
            int[] faceVertexIndices = [0, 2, 1, 4, 0, 1, 3, 1, 2, 3]
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


def stage(*subsets: str, faces: str = TRIANGLES, api: str = "MaterialBindingAPI") -> str:
    """A body with a tetrahedron that is grey but for its subsets."""
    materials = "".join(
        MATERIAL.format(name=name, colour=colour) for name, colour in (("grey", "0.5, 0.5, 0.5"), ("red", "1, 0, 0"), ("blue", "0, 0, 1"))
    )
    return f"""{HEADER}
def Xform "robot"
{{{materials}
    def Xform "body" (
        prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]
    )
    {{
        float physics:mass = 2
        def Mesh "hull" (
            prepend apiSchemas = ["{api}"]
        )
        {{
            point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0.6, 0.6, 0)]{faces}
            uniform token subdivisionScheme = "none"
            uniform token subsetFamily:materialBind:familyType = "nonOverlapping"
            rel material:binding = </robot/grey>
            {"".join(subsets)}
        }}
    }}
}}
"""


TWO = (subset("1, 2"), subset("3", "blue", "tip"))


def shown(mechanism: Mechanism) -> dict[str, tuple[tuple[int, ...], str]]:
    """The triangles of each subset, and the material that they show."""
    return {view.id.name: (view.faces, view.material.name) for views in mechanism.subsets.values() for view in views}


def test_subsets_are_edges_and_nothing_of_them_is_left_over() -> None:
    robot = read_text(stage(*TWO))
    assert shown(robot) == {"part": ((1, 2), "red"), "tip": ((3,), "blue")}
    assert [extra.text for found in robot.extras.values() for extra in found] == []
