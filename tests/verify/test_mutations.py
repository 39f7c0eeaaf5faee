"""The verifier can fail: every planted change is found, by the check that is there for it, at the element that was changed.

And it does not cry wolf: a robot is the same as itself written in another order, another notation or another format.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from lxml import etree
from msgspec import Struct

from hymeko_x.verify import verify
from tests.verify.robots import ARM_MJCF, ARM_URDF, RIG_MJCF

Write = Callable[[str, str], Path]

POSITION, ROTATION = "forward kinematics, position", "forward kinematics, rotation"
ROBOTS = {"arm.urdf": ("urdf", ARM_URDF), "arm.xml": ("mjcf", ARM_MJCF), "rig.xml": ("mjcf", RIG_MJCF)}


class Planted(Struct, frozen=True):
    """One planted change: an XPath to an attribute (set to ``to``) or an element (removed, or replaced), and who must see it where."""

    what: str
    robot: str
    path: str
    to: str | None
    check: str
    at: str

    @property
    def id(self) -> str:
        return f"{self.robot}: {self.what}"

    def apply(self, text: str) -> str:
        """The changed text."""
        root = etree.fromstring(text.encode())
        path, _, attribute = self.path.partition("/@")
        (element,) = root.xpath(path)
        if attribute:
            assert element.get(attribute) != self.to
            if self.to is None:
                del element.attrib[attribute]
            else:
                element.set(attribute, self.to)
        elif self.to is None:
            element.getparent().remove(element)
        elif self.to.startswith("+"):
            element.append(etree.fromstring(self.to[1:]))
        else:
            element.getparent().replace(element, etree.fromstring(self.to))
        return etree.tostring(root).decode()


def joint(name: str, rest: str = "") -> str:
    return f"//joint[@name='{name}']{rest}"


def link(name: str, rest: str = "") -> str:
    return f"//link[@name='{name}']{rest}"


def body(name: str, rest: str = "") -> str:
    return f"//body[@name='{name}']{rest}"


URDF = [
    # kinematics
    Planted("axis sign", "arm.urdf", joint("elbow", "/axis/@xyz"), "0 -0.6 -0.8", ROTATION, "body 'fore'"),
    Planted("axis turned", "arm.urdf", joint("roll", "/axis/@xyz"), "0 1 0", ROTATION, "body 'slider'"),
    Planted("slide axis sign", "arm.urdf", joint("rail", "/axis/@xyz"), "0 0 -1", POSITION, "body 'hand'"),
    Planted("axis dropped (x instead)", "arm.urdf", joint("shoulder", "/axis"), None, ROTATION, "body 'upper'"),
    Planted("axis tilted by 1e-6", "arm.urdf", joint("shoulder", "/axis/@xyz"), "1e-6 0 1", ROTATION, "body 'upper'"),
    Planted("origin shifted by 1e-6 m", "arm.urdf", joint("elbow", "/origin/@xyz"), "0 0.030001 0.3", POSITION, "body 'fore'"),
    Planted("origin in millimetres", "arm.urdf", joint("elbow", "/origin/@xyz"), "0 30 300", POSITION, "body 'fore'"),
    Planted("rpy order", "arm.urdf", joint("shoulder", "/origin/@rpy"), "0.3 0.2 0.1", ROTATION, "body 'upper'"),
    Planted("rpy in degrees", "arm.urdf", joint("rail", "/origin/@rpy"), "0 90 0", ROTATION, "body 'hand'"),
    Planted("rpy as intrinsic angles", "arm.urdf", joint("shoulder", "/origin/@rpy"), "0.0383 0.2205 0.2804", ROTATION, "body 'upper'"),
    Planted("origin dropped", "arm.urdf", joint("tool_mount", "/origin"), None, POSITION, "body 'tool'"),
    Planted("fixed pose turned", "arm.urdf", joint("tool_mount", "/origin/@rpy"), "0 0 0.500001", ROTATION, "body 'tool'"),
    # structure
    Planted("revolute made prismatic", "arm.urdf", joint("elbow", "/@type"), "prismatic", "joints", "elbow"),
    Planted("revolute made fixed", "arm.urdf", joint("elbow", "/@type"), "fixed", "joints", "elbow"),
    Planted("fixed made continuous", "arm.urdf", joint("tool_mount", "/@type"), "continuous", "joints", "tool_mount"),
    Planted(
        "continuous made revolute",
        "arm.urdf",
        joint("roll"),
        '<joint name="roll" type="revolute"><parent link="fore"/><child link="slider"/>'
        '<origin xyz="0.2 0 0.01"/><axis xyz="1 0 0"/><limit lower="-3" upper="3" effort="10" velocity="6"/></joint>',
        "position limits",
        "roll",
    ),
    Planted("another parent", "arm.urdf", joint("left_slide", "/parent/@link"), "slider", "joints", "body 'left'"),
    Planted("another parent of a fixed link", "arm.urdf", joint("tool_mount", "/parent/@link"), "left", "joints", "body 'tool'"),
    Planted("joint renamed", "arm.urdf", joint("shoulder", "/@name"), "shoulder_pan", "joints", "joint 'shoulder'"),
    Planted("fixed joint renamed", "arm.urdf", joint("tool_mount", "/@name"), "mount", "joints", "joint 'tool_mount'"),
    Planted("frame link dropped", "arm.urdf", "//link[@name='tool'] | //joint[@name='tool_mount']", None, "bodies", "body 'tool'"),
    Planted("frame link added", "arm.urdf", "/robot", "+<x/>", "bodies", "body 'extra'"),
    # limits and mechanics
    Planted("lower limit", "arm.urdf", joint("shoulder", "/limit/@lower"), "-2.0000001", "position limits", "shoulder"),
    Planted("upper limit in degrees", "arm.urdf", joint("elbow", "/limit/@upper"), "97.4", "position limits", "elbow"),
    Planted("slide limit in millimetres", "arm.urdf", joint("rail", "/limit/@upper"), "120", "position limits", "rail"),
    Planted("limits swapped in sign", "arm.urdf", joint("shoulder", "/limit/@upper"), "2", "position limits", "shoulder"),
    Planted("velocity limit", "arm.urdf", joint("elbow", "/limit/@velocity"), "4.1", "velocity limits", "elbow"),
    Planted("effort limit", "arm.urdf", joint("roll", "/limit/@effort"), "11", "effort limits", "roll"),
    Planted("damping", "arm.urdf", joint("shoulder", "/dynamics/@damping"), "0.70001", "damping", "shoulder"),
    Planted("friction", "arm.urdf", joint("elbow", "/dynamics/@friction"), "0", "friction", "elbow"),
    Planted("damping and friction dropped", "arm.urdf", joint("elbow", "/dynamics"), None, "damping", "elbow"),
    # mimic
    Planted("mimic dropped", "arm.urdf", joint("right_slide", "/mimic"), None, "couplings", "right_slide"),
    Planted("mimic multiplier", "arm.urdf", joint("right_slide", "/mimic/@multiplier"), "-2", "coupled coordinates", "right_slide"),
    Planted("mimic offset", "arm.urdf", joint("right_slide", "/mimic/@offset"), "0.0050001", "coupled coordinates", "right_slide"),
    Planted("mimic offset dropped", "arm.urdf", joint("right_slide", "/mimic/@offset"), None, POSITION, "body 'right'"),
    Planted("mimics another joint", "arm.urdf", joint("right_slide", "/mimic/@joint"), "rail", "coupled coordinates", "right_slide"),
    # inertia
    Planted("mass", "arm.urdf", link("upper", "/inertial/mass/@value"), "2.0000001", "mass", "body 'upper'"),
    Planted("mass in grams", "arm.urdf", link("left", "/inertial/mass/@value"), "50", "mass", "body 'left'"),
    Planted(
        "centre of mass by 1e-6 m", "arm.urdf", link("hand", "/inertial/origin/@xyz"), "0 0.000001 0.03", "centre of mass", "body 'hand'"
    ),
    Planted("centre of mass sign", "arm.urdf", link("slider", "/inertial/origin/@xyz"), "0 -0.01 0", "centre of mass", "body 'slider'"),
    Planted(
        "ixx and iyy swapped",
        "arm.urdf",
        link("hand", "/inertial/inertia"),
        '<inertia ixx="0.0004" iyy="0.0003" izz="0.0002" ixy="0" ixz="0" iyz="0"/>',
        "inertia tensor",
        "body 'hand'",
    ),
    Planted(
        "sign of a product of inertia", "arm.urdf", link("upper", "/inertial/inertia/@ixz"), "0.0005", "inertia tensor", "body 'upper'"
    ),
    Planted(
        "ixy and iyz swapped",
        "arm.urdf",
        link("upper", "/inertial/inertia"),
        '<inertia ixx="0.016" iyy="0.018" izz="0.004" ixy="0.0002" ixz="-0.0005" iyz="0.001"/>',
        "inertia tensor",
        "body 'upper'",
    ),
    Planted("frame of the tensor dropped", "arm.urdf", link("fore", "/inertial/origin/@rpy"), None, "inertia tensor", "body 'fore'"),
    Planted(
        "frame of the tensor inverted", "arm.urdf", link("fore", "/inertial/origin/@rpy"), "-0.3 0.2 -0.7", "inertia tensor", "body 'fore'"
    ),
    Planted("inertial dropped", "arm.urdf", link("slider", "/inertial"), None, "mass", "body 'slider'"),
    Planted("inertia seen in the mass matrix", "arm.urdf", link("fore", "/inertial/mass/@value"), "1.3", "mass matrix", "joint"),
    Planted("inertia seen in the gravity torque", "arm.urdf", link("fore", "/inertial/mass/@value"), "1.3", "gravity torque", "joint"),
    # shapes
    Planted("collision dropped", "arm.urdf", link("fore", "/collision"), None, "collision shapes", "body 'fore'"),
    Planted("visual dropped", "arm.urdf", link("upper", "/visual"), None, "visual shapes", "body 'upper'"),
    Planted(
        "sphere made a box",
        "arm.urdf",
        link("fore", "/collision/geometry/sphere"),
        '<box size="0.1 0.1 0.1"/>',
        "collision shapes",
        "body 'fore'",
    ),
    Planted(
        "box halved",
        "arm.urdf",
        link("hand", "/collision/geometry/box/@size"),
        "0.04 0.02 0.03",
        "collision shapes, size and pose",
        "body 'hand'",
    ),
    Planted(
        "box axes swapped",
        "arm.urdf",
        link("fore", "/visual/geometry/box/@size"),
        "0.06 0.2 0.04",
        "visual shapes, size and pose",
        "body 'fore'",
    ),
    Planted(
        "cylinder length as half",
        "arm.urdf",
        link("upper", "/visual/geometry/cylinder/@length"),
        "0.15",
        "visual shapes, size and pose",
        "body 'upper'",
    ),
    Planted(
        "radius as diameter",
        "arm.urdf",
        link("fore", "/collision/geometry/sphere/@radius"),
        "0.12",
        "collision shapes, size and pose",
        "body 'fore'",
    ),
    Planted(
        "collision pose dropped", "arm.urdf", link("upper", "/collision/origin"), None, "collision shapes, size and pose", "body 'upper'"
    ),
    Planted(
        "collision turned",
        "arm.urdf",
        link("upper", "/collision/origin/@rpy"),
        "0 0.1001 0",
        "collision shapes, size and pose",
        "body 'upper'",
    ),
]

MJCF = [
    Planted(
        "quaternion order", "rig.xml", body("thigh", "/@quat"), "0.25881904510252074 0 0 0.96592582628906831", ROTATION, "body 'thigh'"
    ),
    Planted("anchor", "rig.xml", joint("hip_x", "/@pos"), "0 0 0.021", POSITION, "body 'thigh'"),
    Planted("anchor of a ball", "rig.xml", joint("ankle", "/@pos"), None, POSITION, "body 'foot'"),
    Planted("order of joints on one body", "rig.xml", body("thigh"), None, "joints", "hip_x"),
    Planted("reference", "rig.xml", joint("hip_y", "/@ref"), "0.3", "coordinate references", "hip_y"),
    Planted("armature", "rig.xml", joint("knee", "/@armature"), "0.021", "armature", "knee"),
    Planted("stiffness", "rig.xml", joint("hip_y", "/@stiffness"), "21", "stiffness", "hip_y"),
    Planted("spring reference", "rig.xml", joint("hip_y", "/@springref"), "0.11", "spring reference", "hip_y"),
    Planted("damping of a ball", "rig.xml", joint("ankle", "/@damping"), "0.3", "damping", "ankle"),
    Planted("range given in degrees", "rig.xml", "//compiler/@angle", "degree", "position limits", "joint"),
    Planted("range dropped", "rig.xml", joint("knee", "/@range"), None, "position limits", "knee"),
    Planted("one-sided force range", "rig.xml", joint("knee", "/@actuatorfrcrange"), "-90 80", "effort limits", "knee"),
    Planted("free base made fixed", "rig.xml", "//freejoint", None, "base", "body 'torso'"),
    Planted("free body starts elsewhere", "rig.xml", body("torso", "/@pos"), "0 0 1.1", POSITION, "body 'torso'"),
    Planted("ball made a hinge", "rig.xml", joint("ankle", "/@type"), "hinge", "joints", "ankle"),
    Planted("loop dropped", "rig.xml", "//connect", None, "loops", "loop 'pin'"),
    Planted("loop's anchor", "rig.xml", "//connect/@anchor", "0.21 0 0", "loop closure, position", "loop 'pin'"),
    Planted("loop joins another body", "rig.xml", "//connect/@body2", "gear", "loops", "loop 'pin'"),
    Planted("loop made inactive", "rig.xml", "//connect/@active", "false", "loops", "loop 'pin'"),
    Planted("weld turned", "rig.xml", "//weld/@relpose", "0.1 0.2 0.3 0.7 0 0 0.7", "loop closure, rotation", "loop 'clamp'"),
    Planted("weld shifted", "rig.xml", "//weld/@relpose", "0.1 0.2 0.4 1 0 0 0", "loop closure, position", "loop 'clamp'"),
    Planted("coupling's ratio", "rig.xml", "//equality/joint/@polycoef", "0.1 -3.001 0.5 0 0", "coupled coordinates", "gear_joint"),
    Planted("coupling's square term", "rig.xml", "//equality/joint/@polycoef", "0.1 -3 0 0 0", "coupled coordinates", "gear_joint"),
    Planted("coupling dropped", "rig.xml", "//equality/joint", None, "couplings", "gear_joint"),
    Planted("tendon's coefficient", "rig.xml", "//fixed/joint[@joint='knee']/@coef", "0.25", "tendons, coefficients", "hamstring"),
    Planted("tendon on another joint", "rig.xml", "//fixed/joint[@joint='knee']/@joint", "hip_x", "tendons", "hamstring"),
    Planted("tendon dropped", "rig.xml", "//tendon", None, "tendons", "hamstring"),
    Planted("actuator's gear", "rig.xml", "//motor/@gear", "-12", "actuators, numbers", "crank_motor"),
    Planted("actuator's gain", "rig.xml", "//position/@kp", "51", "actuators, numbers", "knee_servo"),
    Planted("actuator on another joint", "rig.xml", "//motor/@joint", "rod_joint", "actuators", "crank_motor"),
    Planted("actuator dropped", "rig.xml", "//motor", None, "actuators", "crank_motor"),
    Planted("mirrored mesh", "rig.xml", "//mesh/@scale", "1 -1 1", "collision meshes", "body 'thigh'"),
    Planted("mesh in millimetres", "rig.xml", "//mesh/@scale", "0.001 0.001 0.001", "collision meshes", "body 'thigh'"),
    Planted("mesh moved", "rig.xml", "//geom[@name='thigh_mesh']/@pos", "0 0 -0.11", "collision meshes", "body 'thigh'"),
    Planted(
        "geom collides no more",
        "rig.xml",
        "//geom[@name='sole']",
        '<geom name="sole" type="box" size="0.08 0.03 0.01" pos="0.03 0 0" contype="0" conaffinity="0"/>',
        "collision shapes",
        "body 'foot'",
    ),
    Planted("world's geometry", "rig.xml", "//geom[@name='floor']/@pos", "0 0 0.1", "collision shapes, size and pose", "body 'world'"),
    Planted("fixed body moved", "rig.xml", body("anvil", "/@pos"), "1 0 0.21", POSITION, "body 'anvil'"),
    Planted("fixed body turned", "rig.xml", body("anvil", "/@pos"), "1 0 0.2000001", POSITION, "body 'anvil'"),
    Planted("body renamed", "rig.xml", body("rocker", "/@name"), "rocker2", "bodies", "body 'rocker'"),
    Planted("inertial frame dropped", "arm.xml", body("fore", "/inertial/@euler"), None, "inertia tensor", "body 'fore'"),
    Planted(
        "diagonal permuted", "arm.xml", body("hand", "/inertial/@diaginertia"), "0.0002 0.0003 0.0004", "inertia tensor", "body 'hand'"
    ),
    Planted("euler sequence", "arm.xml", "//compiler/@eulerseq", "xyz", ROTATION, "body 'upper'"),
    Planted(
        "coupling in the other direction",
        "arm.xml",
        "//equality/joint",
        '<joint joint1="left_slide" joint2="right_slide" polycoef="-0.0025 0.5 0 0 0"/>',
        "couplings",
        "right_slide",
    ),
]

ALL = [*URDF, *MJCF]

ONLY_URDF = ("velocity limit", "fixed joint renamed")
IN_BOTH = [planted for planted in URDF if planted.what not in ONLY_URDF]


def mutated(planted: Planted) -> str:
    """The text of the robot with its change; a few changes take more than one edit."""
    text = ROBOTS[planted.robot][1]
    if planted.what == "body renamed":
        return planted.apply(text).replace('body2="rocker"', 'body2="rocker2"')
    if planted.what == "frame link dropped":
        return text.replace('<link name="tool"/>', "").replace(text[text.index('<joint name="tool_mount"') : text.index("</robot>")], "")
    if planted.what == "frame link added":
        extra = '<link name="extra"/><joint name="extra_mount" type="fixed"><parent link="hand"/><child link="extra"/></joint></robot>'
        return text.replace("</robot>", extra)
    if planted.what == "order of joints on one body":
        first, second = (line for line in text.splitlines() if 'name="hip_x"' in line or 'name="hip_y"' in line)
        return text.replace(f"{first}\n{second}", f"{second}\n{first}")
    return planted.apply(text)


def test_the_suite_holds_at_least_60_kinds_of_change() -> None:
    assert len({planted.what for planted in ALL}) >= 60


@pytest.mark.parametrize("planted", ALL, ids=lambda planted: planted.id)
def test_a_planted_change_is_found_where_it_is(planted: Planted, written: Write) -> None:
    format, text = ROBOTS[planted.robot]
    verdict = verify(written(format, text), written(format, mutated(planted)), samples=20)
    assert verdict.verdict == "different"
    failed = {check.quantity: check.at for check in verdict.failed}
    assert planted.check in failed
    assert planted.at in failed[planted.check]


@pytest.mark.parametrize("planted", IN_BOTH, ids=lambda planted: planted.id)
def test_a_planted_change_is_found_in_another_format(planted: Planted, written: Write) -> None:
    """The same change, seen from the MJCF file."""
    verdict = verify(written("mjcf", ARM_MJCF), written("urdf", mutated(planted)), samples=20)
    assert verdict.verdict == "different"
    failed = {check.quantity: check.at for check in verdict.failed}
    assert planted.check in failed
    assert planted.at in failed[planted.check]


# ---- no false alarm --------------------------------------------------------------------------------------------------


def turned_around(text: str) -> str:
    """The same robot with the children of every element but poses and numbers in reverse order."""
    root = etree.fromstring(text.encode())
    for parent in root.iter("robot", "worldbody", "body", "equality", "actuator", "asset", "mujoco"):
        joints = [child for child in parent if child.tag in ("joint", "freejoint") and parent.tag == "body"]
        others = [child for child in reversed(parent) if child not in joints]
        for child in [*joints, *others]:
            parent.append(child)
    return etree.tostring(root).decode()


def rewritten(text: str) -> str:
    """The same robot without blanks and comments, with numbers spelled differently."""
    root = etree.fromstring(text.encode(), etree.XMLParser(remove_blank_text=True))
    for element in root.iter():
        for name, value in element.attrib.items():
            if name not in ("name", "model", "joint", "joint1", "joint2", "body1", "body2", "link", "angle"):
                element.set(name, " ".join(_respelled(word) for word in value.split()))
    return etree.tostring(root).decode()


def _respelled(word: str) -> str:
    try:
        return f"{float(word):.17e}" if "." in word else word
    except ValueError:
        return word


@pytest.mark.parametrize("change", [str, turned_around, rewritten], ids=["itself", "reordered", "rewritten"])
@pytest.mark.parametrize("robot", ROBOTS)
def test_a_robot_is_the_same_as(change: Callable[[str], str], robot: str, written: Write) -> None:
    format, text = ROBOTS[robot]
    verdict = verify(written(format, text), written(format, change(text)))
    assert [f"{check.quantity} at {check.at}" for check in verdict.failed] == []
    assert verdict.is_same


@pytest.mark.parametrize("order", [1, -1], ids=["urdf to mjcf", "mjcf to urdf"])
def test_a_robot_is_the_same_in_two_formats(order: int, written: Write) -> None:
    files = [written("urdf", ARM_URDF), written("mjcf", ARM_MJCF)][::order]
    verdict = verify(*files)
    assert [f"{check.quantity} at {check.at}" for check in verdict.failed] == []
    assert verdict.is_same
    assert max(check.worst for check in verdict.checks if check.quantity in (POSITION, ROTATION)) < 1e-14
