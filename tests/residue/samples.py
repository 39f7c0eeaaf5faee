"""Robots that say what other formats cannot, as MJCF and URDF."""

from __future__ import annotations

MJCF = """<mujoco model="walker">
  <compiler angle="degree" autolimits="true"/>
  <option timestep="0.004" integrator="implicitfast"/>
  <default>
    <joint armature="0.01" damping="0.5"/>
    <geom rgba="0.8 0.6 0.4 1" condim="3"/>
    <default class="foot"><geom type="sphere" size="0.04" friction="1.5 0.1 0.1"/></default>
  </default>
  <asset>
    <texture name="grid" type="2d" builtin="checker" rgb1=".1 .2 .3" rgb2=".2 .3 .4" width="32" height="32"/>
    <material name="grid" texture="grid" texrepeat="2 2" reflectance="0.1"/>
  </asset>
  <worldbody>
    <light name="sun" pos="0 0 3" dir="0 0 -1" directional="true"/>
    <geom name="floor" type="plane" size="5 5 0.1" material="grid"/>
    <body name="torso" pos="0 0 1.2">
      <freejoint name="root"/>
      <geom name="trunk" type="capsule" fromto="0 0 -0.2 0 0 0.2" size="0.1"/>
      <site name="imu" pos="0 0 0.1" euler="0 30 0"/>
      <camera name="eyes" pos="0.1 0 0.2" xyaxes="0 -1 0 0 0 1" fovy="60"/>
      <body name="left_thigh" pos="0 0.1 -0.2">
        <joint name="left_hip_x" axis="1 0 0" range="-25 5" pos="0 0 0.02"/>
        <joint name="left_hip_y" axis="0 1 0" range="-20 110" ref="10"/>
        <joint name="left_hip_z" axis="0 0 1" range="-60 35" stiffness="2"/>
        <geom name="left_thigh" type="capsule" fromto="0 0 0 0 0 -0.3" size="0.05"/>
        <body name="left_shin" pos="0 0 -0.35" euler="0 5 0">
          <joint name="left_knee" axis="0 -1 0" range="-160 -2" pos="0 0 0.02"/>
          <geom name="left_shin" type="box" size="0.03 0.03 0.15" pos="0 0 -0.15" mass="2"/>
          <geom name="left_foot" class="foot" pos="0 0 -0.32"/>
          <site name="left_sole" pos="0 0 -0.36"/>
        </body>
      </body>
      <body name="right_thigh" pos="0 -0.1 -0.2">
        <camera name="depth" resolution="1280 720" sensorsize="0.004 0.002" focal="0.002 0.002"/>
        <joint name="right_hip" axis="0 1 0" range="-110 20"/>
        <geom name="right_thigh" type="ellipsoid" size="0.05 0.05 0.15" pos="0 0 -0.15"/>
        <body name="right_shin" pos="0 0 -0.35">
          <joint name="right_knee" axis="0 1 0" range="2 160"/>
          <inertial pos="0 0 -0.15" mass="1.5" diaginertia="0.02 0.02 0.003"/>
          <geom name="right_shin" type="cylinder" size="0.03 0.15" pos="0 0 -0.15"/>
          <site name="right_sole" pos="0 0 -0.33"/>
        </body>
      </body>
    </body>
  </worldbody>
  <contact>
    <exclude body1="torso" body2="left_shin"/>
  </contact>
  <tendon>
    <spatial name="strap" stiffness="50" width="0.01"><site site="left_sole"/><site site="right_sole"/></spatial>
    <fixed name="knees"><joint joint="left_knee" coef="1"/><joint joint="right_knee" coef="-0.5"/></fixed>
  </tendon>
  <equality>
    <connect name="chained" body1="left_shin" body2="right_shin" anchor="0 0 -0.3" active="false"/>
  </equality>
  <actuator>
    <position name="left_knee" joint="left_knee" kp="40" ctrlrange="-150 0"/>
    <motor name="right_knee" joint="right_knee" gear="30"/>
    <general name="knees" tendon="knees" gainprm="3"/>
  </actuator>
  <sensor>
    <accelerometer name="imu" site="imu" noise="0.1"/>
    <jointpos name="left_knee" joint="left_knee"/>
  </sensor>
  <keyframe>
    <key name="stand" qpos="0 0 1.2 1 0 0 0 0 0.1 0 -0.2 0 0.3"/>
  </keyframe>
</mujoco>
"""

PLAIN_MJCF = (
    MJCF.replace('<joint name="left_hip_x" axis="1 0 0" range="-25 5" pos="0 0 0.02"/>', "")
    .replace('type="ellipsoid" size="0.05 0.05 0.15"', 'type="box" size="0.05 0.05 0.15"')
    .replace(' ref="10"', "")
    .replace('<joint name="left_hip_z" axis="0 0 1" range="-60 35" stiffness="2"/>', "")
    .replace(' range="-160 -2" pos="0 0 0.02"', ' range="-160 -2"')
    .replace(' qpos="0 0 1.2 1 0 0 0 0 0.1 0 -0.2 0 0.3"', ' qpos="0 0 1.2 1 0 0 0 0 -0.2 0 0.3"')
)
"""The same with one dof per joint, at the origin of its body: what a URDF says with as many links and joints."""

URDF = """<?xml version="1.0"?>
<!-- made by hand -->
<robot name="arm" xmlns:drake="http://drake.mit.edu">
  <material name="steel"><color rgba="0.7 0.70 0.7 1.0"/></material>
  <link name="base"><visual name="plate">
    <geometry><box size="0.20 0.2 0.05"/></geometry><material name="steel"/></visual></link>
  <link name="upper">
    <inertial><origin xyz="0 0 0.150" rpy="0 0.1 0"/><mass value="1.50"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.011" iyz="0" izz="0.002"/></inertial>
    <visual><origin xyz="0 0 0.15" rpy="0.1 0.20 0.3"/><geometry><cylinder radius="0.04" length="0.3"/></geometry></visual>
    <collision><origin xyz="0 0 0.15"/><geometry><cylinder radius="0.05" length="0.32"/></geometry></collision>
    <drake:capsule/>
  </link>
  <link name="lower"><inertial><mass value="0.8"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
  <link name="finger"><inertial><mass value="0.1"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 0.05" rpy="0 0 1.570"/><parent link="base"/><child link="upper"/><axis xyz="0 0 2"/>
    <limit lower="-1.5" upper="1.50" effort="20" velocity="3.14"/><dynamics damping="0.7" friction="0.1"/>
    <safety_controller k_velocity="10" k_position="5" soft_lower_limit="-1.4" soft_upper_limit="1.4"/>
  </joint>
  <joint name="elbow" type="continuous"><origin xyz="0 0 0.3"/><parent link="upper"/><child link="lower"/><axis xyz="0 1 0"/></joint>
  <joint name="grip" type="prismatic">
    <origin xyz="0 0 0.2"/><parent link="lower"/><child link="finger"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.05" effort="5" velocity="0.1"/>
    <mimic joint="shoulder" multiplier="0.02" offset="0.01"/>
  </joint>
  <transmission name="shoulder_trans"><type>transmission_interface/SimpleTransmission</type>
    <joint name="shoulder"><hardwareInterface>hardware_interface/EffortJointInterface</hardwareInterface></joint>
    <actuator name="shoulder_motor"><mechanicalReduction>50</mechanicalReduction></actuator>
  </transmission>
  <gazebo reference="upper"><mu1>0.9</mu1></gazebo>
</robot>
"""
