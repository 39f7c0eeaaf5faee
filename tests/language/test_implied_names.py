"""What HyMeKo text leaves out because a name tells it: the child of a joint, the kind of what a reference means, the name of a shape."""

from __future__ import annotations

import pytest

import hymeko_x as hx
from hymeko_x.backends.hymeko import write
from hymeko_x.diagnostics import Report
from hymeko_x.ir.mechanism import Id, Mechanism
from hymeko_x.rewrite import Options


def read(text: str) -> Mechanism:
    robot = hx.loads(text, "hymeko").mechanism
    assert hx.loads(printed(robot), "hymeko").mechanism == robot
    return robot


def printed(robot: Mechanism) -> str:
    return write(robot, Options(), Report()).main.decode()


@pytest.mark.parametrize(
    ("joint", "body"),
    [("knee", "knee"), ("knee_joint", "knee"), ("knee_joint", "knee_link"), ("KneeJoint", "KneeLink"), ("joint3", "link3")],
)
def test_a_joint_leads_to_the_body_of_its_name(joint: str, body: str) -> None:
    robot = read(f"r : robot {{ thigh {{}} {body} {{}} @{joint} {{ + thigh - {body} }} }}")
    assert f"@{joint} {{ + thigh }}" in printed(robot)
    assert robot.joints[Id("joint", joint)].child == Id("body", body)


@pytest.mark.parametrize("other", ["knee_joint", "knee_link"])
def test_a_joint_names_its_child_where_its_name_means_another_body(other: str) -> None:
    robot = read(f"r : robot {{ thigh {{}} knee {{}} {other} {{}} @f : fixed {{ + thigh - {other} }} @knee_joint {{ + thigh - knee }} }}")
    assert "@knee_joint { + thigh - knee }" in printed(robot)


def test_in_an_assembly_too() -> None:
    robot = read("r : robot { pelvis {} left : assembly { hip_link {} @hip_joint { + pelvis } } hip_link { + pelvis } }")
    assert robot.joints[Id("joint", "left_hip_joint")].child == Id("body", "left_hip_link")


LEG = "r : robot { knee {} shin {} @knee { + knee - shin } knee : frame { + shin }"


@pytest.mark.parametrize(
    ("element", "kind"),
    [
        ("m : motor { [40] - knee }", "joint"),
        ("knee : servo { - knee }", "joint"),
        ("t : sensor.touch { + knee }", "frame"),
        ("p : sensor.jointpos { + knee }", "joint"),
        ("i : sensor.imu { + knee }", "body"),
    ],
)
def test_a_reference_means_what_an_actuator_drives_and_a_sensor_measures(element: str, kind: str) -> None:
    robot = read(f"{LEG} {element} }}")
    assert element in printed(robot)
    edge = next(edge for key, edge in robot.graph.edges.items() if key.kind in ("drive", "sense"))
    assert Id(kind, "knee") in [arc.target for arc in edge.arcs]


def test_another_kind_stands_before_the_name() -> None:
    robot = read(f"{LEG} b : sensor.touch {{ + body.knee }} }}")
    assert "b : sensor.touch { + body.knee }" in printed(robot)


def test_a_shape_is_named_after_its_mesh_or_its_body() -> None:
    robot = read("""r : robot { arm {
      visual { mesh "arm_look.obj" name } collision { box [1 1 1] name } collision { box [2 1 1] name=arm_look }
    } }""")
    shapes = robot.shapes[Id("body", "arm")]
    assert [view.shape.name for view in shapes] == ["arm_look", "arm", "arm_look"]
    assert 'visual { mesh "arm_look.obj" name } collision { box [1 1 1] name } collision { box [2 1 1] name=arm_look }' in " ".join(
        printed(robot).split()
    )
