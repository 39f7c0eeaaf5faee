"""Short words for what many files repeat: rounded angles, the ending of files, and the actuators of transmissions."""

from __future__ import annotations

import math

import pytest

import hymeko_x as hx
from hymeko_x.ir.mechanism import Id, Mechanism
from hymeko_x.ir.parts import Actuator


def limits(text: str) -> tuple[float | None, ...]:
    """The lower and upper limits of the joints of a HyMeKo text, in rad."""
    robot = hx.loads(text, "hymeko").mechanism
    return tuple(
        bound for view in robot.joints.values() for dof in view.joint.dofs for bound in (dof.limits.lower, dof.limits.upper) if dof.limits
    )


def urdf(*joints: str, rest: str = "") -> Mechanism:
    links = "".join(f'<link name="l{number}"/>' for number in range(len(joints) + 1))
    body = "".join(
        f'<joint name="j{number}" type="revolute"><parent link="l{number}"/><child link="l{number + 1}"/>{joint}</joint>'
        for number, joint in enumerate(joints)
    )
    return hx.loads(f'<robot name="r">{links}{body}{rest}</robot>', "urdf").mechanism


def limit(lower: str, upper: str) -> str:
    return f'<limit lower="{lower}" upper="{upper}" effort="1" velocity="1"/>'


def round_trip(robot: Mechanism) -> str:
    """The HyMeKo text of a robot, which brings the same robot back."""
    text = hx.dumps(robot, "hymeko")
    back = hx.loads(text, "hymeko").mechanism
    assert back == robot
    assert hx.dumps(back, "hymeko") == text
    return text


JOINT = "r : robot {{ {units} a {{}} b {{}} @j {{ + a - b limit [-90 {upper}] }} }}"


@pytest.mark.parametrize(
    ("units", "lower"), [("", -math.pi / 2), ("units { digits 12 }", -1.57079632679), ("units { digits 3 angle deg }", -1.57)]
)
def test_plain_angles_have_so_many_digits_of_a_radian(units: str, lower: float) -> None:
    assert limits(JOINT.format(units=units, upper="1.234567890123rad")) == (lower, 1.234567890123)


@pytest.mark.parametrize("digits", ["0", "17", "-1", "2.5"])
def test_angles_have_1_to_16_digits(digits: str) -> None:
    with pytest.raises(hx.Refusal):
        limits(JOINT.format(units=f"units {{ digits {digits} }}", upper="90"))


def test_angles_that_were_rounded_are_printed_in_degrees() -> None:
    text = round_trip(urdf(limit("-1.57079632679", "2.61799387799"), limit("-0.785398163397", "0.5"), limit("0", "1.0471975512")))
    assert "units { digits 12 }" in text
    assert [line for line in text.splitlines() if "limit" in line] != []
    assert "limit [-90 150]" in text
    assert "limit [-45 0.5rad]" in text
    assert "limit [0 60]" in text


def test_a_number_that_is_shorter_in_radians_stays_in_radians() -> None:
    assert "limit [0.3rad 180]" in round_trip(urdf(limit("0.3", repr(math.pi)), limit(repr(math.pi / 4), repr(math.pi / 2))))


def mesh(name: str) -> str:
    return f'<link name="m{abs(hash(name))}"><visual><geometry><mesh filename="{name}"/></geometry></visual></link>'


@pytest.mark.parametrize(
    ("names", "files", "short"),
    [
        (["a.stl", "b/c.stl", "d.stl"], "*.stl", ["a", "b/c", "d"]),
        (["a.stl", "b.stl", "d.obj"], "*.stl", ["a", "b", "d.obj"]),
        (["a.stl", "b.stl", "v1.2.stl"], "*.stl", ["a", "b", "v1.2.stl"]),
        (["a.stl", "b.dae", "c.obj"], "", ["a.stl", "b.dae", "c.obj"]),
    ],
    ids=["one ending", "another ending", "a dot in a name", "three endings"],
)
def test_files_of_one_folder_and_ending_are_named_by_their_stems(names: list[str], files: str, short: list[str]) -> None:
    folder = "package://robot_description/meshes/"
    shapes = "".join(f'<visual><geometry><mesh filename="{folder}{name}"/></geometry></visual>' for name in names)
    text = round_trip(hx.loads(f'<robot name="r"><link name="a">{shapes}</link></robot>', "urdf").mechanism)
    assert f'files "{folder}{files}"' in text
    assert [f'visual "~/{name}"' in text for name in short] == [True] * len(short)


def test_a_file_without_an_ending_is_named_in_full_beside_others_with_one() -> None:
    names = ("p/a.stl", "p/b.stl", "p/c.stl", "p/bare")
    shapes = "".join(f'<visual><geometry><mesh filename="package://{name}"/></geometry></visual>' for name in names)
    text = round_trip(hx.loads(f'<robot name="r"><link name="a">{shapes}</link></robot>', "urdf").mechanism)
    assert 'visual "package://p/bare"' in text


TRANSMISSION = """<transmission name="{name}"><type>t/Simple</type><joint name="{joint}"/><actuator name="{actuator}"/></transmission>"""


def test_the_actuator_of_a_transmission_need_not_be_described() -> None:
    text = "r : robot { a {} b {} c {} @j { + a - b } @k { + b - c } @t : drive.Simple { + m - j } @u : drive.Simple { + m - k } }"
    robot = hx.loads(text, "hymeko").mechanism
    assert dict(robot.vertices(Actuator)) == {Id("actuator", "m"): Actuator("transmission")}


def test_the_actuator_of_another_drive_is_described() -> None:
    with pytest.raises(hx.Refusal, match="'m' is not defined"):
        hx.loads("r : robot { a {} b {} @j { + a - b } @t : drive { + m - j } }", "hymeko")


@pytest.mark.parametrize(
    ("actuator", "is_implied"),
    [("motor", True), ("arm_motor", True), ("j0", False), ("world", False)],
)
def test_an_actuator_that_says_nothing_is_not_printed(actuator: str, is_implied: bool) -> None:
    robot = urdf(limit("0", "1"), rest=TRANSMISSION.format(name="t", joint="j0", actuator=actuator))
    assert ("actuator.transmission {}" not in round_trip(robot)) == is_implied


@pytest.mark.parametrize(("actuator", "is_implied"), [("arm_long_name_{}_motor", True), ("arm_{}_motor", False)])
def test_in_an_assembly_it_has_its_end_alone(actuator: str, is_implied: bool) -> None:
    links = '<link name="base"/>' + "".join(f'<link name="arm_long_name_{number}"/>' for number in range(4))
    parents = ["base", *(f"arm_long_name_{number}" for number in range(3))]
    joints = "".join(
        f'<joint name="arm_long_name_{number}_joint" type="revolute"><parent link="{parent}"/><child link="arm_long_name_{number}"/>'
        f"{limit(str(number), '4')}</joint>"
        for number, parent in enumerate(parents)
    )
    drives = "".join(
        TRANSMISSION.format(name=f"arm_long_name_{number}_drive", joint=f"arm_long_name_{number}_joint", actuator=actuator.format(number))
        for number in range(4)
    )
    robot = hx.loads(f'<robot name="r">{links}{joints}{drives}</robot>', "urdf").mechanism
    text = round_trip(robot)
    assert ": assembly" in text
    assert ("actuator.transmission {}" not in text) == is_implied
