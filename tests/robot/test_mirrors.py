"""The mirror image of cameras, of free and ball joints in keyframes, and of what pushes in a direction."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

import hymeko_x as hx
from tests.robot.robots import check_same_model

DRONE = """<mujoco>
  <worldbody>
    <camera name="side" pos="2 -1 1" xyaxes="0.6 0.8 0 0 0 1"/>
    <body name="hull" pos="0 0 1">
      <freejoint name="fly"/>
      <geom type="box" size=".1 .2 .05"/>
      <camera name="ahead" pos=".1 .05 0" quat="0.5 0.5 -0.5 -0.5"/>
      <camera name="down"/>
      <site name="rotor" pos=".1 .2 0" euler="10 20 30"/>
      <body name="eye" pos="0 .1 .1">
        <joint name="look" type="ball"/>
        <geom size=".02" mass=".1"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="thrust" site="rotor" gear="1 2 3 .1 .2 .3"/>
    <motor name="gaze" joint="look" gear=".1 .2 .3"/>
    <motor name="wind" joint="fly" gear="1 2 3 4 5 6"/>
  </actuator>
  <keyframe><key name="far" qpos="1 2 3 .5 .5 -.5 .5 .6 0 .8 0" qvel="1 2 3 4 5 6 7 8 9"/></keyframe>
</mujoco>"""
FLIP = np.diag((1.0, -1.0, 1.0))


@pytest.fixture
def images() -> tuple[tuple[mujoco.MjModel, mujoco.MjData], tuple[mujoco.MjModel, mujoco.MjData]]:
    """The drone and its mirror image at their keyframes, with all motors on."""
    found = []
    for robot in (hx.loads(DRONE, "mjcf"), hx.loads(DRONE, "mjcf").mirrored()):
        model = robot.to_mujoco()
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, 0)
        data.ctrl[:] = 1, 2, 3
        mujoco.mj_forward(model, data)
        found.append((model, data))
    return found[0], found[1]


def test_a_keyframe_is_the_mirrored_one(images) -> None:  # type: ignore[no-untyped-def]
    (_, data), (_, image) = images
    assert data.body("hull").xpos.tolist() == [1, 2, 3]
    for name in ("hull", "eye"):
        assert np.allclose(image.body(name).xpos, FLIP @ data.body(name).xpos, atol=1e-12)
        assert np.allclose(image.body(name).xmat.reshape(3, 3), FLIP @ data.body(name).xmat.reshape(3, 3) @ FLIP, atol=1e-12)


def test_a_camera_looks_at_the_mirrored_scene_with_its_up_still_up(images) -> None:  # type: ignore[no-untyped-def]
    (_, data), (_, image) = images
    for name in ("side", "ahead", "down"):
        before, after = (found.camera(name).xmat.reshape(3, 3) for found in (data, image))
        assert np.allclose(after @ np.diag((-1, 1, 1)), FLIP @ before, atol=1e-12)


def test_the_mirror_image_of_the_image_is_the_drone() -> None:
    drone = hx.loads(DRONE, "mjcf")
    check_same_model(drone.mirrored().mirrored().to_mujoco(), drone.to_mujoco())


def test_thrusts_and_torques_move_the_image_as_the_original(images) -> None:  # type: ignore[no-untyped-def]
    (_, data), (_, image) = images
    assert np.abs(data.qacc).max() > 1
    signs = np.array((1, -1, 1, -1, 1, -1, -1, 1, -1))
    assert np.allclose(image.qacc, data.qacc * signs, rtol=1e-9, atol=1e-9)
