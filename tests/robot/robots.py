"""A small arm and a small hand in two formats each, for tests of the object model."""

from __future__ import annotations

import mujoco
import numpy as np

import hymeko_x as hx

ARM = """<mujoco model="arm">
  <compiler angle="radian"/>
  <default>
    <geom solref="0.01 1"/>
    <default class="link"><geom rgba="0.2 0.2 0.2 1" friction="0.7 0.01 0.001"/></default>
  </default>
  <asset><material name="steel" rgba="0.5 0.5 0.5 1"/></asset>
  <worldbody>
    <body name="base" pos="0 0 0.1">
      <inertial pos="0 0 0.05" mass="4" diaginertia="0.02 0.02 0.02"/>
      <geom name="foot" type="box" size="0.1 0.1 0.05" material="steel"/>
      <body name="upper" pos="0 0 0.1" childclass="link">
        <joint name="shoulder" axis="0 0 1" range="-2 2" damping="0.5"/>
        <geom type="capsule" size="0.04 0.15" pos="0 0 0.15" mass="2"/>
        <body name="fore" pos="0 0 0.3">
          <joint name="elbow" axis="0 1 0" range="-1.5 1.5"/>
          <geom type="capsule" size="0.03 0.1" pos="0 0 0.1" mass="1"/>
          <site name="flange" pos="0 0 0.2" euler="0 0 0.5"/>
        </body>
      </body>
    </body>
  </worldbody>
  <contact><exclude name="near" body1="base" body2="upper"/></contact>
  <actuator>
    <position name="turn" joint="shoulder" kp="50"/>
    <motor name="lift" joint="elbow" gear="20"/>
  </actuator>
  <sensor><jointpos name="angle" joint="elbow"/></sensor>
  <keyframe><key name="home" qpos="0.1 0.2" ctrl="0.1 0"/></keyframe>
</mujoco>"""

HAND = """<mujoco model="hand">
  <compiler angle="radian"/>
  <default>
    <default class="finger"><geom rgba="1 0 0 1" solref="0.005 1"/><joint range="0 0.04" type="slide"/></default>
  </default>
  <asset><material name="steel" rgba="0.9 0.9 0.9 1"/></asset>
  <worldbody>
    <body name="palm">
      <geom name="block" type="box" size="0.03 0.05 0.02" mass="0.4" material="steel"/>
      <body name="left" pos="0 0.02 0.04" childclass="finger">
        <joint name="left" axis="0 1 0"/>
        <geom type="box" size="0.01 0.005 0.02" mass="0.05"/>
      </body>
      <body name="right" pos="0 -0.02 0.04" childclass="finger">
        <joint name="right" axis="0 -1 0"/>
        <geom type="box" size="0.01 0.005 0.02" mass="0.05"/>
      </body>
    </body>
  </worldbody>
  <tendon><fixed name="split"><joint joint="left" coef="0.5"/><joint joint="right" coef="0.5"/></fixed></tendon>
  <equality><joint name="together" joint1="left" joint2="right" polycoef="0 1 0 0 0"/></equality>
  <actuator><position name="grip" tendon="split" kp="100"/></actuator>
</mujoco>"""

URDF_HAND = """<robot name="claw">
  <material name="steel"><color rgba="0.9 0.9 0.9 1"/></material>
  <link name="palm">
    <inertial><mass value="0.5"/><inertia ixx="0.001" iyy="0.001" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><box size="0.06 0.1 0.04"/></geometry><material name="steel"/></visual>
    <collision><geometry><box size="0.06 0.1 0.04"/></geometry></collision>
  </link>
  <link name="finger">
    <inertial><origin xyz="0 0 0.02"/><mass value="0.1"/>
      <inertia ixx="0.0001" iyy="0.0001" izz="0.0001" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0 0 0.02"/><geometry><box size="0.02 0.01 0.04"/></geometry></collision>
  </link>
  <joint name="close" type="revolute">
    <parent link="palm"/><child link="finger"/><origin xyz="0 0.02 0.03"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="1" effort="5" velocity="2"/>
  </joint>
</robot>"""


def arm() -> hx.Robot:
    return hx.loads(ARM, "mjcf")


def hand() -> hx.Robot:
    return hx.loads(HAND, "mjcf")


def claw() -> hx.Robot:
    return hx.loads(URDF_HAND, "urdf")


_FILES = ("paths", "npaths", "nbuffer", "names_map")


def check_same_model(ours: mujoco.MjModel, theirs: mujoco.MjModel, *, in_order: bool = True) -> None:
    """Each number and each array of two compiled models is the same, but for names, paths of files, and if so the order of meshes."""
    order = () if in_order else ("mesh_", "bvh_", "name_mesh", "geom_dataid")
    compared = 0
    for name in dir(theirs):
        if name.startswith(("_", *order)) or name.endswith("pathadr") or name in _FILES:
            continue
        expected, found = getattr(theirs, name), getattr(ours, name)
        if isinstance(expected, np.ndarray):
            assert found.shape == expected.shape, name
            assert np.allclose(found, expected, atol=1e-12, rtol=1e-12), name
            compared += 1
        elif isinstance(expected, int):
            assert found == expected, name
    assert compared > 300
    assert meshes_of_geoms(ours) == meshes_of_geoms(theirs)


def meshes_of_geoms(model: mujoco.MjModel) -> list[str]:
    is_mesh = model.geom_type == int(mujoco.mjtGeom.mjGEOM_MESH)
    return [model.mesh(number).name for number in model.geom_dataid[is_mesh]]
