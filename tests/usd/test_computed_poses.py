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


_PAIR = """#usda 1.0
(
    defaultPrim = "r"
    metersPerUnit = 1
    upAxis = "Z"
)
def Xform "r" (prepend apiSchemas = ["PhysicsArticulationRootAPI"])
{
    def Xform "cart" (prepend apiSchemas = ["PhysicsRigidBodyAPI"])
    {
        def Cube "box" (prepend apiSchemas = ["PhysicsCollisionAPI"])
        {
            double size = 0.2
        }
    }
    def Xform "pole" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"])
    {
        float physics:mass = 1
        float3 physics:diagonalInertia = (1, 1, 1)
    }
    def PhysicsRevoluteJoint "hinge"
    {
        uniform token physics:axis = "X"
        rel physics:body0 = </r/cart>
        rel physics:body1 = </r/pole>
        point3f physics:localPos0 = (0.3, 0, 0)
        point3f physics:localPos1 = (0.1, 0, 0)
        quatf physics:localRot0 = (0.70710677, 0, 0, 0.70710677)
        quatf physics:localRot1 = (0.70710677, 0, 0, 0.70710677)
    }
}
"""


def test_a_body_behind_a_turned_joint_has_no_noise_in_mjcf(tmp_path: Path) -> None:
    (tmp_path / "r.usda").write_text(_PAIR, "utf-8")
    hx.convert(tmp_path / "r.usda", tmp_path / "r.xml")
    text = (tmp_path / "r.xml").read_text("utf-8")
    assert '<body name="pole" pos="0.2 0 0">' in text
    assert '<joint name="hinge" axis="0 1 0" pos="0.1 0 0"/>' in text


def test_a_mass_that_a_collider_gives_has_no_noise(tmp_path: Path) -> None:
    (tmp_path / "r.usda").write_text(_PAIR, "utf-8")
    body = hx.load(tmp_path / "r.usda").bodies["cart"]
    assert (body.mass, body.tensor) == (8.0, (0.0533333333333333, 0.0533333333333333, 0.0533333333333333, 0.0, 0.0, 0.0))
