"""Stereotypes are called after what their elements are, and never like one of them."""

from __future__ import annotations

import re

import hymeko_x as hx

MASS = '<inertial><mass value="0.125"/><inertia ixx="0.0625" iyy="0.03125" izz="0.015625" ixy="0" ixz="0" iyz="0"/></inertial>'
LIMIT = '<limit lower="-1.0625" upper="1.0625" effort="40" velocity="10"/><dynamics damping="0.125" friction="0.0625"/>'
WHITE = '<material name="white"><color rgba="1 1 1 1"/></material>'


def _printed(*links: str) -> str:
    """The HyMeKo text of links below a base, each with a joint of its name."""
    text = '<link name="base"/>'
    for name, content in (link.split("|") for link in links):
        text += f'<link name="{name}">{MASS}{content}</link><joint name="{name}_joint" type="revolute">'
        text += f'<parent link="base"/><child link="{name}"/><axis xyz="0 1 0"/>{LIMIT}</joint>'
    return hx.dumps(hx.loads(f'<robot name="r">{text}</robot>'.encode(), "urdf"), "hymeko")


def _stereotypes(text: str) -> list[str]:
    return re.findall(r"^  (\w+)\(\)", text, re.MULTILINE)


def test_joints_and_bodies_are_called_after_the_words_of_their_names() -> None:
    found = _stereotypes(_printed(*(f"{size}_thigh|" for size in ("big", "small", "thin", "fat"))))
    assert found == ["thigh", "thigh_joint"]


def test_a_stereotype_is_not_called_like_an_element() -> None:
    text = _printed("joint1|", "joint2|", "joint3|", "joint4|")
    names = re.findall(r"^  @?(\w+)(?: :| \{)", text, re.MULTILINE)
    assert _stereotypes(text) == ["part", "axle"]
    assert not {*_stereotypes(text)} & {*names}


def test_shapes_are_called_after_their_material_where_their_bodies_have_nothing_in_common() -> None:
    shape = f'<visual><geometry><box size="{{0}} 1 1"/></geometry>{WHITE}</visual>'
    text = _printed(
        *(f"{name}|{shape.format(size)}" for size, name in enumerate(("arm", "hand", "leg", "head", "neck", "toe", "eye", "ear", "jaw"), 1))
    )
    assert "white() { material=white }" in text
    assert text.count("visual : white {") == 9


def test_shapes_are_called_after_what_their_bodies_are() -> None:
    shape = '<collision><geometry><cylinder radius="0.0625" length="0.125"/></geometry></collision>'
    text = _printed(*(f"{size}_wheel|{shape}" for size in ("big", "small", "thin", "fat")))
    assert _stereotypes(text) == ["wheel", "wheel_hull", "wheel_joint"]
    robot = hx.loads(text, "hymeko")
    assert hx.loads(hx.dumps(robot, "hymeko"), "hymeko") == robot


def _joints(*pairs: str) -> list[str]:
    """The stereotypes of a HyMeKo robot with these joints, each ``name|child``, that share much."""
    ends = [pair.split("|") for pair in pairs]
    bodies = " ".join(f"{child} {{ mass {number} }}" for number, (_, child) in enumerate(ends, 1))
    joints = " ".join(f"@{name} {{ + base - {child} axis=Y limit [-61 61] effort 41 velocity 121 damping 0.125 }}" for name, child in ends)
    return _stereotypes(hx.dumps(hx.loads(f"r : robot {{ base {{}} {bodies} {joints} }}", "hymeko"), "hymeko"))


def test_joints_of_one_limb_are_called_after_it() -> None:
    assert _joints("shoulder_pan|a", "elbow|b", "wrist_1|c", "wrist_2|d") == ["arm_joint"]
    assert _joints("RHipPitch|a", "RKneePitch|b", "LHipRoll|c", "LAnkleRoll|d") == ["leg_joint"]
    assert _joints("index_finger_joint1|a", "index_finger_joint2|b", "little_finger_joint1|c", "little_finger_joint2|d") == ["finger_joint"]


def test_joints_called_by_number_are_called_after_what_they_move() -> None:
    assert _joints("j1|left_wheel", "j2|right_wheel", "j3|third_wheel") == ["wheel_joint"]


def test_shapes_beside_their_bodies_are_called_after_the_side() -> None:
    shape = "box [0.0625 0.125 0.25] rgba [0.125 0.25 0.5] name=x"
    places = ("0 0.03125 0", "0 0.03125 0", "0 -0.03125 0", "0 -0.03125 0")
    legs = " ".join(f"hip{n} {{ mass {n} visual {{ {shape}{n} at [[{place}] [12.25 34.5 56.75]] }} }}" for n, place in enumerate(places, 1))
    text = hx.dumps(hx.loads(f"r : robot {{ {legs} }}", "hymeko"), "hymeko")
    assert _stereotypes(text) == ["hip", "right_hip_look", "left_hip_look"]


def _of_text(text: str) -> list[str]:
    return _stereotypes(hx.dumps(hx.loads(f"r : robot {{ {text} }}", "hymeko"), "hymeko"))


def test_pairs_that_do_not_collide_are_called_after_the_reason() -> None:
    bodies = " ".join(f"link{number} {{}}" for number in range(9))
    pairs = [(near, far, "Adjacent" if far == near + 1 else "Never") for near in range(8) for far in (near + 1, 8)]
    text = " ".join(f"@pair{a}{b} : exclude {{ ~ link{a} ~ link{b} reason={reason} }}" for a, b, reason in dict.fromkeys(pairs))
    assert _of_text(f"{bodies} {text}") == ["adjacent", "never"]


def test_materials_that_share_their_gloss_are_called_glossy() -> None:
    colours = ("red", "green", "blue", "white", "grey")
    paints = " ".join(f"{name} : material {{ rgba [0.{n} 0 0] specular 0.53125 shininess 0.28125 }}" for n, name in enumerate(colours, 1))
    assert _of_text(paints) == ["glossy"]


def test_frames_called_by_their_side_are_called_after_their_body() -> None:
    calves = " ".join(
        f"{side}_calf {{}} {side} : frame {{ [0 0 0.{n}] + {side}_calf size [0.0234375 0.0234375 0.0234375] }}"
        for n, side in enumerate(("FL", "FR", "RL", "RR"), 1)
    )
    assert _of_text(calves) == ["calf_mark"]


def test_shapes_whose_bodies_gave_their_name_to_others_are_called_after_their_form() -> None:
    solids = ("box [0.0234375 0.0390625 0.0546875]", "capsule [0.0234375 0.0390625]", "sphere 0.0234375", "cylinder [0.0390625 0.0546875]")
    shapes = " ".join(f"collision {{ {solid} friction [0.6015625] }}" for solid in solids)
    bodies = " ".join(f"{side}_down {{ {shapes} }}" for side in ("big", "small", "thin", "fat"))
    assert _of_text(bodies) == ["down", "down_hull", "collision", "down_capsule", "down_sphere"]


def test_a_stereotype_whose_name_another_one_has_is_called_after_what_it_gives() -> None:
    limits = [("-3.140625", "3.140625")] * 5 + [(f"-1.{n}25", f"1.0{n}25") for n in range(1, 6)]
    links = "".join(f'<link name="x{n}">{MASS}</link>' for n in range(11))
    joints = "".join(
        f'<joint name="q{n}" type="revolute"><parent link="x{n - 1}"/><child link="x{n}"/><origin xyz="0 0 0.{n}"/><axis xyz="0 0 1"/>'
        f'<limit lower="{lower}" upper="{upper}" effort="40.{n}" velocity="10.0625"/><dynamics damping="0.125" friction="0.0625"/></joint>'
        for n, (lower, upper) in enumerate(limits, 1)
    )
    text = hx.dumps(hx.loads(f'<robot name="r">{links}{joints}</robot>'.encode(), "urdf"), "hymeko")
    assert _stereotypes(text) == ["part", "axle", "limited_axle"]


def test_transmissions_are_called_after_their_interface() -> None:
    links = "".join(f'<link name="x{n}">{MASS}</link>' for n in range(9))
    joints = "".join(
        f'<joint name="q{n}" type="continuous"><parent link="x{n - 1}"/><child link="x{n}"/><axis xyz="0 0 1"/></joint>'
        f'<transmission name="t{n}"><type>{"a" * n}</type><joint name="q{n}"/><actuator name="m{n}">'
        "<hardwareInterface>hardware_interface/VelocityJointInterface</hardwareInterface></actuator></transmission>"
        for n in range(1, 9)
    )
    text = hx.dumps(hx.loads(f'<robot name="r">{links}{joints}</robot>'.encode(), "urdf"), "hymeko")
    assert "velocity_drive" in _stereotypes(text)
