"""`--for ros2`: a URDF with an SRDF beside it that ROS, MoveIt, ros2_control and Pinocchio take as they are."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest
from lxml import etree

import hymeko_x as hx
from hymeko_x.diagnostics import Report
from hymeko_x.ir.parts import Actuator

ARM = """
<mujoco model="arm">
  <compiler angle="radian"/>
  <default><default class="limb"><geom type="capsule" size="0.03" fromto="0 0 0 0 0 0.3"/></default></default>
  <worldbody>
    <light name="sun" pos="0 0 3"/>
    <geom name="floor" type="plane" size="0 0 1"/>
    <body name="base" childclass="limb">BASE<geom/>
      <body name="upper" pos="0 0 0.3"><joint name="shoulder" axis="0 1 0" range="-2 2"/><geom/>
        <site name="imu" pos="0 0 0.1" euler="0 0 1.57"/>
        <body name="hand" pos="0 0 0.3"><geom size="0.02"/>
          <body name="left"><joint name="b_left" type="slide" axis="0 1 0" range="0 0.04"/><geom size="0.01"/></body>
          <body name="right"><joint name="c_right" type="slide" axis="0 -1 0" range="0 0.04"/><geom size="0.01"/></body>
          <body name="thumb"><joint name="a_thumb" type="slide" axis="1 0 0" range="0 0.1"/><geom size="0.01"/></body>
        </body>
      </body>
    </body>
  </worldbody>
  <equality>
    <joint joint1="b_left" joint2="c_right"/>
    <joint joint1="a_thumb" joint2="b_left" polycoef="0.01 2 0 0 0"/>
  </equality>
  <contact><exclude body1="base" body2="hand"/></contact>
  <actuator>
    <position name="turn" joint="shoulder" kp="300" kv="20" forcerange="-40 40" ctrlrange="-2 2" gear="2"/>
    <velocity name="slow" joint="shoulder" kv="3"/>
    <motor name="grip" joint="c_right" ctrlrange="-5 5"/>
  </actuator>
  <keyframe><key name="home" qpos="QPOS0.5 0.01 0.01 0.03"/></keyframe>
</mujoco>
"""
FIXED = ARM.replace("BASE", "").replace("QPOS", "")
DRIVEN_THUMB = FIXED.replace('"c_right" ctrlrange', '"a_thumb" ctrlrange')
FLOATING = ARM.replace("BASE", "<freejoint name='root'/>").replace("QPOS", "0 0 1 1 0 0 0 ")


def package(text: str, folder: Path) -> Path:
    """The URDF in a ROS package, made of this MJCF."""
    source, output = folder / "arm.xml", folder / "arm_description" / "arm.urdf"
    source.write_text(text, "utf-8")
    output.parent.mkdir()
    hx.convert(source, output, target="ros2")
    return output


def srdf_of(urdf: Path) -> etree._Element:
    return etree.parse(str(urdf.with_suffix(".srdf"))).getroot()


@pytest.fixture
def urdf(tmp_path: Path) -> Path:
    return package(FIXED, tmp_path)


# ---- the URDF ------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", [DRIVEN_THUMB, FLOATING.replace('"c_right" ctrlrange', '"a_thumb" ctrlrange')])
def test_pinocchio_with_mimic_joints_finds_each_link_and_joint_once(text: str, tmp_path: Path) -> None:
    urdf = package(text, tmp_path)
    model = pin.buildModelFromUrdf(str(urdf), mimic=True)
    tree = etree.parse(str(urdf))
    names = [element.get("name") for element in (*tree.findall("link"), *tree.findall("joint"))]
    counts = Counter(frame.name for frame in model.frames)
    assert {name: counts[name] for name in names} == dict.fromkeys(names, 1)
    assert [model.frames[model.getFrameId(name)].name for name in names] == names
    assert (model.nq, model.nv) == (2, 2)  # the shoulder, and the first finger of the tree, which both others follow


def mimics_of(urdf: Path) -> dict[str, dict[str, str]]:
    mimics = {joint.get("name"): joint.find("mimic") for joint in etree.parse(str(urdf)).findall("joint")}
    return {name: dict(mimic.attrib) for name, mimic in mimics.items() if mimic is not None}


def test_the_joint_that_comes_first_leads_and_the_coordinates_stay(tmp_path: Path) -> None:
    assert mimics_of(package(DRIVEN_THUMB, tmp_path)) == {
        "b_left": {"joint": "a_thumb", "multiplier": "0.5", "offset": "-0.005"},
        "c_right": {"joint": "a_thumb", "multiplier": "0.5", "offset": "-0.005"},
    }


def test_a_driven_joint_leads_wherever_it_stands(tmp_path: Path) -> None:
    """ros2_control refuses a command interface of a mimic joint."""
    by_hand = {
        "b_left": {"joint": "c_right", "multiplier": "1", "offset": "0"},
        "a_thumb": {"joint": "c_right", "multiplier": "2", "offset": "0.01"},
    }
    assert mimics_of(package(FIXED, tmp_path)) == by_hand
    (tmp_path / "left").mkdir()
    driven_left = FIXED.replace('"c_right" ctrlrange', '"b_left" ctrlrange')
    assert mimics_of(package(driven_left, tmp_path / "left")) == {
        "a_thumb": {"joint": "b_left", "multiplier": "2", "offset": "0.01"},
        "c_right": {"joint": "b_left", "multiplier": "1", "offset": "0"},
    }


def test_a_joint_is_called_apart_from_a_link_and_a_site_is_a_link(urdf: Path) -> None:
    tree = etree.parse(str(urdf))
    joints = {joint.get("name"): joint.find("child").get("link") for joint in tree.findall("joint")}
    assert joints["hand_joint"] == "hand"
    assert joints["imu_joint"] == "imu"
    assert tree.find("joint[@name='imu_joint']/origin").get("xyz") == "0 0 0.1"
    assert not {link.get("name") for link in tree.findall("link")} & joints.keys()


def test_without_sites_there_is_no_such_link(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(FIXED, "utf-8")
    hx.convert(tmp_path / "arm.xml", tmp_path / "arm.urdf", target="ros2", sites=False)
    assert etree.parse(str(tmp_path / "arm.urdf")).find("link[@name='imu']") is None


def test_a_floating_base_is_open_and_a_virtual_joint_of_the_srdf(tmp_path: Path) -> None:
    urdf = package(FLOATING, tmp_path)
    tree = etree.parse(str(urdf))
    assert tree.find("link[@name='world']") is None
    assert [dict(node.attrib) for node in srdf_of(urdf).findall("virtual_joint")] == [
        {"name": "root", "type": "floating", "parent_frame": "world", "child_link": "base"}
    ]
    back = hx.load(urdf).mechanism
    assert [dof.kind.value for view in back.joints.values() if view.id.name == "root" for dof in view.joint.dofs] == ["free"]


def test_a_sensor_that_measures_against_the_world_leaves_the_base_open(tmp_path: Path) -> None:
    sensor = '<sensor><framezaxis name="up" objtype="xbody" objname="world" reftype="xbody" refname="base"/></sensor></mujoco>'
    tree = etree.parse(str(package(FLOATING.replace("</mujoco>", sensor), tmp_path)))
    assert tree.find("link[@name='world']") is None
    assert [joint.get("name") for joint in tree.findall("joint") if joint.find("child").get("link") == "base"] == []


def test_what_only_a_simulation_has_is_left_out_with_a_note(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(FLOATING, "utf-8")
    result = hx.convert(tmp_path / "arm.xml", tmp_path / "arm.urdf", target="ros2")
    messages = [diagnostic.message for diagnostic in result.report if diagnostic.code.id == "HX114"]
    assert "what only a simulation has on the world is left out (--for ros2): plane 'floor', light 'sun'" in messages
    assert [loss for loss in result.losses or () if "floor" in loss.element or "imu" in loss.element] == []


# ---- ros2_control --------------------------------------------------------------------------------------------------------------


def test_ros2_control_has_a_command_interface_for_each_drive(urdf: Path) -> None:
    system = etree.parse(str(urdf)).find("ros2_control")
    assert system.find("hardware/plugin").text == "mock_components/GenericSystem"
    found = {
        joint.get("name"): {
            interface.get("name"): {item.get("name"): item.text for item in interface} for interface in joint.findall("command_interface")
        }
        for joint in system.findall("joint")
    }
    turn = {"actuator": "turn", "actuator_type": "position", "gear": "2", "kp": "300", "kv": "20"}
    assert found["shoulder"]["position"] == {"min": "-2", "max": "2", **turn, "ctrlrange": "-2 2", "forcerange": "-40 40"}
    assert found["shoulder"]["velocity"] == {"actuator": "slow", "actuator_type": "velocity", "kv": "3"}
    assert found["c_right"]["effort"]["actuator_type"] == "motor"
    assert [node.get("name") for node in system.findall("joint[@name='shoulder']/state_interface")] == ["position", "velocity", "effort"]
    assert system.find("joint[@name='shoulder']/state_interface[@name='position']/param[@name='initial_value']").text == "0.5"


def test_the_world_comes_first_and_ros2_control_last(tmp_path: Path) -> None:
    elements = [(tag.tag, tag.get("name")) for tag in etree.parse(package(FIXED, tmp_path)).getroot() if isinstance(tag.tag, str)]
    assert elements[0] == ("link", "world")
    assert elements[-1] == ("ros2_control", "arm")


def test_an_interface_without_a_type_is_a_command_of_unknown_gains() -> None:
    text = '<ros2_control name="s" type="system"><joint name="j"><command_interface name="position"/></joint></ros2_control>'
    joint = '<joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>'
    robot = hx.loads(f'<robot name="r"><link name="a"/><link name="b"/>{joint}{text}</robot>', "urdf").mechanism
    assert [(key.name, part) for key, part in robot.vertices(Actuator)] == [("j", Actuator("transmission"))]


ROS_1 = """<robot name="r">
  <link name="a"/> <link name="b"/> <link name="c"/> <link name="d"/>
  <joint name="turn" type="revolute"><parent link="a"/><child link="b"/><limit lower="-1" upper="2" effort="60" velocity="3"/></joint>
  <joint name="pitch" type="continuous"><parent link="b"/><child link="c"/><limit effort="40" velocity="2"/></joint>
  <joint name="roll" type="continuous"><parent link="c"/><child link="d"/><limit effort="30" velocity="2"/></joint>
  <transmission name="turn_trans">
    <type>transmission_interface/SimpleTransmission</type>
    <joint name="turn"><hardwareInterface>hardware_interface/PosVelJointInterface</hardwareInterface></joint>
    <actuator name="turn_motor"><mechanicalReduction>50</mechanicalReduction></actuator>
  </transmission>
  <transmission name="wrist_trans">
    <type>transmission_interface/DifferentialTransmission</type>
    <actuator name="left"><role>actuator1</role><mechanicalReduction>10</mechanicalReduction></actuator>
    <actuator name="right"><role>actuator2</role><mechanicalReduction>-10</mechanicalReduction></actuator>
    <joint name="pitch"><role>joint1</role><offset>0.25</offset><hardwareInterface>EffortJointInterface</hardwareInterface></joint>
    <joint name="roll"><role>joint2</role><offset>0</offset><hardwareInterface>EffortJointInterface</hardwareInterface></joint>
  </transmission>
  <transmission name="odd_trans"><type>acme/Odd</type><joint name="roll"/><actuator name="odd"/></transmission>
</robot>"""


@pytest.mark.unread("HX104")
def test_transmissions_of_ros_1_are_commands_and_transmissions_of_ros_2(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(ROS_1, "utf-8")
    (tmp_path / "out").mkdir()
    done = hx.convert(tmp_path / "r.urdf", tmp_path / "out" / "r.urdf", target="ros2")
    assert [loss.element for loss in done.losses] == []
    root = etree.parse(tmp_path / "out" / "r.urdf").getroot()
    assert [node.get("name") for node in root.findall("transmission")] == ["odd_trans"]
    warned = [item.message for item in done.report if item.code.id == "HX104"]
    assert warned == [
        "1 transmission of ROS 1 (of other kinds, and of joints that are fixed or follow others) stay as they are, "
        "and ROS 2 does not read them: 'odd_trans' (Odd)"
    ]
    system = root.find("ros2_control")
    commands = {joint.get("name"): [node.get("name") for node in joint.findall("command_interface")] for joint in system.findall("joint")}
    assert commands == {"turn": ["position", "velocity"], "pitch": ["effort"], "roll": ["effort"]}
    turn, wrist = system.findall("transmission")
    assert turn.findtext("plugin") == "transmission_interface/SimpleTransmission"
    assert turn.findtext("joint/mechanical_reduction") == "50"
    assert wrist.findtext("plugin") == "transmission_interface/DifferentialTransmission"
    ends = [(node.get("name"), node.get("role"), *(child.text for child in node)) for node in wrist if node.tag != "plugin"]
    assert ends == [("left", "actuator1", "10"), ("right", "actuator2", "-10"), ("pitch", "joint1", "0.25"), ("roll", "joint2")]


@pytest.mark.parametrize("text", [FIXED, FLOATING])
def test_the_way_through_urdf_and_srdf_and_back_gives_the_same_torques(text: str, tmp_path: Path) -> None:
    urdf = package(text, tmp_path)
    hx.convert(urdf, tmp_path / "back.xml", target="mujoco")
    before, after = (mujoco.MjModel.from_xml_path(str(tmp_path / name)) for name in ("arm.xml", "back.xml"))
    assert [before.actuator(i).name for i in range(before.nactuator)] == [after.actuator(i).name for i in range(after.nactuator)]
    random = np.random.default_rng(1)
    data, other = mujoco.MjData(before), mujoco.MjData(after)
    moved = ("shoulder", "a_thumb", "b_left", "c_right")
    for _ in range(50):
        data.ctrl[:] = other.ctrl[:] = random.uniform(-3, 3, before.nu)
        for name in moved:
            data.joint(name).qpos[:] = other.joint(name).qpos[:] = random.normal()
            data.joint(name).qvel[:] = other.joint(name).qvel[:] = random.normal()
        mujoco.mj_forward(before, data)
        mujoco.mj_forward(after, other)
        ours, theirs = (np.array([found.joint(name).qfrc_actuator[0] for name in moved]) for found in (data, other))
        assert np.abs(ours - theirs).max() <= 1e-6 * np.abs(ours).max()
    assert [after.key(i).name for i in range(after.nkey)] == ["home"]
    assert after.key("home").qpos[after.joint("shoulder").qposadr[0]] == 0.5


SHOULDER = """<mujoco model="shoulder">
  <compiler angle="radian"/>
  <worldbody>
    <body name="trunk"><geom size="0.1"/>
      <body name="arm" pos="0 0 0.3"><geom size="0.1"/>
        <joint name="lift" axis="0 1 0" ref="0.2" range="-1 2" pos="0 0 -0.1"/><joint name="turn" axis="0 0 1" pos="0 0.05 0"/>
        <body name="fore" pos="0 0 0.3"><geom size="0.05"/><joint name="elbow" axis="0 1 0"/>
          <body name="ball" pos="0 0 0.3"><geom size="0.05"/><joint name="wrist" type="ball"/></body>
        </body>
      </body>
    </body>
  </worldbody>
  <tendon><fixed name="both"><joint joint="turn" coef="0.5"/><joint joint="elbow" coef="2"/></fixed></tendon>
  <actuator>
    <position name="lifts" joint="lift" kp="30" kv="2" forcerange="-40 40"/>
    <motor name="bends" tendon="both" gear="2"/>
    <motor name="turns" joint="turn" gear="3"/>
  </actuator>
  <keyframe><key name="home" qpos="0.5 -0.25 0.75 0.5 0.5 -0.5 0.5"/></keyframe>
</mujoco>"""


@pytest.mark.unread("HX103")  # bodies between the joints of a chain have no mass
def test_the_joints_of_one_body_have_commands_poses_and_come_back(tmp_path: Path) -> None:
    """Joints on one body of MJCF are a chain of joints in URDF."""
    (tmp_path / "shoulder.xml").write_text(SHOULDER, "utf-8")
    urdf = tmp_path / "shoulder.urdf"
    report = hx.convert(tmp_path / "shoulder.xml", urdf, target="ros2").report
    assert [item for item in report if item.code.id == "HX104"] == []
    system, srdf = etree.parse(str(urdf)).find("ros2_control"), srdf_of(urdf)
    starts = {node.get("name"): node.findtext("state_interface[@name='position']/param") for node in system.findall("joint")}
    quarter = "1.5707963267948966"
    assert starts == {"lift": "0.5", "turn": "-0.25", "elbow": "0.75", "wrist_x": quarter, "wrist_y": None, "wrist": quarter}
    assert system.findtext("gpio/param[@name='joints']") == "turn elbow"
    assert [node.get("name") for node in srdf.find("group")] == ["lift", "turn", "elbow"]
    assert [node.get("name") for node in srdf.findall("passive_joint")] == ["wrist_x", "wrist_y", "wrist"]
    state = {node.get("name"): float(node.get("value")) for node in srdf.find("group_state")}
    assert [state[name] for name in ("lift", "turn", "elbow")] == [0.5, -0.25, 0.75]
    hx.convert(urdf, tmp_path / "back.xml", target="mujoco")
    before, after = (mujoco.MjModel.from_xml_path(str(tmp_path / name)) for name in ("shoulder.xml", "back.xml"))
    data, other = mujoco.MjData(before), mujoco.MjData(after)
    mujoco.mj_resetDataKeyframe(before, data, 0)
    mujoco.mj_resetDataKeyframe(after, other, 0)
    data.ctrl[:] = other.ctrl[:] = (0.3, -0.7, 0.2)
    for found, model in ((data, before), (other, after)):
        mujoco.mj_forward(model, found)
    assert other.body("ball").xmat == pytest.approx(data.body("ball").xmat, abs=1e-12)
    assert other.body("ball").xpos == pytest.approx(data.body("ball").xpos, abs=1e-12)
    assert [after.actuator(i).name for i in range(after.nactuator)] == ["lifts", "bends", "turns"]
    names = ("lift", "turn", "elbow")
    ours, theirs = ([float(found.joint(name).qfrc_actuator[0]) for name in names] for found in (data, other))
    assert theirs == pytest.approx(ours, rel=1e-9)
    assert all(ours)


GRIPPER = """<mujoco model="grip">
  <compiler angle="radian"/>
  <worldbody>
    <body name="hand">
      <inertial pos="0 0 0" mass="1" diaginertia="0.1 0.1 0.1"/>
      <body name="left" pos="0 0.1 0"><inertial pos="0 0 0" mass="0.1" diaginertia="1e-3 1e-3 1e-3"/>
        <joint name="l" type="slide" axis="0 1 0" range="0 0.04"/></body>
      <body name="right" pos="0 -0.1 0"><inertial pos="0 0 0" mass="0.1" diaginertia="1e-3 1e-3 1e-3"/>
        <joint name="r" type="slide" axis="0 -1 0" range="0 0.04"/></body>
    </body>
  </worldbody>
  <tendon><fixed name="split"><joint joint="l" coef="0.5"/><joint joint="r" coef="0.25"/></fixed></tendon>
  <actuator>
    <general name="fingers" tendon="split" gear="2" ctrlrange="0 255" forcerange="-100 100" gainprm="0.02" biastype="affine"
      biasprm="0 -100 -10"/>
  </actuator>
</mujoco>"""


def test_an_actuator_on_a_combination_of_joints_is_a_gpio_and_comes_back(tmp_path: Path) -> None:
    (tmp_path / "grip.xml").write_text(GRIPPER, "utf-8")
    report = hx.convert(tmp_path / "grip.xml", tmp_path / "grip.urdf", target="ros2").report
    assert "<ros2_control> has the drives of 1 combination of joints (--for ros2)" in [item.message for item in report]
    gpio = etree.parse(str(tmp_path / "grip.urdf")).find("ros2_control/gpio")
    assert gpio is not None
    assert {node.get("name"): node.text for node in gpio.iterfind("param")} == {
        "tendon": "split",
        "joints": "l r",
        "coefficients": "0.5 0.25",
    }
    assert [node.get("name") for node in gpio.iterfind("command_interface")] == ["position"]
    hx.convert(tmp_path / "grip.urdf", tmp_path / "back.xml", target="mujoco")
    before, after = (mujoco.MjModel.from_xml_path(str(tmp_path / name)) for name in ("grip.xml", "back.xml"))
    data, other = mujoco.MjData(before), mujoco.MjData(after)
    for ctrl in (0.0, 100.0, 255.0):
        data.ctrl[:] = other.ctrl[:] = ctrl
        for found in (data, other):
            found.joint("l").qpos[:], found.joint("r").qvel[:] = 0.02, 0.3
        mujoco.mj_forward(before, data)
        mujoco.mj_forward(after, other)
        ours, theirs = ([found.joint(name).qfrc_actuator[0] for name in "lr"] for found in (data, other))
        assert theirs == pytest.approx(ours, rel=1e-12)
        assert ours[0] == 2.0 * ours[1] != 0.0


@pytest.mark.parametrize(
    "change",
    [('name="joints">l r', 'name="joints">l none'), ("0.5 0.25", "0.5"), ('"actuator_type"', '"kind"')],
    ids=["no such joint", "a coefficient too few", "no type"],
)
def test_a_gpio_that_names_no_combination_is_none(change: tuple[str, str], tmp_path: Path) -> None:
    (tmp_path / "grip.xml").write_text(GRIPPER, "utf-8")
    hx.convert(tmp_path / "grip.xml", tmp_path / "grip.urdf", target="ros2")
    text = (tmp_path / "grip.urdf").read_text("utf-8")
    assert change[0] in text
    robot = hx.loads(text.replace(*change), "urdf").mechanism
    assert not dict(robot.vertices(Actuator))


def test_a_pose_comes_back_as_a_keyframe(urdf: Path, tmp_path: Path) -> None:
    hx.convert(urdf, tmp_path / "back.xml")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "back.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    assert [float(data.joint(name).qpos[0]) for name in ("shoulder", "b_left", "c_right", "a_thumb")] == [0.5, 0.01, 0.01, 0.03]


# ---- SRDF ----------------------------------------------------------------------------------------------------------------------


def srdf_problems(urdf: Path) -> list[str]:
    """What srdfdom's model.cpp reports of an SRDF file, rule by rule; nothing for a file that it takes."""
    tree, root = etree.parse(str(urdf)).getroot(), srdf_of(urdf)
    links, joints = ({element.get("name") for element in tree.findall(tag)} for tag in ("link", "joint"))
    virtual = {node.get("name") for node in root.findall("virtual_joint")}
    groups = [group.get("name") for group in root.findall("group")]
    wrong = [] if root.tag == "robot" else ["the root is not <robot>"]
    wrong += [] if root.get("name") == tree.get("name") else ["the robot has another name"]
    wrong += [f"<{node.tag}> is unknown" for node in root if node.tag not in KNOWN]
    wrong += [f"<{node.tag} {name}> is missing" for node in root for name in KNOWN.get(node.tag, ()) if not node.get(name)]
    wrong += [f"group {name} is there twice" for name, count in Counter(groups).items() if count > 1]
    for group in root.findall("group"):
        wrong += [f"group {group.get('name')} is empty"] if not len(group) else []
        wrong += [f"link {node.get('name')}" for node in group.findall("link") if node.get("name") not in links]
        wrong += [f"joint {node.get('name')}" for node in group.findall("joint") if node.get("name") not in joints | virtual]
    for state in root.findall("group_state"):
        wrong += [] if state.get("group") in groups else [f"group {state.get('group')} of a state"]
        wrong += [f"joint {node.get('name')} of a state" for node in state if node.get("name") not in joints | virtual]
        wrong += [f"value '{node.get('value')}'" for node in state if not [float(item) for item in (node.get("value") or "").split()]]
    wrong += [f"child {node.get('child_link')}" for node in root.findall("virtual_joint") if node.get("child_link") not in links]
    wrong += [f"type {n.get('type')}" for n in root.findall("virtual_joint") if n.get("type") not in ("fixed", "floating", "planar")]
    wrong += [f"passive {node.get('name')}" for node in root.findall("passive_joint") if node.get("name") not in joints | virtual]
    for pair in root.findall("disable_collisions"):
        wrong += [f"link {pair.get(end)} of a pair" for end in ("link1", "link2") if pair.get(end) not in links]
    return wrong


KNOWN = {
    "group": ("name",),
    "group_state": ("name", "group"),
    "end_effector": ("name", "parent_link", "group"),
    "virtual_joint": ("name", "type", "parent_frame", "child_link"),
    "passive_joint": ("name",),
    "disable_collisions": ("link1", "link2", "reason"),
}
"""The elements that are written, with the attributes that srdfdom (and MoveIt's setup assistant, of reasons) requires."""


@pytest.mark.parametrize("text", [FIXED, FLOATING])
def test_the_srdf_keeps_the_rules_of_srdfdom(text: str, tmp_path: Path) -> None:
    assert srdf_problems(package(text, tmp_path)) == []


def test_the_rules_find_what_is_wrong(urdf: Path) -> None:
    path = urdf.with_suffix(".srdf")
    text = path.read_text("utf-8").replace('link1="base"', 'link1="nowhere"').replace('group="all"', 'group="none"', 1)
    path.write_text(text.replace('value="0.5"', 'value=""'), "utf-8")
    assert sorted(set(srdf_problems(urdf))) == ["group none of a state", "link nowhere of a pair", "value ''"]


def test_the_srdf_has_the_group_the_pose_and_the_exclusions_with_their_reasons(urdf: Path) -> None:
    root = srdf_of(urdf)
    assert [node.get("name") for node in root.find("group")] == ["shoulder", "c_right"]
    assert [node.get("name") for node in root.findall("passive_joint")] == []
    assert {node.get("name"): node.get("value") for node in root.find("group_state[@name='home']")} == {
        "shoulder": "0.5",
        "b_left": "0.01",
        "c_right": "0.01",
        "a_thumb": "0.03",
    }
    pairs = {(node.get("link1"), node.get("link2")): node.get("reason") for node in root.findall("disable_collisions")}
    assert pairs == {
        ("base", "hand"): "User",
        ("base", "upper"): "Adjacent",
        ("upper", "hand"): "Adjacent",
        ("hand", "left"): "Adjacent",
        ("hand", "right"): "Adjacent",
        ("hand", "thumb"): "Adjacent",
    }


def test_the_srdf_beside_a_urdf_is_read_with_it_and_one_line_says_so(urdf: Path, tmp_path: Path) -> None:
    report = Report()
    robot = hx.load(urdf, report=report).mechanism
    assert [str(diagnostic) for diagnostic in report] == [
        "note[HX014]: 'arm.srdf' beside the robot is read with it: its exclusions, poses and groups"
    ]
    kinds = Counter(key.kind for key in (*robot.graph.vertices, *robot.graph.edges))
    assert (kinds["contact"], kinds["pose"], kinds["stance"]) == (6, 1, 1)
    (tmp_path / "other").mkdir()
    result = hx.convert(urdf, tmp_path / "other" / "arm.urdf", target="ros2")
    assert (tmp_path / "other" / "arm.srdf").read_bytes() == urdf.with_suffix(".srdf").read_bytes()
    assert result.losses == ()


@pytest.mark.parametrize("damage", ["<robot", "<other/>"])
@pytest.mark.unread("HX010")
def test_an_srdf_that_cannot_be_read_is_left_out_with_a_warning(damage: str, urdf: Path) -> None:
    urdf.with_suffix(".srdf").write_text(damage, "utf-8")
    report = Report()
    robot = hx.load(urdf, report=report).mechanism
    assert [diagnostic.severity.value for diagnostic in report if diagnostic.code.id == "HX014"] == ["warning"]
    assert not [key for key in robot.graph.edges if key.kind == "contact"]


# ---- paths of meshes -----------------------------------------------------------------------------------------------------------

TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
MESH = """<mujoco model="m"><asset><mesh name="hull" file="parts/hull.obj"/></asset>
<worldbody><body name="base"><geom type="mesh" mesh="hull"/><geom type="ellipsoid" size="1 2 3"/></body></worldbody></mujoco>"""


def test_meshes_are_in_the_package_in_which_the_output_lies(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "hull.obj").write_text(TETRAHEDRON, "utf-8")
    urdf = package(MESH, tmp_path)
    files = {node.get("filename") for node in etree.parse(str(urdf)).iter("mesh")}
    assert files == {"package://arm_description/meshes/hull.obj", "package://arm_description/shapes/base_ellipsoid.obj"}
    assert all((tmp_path / file.removeprefix("package://")).is_file() for file in files)
    assert hx.verify(tmp_path / "arm.xml", urdf, samples=2).is_same


def test_the_package_is_that_of_the_nearest_package_xml_and_a_prefix_can_be_given(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "hull.obj").write_text(TETRAHEDRON, "utf-8")
    (tmp_path / "arm.xml").write_text(MESH, "utf-8")
    (tmp_path / "pkg" / "urdf").mkdir(parents=True)
    (tmp_path / "pkg" / "package.xml").write_text("<package><name>my_robot</name></package>", "utf-8")
    hx.convert(tmp_path / "arm.xml", tmp_path / "pkg" / "urdf" / "arm.urdf", target="ros2")
    assert "package://my_robot/urdf/meshes/hull.obj" in (tmp_path / "pkg" / "urdf" / "arm.urdf").read_text("utf-8")
    result = hx.convert(tmp_path / "arm.xml", tmp_path / "plain.urdf", mesh_prefix="package://other/")
    assert "package://other/meshes/hull.obj" in (tmp_path / "plain.urdf").read_text("utf-8")
    plain = hx.convert(tmp_path / "arm.xml", tmp_path / "plain.urdf")
    assert [(loss.element, loss.field) for loss in result.losses or ()] == [(loss.element, loss.field) for loss in plain.losses or ()]
