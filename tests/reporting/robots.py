"""Small robots of the kinds whose conversions lose the most."""

from __future__ import annotations


def biped() -> str:
    """A walker of Cassie's kind in MJCF: springs in its legs, which four rods close into loops, and ten motors."""
    legs, loops, motors = [], [], []
    for side, y in (("left", 0.1), ("right", -0.1)):
        legs.append(f"""
      <body name="{side}-hip" pos="0 {y} 0"><inertial pos="0 0 0" mass="1.8" diaginertia="0.003 0.004 0.005"/>
        <joint name="{side}-hip-roll" axis="1 0 0" range="-0.3 0.4" armature="0.04"/>
        <joint name="{side}-hip-yaw" axis="0 0 1" range="-0.4 0.4" armature="0.04"/>
        <body name="{side}-thigh" pos="0 0 -0.1"><inertial pos="0 0 -0.2" mass="5" diaginertia="0.02 0.02 0.03"/>
          <joint name="{side}-hip-pitch" axis="0 1 0" range="-0.9 1.4" armature="0.09"/>
          <geom type="mesh" mesh="rod"/>
          <body name="{side}-achilles" pos="0 0.02 0"><inertial pos="0 0 -0.2" mass="0.16" diaginertia="0.001 0.001 0.001"/>
            <joint name="{side}-achilles-rod" type="ball"/></body>
          <body name="{side}-shin" pos="0 0 -0.4"><inertial pos="0 0 -0.2" mass="0.6" diaginertia="0.01 0.01 0.01"/>
            <joint name="{side}-knee" axis="0 1 0" range="-2.8 -0.6" armature="0.09"/>
            <joint name="{side}-spring" axis="0 1 0" stiffness="1500"/>
            <body name="{side}-tarsus" pos="0 0 -0.4"><inertial pos="0 0 -0.1" mass="0.8" diaginertia="0.01 0.01 0.01"/>
              <joint name="{side}-heel-spring" axis="0 1 0" stiffness="1250"/>
              <body name="{side}-foot" pos="0 0 -0.2"><inertial pos="0 0 0" mass="0.2" diaginertia="0.001 0.001 0.001"/>
                <joint name="{side}-toe" axis="0 1 0" range="-2.4 -0.5" armature="0.02"/>
                <geom name="{side}-sole" type="capsule" size="0.02 0.06" friction="0.8"/></body></body></body></body></body>""")
        loops.append(f'<connect name="{side}-rod" body1="{side}-achilles" body2="{side}-tarsus" anchor="0 0 -0.5"/>')
        loops.append(f'<connect name="{side}-plantar" body1="{side}-shin" body2="{side}-foot" anchor="0 0 -0.1"/>')
        motors += [f'<motor name="{side}-{joint}" joint="{side}-{joint}" gear="25" ctrlrange="-4.5 4.5"/>' for joint in _DRIVEN]
    return f"""<mujoco model="biped">
  <asset><mesh name="rod" vertex="0 0 0 0.1 0 0 0 0.1 0 0 0 -0.4"/></asset>
  <worldbody>
    <body name="pelvis" pos="0 0 1"><freejoint name="root"/><inertial pos="0 0 0" mass="10" diaginertia="0.1 0.1 0.1"/>{"".join(legs)}
    </body>
  </worldbody>
  <equality>{"".join(loops)}</equality>
  <actuator>{"".join(motors)}</actuator>
</mujoco>
"""


_DRIVEN = ("hip-roll", "hip-yaw", "hip-pitch", "knee", "toe")
