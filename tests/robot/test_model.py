"""A robot as an object: its elements by name, its kinematics, and other libraries' views of it."""

from __future__ import annotations

import pickle

import mujoco
import numpy as np
import pytest

import hymeko_x as hx
from tests.robot.robots import arm, claw, hand


def test_elements_are_found_by_name_and_have_typed_fields() -> None:
    robot = arm()
    elbow = robot.joints["elbow"]
    assert (elbow.type, elbow.axis, elbow.limits.upper, elbow.parent.name, elbow.child.name) == ("hinge", (0, 1, 0), 1.5, "upper", "fore")
    assert [child.name for child in robot.bodies["base"].children] == ["upper"]
    assert robot.bodies["fore"].parent == robot.bodies["upper"]
    assert robot.bodies["base"].mass == 4
    assert robot.frames["flange"].body == robot.bodies["fore"]
    assert robot.actuators["lift"].drives == (elbow,)
    assert robot.sensors["angle"].measures == (elbow,)
    assert robot.shapes["foot"].material == robot.materials["steel"]
    assert [*robot.joints] == ["base", "shoulder", "elbow"]
    assert [body.name for body in robot.bodies["upper"].subtree()] == ["upper", "fore"]


def test_an_unknown_name_is_a_key_error_with_similar_names() -> None:
    with pytest.raises(KeyError) as error:
        arm().joints["elbw"]
    assert str(error.value) == "there is no joint 'elbw'; did you mean 'elbow'?"
    with pytest.raises(KeyError) as error:
        arm().cameras["front"]
    assert str(error.value) == "there is no camera 'front'; the robot has no camera"
    assert "elbw" not in arm().joints
    assert arm().joints.get("elbw") is None


def test_the_text_of_a_robot_is_one_line_or_a_tree_of_at_most_forty() -> None:
    assert repr(claw()) == "<Robot 'claw': 2 bodies, 1 joints (1 dofs), from <text>>"
    free = hx.loads("r : robot { a {} @j : floating { + world - a } }", "hymeko")
    assert repr(free) == f"<Robot 'r': 1 bodies, 1 joints ({free.dofs} dofs), from <text>>"
    assert free.dofs == 6
    assert str(claw()).splitlines()[1:] == ["palm", "  finger  (close: hinge)"]
    links = "".join(f"<link name='l{number}'/>" for number in range(100))
    joints = "".join(
        f"<joint name='j{number}' type='fixed'><parent link='l{number - 1}'/><child link='l{number}'/></joint>" for number in range(1, 100)
    )
    lines = str(hx.loads(f"<robot name='r'>{links}{joints}</robot>", "urdf")).splitlines()
    assert (len(lines), lines[-1]) == (40, "... and 62 more bodies")


def test_the_mass_counts_what_the_engine_computes_from_shapes() -> None:
    assert arm().mass == pytest.approx(7)
    assert arm().mass == pytest.approx(sum(arm().to_mujoco().body_mass))
    upper = arm().bodies["upper"]
    assert upper.part.inertial is None
    assert upper.mass == pytest.approx(arm().to_mujoco().body("upper").mass[0])
    with arm().edit() as e:
        e.bodies["upper"].mass *= 2
    assert e.robot.mass == pytest.approx(7 + upper.mass)
    assert hx.loads("<robot name='r'><link name='l'/></robot>", "urdf").bodies["l"].mass is None


def test_forward_kinematics_is_that_of_mujoco() -> None:
    robot = arm()
    model = robot.to_mujoco()
    data = mujoco.MjData(model)
    data.qpos[:] = (0.3, -0.7)
    mujoco.mj_forward(model, data)
    for q in ({"shoulder": 0.3, "elbow": -0.7}, (0.3, -0.7), np.array((0.3, -0.7))):
        poses = robot.fk(q)
        assert set(poses) == {"base", "upper", "fore"}
        for name, pose in poses.items():
            assert np.abs(np.array(pose.matrix())[:3, 3] - data.body(name).xpos).max() < 1e-12
            assert np.abs(np.array(pose.matrix())[:3, :3] - data.body(name).xmat.reshape(3, 3)).max() < 1e-12
            assert robot.bodies[name].world_pose(q) == pose
    assert np.abs(np.array(robot.frames["flange"].world_pose((0.3, -0.7)).xyz) - data.site("flange").xpos).max() < 1e-12
    with pytest.raises(hx.EditError, match="robot 'arm' has 2 coordinates, found 3"):
        robot.fk((1, 2, 3))
    with pytest.raises(KeyError, match="there is no joint 'ellbow'; did you mean 'elbow'"):
        robot.fk({"ellbow": 1})


def test_a_joint_that_follows_another_moves_with_it() -> None:
    robot = hand()
    assert robot.fk({"right": 0.01})["left"].xyz[1] == pytest.approx(0.02 + 0.01)
    assert robot.fk({"right": 0.01, "left": 0})["left"].xyz[1] == pytest.approx(0.02)


def test_other_libraries_get_the_robot_in_memory() -> None:
    assert (arm().to_mujoco().nbody, arm().dofs) == (4, 2)
    assert claw().to_pinocchio().names[1] == "close"
    stage = claw().to_usd()
    assert stage.GetDefaultPrim().GetName() == "claw"
    graph = claw().to_networkx()
    assert graph.nodes[hx.Id("body", "palm")]["part"] == claw().bodies["palm"].part
    assert graph.number_of_edges() == sum(len(edge.arcs) for edge in claw().mechanism.graph.edges.values())


def test_every_public_function_takes_a_robot() -> None:
    robot = claw()
    assert hx.dumps(robot, "urdf") == hx.dumps(robot.mechanism, "urdf")
    assert hx.diff(robot, robot.mechanism) == ()
    assert hx.verify(robot, robot.mechanism, samples=3).verdict == "same"
    ours, theirs = (hx.dynamics(given).state_space().floats for given in (robot, robot.mechanism))
    assert all(np.array_equal(a, b) for a, b in zip(ours, theirs, strict=True))


def test_a_robot_that_was_loaded_has_names_and_a_short_text() -> None:
    robot = hx.loads(hx.dumps(claw(), "urdf"), "urdf")
    assert robot.joints["close"].child.name == "finger"
    assert len(repr(robot).splitlines()) == 1
    assert "finger" in str(robot)


def test_a_robot_is_the_same_in_another_process() -> None:
    robot = hx.loads(hx.dumps(claw(), "urdf"), "urdf")
    again = pickle.loads(pickle.dumps(robot))
    assert again == robot
    assert hx.dumps(again, "urdf") == hx.dumps(robot, "urdf")


@pytest.mark.parametrize(
    ("matrix", "message"),
    [
        ([[2, 0, 0], [0, 1, 0], [0, 0, 1]], "the matrix is no rotation: it scales, shears or mirrors"),
        ([[2, 0, 0], [0, 2, 0], [0, 0, 2]], "the matrix is no rotation: it scales, shears or mirrors"),
        ([[-1, 0, 0], [0, 1, 0], [0, 0, 1]], "the matrix is no rotation: it scales, shears or mirrors"),
        ([[float("nan"), 0, 0], [0, 1, 0], [0, 0, 1]], "the matrix is no rotation: it scales, shears or mirrors"),
        ([[1, 0], [0, 1]], "a pose is a matrix of 4 x 4 or 3 x 3 numbers"),
    ],
)
def test_a_matrix_that_is_no_pose_is_refused(matrix: list[list[float]], message: str) -> None:
    with pytest.raises(ValueError, match=f"^{message}$"):
        hx.Pose.from_matrix(matrix)


def test_a_robot_does_not_change() -> None:
    with pytest.raises(hx.EditError, match=r"body 'palm' belongs to a robot, which does not change; use `with robot.edit\(\) as e:`"):
        claw().bodies["palm"].mass = 1


def test_poses_are_made_of_angles_matrices_and_each_other() -> None:
    turned = hx.Pose.from_rpy((0, 0, 90 * hx.deg), (0, 0, 5 * hx.mm))
    assert np.allclose((turned @ hx.Pose((1, 0, 0))).xyz, (0, 1, 0.005), atol=1e-15)
    rng = np.random.default_rng(0)
    for quat in [*rng.normal(size=(200, 4)), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1), (1e-9, 1, 1, 0)]:
        pose = hx.Pose.from_quat(tuple(quat), (1, 2, 3))
        again = hx.Pose.from_matrix(pose.matrix())
        assert np.allclose(again.matrix(), pose.matrix(), atol=1e-15)
        assert np.allclose((pose @ pose.inverse()).matrix(), np.eye(4), atol=1e-14)
