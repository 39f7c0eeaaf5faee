"""Small texts of each format that say as much as possible: what mutations start from."""

from __future__ import annotations

URDF = (
    """<?xml version="1.0"?>
<robot name="r" version="1.0" xmlns:drake="http://drake.mit.edu">
  <material name="red"><color rgba="1 0 0 1"/><texture filename="t.png"/></material>
  <link name="base"><inertial><origin xyz="0 0 .1" rpy="0 .1 0"/><mass value="2"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
    <visual name="v"><origin xyz="1 0 0"/><geometry><mesh filename="package://p/a.stl" scale="1 1 1"/></geometry><material name="red"/></visual>
    <collision><geometry><cylinder radius=".1" length="2"/></geometry></collision></link>
  <link name="arm"/><link name="hand"><visual><geometry><box size="1 2 3"/></geometry><material name=""><color rgba="0 1 0 1"/></material></visual></link>
  <joint name="j" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 1" rpy="1.57 0 0"/><axis xyz="0 1 1"/>
    <limit lower="-1" upper="1" effort="10" velocity="2" drake:acceleration="3"/><dynamics damping="1" friction=".1"/>
    <safety_controller k_velocity="1" k_position="1" soft_lower_limit="-1" soft_upper_limit="1"/><calibration rising="0.1"/></joint>
  <joint name="k" type="prismatic"><parent link="arm"/><child link="hand"/><limit effort="1" velocity="1"/><mimic joint="j" multiplier="2" offset=".1"/></joint>
  <transmission name="t"><type>transmission_interface/SimpleTransmission</type><joint name="j"><hardwareInterface>EffortJointInterface</hardwareInterface></joint>
    <actuator name="m"><mechanicalReduction>50</mechanicalReduction></actuator></transmission>
  <gazebo reference="arm"><mu1>0.2</mu1><selfCollide>true</selfCollide></gazebo>
  <mujoco><compiler meshdir="m" discardvisual="false"/></mujoco>
  <!-- the end -->
</robot>
""",
    """<robot name="planar"><link name="a"/><link name="b"/><link name="c"/>
<joint name="p" type="planar"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>
<joint name="f" type="floating"><parent link="b"/><child link="c"/></joint>
<ros2_control name="s" type="system"><hardware><plugin>x/Y</plugin></hardware><joint name="p"><command_interface name="position"/></joint></ros2_control>
</robot>
""",
)

MJCF = (
    """<mujoco model="m">
  <compiler angle="radian" eulerseq="zyx" meshdir="meshes" autolimits="true"/>
  <option timestep="0.002" gravity="0 0 -9.81"/><size njmax="100"/>
  <default><geom rgba="1 0 0 1" condim="4"/><default class="big"><joint damping="1" range="-1 1"/><motor ctrlrange="-1 1"/></default></default>
  <asset><mesh name="tetra" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/><texture name="sky" type="skybox" builtin="gradient" rgb1="1 1 1" rgb2="0 0 0" width="8" height="8"/>
    <material name="shiny" specular=".5" rgba="1 1 1 1"/></asset>
  <worldbody><light pos="0 0 3" dir="0 0 -1"/><geom type="plane" size="1 1 .1" material="shiny"/><camera name="c" pos="1 1 1" euler="0 1 0"/>
    <frame pos="0 0 1" euler="0 0 1"><body name="a" childclass="big" pos="0 0 1" quat="1 0 0 1"><freejoint name="root"/>
      <inertial mass="1" pos="0 0 0" fullinertia="1 1 1 0 0 0"/><geom type="capsule" fromto="0 0 0 0 0 1" size=".1"/><site name="s" pos="0 0 1"/>
      <body name="b" axisangle="0 0 1 1"><joint name="j" type="hinge" axis="0 1 0"/><joint name="k" type="slide" class="big"/><geom name="g" type="mesh" mesh="tetra"/>
        <body name="d" xyaxes="1 0 0 0 1 0"><joint name="l" type="ball" range="0 1"/><geom name="h" size=".1" mass="2"/><site name="e" zaxis="0 0 1"/></body></body>
    </body></frame></worldbody>
  <contact><pair geom1="g" geom2="h"/><exclude body1="a" body2="b"/></contact>
  <tendon><fixed name="x"><joint joint="j" coef="1"/><joint joint="k" coef="-1"/></fixed>
    <spatial name="y" width=".01"><site site="s"/><geom geom="h" sidesite="e"/><site site="e"/><pulley divisor="2"/><site site="e"/><site site="s"/></spatial></tendon>
  <equality><weld body1="a" body2="b"/><connect name="o" body1="b" body2="d" anchor="0 0 0"/><joint joint1="j" joint2="k" polycoef="0 1 0 0 0"/></equality>
  <actuator><motor name="m" joint="j" class="big" gear="2"/><position tendon="x" kp="5"/><general site="s" gear="1 0 0 0 0 0" biastype="affine" biasprm="0 1 2"/></actuator>
  <sensor><jointpos joint="j"/><accelerometer name="acc" site="s" noise=".1"/><framepos objtype="body" objname="b"/></sensor>
  <keyframe><key name="home" qpos="0 0 0 1 0 0 0 0 0 1 0 0 0"/></keyframe><custom><numeric name="n" data="1 2 3"/><text name="z" data="hello"/></custom>
</mujoco>
""",
)

HYMEKO = (
    """spider import "std/kinematics.himeko" as std
units { length m angle deg mass kg }
limb(side, x, len=0.3) : std.assembly {
  coxa : std.link { mass 0.4 inertia [1e-3 1e-3 2e-3 0 0 0] visual -> skin
    skin : std.mesh { url "package://spider/coxa.stl" scale [1e-3 1e-3 1e-3] } }
  tibia : std.link { mass 200g visual { capsule [15mm ${len}] at [0 0 ${-len/2}] } }
  @swing : std.revolute { + trunk [[${x} ${0.1*side} 0] [0 0 ${90*side}]] - coxa, axis -> std.AXIS_Z,
    limit [-45deg 45deg] effort 6Nm velocity 5rad/s damping 0.05 }
  @knee : std.revolute { + coxa - tibia axis=Y limit [-90 90] }
}
trunk : std.link { mass 3 `b c` [1 2 [3]] note "a\\"b" }
left : limb(side=1 x=0.1) {}
right : limb(side=-1 x=0.1) {}
@gear : coupling { + left.knee [1] - right.knee }
// the end /* of */ it
""",
)

USD = (
    """#usda 1.0
(
    defaultPrim = "r"
    metersPerUnit = 0.01
    upAxis = "Y"
    kilogramsPerUnit = 1
)
def Xform "r" (prepend apiSchemas = ["PhysicsArticulationRootAPI"])
{
    def Scope "m"
    {
        def Material "red"
        {
            token outputs:surface.connect = </r/m/red/s.outputs:surface>
            def Shader "s"
            {
                uniform token info:id = "UsdPreviewSurface"
                color3f inputs:diffuseColor = (1, 0, 0)
                token outputs:surface
            }
        }
    }
    def Xform "a" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"])
    {
        float physics:mass = 2
        float3 physics:diagonalInertia = (1, 1, 1)
        quatf physics:principalAxes = (1, 0, 0, 0)
        point3f physics:centerOfMass = (0, 0, 0)
        double3 xformOp:translate = (0, 1, 0)
        quatf xformOp:orient = (1, 0, 0, 0)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:orient"]
        def Cube "c" (prepend apiSchemas = ["PhysicsCollisionAPI"])
        {
            double size = 2
        }
        def Mesh "t" (prepend apiSchemas = ["MaterialBindingAPI"])
        {
            point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
            int[] faceVertexCounts = [3, 3]
            int[] faceVertexIndices = [0, 1, 2, 0, 2, 3]
            rel material:binding = </r/m/red>
        }
    }
    def Xform "b" (prepend apiSchemas = ["PhysicsRigidBodyAPI"])
    {
        def Capsule "c"
        {
            double radius = 1
            double height = 2
            uniform token axis = "X"
        }
    }
    def PhysicsRevoluteJoint "j" (prepend apiSchemas = ["PhysicsDriveAPI:angular"])
    {
        rel physics:body0 = </r/a>
        rel physics:body1 = </r/b>
        point3f physics:localPos0 = (0, 1, 0)
        quatf physics:localRot0 = (1, 0, 0, 0)
        uniform token physics:axis = "Z"
        float physics:lowerLimit = -90
        float physics:upperLimit = 90
        float drive:angular:physics:stiffness = 10
        uniform token drive:angular:physics:type = "force"
        custom double my:own = 1.5
    }
    def PhysicsFixedJoint "f"
    {
        rel physics:body1 = </r/a>
    }
    def "i" (references = </r/b>)
    {
    }
    variantSet "v" = {
        "one" {
            def Sphere "s"
            {
                double radius = 1
            }
        }
    }
}
""",
)

XACRO = (
    """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="n" default="2"/><xacro:property name="w" value="${pi/2}"/>
<xacro:macro name="leg" params="side:=1 *block **more parent"><link name="leg${side}"><xacro:insert_block name="block"/></link>
<joint name="j${side}" type="fixed"><parent link="${parent}"/><child link="leg${side}"/><origin xyz="0 ${side*0.1} 0"/></joint></xacro:macro>
<link name="base"/><xacro:if value="$(arg n)"><xacro:leg side="-1" parent="base"><visual><geometry><sphere radius="${w}"/></geometry></visual><a/></xacro:leg></xacro:if>
</robot>
""",
)

SDF = (
    """<?xml version="1.0"?><sdf version="1.9"><world name="w"><model name="m"><link name="l"><inertial><mass>1</mass></inertial><pose>0 0 1 0 0 0</pose></link>
<joint name="j" type="revolute"><parent>world</parent><child>l</child><axis><xyz>0 0 1</xyz></axis></joint></model></world></sdf>
""",
)

BY_FORMAT = {"urdf": URDF, "mjcf": MJCF, "hymeko": HYMEKO, "usd": USD, "sdf": SDF, "xacro": XACRO}
"""The texts of each format by its name."""
