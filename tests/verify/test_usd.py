"""The same arm in USD: same as in URDF, in whatever units the stage has, and different when something was changed."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from msgspec import Struct
from pxr import Gf, Sdf, Usd, UsdPhysics

from hymeko_x.verify import model_of, verify
from hymeko_x.verify.model import KinematicModel
from hymeko_x.verify.readers.usd.scene import unit_axes
from tests.usd.stages import HEADER
from tests.verify.robots import ARM_MJCF, ARM_URDF, RIG_MJCF
from tests.verify.usd_writer import usd_of

Write = Callable[[str, str], Path]

POSITION, ROTATION = "forward kinematics, position", "forward kinematics, rotation"
TURNED = Gf.Quatf(0.9238795, 0.0, 0.3826834, 0.0)


class Planted(Struct, frozen=True):
    """One attribute of one prim set to another value, and who must see it where."""

    what: str
    prim: str
    attribute: str
    to: object
    check: str
    at: str

    def apply(self, text: str) -> str:
        layer = Sdf.Layer.CreateAnonymous(".usda")
        layer.ImportFromString(text)
        stage = Usd.Stage.Open(layer)
        prim = stage.GetPrimAtPath(f"/robot/{self.prim}")
        assert prim, self.prim
        if self.attribute == "active":
            prim.SetActive(self.to)
        elif self.attribute in ("physics:body0", "physics:body1", "newton:mimicJoint"):
            prim.GetRelationship(self.attribute).SetTargets([f"/robot/{self.to}"] if self.to else [])
        elif self.attribute == "type":
            prim.SetTypeName(self.to)
        elif self.attribute == "api":
            prim.RemoveAPI(self.to)
        else:
            attribute = prim.GetAttribute(self.attribute)
            assert attribute, self.attribute
            assert attribute.Get() != self.to
            attribute.Set(self.to)
        return str(layer.ExportToString())


CHANGES = [
    Planted("axis token", "joints/shoulder", "physics:axis", "X", ROTATION, "body 'upper'"),
    Planted("local rotation 0", "joints/shoulder", "physics:localRot0", TURNED, ROTATION, "body 'upper'"),
    Planted("local rotation 1 dropped", "joints/elbow", "physics:localRot1", Gf.Quatf(1), ROTATION, "body 'fore'"),
    Planted("local position 0 by 1e-5 m", "joints/elbow", "physics:localPos0", Gf.Vec3f(0, 0.03001, 0.3), POSITION, "body 'fore'"),
    Planted("local position 1", "joints/rail", "physics:localPos1", Gf.Vec3f(0, 0, 0.001), POSITION, "body 'hand'"),
    Planted("quaternion order", "joints/tool_mount", "physics:localRot0", Gf.Quatf(0, 0, 0.247404, 0.968912), ROTATION, "body 'tool'"),
    Planted("bodies swapped", "joints/elbow", "physics:body0", "base", "joints", "body 'fore'"),
    Planted("another parent", "joints/left_slide", "physics:body0", "slider", "joints", "body 'left'"),
    Planted("anchored to the world", "joints/shoulder", "physics:body0", None, "joints", "body 'upper'"),
    Planted("revolute made prismatic", "joints/elbow", "type", "PhysicsPrismaticJoint", "joints", "elbow"),
    Planted("revolute made spherical", "joints/roll", "type", "PhysicsSphericalJoint", "joints", "roll"),
    Planted("slide made fixed", "joints/rail", "type", "PhysicsFixedJoint", "joints", "rail"),
    Planted("joint dropped", "joints/roll", "active", False, "joints", "body 'slider'"),
    Planted("joint switched off", "joints/roll", "physics:jointEnabled", False, "joints", "body 'slider'"),
    Planted("joint made a loop", "joints/roll", "physics:excludeFromArticulation", True, "loops", "roll"),
    Planted("body dropped", "tool", "active", False, "bodies", "body 'tool'"),
    Planted("limits in radians", "joints/shoulder", "physics:upperLimit", 2.5, "position limits", "shoulder"),
    Planted("limit by 0.001 degrees", "joints/elbow", "physics:lowerLimit", -85.9447, "position limits", "elbow"),
    Planted("limit dropped", "joints/elbow", "physics:lowerLimit", float("-inf"), "position limits", "elbow"),
    Planted("mass", "upper", "physics:mass", 2.0001, "mass", "body 'upper'"),
    Planted("mass not authored", "upper", "physics:mass", 0.0, "mass", "body 'upper'"),
    Planted("centre by 1e-6 m", "hand", "physics:centerOfMass", Gf.Vec3f(0, 1e-6, 0.03), "centre of mass", "body 'hand'"),
    Planted("principal axes dropped", "fore", "physics:principalAxes", Gf.Quatf(1), "inertia tensor", "body 'fore'"),
    Planted("diagonal permuted", "hand", "physics:diagonalInertia", Gf.Vec3f(4e-4, 3e-4, 2e-4), "inertia tensor", "body 'hand'"),
    Planted("cube's size", "hand/shape_0", "size", 2.0, "collision shapes, size and pose", "body 'hand'"),
    Planted("cylinder's height", "upper/shape_0", "height", 0.31, "visual shapes, size and pose", "body 'upper'"),
    Planted("cylinder's axis", "upper/shape_1", "axis", "X", "collision shapes, size and pose", "body 'upper'"),
    Planted("scale of a shape", "fore/shape_0", "xformOp:scale", Gf.Vec3f(0.06, 0.2, 0.04), "visual shapes, size and pose", "body 'fore'"),
    Planted("shape moved", "fore/shape_1", "xformOp:translate", Gf.Vec3d(0.1, 0, 1e-5), "collision shapes, size and pose", "body 'fore'"),
    Planted("collides no more", "fore/shape_1", "api", UsdPhysics.CollisionAPI, "collision shapes", "body 'fore'"),
    Planted("mimic's multiplier", "joints/right_slide", "newton:mimicCoef1", -2.0, "coupled coordinates", "right_slide"),
    Planted("mimic's offset", "joints/right_slide", "newton:mimicCoef0", 0.00501, "coupled coordinates", "right_slide"),
    Planted("mimics another joint", "joints/right_slide", "newton:mimicJoint", "joints/rail", "coupled coordinates", "right_slide"),
    Planted("mimics nothing", "joints/right_slide", "newton:mimicJoint", None, "couplings", "right_slide"),
]


@pytest.fixture
def arm(written: Write) -> KinematicModel:
    return model_of(written("urdf", ARM_URDF))


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change.what)
def test_a_change_in_a_stage_is_found_where_it_is(change: Planted, arm: KinematicModel, written: Write) -> None:
    verdict = verify(arm, written("usd", change.apply(usd_of(arm))), samples=20)
    assert verdict.verdict == "different"
    failed = {check.quantity: check.at for check in verdict.failed}
    assert change.check in failed
    assert change.at in failed[change.check]


def test_another_unit_of_length_is_another_robot(arm: KinematicModel, written: Write) -> None:
    text = usd_of(arm).replace("metersPerUnit = 1", "metersPerUnit = 0.01")
    verdict = verify(arm, written("usd", text), samples=20)
    assert {"forward kinematics, position", "centre of mass"} <= {check.quantity for check in verdict.failed}


@pytest.mark.parametrize(("metres", "kilograms"), [(1.0, 1.0), (0.01, 1.0), (0.001, 0.001)])
def test_an_arm_is_the_same_in_usd_in_any_units(metres: float, kilograms: float, arm: KinematicModel, written: Write) -> None:
    verdict = verify(arm, written("usd", usd_of(arm, metres=metres, kilograms=kilograms)))
    assert [f"{check.quantity} at {check.at}" for check in verdict.failed] == []
    assert verdict.is_same


def test_a_fixed_base_and_a_falling_one_are_different(arm: KinematicModel, written: Write) -> None:
    verdict = verify(written("mjcf", ARM_MJCF), written("usd", usd_of(arm)))
    assert [(check.quantity, check.at) for check in verdict.failed] == [("base", "body 'base' is fixed, and free in the other")]


def test_a_robot_with_renamed_elements_is_the_same_by_structure(written: Write) -> None:
    for name in ("base", "upper", "fore", "slider", "hand", "shoulder", "elbow", "roll", "left_slide"):
        assert f'"{name}"' in ARM_URDF
    renamed = ARM_URDF
    for name in ("upper", "fore", "slider", "hand", "left_slide"):
        renamed = renamed.replace(f'"{name}"', f'"x_{name}"')
    files = written("urdf", ARM_URDF), written("urdf", renamed)
    assert verify(*files).verdict == "different"
    assert verify(*files, structure=True).is_same


def test_structure_finds_the_change_in_a_renamed_robot(written: Write) -> None:
    renamed = RIG_MJCF.replace('"crank', '"k').replace('"rod', '"r').replace('pos="0.1 0 0"', 'pos="0.11 0 0"')
    verdict = verify(written("mjcf", RIG_MJCF), written("mjcf", renamed), structure=True)
    assert verdict.verdict == "different"
    assert any(check.quantity == POSITION and "body 'rod'" in check.at for check in verdict.failed)


def test_several_joints_between_two_bodies_are_the_joints_of_one_body(written: Write) -> None:
    """One joint prim per dof, in the order of the file, each with its own frames at the same pose of rest."""
    outer = '<body name="a"><freejoint/><geom size="0.1" group="3"/>BODY</body>'
    text = f'<mujoco><compiler angle="radian"/><worldbody>{outer}</worldbody></mujoco>'
    hinges = '<joint name="x" axis="1 0 0" pos="0 0 0.02"/><joint name="y" axis="0 1 0" pos="0 0.1 0"/><joint name="z" axis="0 0 1"/>'
    inner = (
        f'<body name="b" pos="0.1 0.2 0.3" euler="0.1 0.2 0.3">{hinges}<inertial pos="0 0 0.1" mass="1" diaginertia="0.1 0.2 0.2"/></body>'
    )
    model = model_of(written("mjcf", text.replace("BODY", inner)))
    verdict = verify(model, written("usd", usd_of(model)), samples=20)
    assert [f"{check.quantity} at {check.at}" for check in verdict.failed] == []
    other = model_of(written("mjcf", text.replace("BODY", inner.replace('pos="0 0.1 0"', 'pos="0.01 0.1 0"'))))
    assert POSITION in {check.quantity for check in verify(model, written("usd", usd_of(other)), samples=20).failed}


WORLD_AND_ARM = (
    HEADER
    + """def Xform "robot"
{
    def Xform "world" (prepend apiSchemas = ["PhysicsRigidBodyAPI"])
    {
    }
    def Xform "arm" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI", "NewtonMassAPI"])
    {
        float physics:mass = 1
        double[] newton:inertia = [0.01, 0, 0.01, 0, 0.002, 0]
    }
    def PhysicsFixedJoint "held"
    {
        rel physics:body1 = </robot/world>
    }
    def PhysicsRevoluteJoint "turn"
    {
        rel physics:body0 = </robot/world>
        rel physics:body1 = </robot/arm>
    }
}
"""
)
WORLD_AND_ARM_URDF = """<robot name="robot"><link name="world"/>
  <link name="arm"><inertial><mass value="1"/><inertia ixx="0.01" ixy="0" ixz="0.002" iyy="0" iyz="0" izz="0.01"/></inertial></link>
  <joint name="turn" type="continuous"><parent link="world"/><child link="arm"/><axis xyz="1 0 0"/></joint></robot>"""


def failed(written: Write, stage: str) -> list[str]:
    found = verify(written("urdf", WORLD_AND_ARM_URDF), written("usd", stage))
    assert found.checks
    return [check.quantity for check in found.failed]


def test_a_body_called_world_without_mass_that_is_fixed_there_is_the_world(written: Write) -> None:
    assert failed(written, WORLD_AND_ARM) == []
    assert failed(written, WORLD_AND_ARM.replace("PhysicsFixedJoint", "PhysicsPrismaticJoint")) != []
    assert failed(written, WORLD_AND_ARM.replace('"held"\n    {', '"held"\n    {\n        point3f physics:localPos0 = (0, 0, 1)')) != []


def test_a_tensor_without_principal_moments_is_that_of_newton(written: Write) -> None:
    assert failed(written, WORLD_AND_ARM.replace("0.01, 0, 0.01", "0.01, 0.001, 0.01")) == ["inertia tensor"]
    assert "inertia tensor" in failed(written, WORLD_AND_ARM.replace("double[] newton:inertia", "double[] other:inertia"))


LOOP = """    def PhysicsRevoluteJoint "again"
    {
        rel physics:body0 = </robot/world>
        rel physics:body1 = </robot/arm>
        point3f physics:localPos0 = (0.1, 0, 0)
        point3f physics:localPos1 = (0.1, 0, 0)
        bool physics:excludeFromArticulation = true
    }
"""
POINTS = """<mujoco><worldbody><body name="arm"><joint name="turn" axis="1 0 0"/>
  <inertial mass="1" pos="0 0 0" fullinertia="0.01 0.01 0.01 0 0.002 0"/></body></worldbody>
  <equality><connect name="again" body1="arm" anchor="0.1 0 0"/><connect body1="arm" anchor="0.3 0 0"/></equality></mujoco>"""


def test_two_points_that_stay_together_are_a_hinge(written: Write) -> None:
    stage = written("usd", (WORLD_AND_ARM.rstrip()[:-1] + LOOP + "}\n").replace("0.01, 0, 0.01", "0.01, 0.01, 0.01"))
    points = written("mjcf", POINTS)
    for pair in ((stage, points), (points, stage)):
        assert [f"{check.quantity} at {check.at}" for check in verify(*pair).failed] == []
    skew = written("mjcf", POINTS.replace("0.3 0 0", "0.3 0.1 0"))
    assert [check.quantity for check in verify(stage, skew).failed] == ["loop closure, rotation"]
    alone = written("mjcf", POINTS.replace('<connect body1="arm" anchor="0.3 0 0"/>', ""))
    assert [check.quantity for check in verify(stage, alone).failed] == ["loops"]


def test_what_a_scale_of_zero_flattens_still_has_axes() -> None:
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    for scale in ((2.0, 3.0, 0.0), (0.0, 3.0, 4.0), (2.0, 0.0, 4.0)):
        assert unit_axes(turn @ np.diag(scale)) == pytest.approx(turn)
    assert unit_axes(turn @ np.diag((2.0, 3.0, 4.0))) == pytest.approx(turn)
    assert np.linalg.det(unit_axes(np.zeros((3, 3)))) == pytest.approx(1.0)
