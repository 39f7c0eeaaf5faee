"""Poses that reading a stage computes from matrices are as a person would write them."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx

pytest.importorskip("pxr")

_STAGE = """#usda 1.0
(
    defaultPrim = "r"
    metersPerUnit = 1
    upAxis = "Z"
)
def Xform "r" (prepend apiSchemas = ["PhysicsArticulationRootAPI"])
{
    def Xform "arm" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"])
    {
        float physics:mass = 1
        quatd xformOp:orient = (0.8, 0.6, 0, 0)
        double3 xformOp:translate = (0.1, 0.2, 0.3)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:orient"]

        def Cube "box" (prepend apiSchemas = ["PhysicsCollisionAPI"])
        {
            double size = 0.1
            quatd xformOp:orient = (0, 1, 0, 0)
            double3 xformOp:translate = (0.07, -0.03, 0.09)
            uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:orient"]
        }
    }
}
"""


def test_a_shape_in_a_turned_body_has_the_numbers_of_the_stage(tmp_path: Path) -> None:
    file = tmp_path / "r.usda"
    file.write_text(_STAGE, "utf-8")
    (shape,) = hx.load(file).bodies["arm"].shapes
    assert (shape.pose.xyz, shape.pose.quat) == ((0.07, -0.03, 0.09), (0.0, 1.0, 0.0, 0.0))
