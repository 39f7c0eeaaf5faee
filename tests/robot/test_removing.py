"""What is removed leaves nothing behind that names it, also not in what only MJCF can represent."""

from __future__ import annotations

import pytest

import hymeko_x as hx
from tests.robot.robots import ARM, HAND, arm, check_same_model

COUPLED = HAND.replace(
    "<tendon>", '<tendon><fixed name="both"><joint joint="left" coef="1"/><joint joint="right" coef="1"/></fixed>'
).replace("<equality>", '<equality><tendon name="equal" tendon1="split" tendon2="both"/>')
WATCHED = HAND.replace(
    "<worldbody>",
    '<worldbody><camera name="eye" pos="1 0 1" mode="targetbody" target="left"/>'
    '<light name="lamp" pos="0 1 1" mode="targetbody" target="left"/>',
)


def coupled() -> hx.Robot:
    return hx.loads(COUPLED, "mjcf")


def test_a_removed_tendon_goes_with_the_equality_that_names_it() -> None:
    assert coupled().to_mujoco().neq == 2
    with coupled().edit() as e:
        e.remove(e.tendons["both"])
    assert e.robot.to_mujoco().neq == 1
    with coupled().edit() as e:
        e.remove(e.bodies["left"])
    assert e.robot.to_mujoco().neq == 0


def test_cameras_and_lights_that_follow_a_removed_body_stay_where_they_are() -> None:
    with hx.loads(WATCHED, "mjcf").edit() as e:
        e.remove(e.bodies["left"])
    model = e.robot.to_mujoco()
    assert (model.cam_mode.tolist(), model.light_mode.tolist()) == ([0], [0])
    assert model.camera("eye").pos.tolist() == [1, 0, 1]


def test_a_part_that_is_detached_takes_its_equalities_with_it() -> None:
    rest, back = arm().attach(coupled(), at="flange", prefix="hand/").detach("hand/")
    assert rest.to_mujoco().nkey == 1
    check_same_model(rest.to_mujoco(), arm().to_mujoco())
    assert back.to_mujoco().neq == 2


def test_the_slash_of_a_prefix_may_be_left_out() -> None:
    whole = arm().attach(coupled(), at="flange", prefix="hand/")
    (rest, back), (short_rest, short_back) = whole.detach("hand/"), whole.detach("hand")
    assert [*short_back.bodies] == ["palm", "left", "right"]
    assert (short_rest, short_back) == (rest, back)


KEYED = ARM.replace('ctrl="0.1 0"/>', 'ctrl="0.1 0.3"/>')


def test_keyframes_fit_a_robot_with_more_and_with_fewer_joints() -> None:
    with hx.loads(KEYED, "mjcf").edit() as e:
        e.add_body("ball", on="world", at=(1, 2, 3), joint="free", mass=1, tensor=(1, 1, 1, 0, 0, 0))
        e.add_body("tool", on="upper", joint="slide", mass=1, tensor=(1, 1, 1, 0, 0, 0))
    model = e.robot.to_mujoco()
    assert (model.key("home").qpos.tolist(), model.key("home").ctrl.tolist()) == ([0.1, 0.2, 0, 1, 2, 3, 1, 0, 0, 0], [0.1, 0.3])
    with e.robot.edit() as e:
        e.remove(e.joints["shoulder"])
        e.add_joint("weld", parent="base", child="upper", at=(0, 0, 0.1))
        e.remove(e.bodies["ball"])
    model = e.robot.to_mujoco()
    assert (model.key("home").qpos.tolist(), model.key("home").ctrl.tolist()) == ([0.2, 0], [0.3])


def test_each_part_takes_its_own_keyframes_along() -> None:
    hand = hx.loads(HAND.replace("</mujoco>", '<keyframe><key name="open" qpos="0.01 0.02" ctrl="3"/></keyframe></mujoco>'), "mjcf")
    rest, back = arm().attach(hand, at="flange", prefix="hand/").detach("hand/")
    assert [rest.to_mujoco().key(0).name, rest.to_mujoco().nkey] == ["home", 1]
    assert [back.to_mujoco().key(0).name, back.to_mujoco().nkey] == ["open", 1]
    assert back.to_mujoco().key("open").qpos.tolist() == [0.01, 0.02]


def test_a_part_takes_along_what_only_its_format_has() -> None:
    hand = hx.loads(HAND.replace("</mujoco>", '<custom><numeric name="grasp" data="1 2"/></custom></mujoco>'), "mjcf")
    whole = arm().attach(hand, at="flange", prefix="hand/")
    rest, back = whole.detach("hand/")
    assert [found.to_mujoco().nnumeric for found in (whole, rest, back)] == [1, 0, 1]
    assert back.to_mujoco().numeric("grasp").data.tolist() == [1, 2]


SENSED = """<mujoco model="sensed"><asset><material name="grey" rgba=".5 .5 .5 1"/></asset>
<worldbody><body name="base"><geom size=".1" mass="1" material="grey"/>
<body name="finger" pos="0 0 .2"><joint name="j"/><geom size=".1" mass="1" material="grey"/>
<site name="tip" size=".02"/><camera name="eye"/></body></body></worldbody>
<actuator><motor name="push" site="tip" gear="1 0 0 0 0 0"/></actuator><sensor><touch name="felt" site="tip"/></sensor></mujoco>"""


def test_a_part_takes_along_sites_with_sensors_and_actuators() -> None:
    rest, part = hx.loads(SENSED, "mjcf").detach("finger")
    assert ([*part.frames], [*part.sensors], [*part.actuators], [*part.cameras]) == (["tip"], ["felt"], ["push"], ["eye"])
    assert not [*rest.frames, *rest.sensors, *rest.actuators, *rest.cameras]
    model = part.to_mujoco()
    assert (model.nsensor, model.nu, model.nsite) == (1, 1, 1)
    assert "sensor" not in hx.dumps(rest, "mjcf")


def test_what_was_detached_without_a_prefix_goes_back_on_although_both_have_its_materials() -> None:
    whole = hx.loads(SENSED, "mjcf")
    joint = whole.joints["j"]
    rest, part = whole.detach("finger")
    again = rest.attach(part, at="base", joint=joint.part, pose=joint.pose)
    assert [*again.materials] == ["grey"]
    assert {str(item.element) for item in hx.diff(again, whole)} == {"joint 'finger_joint'", "joint 'j'"}
    with part.edit() as e:
        e.materials["grey"].rgba = (1, 0, 0, 1)
    with pytest.raises(hx.EditError, match="material 'grey' is in robot 'sensed' and in robot 'finger'; give a prefix"):
        rest.attach(e.robot, at="base")


# ---- articulations of a stage -----------------------------------------------------------------------------------------------------

ARTICULATED = "PhysicsArticulationRootAPI"


def stage(text: str) -> hx.Robot:
    """A robot as its stage has it."""
    return hx.loads(hx.dumps(hx.loads(text, "hymeko"), "usd"), "usd")


ONE = "one : robot { base { mass 1 inertia [1 1 1] } }"
TWO = "two : robot { foot { mass 1 inertia [1 1 1] } tip { mass 1 inertia [1 1 1] } @j : revolute { + foot - tip axis=Z } }"


def test_a_stage_is_an_articulation_as_long_as_it_has_joints() -> None:
    two = stage(TWO)
    with two.edit() as e:
        e.remove("tip")
    assert hx.loads(hx.dumps(e.robot, "usd"), "usd").bodies.keys() == {"foot"}
    assert [ARTICULATED in hx.dumps(robot, "usd") for robot in (two, e.robot, two.subtree("tip"))] == [True, False, False]


def test_a_stage_that_gets_its_first_joint_is_an_articulation() -> None:
    one = stage(ONE)
    with one.edit() as e:
        e.add_body("tip", on="base", joint="hinge", axis=(0, 0, 1), mass=1, tensor=(1, 1, 1, 0, 0, 0))
    whole = one.attach(stage(TWO), at="base", prefix="x/")
    hinged = one.attach(one, at="base", prefix="x/", joint="hinge")
    assert [ARTICULATED in hx.dumps(robot, "usd") for robot in (one, e.robot, whole, hinged)] == [False, True, True, True]
    assert [ARTICULATED in hx.dumps(part, "usd") for part in whole.detach("x/")] == [False, True]
    assert ARTICULATED not in hx.dumps(one.attach(one, at="base", prefix="x/"), "usd")


def test_what_an_author_has_beside_the_api_of_an_articulation_stays() -> None:
    text = hx.dumps(hx.loads(TWO, "hymeko"), "usd").replace(f'["{ARTICULATED}"]', f'["{ARTICULATED}", "PhysxArticulationAPI"]')
    with hx.loads(text, "usd").edit() as e:
        e.remove("tip")
    written = hx.dumps(e.robot, "usd")
    assert (ARTICULATED in written, '["PhysxArticulationAPI"]' in written) == (False, True)
