"""Named configurations of a robot: group states and poses of every format, and keyframes of MJCF."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

import hymeko_x as hx
from tests.robot.robots import arm, claw

DRONE = """<mujoco model="drone">
  <worldbody>
    <body name="hull" pos="0 0 1" euler="0 0 90"><freejoint name="fly"/><geom size=".1"/>
      <body name="eye" pos="0 0 1"><joint name="gimbal" type="ball"/><geom size=".1"/></body>
    </body>
  </worldbody>
  <keyframe><key name="up" qpos="1 0 2 0.8 0 0.6 0 0 0 1 0" time="3"/><key/></keyframe>
</mujoco>"""


def drone() -> hx.Robot:
    return hx.loads(DRONE, "mjcf")


def test_a_keyframe_is_a_pose_with_its_coordinates_by_joint() -> None:
    assert [*arm().poses] == ["home"]
    assert arm().poses["home"].values == {"shoulder": (0.1,), "elbow": (0.2,)}
    with pytest.raises(KeyError, match="there is no pose 'hom'; did you mean 'home'"):
        arm().poses["hom"]


def test_kinematics_at_a_keyframe_are_those_of_mujoco() -> None:
    model = drone().to_mujoco()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_kinematics(model, data)
    poses = drone().fk(drone().poses["up"].values)
    assert [*poses] == ["hull", "eye"]
    for name, pose in poses.items():
        assert np.allclose(np.array(pose.matrix())[:3, 3], data.body(name).xpos, atol=1e-12)
        assert np.allclose(np.array(pose.matrix())[:3, :3], data.body(name).xmat.reshape(3, 3), atol=1e-12)


def test_a_pose_with_a_free_joint_is_a_keyframe_where_it_floats_and_comes_back() -> None:
    text = """drone : robot { world {} hull { mass 1 inertia [1 1 1] } @fly : floating { [[0 0 1] [0 0 90]] + world - hull }
      up : pose {} @up_values : stance { + up [1 0 0 0.8 0 0.6 0] ~ fly } }"""
    robot = hx.loads(text, "hymeko")
    model = robot.to_mujoco()
    assert model.key("up").qpos[:3] == pytest.approx([0, 1, 1])
    back = hx.loads(hx.dumps(robot, "mjcf"), "mjcf")
    assert back.poses["up"].values["fly"] == pytest.approx(robot.poses["up"].values["fly"])


def test_keyframes_are_renamed_and_removed_and_their_names_are_taken() -> None:
    with drone().edit() as e:
        e.rename("up", "high")
        e.rename(e.joints["gimbal"], "head")
        assert e.poses["high"].values["head"] == (0, 0, 1, 0)
        with pytest.raises(hx.EditError, match="there is a pose 'high' already"):
            e.add_pose("high", {"head": (1, 0, 0, 0)})
        with pytest.raises(hx.EditError, match="pose 'high' is a text of its format"):
            e.poses["high"].time = 1.0
        e.add_pose("new", {"head": (1, 0, 0, 0)})
    model = e.robot.to_mujoco()
    assert [model.key(number).name for number in range(model.nkey)] == ["high", "", "new"]
    assert (model.key("high").time.tolist(), model.key("high").qpos.tolist()) == ([3], [1, 0, 2, 0.8, 0, 0.6, 0, 0, 0, 1, 0])
    with e.robot.edit() as e:
        e.remove(e.poses["high"])
        e.remove("new")
    assert ([*e.robot.poses], e.robot.to_mujoco().nkey) == ([], 1)


def test_a_robot_without_any_has_none() -> None:
    assert (len(claw().poses), "home" in claw().poses) == (0, False)
