"""Robots of our own for the verifier: an arm with a gripper in two formats, and a rig with everything that only MJCF can say."""

from __future__ import annotations

ARM_URDF = """<?xml version="1.0"?>
<robot name="arm">
  <link name="base">
    <inertial><origin xyz="0 0 0.05"/><mass value="4"/><inertia ixx="0.02" iyy="0.02" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><box size="0.2 0.2 0.1"/></geometry></visual>
    <collision><geometry><box size="0.2 0.2 0.1"/></geometry></collision>
  </link>
  <link name="upper">
    <inertial><origin xyz="0.01 0.02 0.15"/><mass value="2"/>
      <inertia ixx="0.016" iyy="0.018" izz="0.004" ixy="0.001" ixz="-0.0005" iyz="0.0002"/></inertial>
    <visual><origin xyz="0 0 0.15"/><geometry><cylinder radius="0.04" length="0.3"/></geometry></visual>
    <collision name="upper_hull"><origin xyz="0 0 0.15" rpy="0 0.1 0"/><geometry><cylinder radius="0.05" length="0.32"/></geometry>
      </collision>
  </link>
  <link name="fore">
    <inertial><origin xyz="0.1 0 0" rpy="0.3 -0.2 0.7"/><mass value="1.2"/>
      <inertia ixx="0.002" iyy="0.008" izz="0.009" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><origin xyz="0.1 0 0"/><geometry><box size="0.2 0.06 0.04"/></geometry></visual>
    <collision><origin xyz="0.1 0 0"/><geometry><sphere radius="0.06"/></geometry></collision>
  </link>
  <link name="slider">
    <inertial><origin xyz="0 0.01 0"/><mass value="0.5"/>
      <inertia ixx="0.0004" iyy="0.0005" izz="0.0006" ixy="0" ixz="0" iyz="0.00005"/></inertial>
  </link>
  <link name="hand">
    <inertial><origin xyz="0 0 0.03"/><mass value="0.4"/><inertia ixx="0.0003" iyy="0.0004" izz="0.0002" ixy="0" ixz="0" iyz="0"/>
      </inertial>
    <collision><origin xyz="0 0 0.03"/><geometry><box size="0.08 0.04 0.06"/></geometry></collision>
  </link>
  <link name="left"><inertial><mass value="0.05"/><inertia ixx="1e-5" iyy="2e-5" izz="1.5e-5" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="right"><inertial><mass value="0.05"/><inertia ixx="1e-5" iyy="2e-5" izz="1.5e-5" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="tool"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><origin xyz="0 0 0.1" rpy="0.1 0.2 0.3"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2.5" effort="80" velocity="3"/><dynamics damping="0.7" friction="0.2"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper"/><child link="fore"/><origin xyz="0 0.03 0.3" rpy="0 0 0.4"/><axis xyz="0 0.6 0.8"/>
    <limit lower="-1.5" upper="1.7" effort="60" velocity="4"/><dynamics damping="0.5" friction="0.1"/>
  </joint>
  <joint name="roll" type="continuous">
    <parent link="fore"/><child link="slider"/><origin xyz="0.2 0 0.01"/><axis xyz="1 0 0"/><limit effort="10" velocity="6"/>
  </joint>
  <joint name="rail" type="prismatic">
    <parent link="slider"/><child link="hand"/><origin xyz="0.05 0 0" rpy="0 1.5707963267948966 0"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.12" effort="30" velocity="0.5"/>
  </joint>
  <joint name="left_slide" type="prismatic">
    <parent link="hand"/><child link="left"/><origin xyz="0.02 0 0.06"/><axis xyz="1 0 0"/>
      <limit lower="0" upper="0.04" effort="5" velocity="0.1"/>
  </joint>
  <joint name="right_slide" type="prismatic">
    <parent link="hand"/><child link="right"/><origin xyz="-0.02 0 0.06"/><axis xyz="-1 0 0"/>
      <limit lower="0" upper="0.09" effort="5" velocity="0.1"/>
    <mimic joint="left_slide" multiplier="2" offset="0.005"/>
  </joint>
  <joint name="tool_mount" type="fixed"><parent link="hand"/><child link="tool"/><origin xyz="0 0 0.1" rpy="0 0 0.5"/></joint>
</robot>
"""

ARM_MJCF = """<mujoco model="arm">
  <compiler angle="radian" eulerseq="XYZ"/>
  <worldbody>
    <body name="base">
      <inertial pos="0 0 0.05" mass="4" diaginertia="0.02 0.02 0.03"/>
      <geom type="box" size="0.1 0.1 0.05" contype="0" conaffinity="0"/>
      <geom type="box" size="0.1 0.1 0.05" group="3"/>
      <body name="upper" pos="0 0 0.1" euler="0.1 0.2 0.3">
        <joint name="shoulder" axis="0 0 1" range="-2 2.5" damping="0.7" frictionloss="0.2" actuatorfrcrange="-80 80"/>
        <inertial pos="0.01 0.02 0.15" mass="2" fullinertia="0.016 0.018 0.004 0.001 -0.0005 0.0002"/>
        <geom type="cylinder" size="0.04 0.15" pos="0 0 0.15" contype="0" conaffinity="0"/>
        <geom name="upper_hull" type="cylinder" size="0.05 0.16" pos="0 0 0.15" euler="0 0.1 0" group="3"/>
        <body name="fore" pos="0 0.03 0.3" euler="0 0 0.4">
          <joint name="elbow" axis="0 0.6 0.8" range="-1.5 1.7" damping="0.5" frictionloss="0.1" actuatorfrcrange="-60 60"/>
          <inertial pos="0.1 0 0" euler="0.3 -0.2 0.7" mass="1.2" diaginertia="0.002 0.008 0.009"/>
          <geom type="box" size="0.1 0.03 0.02" pos="0.1 0 0" contype="0" conaffinity="0"/>
          <geom type="sphere" size="0.06" pos="0.1 0 0" group="3"/>
          <body name="slider" pos="0.2 0 0.01">
            <joint name="roll" axis="1 0 0" actuatorfrcrange="-10 10"/>
            <inertial pos="0 0.01 0" mass="0.5" fullinertia="0.0004 0.0005 0.0006 0 0 0.00005"/>
            <body name="hand" pos="0.05 0 0" euler="0 1.5707963267948966 0">
              <joint name="rail" type="slide" axis="0 0 1" range="0 0.12" actuatorfrcrange="-30 30"/>
              <inertial pos="0 0 0.03" mass="0.4" diaginertia="0.0003 0.0004 0.0002"/>
              <geom type="box" size="0.04 0.02 0.03" pos="0 0 0.03" group="3"/>
              <body name="left" pos="0.02 0 0.06">
                <joint name="left_slide" type="slide" axis="1 0 0" range="0 0.04" actuatorfrcrange="-5 5"/>
                <inertial pos="0 0 0" mass="0.05" diaginertia="1e-5 2e-5 1.5e-5"/>
              </body>
              <body name="right" pos="-0.02 0 0.06">
                <joint name="right_slide" type="slide" axis="-1 0 0" range="0 0.09" actuatorfrcrange="-5 5"/>
                <inertial pos="0 0 0" mass="0.05" diaginertia="1e-5 2e-5 1.5e-5"/>
              </body>
              <body name="tool" pos="0 0 0.1" euler="0 0 0.5"/>
            </body>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <equality>
    <joint joint1="right_slide" joint2="left_slide" polycoef="0.005 2 0 0 0"/>
  </equality>
</mujoco>
"""

RIG_MJCF = """<mujoco model="rig">
  <compiler angle="radian" eulerseq="XYZ" autolimits="true"/>
  <asset>
    <mesh name="wedge" vertex="0 0 0  0.1 0 0  0 0.2 0  0 0 0.3  0.1 0.2 0.05" scale="1 1 1"/>
  </asset>
  <worldbody>
    <geom name="floor" type="plane" size="2 2 0.1"/>
    <body name="torso" pos="0 0 1">
      <freejoint name="root"/>
      <inertial pos="0 0 0.1" mass="5" diaginertia="0.1 0.12 0.05"/>
      <geom name="trunk" type="capsule" size="0.1 0.2"/>
      <body name="thigh" pos="0.1 0 -0.2" quat="0.96592582628906831 0.25881904510252074 0 0">
        <joint name="hip_x" axis="1 0 0" pos="0 0 0.02" range="-0.5 0.6" armature="0.01" damping="1.5"/>
        <joint name="hip_y" axis="0 1 0" pos="0 0.01 0" range="-1 1.2" ref="0.2" stiffness="20" springref="0.1"/>
        <joint name="hip_z" axis="0 0 1" range="-0.4 0.4" frictionloss="0.3"/>
        <inertial pos="0 0 -0.15" mass="1.5" fullinertia="0.01 0.011 0.002 0.0003 0 0"/>
        <geom name="thigh_mesh" type="mesh" mesh="wedge" pos="0 0 -0.1"/>
        <body name="shin" pos="0 0 -0.3">
          <joint name="knee" axis="0 1 0" range="-2 0" armature="0.02" actuatorfrcrange="-90 90"/>
          <inertial pos="0 0 -0.12" mass="0.8" diaginertia="0.006 0.006 0.001"/>
          <geom name="shin_hull" type="ellipsoid" size="0.03 0.04 0.15" pos="0 0 -0.15"/>
          <site name="heel" pos="-0.02 0 -0.3"/>
          <body name="foot" pos="0 0 -0.3">
            <joint name="ankle" type="ball" pos="0 0 0.01" damping="0.2"/>
            <inertial pos="0.03 0 0" mass="0.3" diaginertia="0.0004 0.0006 0.0007"/>
            <geom name="sole" type="box" size="0.08 0.03 0.01" pos="0.03 0 0"/>
          </body>
        </body>
      </body>
      <body name="crank" pos="0 0.15 0">
        <joint name="crank_joint" axis="0 1 0"/>
        <inertial pos="0.05 0 0" mass="0.4" diaginertia="0.0005 0.001 0.001"/>
        <body name="rod" pos="0.1 0 0">
          <joint name="rod_joint" axis="0 1 0"/>
          <inertial pos="0.1 0 0" mass="0.3" diaginertia="0.0004 0.001 0.001"/>
        </body>
      </body>
      <body name="rocker" pos="0.3 0.15 0">
        <joint name="rocker_joint" axis="0 1 0"/>
        <inertial pos="0 0 0.05" mass="0.3" diaginertia="0.0006 0.0006 0.0002"/>
      </body>
      <body name="gear" pos="0 -0.2 0">
        <joint name="gear_joint" axis="0 0 1"/>
        <inertial pos="0 0 0" mass="0.2" diaginertia="0.0002 0.0002 0.0003"/>
      </body>
    </body>
    <body name="anvil" pos="1 0 0.2">
      <inertial pos="0 0 0" mass="9" diaginertia="0.1 0.1 0.1"/>
      <geom name="block" type="box" size="0.1 0.1 0.2"/>
    </body>
  </worldbody>
  <tendon>
    <fixed name="hamstring" stiffness="3"><joint joint="hip_y" coef="0.5"/><joint joint="knee" coef="-0.25"/></fixed>
  </tendon>
  <equality>
    <connect name="pin" body1="rod" body2="rocker" anchor="0.2 0 0"/>
    <weld name="clamp" body1="gear" body2="anvil" relpose="0.1 0.2 0.3 1 0 0 0"/>
    <joint name="ratio" joint1="gear_joint" joint2="crank_joint" polycoef="0.1 -3 0.5 0 0"/>
  </equality>
  <actuator>
    <position name="knee_servo" joint="knee" kp="50" ctrlrange="-2 0"/>
    <motor name="crank_motor" joint="crank_joint" gear="12"/>
  </actuator>
</mujoco>
"""
