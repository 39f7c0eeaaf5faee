"""What other converters write in words of their own: the robot is the one that they were given."""

from __future__ import annotations

import math

from hymeko_x import formats, pipeline
from hymeko_x.diagnostics import Report
from hymeko_x.ir.mechanism import WORLD, Id, Mechanism
from hymeko_x.ir.parts import Coupling, DofKind, Limits
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles
from tests.usd.stages import HEADER, read_text

NESTED = """#usda 1.0
(
    customLayerData = { string creator = "URDF USD Converter v0.3.4" }
    defaultPrim = "robot"
    metersPerUnit = 1
    upAxis = "Z"
)
def Xform "robot"
{
    def Scope "Geometry"
    {
        def Xform "base"
        {
            def Xform "arm" (apiSchemas = ["PhysicsRigidBodyAPI"])
            {
                double3 xformOp:translate = (0, 0, 1)
                uniform token[] xformOpOrder = ["xformOp:translate"]
                def Xform "tool_0" (displayName = "tool.0")
                {
                    double3 xformOp:translate = (2, 0, 0)
                    uniform token[] xformOpOrder = ["xformOp:translate"]
                    def Xform "finger" (apiSchemas = ["PhysicsRigidBodyAPI"])
                    {
                        double3 xformOp:translate = (0, 3, 0)
                        uniform token[] xformOpOrder = ["xformOp:translate"]
                    }
                }
            }
        }
    }
    def Scope "Physics"
    {
        def PhysicsFixedJoint "mount"
        {
            rel physics:body0 = </robot>
            rel physics:body1 = </robot/Geometry/base/arm>
            point3f physics:localPos0 = (0, 0, 1)
        }
        def PhysicsRevoluteJoint "knuckle"
        {
            rel physics:body0 = </robot/Geometry/base/arm>
            rel physics:body1 = </robot/Geometry/base/arm/tool_0/finger>
            point3f physics:localPos0 = (2, 3, 0)
            custom float urdf:limit:effort = 7
        }
    }
}
"""


def tree(mechanism: Mechanism) -> dict[str, tuple[str, str, tuple[float, ...]]]:
    """Each joint with its parent, its child, and where it is in the parent."""
    return {view.id.name: (view.parent.name, view.child.name, view.parent_pose.xyz) for view in mechanism.joints.values()}


def test_the_links_that_urdf_usd_converter_leaves_without_a_body_are_links_again() -> None:
    assert tree(read_text(NESTED)) == {
        "mount": ("base", "arm", (0.0, 0.0, 1.0)),
        "knuckle": ("tool.0", "finger", (0.0, 3.0, 0.0)),
        "base_fixed": (WORLD.name, "base", (0.0, 0.0, 0.0)),
        "tool.0_fixed": ("arm", "tool.0", (2.0, 0.0, 0.0)),
    }


def test_plain_groups_of_other_programs_are_no_links() -> None:
    assert set(tree(read_text(NESTED.replace("URDF USD Converter", "somebody")))) == {"mount", "knuckle"}


def test_a_bare_root_called_world_is_the_world() -> None:
    assert tree(read_text(NESTED.replace("Geometry/base", "Geometry/world").replace('"base"', '"world"')))["mount"] == (
        WORLD.name,
        "arm",
        (0.0, 0.0, 1.0),
    )


def test_the_effort_of_urdf_usd_converter_is_read() -> None:
    assert read_text(NESTED).joints[Id("joint", "knuckle")].joint.dofs[0].limits == Limits(effort=7.0)


CYBERWAVE = f"""{HEADER}
def Xform "robot" (customData = {{ dictionary cyberwave = {{ string order = "" }} }})
{{
    def Xform "world" (apiSchemas = ["PhysicsRigidBodyAPI"]) {{}}
    def Xform "a_1" (apiSchemas = ["PhysicsRigidBodyAPI"])
    {{
        custom string cyberwave:name = "a/1"
    }}
    def Xform "b" (apiSchemas = ["PhysicsRigidBodyAPI"]) {{}}
    def PhysicsRevoluteJoint "first" (apiSchemas = ["PhysicsDriveAPI:angular"])
    {{
        rel physics:body0 = </robot/world>
        rel physics:body1 = </robot/a_1>
        float physics:lowerLimit = -57.29578
        float physics:upperLimit = 57.29578
        float drive:angular:physics:damping = 0.5
        custom token cyberwave:joint:type = "revolute"
        custom bool cyberwave:joint:hasLimits = 1
        custom bool cyberwave:joint:hasDynamics = 1
        custom double cyberwave:joint:limitLower = -1.0000000001
        custom double cyberwave:joint:limitUpper = 2
        custom double cyberwave:joint:limitEffort = 7
        custom double cyberwave:joint:limitVelocity = 3
        custom double cyberwave:joint:dynamicsDamping = 0.5
        custom double cyberwave:joint:dynamicsFriction = 0.25
    }}
    def PhysicsRevoluteJoint "second"
    {{
        rel physics:body0 = </robot/a_1>
        rel physics:body1 = </robot/b>
        custom token cyberwave:joint:type = "revolute"
        custom string cyberwave:joint:mimicJoint = "first"
        custom double cyberwave:joint:mimicMultiplier = 2
        custom double cyberwave:joint:mimicOffset = 0.1
    }}
}}
"""


def test_speed_effort_and_behaviour_of_cyberwave_are_read_and_bounds_are_doubles_where_they_agree() -> None:
    """Its upper limit says something else than the joint, which somebody must have edited."""
    mechanism = read_text(CYBERWAVE)
    (dof,) = mechanism.joints[Id("joint", "first")].joint.dofs
    assert dof.limits == Limits(-1.0000000001, math.radians(57.29578), 3.0, 7.0)
    assert (dof.damping, dof.friction) == (0.5, 0.25)


def test_a_drive_that_repeats_what_is_passive_is_no_actuator() -> None:
    assert [key for key in read_text(CYBERWAVE).graph.vertices if key.kind == "actuator"] == []


def test_names_that_prims_cannot_have_come_from_cyberwaves_own() -> None:
    assert Id("body", "a/1") in read_text(CYBERWAVE).graph.vertices


def test_a_mimic_by_name_is_a_coupling() -> None:
    mechanism = read_text(CYBERWAVE)
    assert [[(arc.target.name, arc.weight) for arc in arcs] for _, _, arcs in mechanism.edges(Coupling)] == [
        [("second", (1.0,)), ("first", (0.1, 2.0))]
    ]


def test_the_world_body_of_cyberwave_stands_still() -> None:
    assert read_text(CYBERWAVE).joints[Id("joint", "world_free")].joint.dofs == ()


def test_a_slide_and_a_ball_between_the_same_bodies_are_one_joint() -> None:
    joint = """
    def Physics{kind}Joint "{name}"
    {{
        rel physics:body0 = </robot/a>
        rel physics:body1 = </robot/b>
    }}"""
    text = f"""{HEADER}
def Xform "robot"
{{
    def Xform "a" (apiSchemas = ["PhysicsRigidBodyAPI"]) {{}}
    def Xform "b" (apiSchemas = ["PhysicsRigidBodyAPI"]) {{}}
    {joint.format(kind="Prismatic", name="s")}
    {joint.format(kind="Spherical", name="t")}
}}
"""
    assert [dof.kind for dof in read_text(text).joints[Id("joint", "s")].joint.dofs] == [DofKind.SLIDE, DofKind.BALL]


PHYSX = f"""{HEADER}
def Xform "robot"
{{
    def Xform "base" (apiSchemas = ["PhysicsRigidBodyAPI"]) {{}}
    def Xform "arm" (apiSchemas = ["PhysicsRigidBodyAPI"]) {{}}
    def PhysicsRevoluteJoint "elbow"
    {{
        float2 mjc:solreflimit = (0.5, 0.05)
        rel physics:body0 = </robot/base>
        rel physics:body1 = </robot/arm>
        float physxJoint:armature = 0.02
        float physxJoint:maxJointVelocity = 90
    }}
}}
"""


def test_a_value_that_only_physx_has_is_a_value_of_the_joint_and_of_physx_again() -> None:
    robot = read_text(PHYSX)
    (dof,) = robot.joints[Id("joint", "elbow")].joint.dofs
    assert (dof.armature, dof.limits.velocity) == (0.02, math.pi / 2)
    assert not any("physxJoint" in extra.text for extra in robot.extras[Id("joint", "elbow")])
    result = pipeline.convert(robot, formats.USD, Options(), NoFiles(), Report())
    assert result.losses == ()
    for line in ("physxJoint:armature = 0.02", "physxJoint:maxJointVelocity = 90", "mjc:armature = 0.02", "newton:velocityLimit = 90"):
        assert line in result.package.main.decode()


def test_a_value_of_physx_that_contradicts_newton_s_stays_as_it_is_written() -> None:
    robot = read_text(PHYSX.replace("float physx", "float newton:armature = 0.03\n        float physx", 1))
    assert robot.joints[Id("joint", "elbow")].joint.dofs[0].armature == 0.03
    assert any("physxJoint:armature = 0.02" in extra.text for extra in robot.extras[Id("joint", "elbow")])
